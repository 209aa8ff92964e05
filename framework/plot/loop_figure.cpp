#include "framework/plot/loop_figure.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

#include "framework/core/text/axis_names.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/plot/axis_text.hpp"
#include "framework/plot/series_reader.hpp"

namespace tomlin {
namespace {

constexpr double kLoopHeight = 360.0;  // of the panel, in points of the screen

/// A vector that was sampled, by axis.
using Components = std::vector<std::vector<double>>;

double along(const Components& vectors, const std::vector<double>& direction, std::size_t sample) {
  double sum = 0.0;
  for (std::size_t d = 0; d < direction.size(); ++d) sum += direction[d] * vectors[d][sample];
  return sum;
}

double distance_from_start(const Components& position, std::size_t sample) {
  double square = 0.0;
  for (const std::vector<double>& axis : position) {
    square += (axis[sample] - axis[0]) * (axis[sample] - axis[0]);
  }
  return std::sqrt(square);
}

/// Along which the support moves, as it first does; empty where it stays.
std::vector<double> pull_direction(const Components& position) {
  // Of the farthest distance: what is less is rounding.
  constexpr double kMoved = 1e-6;
  std::size_t farthest = 0;
  double distance = 0.0;
  for (std::size_t i = 0; i < position.front().size(); ++i) {
    if (distance_from_start(position, i) <= distance) continue;
    farthest = i;
    distance = distance_from_start(position, i);
  }
  if (distance == 0.0) return {};
  std::vector<double> direction;
  for (const auto& axis : position) direction.push_back((axis[farthest] - axis[0]) / distance);
  const double start = along(position, direction, 0);
  for (std::size_t i = 0; i < position.front().size(); ++i) {
    const double moved = along(position, direction, i) - start;
    if (std::abs(moved) <= kMoved * distance) continue;
    if (moved < 0.0) {
      for (double& component : direction) component = -component;
    }
    break;
  }
  return direction;
}

struct FrictionLoop {
  Polyline trace;
  std::string length;  ///< dimension of the positions, as in the header
  std::string force;
  bool along_x = true;  ///< the direction of the pull
};

FrictionLoop read_loop(const StoredRun& run, const Owners& owners) {
  const SampleTable table(file_of(run, kTableFile));
  const std::string driver = chosen_owner(table, Owner::driver, "position.x", owners);
  std::vector<Series> positions;
  std::vector<Series> forces;
  SeriesReader reader;
  for (const char* axis : kAxisNames) {
    if (!table.find(driver + ".position." + axis)) continue;
    positions.push_back(column_series(table, driver + ".position." + axis));
    forces.push_back(column_series(table, driver + ".force." + axis));
    reader.add(positions.back());
    reader.add(forces.back());
  }
  reader.read(table);
  Components position;
  Components force;
  for (const Series& series : positions) position.push_back(reader.values(series));
  for (const Series& series : forces) force.push_back(reader.values(series));
  const std::vector<double> direction = pull_direction(position);
  if (direction.empty()) {
    refuse_input(FaultCode::plot_no_data, table.file(), driver + ".position",
                 "the support does not move", "a run whose driver reverses");
  }
  FrictionLoop loop{{}, positions.front().unit, forces.front().unit, direction.front() == 1.0};
  for (std::size_t i = 0; i < position.front().size(); ++i) {
    loop.trace.push_back({along(position, direction, i), along(force, direction, i)});
  }
  return loop;
}

/// Samples between two reversals.
struct Stroke {
  std::size_t begin = 0;
  std::size_t last = 0;
  bool forward = true;
};

std::vector<Stroke> strokes_of(const Polyline& trace) {
  std::vector<Stroke> strokes;
  for (std::size_t i = 1; i < trace.size(); ++i) {
    if (trace[i].x == trace[i - 1].x) continue;
    const bool forward = trace[i].x > trace[i - 1].x;
    if (strokes.empty() || strokes.back().forward != forward)
      strokes.push_back({i - 1, i, forward});
    strokes.back().last = i;
  }
  return strokes;
}

/// The last long stroke of this direction.
std::optional<Stroke> last_stroke(const Polyline& trace, bool forward, double extent) {
  constexpr double kLong = 0.25;  // of the loop
  std::optional<Stroke> found;
  for (const Stroke& stroke : strokes_of(trace)) {
    const double length = std::abs(trace[stroke.last].x - trace[stroke.begin].x);
    if (stroke.forward == forward && length >= kLong * extent) found = stroke;
  }
  return found;
}

/// In the middle half of a stroke where the curve is level, close to the middle.
Arrow arrow_on(const Polyline& trace, const Stroke& stroke, const Window& window) {
  const double middle = 0.5 * (trace[stroke.begin].x + trace[stroke.last].x);
  const double quarter = 0.25 * std::abs(trace[stroke.last].x - trace[stroke.begin].x);
  double least = std::numeric_limits<double>::infinity();
  std::size_t best = stroke.begin;
  for (std::size_t i = stroke.begin; i < stroke.last; ++i) {
    const double off = std::abs(0.5 * (trace[i].x + trace[i + 1].x) - middle) / quarter;
    const double across = std::abs(trace[i + 1].x - trace[i].x) / (window.x_to - window.x_from);
    if (across == 0.0 || (off > 1.0 && least < std::numeric_limits<double>::infinity())) continue;
    const double up = std::abs(trace[i + 1].y - trace[i].y) / (window.y_to - window.y_from);
    const double cost = off + up / across;
    if (cost < least) {
      least = cost;
      best = i;
    }
  }
  return {trace[best], trace[best + 1], 0};
}

Window window_around(const std::vector<FrictionLoop>& loops, double width) {
  Window window{HUGE_VAL, -HUGE_VAL, HUGE_VAL, -HUGE_VAL, width, kLoopHeight * width / kPanelWidth};
  for (const FrictionLoop& loop : loops) {
    for (const Point& point : loop.trace) {
      window.x_from = std::min(window.x_from, point.x);
      window.x_to = std::max(window.x_to, point.x);
      window.y_from = std::min(window.y_from, point.y);
      window.y_to = std::max(window.y_to, point.y);
    }
  }
  if (window.y_from == window.y_to) {
    std::tie(window.y_from, window.y_to) = with_margin(window.y_from, window.y_to, false);
  }
  return window;
}

void add_loop(Panel& panel, const FrictionLoop& loop, const Window& window, const StoredRun& run) {
  const int colour = static_cast<int>(panel.curves.size());
  const auto [least, most] =
      std::minmax_element(loop.trace.begin(), loop.trace.end(),
                          [](const Point& a, const Point& b) { return a.x < b.x; });
  for (const bool forward : {true, false}) {
    const auto stroke = last_stroke(loop.trace, forward, most->x - least->x);
    if (!stroke) {
      refuse_input(FaultCode::plot_no_data, file_of(run, kTableFile), "",
                   "the support does not go back: there is no loop",
                   "a run whose driver reverses; the figure force shows this one");
    }
    panel.arrows.push_back(arrow_on(loop.trace, *stroke, window));
    panel.arrows.back().colour = colour;
  }
  Curve curve;
  curve.colour = colour;
  curve.pieces = reduced({loop.trace}, window);
  panel.curves.push_back(std::move(curve));
}

}  // namespace

Figure loop_figure(const std::vector<StoredRun>& runs, const std::vector<std::string>& labels,
                   const Owners& owners, double width) {
  std::vector<FrictionLoop> loops;
  loops.reserve(runs.size());
  for (const StoredRun& run : runs) loops.push_back(read_loop(run, owners));
  check_unit_names(runs, loops.front().length);
  check_unit_names(runs, loops.front().force);
  const Window window = window_around(loops, width);
  Panel panel;
  panel.height = kLoopHeight;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    add_loop(panel, loops[r], window, runs[r]);
    panel.curves.back().label = labels[r];
  }
  std::tie(panel.y_from, panel.y_to) = with_margin(window.y_from, window.y_to, false);
  const bool along_x = std::all_of(loops.begin(), loops.end(),
                                   [](const FrictionLoop& loop) { return loop.along_x; });
  panel.y_label = axis_text(along_x ? "lateral force" : "force along the pull",
                            along_x ? "{/:Italic F_x}" : "{/:Italic F}",
                            unit_name(runs.front(), loops.front().force));
  Figure figure;
  figure.x_label = axis_text(along_x ? "support position" : "support position along the pull",
                             "{/:Italic X}", unit_name(runs.front(), loops.front().length));
  std::tie(figure.x_from, figure.x_to) = with_margin(window.x_from, window.x_to, false);
  figure.panels.push_back(std::move(panel));
  return figure;
}

}  // namespace tomlin
