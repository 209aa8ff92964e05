#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
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
  bool filled = false;  ///< down to the lower end of the y axis
  Mark mark = Mark::none;
};

inline constexpr int kGrey = -1;

/// An arrowhead on a curve.
struct Arrow {
  Point from;
  Point to;
  int colour = 0;  ///< as of a curve
};

/// Numbers over a rectangle as colours, below the curves of a panel.
struct Raster {
  double x_from = 0.0;
  double x_to = 0.0;
  double y_from = 0.0;
  double y_to = 0.0;
  std::size_t columns = 0;
  std::vector<double> values;  ///< row by row from below; NaN: nothing is drawn there
  FigureText label;            ///< of the colour bar
  bool grey = false;           ///< shades of grey in place of colours
  /// The limits of the columns and of the rows, where they are not of one width.
  std::vector<double> x_edges = {};
  std::vector<double> y_edges = {};
};

struct Panel {
  FigureText y_label;
  std::string title;
  double height = 0.0;  ///< of the plotted area, in points of the screen
  std::vector<Curve> curves;
  /// Where the axis ends; equal: gnuplot chooses by the data.
  double y_from = 0.0;
  double y_to = 0.0;
  std::optional<Raster> raster;
  std::vector<Arrow> arrows;
};

/// Of a whole figure, in points of the screen.
struct FigureSize {
  double width = 0.0;
  double height = 0.0;
};

struct FigureFont {
  std::string name = "sans-serif";
  double size = 12.0;  ///< in points
};

struct Figure {
  std::string title;
  FigureText x_label;
  double x_from = 0.0;  ///< as in a panel
  double x_to = 0.0;
  std::vector<Panel> panels;
  bool log_x = false;  ///< every number along a logarithmic axis is positive
  bool log_y = false;
  bool to_scale = false;           ///< a length is as long along x as along y
  std::optional<FigureSize> size;  ///< otherwise as large as its panels and texts need
  FigureFont font;
};

/// Where an axis ends around these numbers, also where they are one; of a logarithmic axis they are
/// positive.
std::pair<double, double> with_margin(double from, double to, bool logarithmic);

/// Width of the plotted area, in points of the screen.
inline constexpr double kPanelWidth = 540.0;

}  // namespace tomlin
