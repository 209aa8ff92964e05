#include <functional>

#include "framework/run/events/events.hpp"
#include "framework/run/observers/kinds.hpp"

/// Hops of bodies that roll in the plane, and whole turns of all that turn freely.
namespace tomlin::observers {
namespace {

/// Height of a body, its rotation in revolutions, and their rates.
struct BodyReading {
  double height = 0.0;
  double rise = 0.0;
  double turns = 0.0;
  double spin = 0.0;
};

/// Interpolates over a step of length h, from values and slopes at its ends.
double hermite(double theta, double h, double y0, double slope0, double y1, double slope1) {
  const double rest = 1.0 - theta;
  const double change = y1 - y0;
  const double bend = rest * (h * slope0 - change) - theta * (h * slope1 - change);
  return y0 + theta * (change + rest * bend);
}

class BodyEvents : public RunObserver, public SignalObserver, public StateReader {
 public:
  explicit BodyEvents(const ObserverParts& parts) : parts_(parts), model_(parts.run.model) {
    for (std::size_t b = 0; b < model_.bodies().size(); ++b) {
      const Model::Body& body = model_.bodies()[b];
      const BodySlot<double>& slot = body.bound.slot;
      if (!body.rotates() || (slot.mapped && !slot.rigid) || body.prescribed()) continue;
      watches_.emplace_back(b, body.rolling_radius, body.rolling_rise);
      parts.events.expect(EventKind::turn);
      if (watches_.back().watches_hops()) parts.events.expect(EventKind::hop);
    }
    for (std::vector<BodyReading>& readings : readings_) readings.resize(watches_.size());
    emit_ = [this](const Event& event) { parts_.events.record(event, name_); };
  }
  bool any() const { return !watches_.empty(); }
  ObserverFacets facets() override { return {.at_steps = this, .reader = this}; }

  void declare(StateLayout& layout) const override {
    declare_all(layout, "events.bodies", watches_);
  }
  void attach(RunState& state) override { attach_all(state, "events.bodies", watches_); }
  void start() override {
    for (BodyWatch& watch : watches_) watch.start();
  }

  /// Without velocities heights and turns alone.
  void read(std::size_t point, const double* position, const double* velocity) override {
    for (std::size_t k = 0; k < watches_.size(); ++k) {
      const std::size_t b = watches_[k].body();
      const BodySlot<double>& slot = model_.bodies()[b].bound.slot;
      BodyReading& reading = readings_[point][k];
      if (slot.rigid && !model_.bodies()[b].rotor) {
        reading.height = height_of(position[slot.centre + 1], 1);
        reading.turns = model_.rotation(b, position);
        if (velocity == nullptr) continue;
        reading.rise = velocity[slot.centre + 1];
        reading.spin = velocity[slot.centre + kRotation];
      } else if (watches_[k].watches_hops()) {
        const int up = model_.bodies()[b].plane[1];
        double centre[3];
        model_.centre(b, position, centre);
        reading.height = height_of(centre[up], up);
        if (velocity == nullptr) continue;
        model_.centre_velocity(b, velocity, centre);
        reading.rise = centre[up];
      }
    }
  }

  void steps(const SignalBlock& block) override { look(block.times[0], readings_[0]); }

  void look_at_point(const SignalSpan& span, std::size_t point) override {
    if (span.is_dense && point > 0) {
      // Between the ends, whose velocities are known.
      const double h = span.to - span.from;
      const double theta = static_cast<double>(point) / 3.0;
      for (std::size_t k = 0; k < watches_.size(); ++k) {
        const BodyReading& a = readings_[0][k];
        const BodyReading& b = readings_[3][k];
        readings_[point][k].height = hermite(theta, h, a.height, a.rise, b.height, b.rise);
        readings_[point][k].turns = hermite(theta, h, a.turns, a.spin, b.turns, b.spin);
      }
    }
    look(span.times[point], readings_[point]);
  }

  void turned(std::size_t body, double turns) override {
    for (BodyWatch& watch : watches_) {
      if (watch.body() != body) continue;
      name_ = model_.bodies()[body].bound.name;
      watch.add_turns(parts_.run.clock.time(), turns, emit_);
    }
  }

  void look_at_end(const RunMoment& end) override {
    read(0, end.position, nullptr);
    look(end.time, readings_[0]);
  }

  void finish(const RunMoment& end) override {
    for (BodyWatch& watch : watches_) {
      name_ = model_.bodies()[watch.body()].bound.name;
      watch.add_turns(end.time, parts_.rotations.turns_of(watch.body(), end.position), emit_);
      watch.finish(end.time, emit_);
    }
  }

 private:
  /// Hardly ever is there a cell along this axis.
  double height_of(double y, int axis) const {
    return model_.origin().cells[static_cast<std::size_t>(axis)] == 0
               ? y
               : static_cast<double>(model_.placed(axis, y));
  }

  void look(double time, const std::vector<BodyReading>& readings) {
    for (std::size_t k = 0; k < watches_.size(); ++k) {
      BodyWatch& watch = watches_[k];
      const Model::Body& body = model_.bodies()[watch.body()];
      name_ = body.bound.name;
      if (watch.watches_hops()) watch.add_height(time, readings[k].height, emit_);
      if (body.bound.slot.rigid && !body.rotor) watch.add_turns(time, readings[k].turns, emit_);
    }
  }

  ObserverParts parts_;
  const Model& model_;
  std::vector<BodyWatch> watches_;
  std::array<std::vector<BodyReading>, 4> readings_;  ///< at four points of a step
  std::string_view name_;                             ///< of the body whose event is looked for
  BodyWatch::Emit emit_;
};

std::unique_ptr<RunObserver> make_body_events(const ObserverParts& parts) {
  auto events = std::make_unique<BodyEvents>(parts);
  if (!events->any()) return nullptr;
  return events;
}

}  // namespace

ObserverKind body_events() {
  return {.rows = {}, .watches = true, .events = {"hops", "turns"}, .make = make_body_events};
}

}  // namespace tomlin::observers
