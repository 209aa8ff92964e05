#pragma once

#include <string>
#include <string_view>

#include "framework/plot/figure.hpp"

namespace tomlin {

enum class PictureFormat { svg, png, pdf };

/// A text as gnuplot takes it: in single quotes, where it substitutes nothing, on one line and
/// shortened. Whatever the text holds, no part of it is a command.
std::string gnuplot_string(std::string_view text);

/// What gnuplot 5.4 has to be told to write the figure to its standard output, data included. The
/// same figure gives the same script.
std::string gnuplot_script(const Figure& figure, PictureFormat format);

}  // namespace tomlin
