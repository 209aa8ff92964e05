#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "framework/core/text/fault.hpp"
#include "framework/core/text/warning.hpp"

/// Tests assert the location, key, value and code of a fault and the name that it suggests, not its
/// wording; and the key and code of a warning.
namespace tomlin::test {

/// `12:10 body.ring.radiu = 1 [scene.unknown_key] did you mean radius`; what a fault has not is
/// left out.
inline std::string brief(const Fault& fault) {
  std::string text;
  if (fault.location.line > 0)
    text = fmt::format("{}:{} ", fault.location.line, fault.location.column);
  text += fault.key;
  if (!fault.value.empty()) text += " = " + fault.value;
  text += fmt::format("{}[{}]", text.empty() || text.back() == ' ' ? "" : " ", id_of(fault.code));
  if (!fault.nearest.empty()) text += " did you mean " + fault.nearest;
  return text;
}

inline std::vector<std::string> briefs(const InputError& error) {
  std::vector<std::string> all;
  for (const Fault& fault : error.faults()) all.push_back(brief(fault));
  return all;
}

/// `drivers.driver [run.few_slips]`: of a warning its key and code.
inline std::string brief(const Warning& warning) {
  return fmt::format("{}{}[{}]", warning.key, warning.key.empty() ? "" : " ", id_of(warning.code));
}

inline std::vector<std::string> briefs(const std::vector<Warning>& warnings) {
  std::vector<std::string> all;
  for (const Warning& warning : warnings) all.push_back(brief(warning));
  return all;
}

/// How many of them have this code.
inline std::size_t count_of(FaultCode code, const std::vector<Warning>& warnings) {
  std::size_t count = 0;
  for (const Warning& warning : warnings) count += warning.code == code ? 1 : 0;
  return count;
}

/// Error lines of the program likewise: `pt.toml:12:10: run.duration = -1 [scene.out_of_range]`,
/// `tomlin: [command.unknown] did you mean run`. Lines without a code stay as they are.
inline std::string abridged(const std::string& errors) {
  static const std::regex form(
      R"re(^(.*?): error: (?:((?:[^ :"]|"[^"]*")+(?: = (?:[^:"]|"[^"]*")+)?): )?)re"
      R"re(.*?(?:did you mean "([^"]*)"\?)? (\[[a-z_]+\.[a-z_.]+\])$)re");
  std::istringstream stream(errors);
  std::string text;
  for (std::string line; std::getline(stream, line);) {
    std::smatch found;
    if (!text.empty()) text += '\n';
    if (!std::regex_match(line, found, form)) {
      text += line;
      continue;
    }
    text += found.str(1) + ": ";
    if (found[2].matched) text += found.str(2) + " ";
    text += found.str(4);
    if (found[3].matched) text += " did you mean " + found.str(3);
  }
  if (errors.ends_with('\n')) text += '\n';
  return text;
}

/// Returns the faults of the InputError that the action throws; empty if it throws none.
inline std::vector<Fault> thrown_faults(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.faults();
  }
  return {};
}

inline std::optional<Fault> first_fault(const std::function<void()>& action) {
  const std::vector<Fault> faults = thrown_faults(action);
  return faults.empty() ? std::nullopt : std::optional(faults.front());
}

inline std::vector<std::string> briefs_of(const std::function<void()>& action) {
  std::vector<std::string> all;
  for (const Fault& fault : thrown_faults(action)) all.push_back(brief(fault));
  return all;
}

}  // namespace tomlin::test
