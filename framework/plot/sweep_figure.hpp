#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "framework/plot/figure.hpp"
#include "framework/plot/stored_sweep.hpp"

namespace tomlin {

struct SweepRequest {
  std::string x;  ///< an axis; empty: the first that is not fixed, and has numbers
  /// Panels of observables from the top, for curves; or the one axis upwards, for a map. Empty: by
  /// the number of axes.
  std::vector<std::vector<std::string>> y;
  std::string value;                                    ///< in colours; empty: the first observable
  std::string minimum_along;                            ///< an axis of the map
  std::vector<std::pair<std::string, std::string>> at;  ///< axes and the values that are shown
  std::optional<std::string> log;  ///< "x", "y", "xy", "none"; by default as grids are spaced
  double width = kPanelWidth;      ///< of the panels as drawn at last: so fine are the curves
};

/// Observables of a sweep: curves over an axis, one for each combination of values of the others,
/// or a map over two axes, with a cell around each point. A curve breaks, and a cell stays white,
/// where the number is undefined, which `notes` then say. Throws InputError.
Figure sweep_figure(const StoredSweep& sweep, const SweepRequest& request,
                    std::vector<std::string>& notes);

}  // namespace tomlin
