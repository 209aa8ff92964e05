#pragma once

#include <string>
#include <string_view>

#include "framework/plot/figure.hpp"

namespace tomlin {

enum class PictureFormat { svg, png, pdf };

/// A text as gnuplot takes it: in double quotes, on one line and shortened. What could mean more
/// than itself, quotes, backquotes, backslashes, is written as its number, so that no part of any
/// text is a command. (Between single quotes gnuplot 5.4 misreads a text that begins with one.)
std::string gnuplot_string(std::string_view text);

/// What gnuplot 5.4 has to be told to write the figure to its standard output, data included. The
/// same figure gives the same script.
std::string gnuplot_script(const Figure& figure, PictureFormat format);

}  // namespace tomlin
