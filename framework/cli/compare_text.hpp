#pragma once

#include <string>

#include "framework/study/compare.hpp"

namespace tomlin {

/// For people: a row for each model, then the answer; `where` says where the files are.
std::string compare_text(const Comparison& comparison, const std::string& where);

/// A row for each model, 17 digits.
std::string compare_csv(const Comparison& comparison);
std::string compare_json(const Comparison& comparison);

/// The drivers' forces along their pull over their way: a row for each sample of each model.
std::string compare_curves_csv(const Comparison& comparison);

}  // namespace tomlin
