#include "framework/cli/tradeoff_figure.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

#include <fmt/format.h>

namespace tomlin {
namespace {

constexpr double kHeight = 400.0;  // of the panel, in points of the screen
/// Errors below this part of the reference's own are drawn there: they have no meaning.
constexpr double kFloor = 0.1;
constexpr double kSmallest = 1e-17;
constexpr double kDecade = 10.0;

struct Range {
  double from = std::numeric_limits<double>::infinity();
  double to = 0.0;
  void take(double x) {
    from = std::min(from, x);
    to = std::max(to, x);
  }
  /// Whole powers of ten.
  Range widened() const {
    return {std::pow(kDecade, std::floor(std::log10(from))),
            std::pow(kDecade, std::ceil(std::log10(to)))};
  }
};

class Diagram {
 public:
  explicit Diagram(const Tradeoff& tradeoff)
      : tradeoff_(tradeoff),
        floor_(std::max(kFloor * tradeoff.reference->error / tradeoff.scale.size, kSmallest)) {
    for (const TradeoffPoint& point : tradeoff.points) {
      const Point at = place(point);
      x_.take(at.x);
      y_.take(at.y);
    }
    y_.take(tradeoff.tolerance);
    x_ = x_.widened();
    y_ = y_.widened();
  }

  Figure figure() const {
    Panel panel;
    panel.height = kHeight;
    panel.y_label = {fmt::format("{} of {}", tradeoff_.scale.relative ? "relative error" : "error",
                                 tradeoff_.observable)};
    panel.y_from = y_.from;
    panel.y_to = y_.to;
    for (std::size_t r = 0; r < tradeoff_.methods.size(); ++r) add_rung(panel, r);
    add_level(panel, tradeoff_.tolerance, fmt::format("tolerance {:g}", tradeoff_.tolerance), true);
    add_level(panel, tradeoff_.reference->error / tradeoff_.scale.size, "error of the reference",
              false);
    if (tradeoff_.recommendation) add_recommendation(panel);
    Figure figure;
    figure.log_x = figure.log_y = true;
    figure.x_label = {"force evaluations and Jacobian columns"};
    figure.x_from = x_.from;
    figure.x_to = x_.to;
    figure.panels = {panel};
    return figure;
  }

 private:
  Point place(const TradeoffPoint& point) const {
    const auto cost = static_cast<double>(std::max<std::uint64_t>(point.cost(), 1));
    return {cost, std::max(tradeoff_.error_of(point), floor_)};
  }

  void add_rung(Panel& panel, std::size_t method) const {
    Polyline line;
    for (const TradeoffPoint& point : tradeoff_.points) {
      if (point.method == method) line.push_back(place(point));
    }
    if (line.empty()) return;
    Curve curve;
    curve.label = tradeoff_.methods[method].name;
    curve.colour = colour_of(method);
    // Other number types lie on those of the same scheme: no more than marks.
    curve.line = tradeoff_.methods[method].number_type == NumberType::double_precision;
    curve.mark = curve.line ? Mark::small_disc : Mark::square;
    curve.pieces = {std::move(line)};
    panel.curves.push_back(std::move(curve));
  }

  /// One for each model and integrator, whatever the number type.
  int colour_of(std::size_t method) const {
    const auto same = [](const Method& a, const Method& b) {
      return a.integrator == b.integrator && a.model == b.model;
    };
    int colour = 0;
    for (std::size_t r = 0; r < method; ++r) {
      if (same(tradeoff_.methods[r], tradeoff_.methods[method])) break;
      const bool is_shown =
          std::any_of(tradeoff_.points.begin(), tradeoff_.points.end(),
                      [r](const TradeoffPoint& point) { return point.method == r; });
      const bool is_new =
          std::none_of(tradeoff_.methods.begin(), tradeoff_.methods.begin() + r,
                       [&](const Method& one) { return same(one, tradeoff_.methods[r]); });
      if (is_shown && is_new) ++colour;
    }
    return colour;
  }

  void add_level(Panel& panel, double level, std::string label, bool dashed) const {
    if (level < y_.from || level > y_.to) return;
    Curve curve;
    curve.label = std::move(label);
    curve.colour = kGrey;
    curve.dashed = dashed;
    curve.pieces = {{{x_.from, level}, {x_.to, level}}};
    panel.curves.push_back(std::move(curve));
  }

  void add_recommendation(Panel& panel) const {
    const TradeoffPoint& point = tradeoff_.points[tradeoff_.recommendation->point];
    Curve curve;
    curve.label = "recommended";
    curve.colour = 1;
    curve.line = false;
    curve.mark = Mark::open_triangle;
    curve.pieces = {{place(point)}};
    panel.curves.push_back(std::move(curve));
  }

  const Tradeoff& tradeoff_;
  double floor_;
  Range x_;
  Range y_;
};

}  // namespace

Figure tradeoff_figure(const Tradeoff& tradeoff) { return Diagram(tradeoff).figure(); }

}  // namespace tomlin
