#pragma once

#include <string>
#include <vector>

#include "framework/plot/reduce.hpp"

/// A figure before it is drawn: panels one above the other, with one axis along x.
namespace tomlin {

/// Text on a figure. Plain text is shown as it is; only the program's own is enhanced, gnuplot's
/// word for markup.
struct FigureText {
  std::string text;
  bool enhanced = false;
};

enum class Mark { none, small_disc, large_disc, square, open_triangle };

struct Curve {
  std::string label;  ///< in the key; none when empty
  std::vector<Polyline> pieces;
  int colour = 0;  ///< which of the palette; kGrey: no data, an aid to the eye
  bool line = true;
  bool dashed = false;
  Mark mark = Mark::none;
};

inline constexpr int kGrey = -1;

struct Panel {
  FigureText y_label;
  std::string title;
  double height = 0.0;  ///< of the plotted area, in points of the screen
  std::vector<Curve> curves;
  /// Where the axis ends; equal: gnuplot chooses by the data.
  double y_from = 0.0;
  double y_to = 0.0;
};

struct Figure {
  std::string title;
  FigureText x_label;
  double x_from = 0.0;  ///< as in a panel
  double x_to = 0.0;
  std::vector<Panel> panels;
  bool logarithmic = false;  ///< both axes; every number is then positive
};

/// Width of the plotted area, in points of the screen.
inline constexpr double kPanelWidth = 540.0;

}  // namespace tomlin
