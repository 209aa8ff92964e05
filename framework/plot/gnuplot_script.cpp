#include "framework/plot/gnuplot_script.hpp"

#include <array>
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

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// In a string between double quotes, whatever stands around it.
bool means_itself(char c) {
  constexpr std::string_view kHarmless = " _=.,:;/[]{}()<>+-*^&!?";
  const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
  const bool beyond_ascii = static_cast<unsigned char>(c) >= 0x80U;
  return letter || is_digit(c) || beyond_ascii || kHarmless.find(c) != std::string_view::npos;
}

constexpr double kPointsPerInch = 72.0;

std::string terminal(PictureFormat format, const FigureLayout& layout) {
  constexpr const char* kFont = "font 'sans-serif,12'";
  switch (format) {
    case PictureFormat::svg:
      return fmt::format("svg size {:.0f},{:.0f} {} background rgb 'white'", layout.width(),
                         layout.height(), kFont);
    case PictureFormat::png:  // two pixels to a point; its fonts come at 96 pixels to 72 points
      return fmt::format(
          "pngcairo size {:.0f},{:.0f} {} fontscale 1.5 linewidth 2 pointscale 2 "
          "background rgb 'white'",
          2.0 * layout.width(), 2.0 * layout.height(), kFont);
    case PictureFormat::pdf:
      break;
  }
  return fmt::format("pdfcairo size {:.4f}in,{:.4f}in {} linewidth 1.5",
                     layout.width() / kPointsPerInch, layout.height() / kPointsPerInch, kFont);
}

std::string text(const FigureText& given) {
  return gnuplot_string(given.text) + (given.enhanced ? " enhanced" : " noenhanced");
}

std::string range(double from, double to) {
  return from < to ? fmt::format("[{}:{}]", from, to) : "[*:*]";
}

std::string style_of(const Curve& curve) {
  constexpr auto kColours = static_cast<int>(kPalette.size());
  const bool grey = curve.colour == kGrey;
  const char* colour = grey ? kGreyColour : kPalette[curve.colour % kColours];
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
  return fmt::format("with {} lc rgb '{}'{}", with, colour, style);
}

std::string data_name(std::size_t panel, std::size_t curve) {
  return fmt::format("$panel{}_curve{}", panel, curve);
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

void append_margins(std::string& script, double top, double bottom) {
  fmt::format_to(std::back_inserter(script),
                 "set tmargin at screen {:.6f}\nset bmargin at screen {:.6f}\n", top, bottom);
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
  const char* format = figure.logarithmic ? "'10^{%L}'" : "'%h'";
  line(last ? std::string("set format x ") + format : "set format x ''");
  if (figure.logarithmic) line(std::string("set format y ") + format);
  script += "plot NaN notitle";
  for (std::size_t c = 0; c < panel.curves.size(); ++c) {
    const Curve& curve = panel.curves[c];
    if (curve.pieces.empty()) continue;
    script += ", \\\n     " + data_name(index, c) + " using 1:2 " + style_of(curve) + " notitle";
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
    const auto& curves = figure.panels[p].curves;
    for (std::size_t c = 0; c < curves.size(); ++c) append_data(script, data_name(p, c), curves[c]);
  }
  script += "set terminal " + terminal(format, layout) + "\n";
  script +=
      "set border 3 lc rgb '#333333' lw 0.8\n"
      "set tics out nomirror scale 0.6\n"
      "set grid lt 1 lc rgb '#E6E6E6' lw 0.6\n"
      "set pointintervalbox 0\n";
  script += fmt::format("set lmargin at screen {:.6f}\n", layout.left());
  script += fmt::format("set rmargin at screen {:.6f}\n", layout.right());
  if (figure.logarithmic) script += "set logscale xy\n";
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
      "unset logscale\nunset border\nunset tics\nunset grid\nunset title\nunset xlabel\nunset "
      "ylabel\n"
      "set xrange [0:1]\nset yrange [0:1]\n"
      "set key left top Left reverse samplen 2 noenhanced\n";
  for (std::size_t p = 0; p < figure.panels.size(); ++p) {
    if (layout.has_key(p)) append_key(script, figure.panels[p], p, layout);
  }
  return script + "unset multiplot\n";
}

}  // namespace tomlin
