#pragma once

#include "framework/plot/figure.hpp"
#include "framework/study/tradeoff.hpp"

namespace tomlin {

/// The work-precision diagram: error against cost, both logarithmic, a line for each method, with
/// the tolerance, the reference's own error and the recommended point. There must be points.
Figure tradeoff_figure(const Tradeoff& tradeoff);

}  // namespace tomlin
