#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "framework/core/text/fault.hpp"

/// Faults for programs, and the table of their codes for people.
namespace tomlin {

/// An array of {code, file, line, column, key, value, why, admissible, did_you_mean}; null is what
/// a fault has not.
nlohmann::ordered_json faults_json(const std::vector<Fault>& faults);

/// Indented. Faults and paths of libraries may hold any bytes: what is not UTF-8 is replaced.
std::string json_text(const nlohmann::ordered_json& json);

/// Meaning of a code, with an example and a cure: for `describe CODE` and `describe diagnostics`.
std::string diagnostic_text(const FaultKind& kind);
nlohmann::ordered_json diagnostic_json(const FaultKind& kind);
std::string diagnostics_text();
nlohmann::ordered_json diagnostics_json();
/// In Markdown, under a heading for each group of codes.
std::string diagnostic_section(const FaultKind& kind);
std::string diagnostics_section();

}  // namespace tomlin
