#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/study/tradeoff/reference.hpp"

namespace tomlin {

/// Runs from starts that hardly differ show whether the scene determines the observable at all.
struct Sensitivity {
  enum class Verdict { determined, not_determined, unknown } verdict = Verdict::unknown;
  std::string why;             ///< when unknown
  std::vector<double> sizes;   ///< of the noise on the starts, one each run
  std::vector<double> values;  ///< of the runs from them
  double spread = 0.0;         ///< largest less smallest, the undisturbed run included
  double min = 0.0;
  double max = 0.0;
  double integration_error = 0.0;  ///< estimated, of the runs compared
  double digits = 0.0;             ///< decimal digits that all share, 0 to 17
};

/// Repeats the run with noise of 1e-12 and 1e-9 on its start (in units of the scene's shortest
/// period, or plain), on the cheapest setting known to be clearly finer than the tolerance. Not
/// determined: the spread exceeds the tolerance and ten times the estimated integration error, or
/// the tolerance alone when no finer steps make the value settle. Uses at most a fifth of the
/// budget.
Sensitivity find_sensitivity(const Variants& variants, const std::vector<Method>& methods,
                             const Reference& reference, Measurer& measurer, double tolerance);

}  // namespace tomlin
