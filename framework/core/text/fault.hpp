#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace tomlin {

/// Where something was written: a file (or "--set") with 1-based line and column; line 0 = unknown.
struct Place {
  std::string file;
  int line = 0;
  int column = 0;
};

/// One fault of the input. All faults of a well-formed scene are collected and shown together.
struct Fault {
  Place place;
  std::string key;         ///< dotted path of the key, e.g. "force.driver.stiffness"
  std::string value;       ///< the value as written; empty when there is none
  std::string why;         ///< what is wrong with it
  std::string admissible;  ///< what would be right; empty when obvious
  std::string nearest;     ///< nearest valid name; empty when there is none
};

/// `FILE:LINE:COLUMN: error: KEY = VALUE: why; admissible: ...; did you mean "..."?`
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
[[noreturn]] void refuse_input(std::string file, std::string key, std::string why,
                               std::string admissible = "", std::string nearest = "");

}  // namespace tomlin
