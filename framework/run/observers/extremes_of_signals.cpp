#include <algorithm>
#include <limits>

#include "framework/run/events/extremes.hpp"
#include "framework/run/observers/kinds.hpp"

/// Extremes of forces and speeds within the window.
namespace tomlin::observers {
namespace {

const ResultQuantity kMaxForce{"max_force", dimension::force, Shape::vector, Scope::window,
                               "largest component along the axis"};
const ResultQuantity kMinForce{"min_force", dimension::force, Shape::vector, Scope::window,
                               "smallest component along the axis"};
const ResultQuantity kPeakToPeakForce{"peak_to_peak_force",
                                      dimension::force,
                                      Shape::vector,
                                      Scope::window,
                                      "max_force less min_force",
                                      "",
                                      {"max_force", "min_force"}};
const ResultQuantity kMaxSpeed{"max_speed", dimension::velocity, Shape::number, Scope::window,
                               "largest speed of the centre; null where it slips in no time"};

class SignalExtremes : public RunObserver, public SignalObserver, public PathObserver {
 public:
  explicit SignalExtremes(const ObserverParts& parts) : parts_(parts) {}

  ObserverFacets facets() override { return {.at_blocks = this, .on_path = this}; }
  void declare(StateLayout& layout) const override {
    Extremes::declare(layout, parts_.signals.count());
  }
  void attach(RunState& state) override { extremes_.attach(state, parts_.signals.count()); }
  void start() override { extremes_.start(); }
  void next_window() override { extremes_.start(); }
  void force_switched(std::string_view) override { extremes_.break_off(); }
  void edge(const RunMoment& moment) override { extremes_.include(moment.signals); }

  void steps(const SignalBlock& block) override {
    if (block.count == 0) return;
    const bool inside = parts_.window.contains(block.times[0]);
    if (inside == parts_.window.contains(block.times[block.count - 1])) {
      extremes_.add_block(block.times, block.signals, block.count, inside);
      return;
    }
    for (std::size_t k = 0; k < block.count; ++k) {
      extremes_.add(block.times[k], block.at(k), parts_.window.contains(block.times[k]));
    }
  }

  /// Counts only the part within the window of a step across an edge of it.
  void span(const SignalSpan& span) override {
    const MeasureWindow& window = parts_.window;
    if (!(span.to > window.from().time && span.from < window.to().time)) return;
    const auto inside = [&](double theta) { return window.contains(span.time(theta)); };
    for (const std::size_t end : {0, 3}) {
      if (inside(end == 0 ? 0.0 : 1.0)) extremes_.include(span.at[end].data());
    }
    for (std::size_t s = 0; s < parts_.signals.count(); ++s) {
      const CubicExtremes found =
          cubic_extremes(span.at[0][s], span.at[1][s], span.at[2][s], span.at[3][s]);
      for (int e = 0; e < found.count; ++e) {
        if (!inside(found.theta[e])) continue;
        extremes_.include(s, refined(span, s, found, e));
      }
    }
  }

  void path_slip(const PathSlip&) override {
    if (!parts_.window.contains(parts_.run.clock.time())) return;
    for (std::size_t b = 0; b < parts_.run.model.bodies().size(); ++b) {
      extremes_.include(parts_.signals.speed_of(b), std::numeric_limits<double>::infinity());
    }
  }

  void results(ResultTable& table, const double*) const override {
    const bool over = parts_.window.is_over();
    const std::size_t axes = parts_.axes();
    const std::vector<Model::Driver>& drivers = parts_.signals.drivers();
    for (std::size_t k = 0; k < drivers.size(); ++k) {
      std::vector<double> max;
      std::vector<double> min;
      std::vector<double> peak_to_peak;
      for (std::size_t d = 0; over && d < axes; ++d) {
        max.push_back(extremes_.high(parts_.signals.force_of(k, d)));
        min.push_back(extremes_.low(parts_.signals.force_of(k, d)));
        peak_to_peak.push_back(max[d] - min[d]);
      }
      ResultGroup& group = table.driver(drivers[k]);
      group.add(kMaxForce, axes, max);
      group.add(kMinForce, axes, min);
      group.add(kPeakToPeakForce, axes, peak_to_peak);
    }
    const std::vector<Model::Body>& bodies = parts_.run.model.bodies();
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      std::optional<double> speed;
      if (over) speed = extremes_.high(parts_.signals.speed_of(b));
      table.body(bodies[b]).add(kMaxSpeed, speed);
    }
  }

 private:
  /// The cubic says where an extreme is, the dense output how large: the cubic is coarser than it
  /// where steps are long. As the cubic has it, where there is no dense output, and nothing that
  /// would be larger than the largest so far.
  double refined(const SignalSpan& span, std::size_t s, const CubicExtremes& found, int e) const {
    const double value = found.value[e];
    if (!span.is_dense) return value;
    const auto [low, high] =
        std::minmax({span.at[0][s], span.at[1][s], span.at[2][s], span.at[3][s]});
    const double near = kNearLargest * (high - low);
    if (extremes_.any(s)) {
      if (found.is_maximum[e] && value + near < extremes_.high(s)) return value;
      if (!found.is_maximum[e] && value - near > extremes_.low(s)) return value;
    }
    return span.extreme_near(found.theta[e], [s](const double* signals) { return signals[s]; });
  }

  ObserverParts parts_;
  Extremes extremes_;
};

}  // namespace

ObserverKind extremes() {
  ObserverKind kind = kind_of<SignalExtremes>(
      {{"drivers", {&kMaxForce, &kMinForce, &kPeakToPeakForce}}, {"bodies", {&kMaxSpeed}}});
  kind.watches = true;
  return kind;
}

}  // namespace tomlin::observers
