#pragma once

#include <string>

#include "framework/output/run_folder.hpp"
#include "framework/plot/figure.hpp"

namespace tomlin {

/// Draws a study's figure into its folder. False, with a note on standard error, where there is no
/// gnuplot or it fails; a figure without panels is not drawn. Throws OutputError.
bool write_study_figure(const RunFolder& folder, const std::string& name, const Figure& figure);

}  // namespace tomlin
