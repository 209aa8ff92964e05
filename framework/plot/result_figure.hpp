#pragma once

#include <string>
#include <vector>

#include "framework/plot/figure.hpp"
#include "framework/plot/stored_run.hpp"

namespace tomlin {

/// Results of runs over a parameter or another result.
struct ResultRequest {
  std::string result;   ///< "driver.mean_force.x", or with the family in front
  std::string against;  ///< likewise, or a parameter's name
  bool log_x = false;
  bool log_y = false;
};

/// One point for each run, joined in the order of x. Runs that differ in another parameter than the
/// one along x are on curves of their own, named by it; along a result the parameter with the most
/// values varies on a curve. `notes` say what is left out: undefined results, and on logarithmic
/// axes numbers that are not positive. Throws InputError for what no run has.
Figure result_figure(const std::vector<StoredRun>& runs, const ResultRequest& request,
                     std::vector<std::string>& notes);

/// Beside an axis: "v" in italics.
FigureText parameter_label(const std::string& name);

/// "mean force along x" of "driver.mean_force.x", with the unit that the run's scene names.
FigureText result_label(const StoredRun& run, const std::string& name);

}  // namespace tomlin
