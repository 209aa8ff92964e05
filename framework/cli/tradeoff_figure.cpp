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
    for (std::size_t r = 0; r < tradeoff_.rungs.size(); ++r) add_rung(panel, r);
    add_level(panel, tradeoff_.tolerance, fmt::format("tolerance {:g}", tradeoff_.tolerance), true);
    add_level(panel, tradeoff_.reference->error / tradeoff_.scale.size, "error of the reference",
              false);
    if (tradeoff_.recommendation) add_recommendation(panel);
    Figure figure;
    figure.logarithmic = true;
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

  void add_rung(Panel& panel, std::size_t rung) const {
    Polyline line;
    for (const TradeoffPoint& point : tradeoff_.points) {
      if (point.rung == rung) line.push_back(place(point));
    }
    if (line.empty()) return;
    Curve curve;
    curve.label = tradeoff_.rungs[rung].name;
    curve.colour = colour_of(rung);
    curve.dashed = tradeoff_.rungs[rung].number_type != "double";
    curve.mark = Mark::small_disc;
    curve.pieces = {std::move(line)};
    panel.curves.push_back(std::move(curve));
  }

  /// One for each model and integrator, whatever the number type.
  int colour_of(std::size_t rung) const {
    const auto same = [](const Rung& a, const Rung& b) {
      return a.integrator == b.integrator && a.model == b.model;
    };
    int colour = 0;
    for (std::size_t r = 0; r < rung; ++r) {
      if (same(tradeoff_.rungs[r], tradeoff_.rungs[rung])) break;
      const bool is_shown =
          std::any_of(tradeoff_.points.begin(), tradeoff_.points.end(),
                      [r](const TradeoffPoint& point) { return point.rung == r; });
      const bool is_new =
          std::none_of(tradeoff_.rungs.begin(), tradeoff_.rungs.begin() + r,
                       [&](const Rung& one) { return same(one, tradeoff_.rungs[r]); });
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
