#pragma once

#include <string>

namespace tomlin {

/// The figure of `tomlin plot` that shows places instead of curves.
inline constexpr const char* kBodyFigure = "ring";

/// What `tomlin plot --help` says below the options: the figures, the quantities, examples.
std::string plot_footer();

}  // namespace tomlin
