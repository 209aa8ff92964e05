#pragma once

#include "framework/plot/figure.hpp"

namespace tomlin {

/// Gives the axes of a figure one scale: where they end, and how high the panels are. x is shared
/// by all panels; around everything stays a margin of so large a share of the width.
void scale_equally(Figure& figure, double margin_share);

}  // namespace tomlin
