#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "framework/core/text/fault_code.hpp"

namespace tomlin {

/// Position of a text: a file (or "--set") with 1-based line and column; line 0 = unknown.
struct SourceLocation {
  std::string file;
  int line = 0;
  int column = 0;
};

/// One fault of the input. All faults of a well-formed scene are collected and shown together.
struct Fault {
  explicit Fault(FaultCode code_of_fault) : code(code_of_fault) {}
  Fault(FaultCode code_of_fault, SourceLocation location_of_fault, std::string key_at_fault,
        std::string value_there, std::string what_is_wrong, std::string what_would_be_right = "",
        std::string nearest_name = "")
      : code(code_of_fault),
        location(std::move(location_of_fault)),
        key(std::move(key_at_fault)),
        value(std::move(value_there)),
        why(std::move(what_is_wrong)),
        admissible(std::move(what_would_be_right)),
        nearest(std::move(nearest_name)) {}

  FaultCode code;
  SourceLocation location;
  std::string key;         ///< dotted path of the key, e.g. "force.driver.stiffness"
  std::string value;       ///< the value as written; the line where there is no key; or empty
  std::string why;         ///< what is wrong with it
  std::string admissible;  ///< what would be right; empty when obvious
  std::string nearest;     ///< nearest valid name; empty when there is none
};

/// `FILE:LINE:COLUMN: error: KEY = VALUE: why; expected: ...; did you mean "..."? [CODE]`
std::string to_string(const Fault& fault);

/// Bad input: thrown once by whatever reads input, with every fault found.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::vector<Fault> faults);
  const std::vector<Fault>& faults() const { return faults_; }

 private:
  std::vector<Fault> faults_;
};

/// Throws the one fault of a file or of an option of the command line.
[[noreturn]] void refuse_input(FaultCode code, std::string file, std::string key, std::string why,
                               std::string admissible = "", std::string nearest = "");

}  // namespace tomlin
