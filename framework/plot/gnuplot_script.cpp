#include "framework/plot/gnuplot_script.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>

#include <fmt/format.h>

#include "framework/plot/figure_layout.hpp"
#include "framework/scene/text.hpp"

namespace tomlin {
namespace {

// M. Okabe and K. Ito, Color Universal Design (2008): told apart by colour-blind eyes too.
constexpr std::array kPalette = {"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                 "#E69F00", "#56B4E9", "#000000"};
constexpr const char* kGreyColour = "#999999";
// Perceptually uniform: viridis by S. van der Walt and N. Smith (2015), at every eighth of it.
constexpr std::array kMapColours = {"#440154", "#472C7A", "#3B518B", "#2C718E", "#21908D",
                                    "#27AD81", "#5CC863", "#AADC32", "#FDE725"};
// Light enough for curves to be seen on them.
constexpr std::array kMapGreys = {"#8C8C8C", "#FFFFFF"};

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// In a string between double quotes, whatever stands around it.
bool means_itself(char c) {
  constexpr std::string_view kHarmless = " _=.,:;/[]{}()<>+-*^&!?";
  const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
  const bool beyond_ascii = static_cast<unsigned char>(c) >= 0x80U;
  return letter || is_digit(c) || beyond_ascii || kHarmless.find(c) != std::string_view::npos;
}

constexpr double kPointsPerInch = 72.0;

std::string terminal(PictureFormat format, const FigureLayout& layout, const FigureFont& given) {
  const std::string font = "font " + gnuplot_string(fmt::format("{},{:g}", given.name, given.size));
  switch (format) {
    case PictureFormat::svg:
      return fmt::format("svg size {:.0f},{:.0f} {} background rgb 'white'", layout.width(),
                         layout.height(), font);
    case PictureFormat::png:  // two pixels to a point; its fonts come at 96 pixels to 72 points
      return fmt::format(
          "pngcairo size {:.0f},{:.0f} {} fontscale 1.5 linewidth 2 pointscale 2 "
          "background rgb 'white'",
          2.0 * layout.width(), 2.0 * layout.height(), font);
    case PictureFormat::pdf:
      break;
  }
  return fmt::format("pdfcairo size {:.4f}in,{:.4f}in {} linewidth 1.5",
                     layout.width() / kPointsPerInch, layout.height() / kPointsPerInch, font);
}

std::string text(const FigureText& given) {
  return gnuplot_string(given.text) + (given.enhanced ? " enhanced" : " noenhanced");
}

std::string range(double from, double to) {
  return from < to ? fmt::format("[{}:{}]", from, to) : "[*:*]";
}

constexpr auto kColours = static_cast<int>(kPalette.size());
constexpr double kArrowLength = 14.0;  // of a head, in points of the screen

const char* colour_of(int colour) {
  return colour == kGrey ? kGreyColour : kPalette[colour % kColours];
}

std::string style_of(const Curve& curve) {
  const bool grey = curve.colour == kGrey;
  // When the colours are used up, the same ones with other dashes.
  const int dashes = curve.dashed ? 2 : grey ? 1 : 1 + curve.colour / kColours;
  std::string style;
  if (curve.line) style += fmt::format(" lw 1.2 dt {}", dashes);
  switch (curve.mark) {
    case Mark::none:
      break;
    case Mark::small_disc:
      style += " pt 7 ps 0.45";
      break;
    case Mark::large_disc:
      style += " pt 7 ps 0.9";
      break;
    case Mark::square:
      style += " pt 5 ps 0.7";
      break;
    case Mark::open_triangle:
      style += " pt 8 ps 1.1";
      break;
  }
  const char* with = curve.mark == Mark::none ? "lines" : curve.line ? "linespoints" : "points";
  return fmt::format("with {} lc rgb '{}'{}", with, colour_of(curve.colour), style);
}

std::string data_name(std::size_t panel, std::size_t curve) {
  return fmt::format("$panel{}_curve{}", panel, curve);
}

std::string raster_name(std::size_t panel) { return fmt::format("$panel{}_raster", panel); }

std::string arrows_name(std::size_t panel, std::size_t arrow) {
  return fmt::format("$panel{}_arrow{}", panel, arrow);
}

/// Inline data: numbers only, an empty line where the curve breaks.
void append_data(std::string& script, const std::string& name, const Curve& curve) {
  if (curve.pieces.empty()) return;
  script += name + " << END\n";
  for (const Polyline& piece : curve.pieces) {
    for (const Point& point : piece) {
      fmt::format_to(std::back_inserter(script), "{} {}\n", point.x, point.y);
    }
    script += '\n';
  }
  script += "END\n";
}

/// A point in each pixel, its limits where they are given, and its number.
void append_raster(std::string& script, const std::string& name, const Raster& raster) {
  const std::size_t rows = raster.values.size() / raster.columns;
  const double width = (raster.x_to - raster.x_from) / static_cast<double>(raster.columns);
  const double height = (raster.y_to - raster.y_from) / static_cast<double>(rows);
  script += name + " << END\n";
  for (std::size_t k = 0; k < raster.values.size(); ++k) {
    const std::size_t row = k / raster.columns;
    const std::size_t column = k % raster.columns;
    if (raster.x_edges.empty()) {
      fmt::format_to(std::back_inserter(script), "{} {} ",
                     raster.x_from + (0.5 + static_cast<double>(column)) * width,
                     raster.y_from + (0.5 + static_cast<double>(row)) * height);
    } else {
      fmt::format_to(std::back_inserter(script), "{0} {2} {0} {1} {2} {3} ", raster.x_edges[column],
                     raster.x_edges[column + 1], raster.y_edges[row], raster.y_edges[row + 1]);
    }
    const double value = raster.values[k];
    script += std::isnan(value) ? "NaN\n" : fmt::format("{:.9g}\n", value);
  }
  script += "END\n";
}

void append_all_data(std::string& script, const Panel& panel, std::size_t p) {
  if (panel.raster) append_raster(script, raster_name(p), *panel.raster);
  for (std::size_t c = 0; c < panel.curves.size(); ++c) {
    append_data(script, data_name(p, c), panel.curves[c]);
  }
  for (std::size_t a = 0; a < panel.arrows.size(); ++a) {
    const Arrow& arrow = panel.arrows[a];
    fmt::format_to(std::back_inserter(script), "{} << END\n{} {} {} {}\nEND\n", arrows_name(p, a),
                   arrow.from.x, arrow.from.y, arrow.to.x - arrow.from.x,
                   arrow.to.y - arrow.from.y);
  }
}

void append_margins(std::string& script, double top, double bottom) {
  fmt::format_to(std::back_inserter(script),
                 "set tmargin at screen {:.6f}\nset bmargin at screen {:.6f}\n", top, bottom);
}

// An axis of fewer decades has numbers at 1, 2 and 5 times the powers of ten.
constexpr double kFewDecades = 2.5;
constexpr double kDecade = 10.0;

// A linear x axis whose ends need more digits to differ has numbers with these digits, and few of
// them. Numbers that need more than a double has are left to gnuplot.
constexpr int kDigits = 6;
constexpr int kMostDigits = 15;
constexpr double kFewTics = 6.0;       // at most; two at least
constexpr double kClearOfEnds = 0.06;  // of the axis: a long number has room

/// Digits that two numbers on an axis need to differ.
int digits_between(double from, double to) {
  const double size = std::max(std::abs(from), std::abs(to));
  return static_cast<int>(std::ceil(std::log10(size / (to - from)))) + 2;
}

/// Numbers at whole multiples of 1, 2 or 5 times a power of ten.
std::string few_tics(double from, double to, bool shown) {
  const double least = (to - from) / kFewTics;
  const double power = std::pow(kDecade, std::floor(std::log10(least)));
  double step = kDecade * power;
  for (const double factor : {5.0, 2.0, 1.0}) {
    if (factor * power >= least) step = factor * power;
  }
  const double clear = kClearOfEnds * (to - from);
  std::string list;
  for (double k = std::ceil((from + clear) / step); k * step <= to - clear; k += 1.0) {
    const std::string number = fmt::format("{:.{}g}", k * step, digits_between(from, to));
    list +=
        fmt::format("{}\"{}\" {:.17g}", list.empty() ? "" : ", ", shown ? number : "", k * step);
  }
  return list;
}

/// The numbers along an axis, unless they stand below another panel: gnuplot's own, but for a
/// logarithmic axis too short for powers of ten, and a short linear one far from zero.
std::string tics(const char* axis, bool logarithmic, double from, double to, bool shown) {
  const bool short_axis = from < to && std::log10(to / from) < kFewDecades;
  std::string list;
  int count = 0;
  if (logarithmic && short_axis) {
    for (double power = std::pow(kDecade, std::floor(std::log10(from))); power <= to;
         power *= kDecade) {
      for (const double factor : {1.0, 2.0, 5.0}) {
        if (factor * power < from || factor * power > to) continue;
        const std::string number = fmt::format("{:g}", factor * power);
        list += fmt::format("{}\"{}\" {}", list.empty() ? "" : ", ", shown ? number : "", number);
        ++count;
      }
    }
  } else if (!logarithmic && *axis == 'x' && from < to && digits_between(from, to) > kDigits &&
             digits_between(from, to) <= kMostDigits) {
    list = few_tics(from, to, shown);
    count = static_cast<int>(std::count(list.begin(), list.end(), ',')) + 1;
  }
  const char* format = !shown ? "''" : logarithmic && !short_axis ? "'10^{%L}'" : "'%h'";
  return fmt::format("set {}tics {}\nset format {} {}\n", axis,
                     count < 2 ? "autofreq" : "(" + list + ")", axis, format);
}

std::string palette(const Raster& raster) {
  std::string list;
  const auto add = [&](const char* colour, std::size_t k) {
    list += fmt::format("{}{} '{}'", k == 0 ? "" : ", ", k, colour);
  };
  if (raster.grey) {
    for (std::size_t k = 0; k < kMapGreys.size(); ++k) add(kMapGreys[k], k);
  } else {
    for (std::size_t k = 0; k < kMapColours.size(); ++k) add(kMapColours[k], k);
  }
  return "set palette maxcolors 0 defined (" + list + ")\n";
}

void append_bar(std::string& script, const Raster& raster, std::size_t index,
                const FigureLayout& layout) {
  script += palette(raster);
  if (raster.label.text.empty()) {
    script += "unset colorbox\n";
    return;
  }
  script += fmt::format(
      "set colorbox user origin screen {:.6f},screen {:.6f} size screen {:.6f},screen {:.6f}\n",
      layout.left_of_bars(), layout.bottom_of(index), layout.width_of_bars(),
      layout.top_of(index) - layout.bottom_of(index));
  script += "set cbtics out scale 0.6\nset cblabel " + text(raster.label) + "\n";
}

void append_panel(std::string& script, const Figure& figure, std::size_t index,
                  const FigureLayout& layout) {
  const Panel& panel = figure.panels[index];
  const bool last = index + 1 == figure.panels.size();
  const auto line = [&](const std::string& text) { script += text + "\n"; };
  append_margins(script, layout.top_of(index), layout.bottom_of(index));
  line("set title " + gnuplot_string(panel.title) + " noenhanced offset 0,-0.6");
  line("set ylabel " + text(panel.y_label));
  line("set yrange " + range(panel.y_from, panel.y_to));
  line(last ? "set xlabel " + text(figure.x_label) + " offset 0,0.4" : "unset xlabel");
  script += tics("x", figure.log_x, figure.x_from, figure.x_to, last);
  script += tics("y", figure.log_y, panel.y_from, panel.y_to, true);
  // A grid would be drawn over the colours.
  line(panel.raster ? "unset grid" : "set grid lt 1 lc rgb '#E6E6E6' lw 0.6");
  if (panel.raster) append_bar(script, *panel.raster, index, layout);
  script += "plot NaN notitle";
  if (panel.raster) {
    // Lines of their own colour cover the seams between boxes.
    script += ", \\\n     " + raster_name(index) +
              (panel.raster->x_edges.empty()
                   ? " using 1:2:3 with image notitle"
                   : " using 1:2:3:4:5:6:7 with boxxyerror lc palette lw 0.5 fs solid border "
                     "notitle");
  }
  for (std::size_t c = 0; c < panel.curves.size(); ++c) {
    const Curve& curve = panel.curves[c];
    if (curve.pieces.empty()) continue;
    const std::string data = ", \\\n     " + data_name(index, c) + " using 1:2 ";
    if (curve.filled) {
      script += data + fmt::format(
                           "with filledcurves y={} lc rgb '{}' fs transparent solid 0.25 "
                           "noborder notitle",
                           panel.y_from, colour_of(curve.colour));
    }
    script += data + style_of(curve) + " notitle";
  }
  for (std::size_t a = 0; a < panel.arrows.size(); ++a) {
    script += ", \\\n     " + arrows_name(index, a) +
              fmt::format(
                  " using 1:2:3:4 with vectors filled head size screen {:.6f},20,60 fixed "
                  "lw 1.2 lc rgb '{}' notitle",
                  kArrowLength / layout.width(), colour_of(panel.arrows[a].colour));
  }
  script += "\n";
}

/// A key is a plot of its own, without data or axes: gnuplot cuts a key to the height of its plot.
void append_key(std::string& script, const Panel& panel, std::size_t index,
                const FigureLayout& layout) {
  append_margins(script, layout.top_of(index), layout.bottom_of_key(index));
  fmt::format_to(std::back_inserter(script), "set key at screen {:.6f},screen {:.6f}\n",
                 layout.left_of_keys(), layout.top_of(index));
  script += "plot NaN notitle";
  for (const Curve& curve : panel.curves) {
    if (curve.label.empty()) continue;
    script += ", \\\n     keyentry " + style_of(curve) + " title " + gnuplot_string(curve.label);
  }
  script += "\n";
}

}  // namespace

std::string gnuplot_string(std::string_view given) {
  std::string result = "\"";
  bool behind_number = false;  // gnuplot takes all octal digits that it finds for one number
  for (const char c : shortened(given, kLongestText)) {
    const bool as_number = !means_itself(c) || (behind_number && is_digit(c));
    if (as_number) {
      fmt::format_to(std::back_inserter(result), "\\{:03o}", static_cast<unsigned char>(c));
    } else {
      result += c;
    }
    behind_number = as_number;
  }
  return result + '"';
}

std::string gnuplot_script(const Figure& figure, PictureFormat format) {
  const FigureLayout layout(figure);
  std::string script = "set encoding utf8\n";
  for (std::size_t p = 0; p < figure.panels.size(); ++p) {
    append_all_data(script, figure.panels[p], p);
  }
  script += "set terminal " + terminal(format, layout, figure.font) + "\n";
  script +=
      "set border 3 lc rgb '#333333' lw 0.8\n"
      "set tics out nomirror scale 0.6\n"
      "set pointintervalbox 0\n";
  script += fmt::format("set lmargin at screen {:.6f}\n", layout.left());
  script += fmt::format("set rmargin at screen {:.6f}\n", layout.right());
  if (figure.log_x) script += "set logscale x\n";
  if (figure.log_y) script += "set logscale y\n";
  script += "set xrange " + range(figure.x_from, figure.x_to) + "\n";
  script += "unset key\n";
  script += "set multiplot\n";
  if (!figure.title.empty()) {
    script += fmt::format("set label 1 {} at screen {:.6f},screen {:.6f} center noenhanced\n",
                          gnuplot_string(figure.title), (layout.left() + layout.right()) / 2.0,
                          layout.top_of_title());
  }
  for (std::size_t p = 0; p < figure.panels.size(); ++p) {
    append_panel(script, figure, p, layout);
    if (p == 0) script += "unset label\n";
  }
  script +=
      "unset logscale\nunset colorbox\nunset border\nunset tics\nunset grid\nunset title\nunset "
      "xlabel\nunset "
      "ylabel\n"
      "set xrange [0:1]\nset yrange [0:1]\n"
      "set key left top Left reverse samplen 2 noenhanced\n";
  for (std::size_t p = 0; p < figure.panels.size(); ++p) {
    if (layout.has_key(p)) append_key(script, figure.panels[p], p, layout);
  }
  return script + "unset multiplot\n";
}

}  // namespace tomlin
