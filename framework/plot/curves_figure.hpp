#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/plot/figure.hpp"
#include "framework/plot/quantities.hpp"
#include "framework/plot/stored_run.hpp"

namespace tomlin {

/// Curves of quantities or columns over another one.
struct CurvesRequest {
  std::string x;
  std::vector<std::vector<std::string>> y;  ///< panels from the top, and the curves of each
  Owners owners;
  std::optional<double> from;  ///< along x; the whole of it by default
  std::optional<double> to;
  bool to_scale = false;  ///< one scale for both axes, which have one unit
  bool log_x = false;
  bool log_y = false;
  double width = kPanelWidth;  ///< of the panels as drawn at last: so fine are the curves
};

/// A curve for each run and each y, every panel with all runs; `labels` are the runs'. Throws
/// InputError for what the tables do not have.
/// Notes say what a logarithmic axis leaves out.
Figure curves_figure(const std::vector<StoredRun>& runs, const std::vector<std::string>& labels,
                     const CurvesRequest& request, std::vector<std::string>& notes);

}  // namespace tomlin
