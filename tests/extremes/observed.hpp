#pragma once

#include <string>
#include <vector>

#include "framework/core/text/warning.hpp"
#include "tests/extremes/extreme_case.hpp"

namespace tomlin::test {

/// Outcome of an extreme scene.
struct Observed {
  Outcome outcome = Outcome::finished;
  std::string message;  ///< of a refusal or a failure
  std::vector<Warning> warnings;
  std::vector<double> values;    ///< of each value that the case names; NaN where undefined
  std::string not_finite;        ///< the first position in a file with something that is no number
  bool effective_reads = false;  ///< scene.toml is a scene
  bool hung = false;             ///< had to be stopped
};

/// Runs a case the way the program does, into a folder, and looks into every file.
Observed observe(const ExtremeCase& extreme);

/// The number at a path after a run of a scene; throws when the run does not finish.
double result_of(const std::string& text, const std::vector<Setting>& settings,
                 const std::string& path);

}  // namespace tomlin::test
