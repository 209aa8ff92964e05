#pragma once

#include <string>
#include <vector>

#include "framework/plot/figure.hpp"
#include "framework/plot/quantities.hpp"
#include "framework/plot/stored_run.hpp"

namespace tomlin {

/// Friction loops: the force of a driver that reverses over the position of its support, both along
/// the pull, a curve for each run, with an arrow on its last stroke each way. `width` is that of
/// the panel as drawn at last. Throws InputError where the support is not sampled or never goes
/// back.
Figure loop_figure(const std::vector<StoredRun>& runs, const std::vector<std::string>& labels,
                   const Owners& owners, double width);

}  // namespace tomlin
