#include "framework/cli/plot_text.hpp"

#include <iterator>
#include <string_view>

#include <fmt/format.h>

#include "framework/plot/quantities.hpp"

namespace tomlin {
namespace {

void add_row(std::string& text, std::string_view name, std::string_view summary) {
  fmt::format_to(std::back_inserter(text), "  {:<17} {}\n", name, summary);
}

constexpr const char* kBelow = R"(
The first word is a folder; another folder that is called like a figure is written with a slash, ring/.
X and Y are such a quantity or any column of observables.csv. Commas put curves on one axis, another
--y makes another panel below. Several DIRs are curves of one figure, named by the parameters in
which their scenes differ, or else by their folders; --label names them otherwise.

Examples:

  tomlin plot pt.out -o force.svg
      the friction trace.
  tomlin plot k_2.out k_8.out hysteresis -o loops.pdf
      two runs on the same axes.
  tomlin plot ring.out --y force_size --y position --y height --from 2 --to 4 -o steps.svg
      three panels over v t from 2 to 4.
  tomlin plot ring.out ring --at 2500,3000,3500 -o places.png
      a ring at three times.
  tomlin plot v_1.out v_2.out ring --x driver_position --at 2,2.5,3 -o places.svg
      two rings, when their drivers have come so far.
  tomlin plot pt.out --x time --y tip.velocity.x -o velocity.svg
      a column over another.

gnuplot 5.4 draws (Debian: gnuplot-nox); TOMLIN_GNUPLOT names another one than the one in PATH. An
earlier FILE is replaced. The same runs give the same SVG.

Exit status: 0 done; 1 gnuplot failed or FILE could not be written; 2 the input was not right, or
there is no gnuplot.)";

}  // namespace

std::string plot_footer() {
  std::string text = "\nWHAT:\n\n";
  for (const FigureKind& kind : figure_kinds()) add_row(text, kind.name, kind.summary);
  add_row(text, kBodyFigure, "particles of a ring, or another planar body, at the moments --at");
  text += "\nQuantities for --x and --y:\n\n";
  for (const Quantity& quantity : quantities()) add_row(text, quantity.name, quantity.summary);
  return text + kBelow;
}

}  // namespace tomlin
