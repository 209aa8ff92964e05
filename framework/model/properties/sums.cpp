#include <algorithm>
#include <cmath>
#include <cstring>

#include "framework/model/properties/force_under_test.hpp"

/// Effects of a force on its bodies as a whole, and on nothing else.
namespace tomlin::properties {
namespace {

/// Foreign numbers in the arrays of forces, in which only the force's own bodies may change.
class Watched {
 public:
  Watched(const ForceTwin<double>& twin, const Model& model) : view_(twin.view()) {
    own_force_.assign(view_.dofs + kGuard, false);
    mapped_size_ = 0;
    for (const Model::Body& body : model.bodies()) {
      const BodySlot<double>& slot = body.bound.slot;
      if (!slot.mapped) continue;
      mapped_size_ = std::max(
          mapped_size_, slot.offset + slot.stride * static_cast<std::size_t>(model.dimension()));
    }
    own_mapped_.assign(mapped_size_, false);
    for (const std::size_t b : twin.force().bodies) {
      const BodySlot<double>& slot = model.bodies()[b].bound.slot;
      for (int d = 0; d < model.dimension(); ++d) {
        for (std::size_t i = 0; i < slot.count; ++i) {
          (slot.mapped ? own_mapped_ : own_force_)[slot.offset + d * slot.stride + i] = true;
        }
        if (slot.rigid) own_force_[slot.centre + d] = true;
      }
    }
  }

  void fill(double background) const {
    std::fill(view_.force, view_.force + own_force_.size(), background);
    std::fill(view_.mapped_force, view_.mapped_force + mapped_size_, background);
  }
  /// Numbers on the force's own bodies.
  std::vector<double> own() const {
    std::vector<double> numbers;
    for (std::size_t k = 0; k < own_force_.size(); ++k) {
      if (own_force_[k]) numbers.push_back(view_.force[k]);
    }
    for (std::size_t k = 0; k < mapped_size_; ++k) {
      if (own_mapped_[k]) numbers.push_back(view_.mapped_force[k]);
    }
    return numbers;
  }
  /// Numbers elsewhere than on the force's own bodies that are not what they were.
  std::size_t changed_elsewhere(double background) const {
    std::size_t changed = 0;
    for (std::size_t k = 0; k < own_force_.size(); ++k) {
      changed += !own_force_[k] && view_.force[k] != background;
    }
    for (std::size_t k = 0; k < mapped_size_; ++k) {
      changed += !own_mapped_[k] && view_.mapped_force[k] != background;
    }
    return changed;
  }

 private:
  static constexpr std::size_t kGuard = kGroup;  // past the end, which is scratch
  const SystemView<double>& view_;
  std::size_t mapped_size_ = 0;
  std::vector<bool> own_force_, own_mapped_;
};

}  // namespace

bool is_open(ForceUnderTest& e) {
  const std::vector<bool>& periodic = e.alone().model().scene().box.periodic;
  return std::find(periodic.begin(), periodic.end(), true) == periodic.end();
}

SingleForce::Wrench total_of(ForceUnderTest& e) {
  SingleForce::Wrench total;
  for (const std::size_t body : e.alone().force().bodies) {
    const SingleForce::Wrench wrench = e.alone().wrench(body);
    for (std::size_t a = 0; a < 3; ++a) {
      total.force[a] += wrench.force[a];
      total.torque[a] += wrench.torque[a];
    }
  }
  return total;
}

bool acts_on_all_its_bodies(ForceUnderTest& e) {
  const std::vector<Pass<double>> passes = e.force().bound->passes();
  const std::vector<std::size_t>& bodies = e.alone().force().bodies;
  return std::all_of(bodies.begin(), bodies.end(), [&](std::size_t body) {
    return std::any_of(passes.begin(), passes.end(), [&](const Pass<double>& pass) {
      return std::any_of(pass.writes.begin(), pass.writes.end(),
                         [&](const Region& region) { return region.body == body; });
    });
  });
}

bool internal(ForceUnderTest& e, const State& state) {
  const double rounding = rounding_of_sum(e.count());
  const double here = e.terms(state).size + e.largest(e.forces(state));
  if (!state.is_close() && !std::isfinite(here)) return false;
  double& near = e.memory().largest;
  if (state.is_close()) near = std::max(near, here);
  const double largest = state.is_close() ? near : here;
  const SingleForce::Wrench total = total_of(e);
  const double size = largest * static_cast<double>(e.count());
  const double lever = size * e.reach(state);
  const double least = kSmallest * static_cast<double>(e.count());
  for (std::size_t a = 0; a < 3; ++a) {
    e.note(total.force[a], 0.0, size, rounding * size + least, state);
    if (is_open(e)) {
      e.note(total.torque[a], 0.0, lever, rounding * lever + least * e.reach(state), state);
    }
  }
  return true;
}

/// A force that does work has a support and rates for its force and power; no other force has.
bool reports_if_it_drives(ForceUnderTest& e) {
  const bool drives = e.force().driving->drive() != nullptr;
  const auto reported = static_cast<double>(e.force().driving->rate_count());
  const double expected = e.traits().does_work ? e.alone().model().dimension() + 1.0 : 0.0;
  if (e.traits().does_work == drives && reported == expected) return true;
  e.contradict(reported, expected);
  return false;
}

/// A driver's force and power as the summary will show them.
bool driver(ForceUnderTest& e, const State& state) {
  const Drive* drive = e.force().driving->drive();
  const auto axes = static_cast<std::size_t>(e.alone().model().dimension());
  const auto first = static_cast<std::size_t>(e.alone().force().first_rate);
  const double rounding = rounding_of_sum(e.count());
  const std::vector<double> forces = e.forces(state);
  const double* rates = e.alone().rates();
  const SingleForce::Wrench total = total_of(e);
  const double size = (e.largest(forces) + e.terms(state).size) * static_cast<double>(e.count());
  double power = 0.0;
  double fastest = 0.0;
  for (std::size_t d = 0; d < axes; ++d) {
    e.note(rates[first + d], total.force[d], size, rounding * size, state);
    power += total.force[d] * drive->velocity[d];
    fastest = std::max(fastest, std::abs(drive->velocity[d]));
  }
  if (drive->steady) {
    e.note(rates[first + axes], power, size * fastest, rounding * size * fastest, state);
  }
  return true;
}

/// Kernels that only add, on numbers that are not theirs; what they read stays as it is. What they
/// add to nothing they add to anything, on the particles of rigid bodies and on their centres too.
bool its_own(ForceUnderTest& e, const State& state) {
  constexpr double kBackground = 8.0;
  ForceTwin<double>& twin = e.twin();
  Watched watched(twin, e.alone().model());
  const std::vector<double> forces = e.forces(state);
  e.put(state, twin);
  twin.evaluate(state.time);
  const auto added_to = [&](double background) {
    watched.fill(background);
    for (const Pass<double>& pass : twin.force().bound->passes()) {
      if (pass.add != nullptr) pass.add(pass.arguments, twin.stage());
    }
    return watched.own();
  };
  const std::vector<double> added = added_to(0.0);
  const std::vector<double> found = added_to(kBackground);
  for (std::size_t k = 0; k < added.size(); ++k) {
    const double size = kBackground + std::abs(added[k]);
    e.note(found[k], kBackground + added[k], size, kRounding * size, state);
  }
  const auto elsewhere = static_cast<double>(watched.changed_elsewhere(kBackground));
  e.note(elsewhere, 0.0, 1.0, 0.0, state);
  for (std::size_t i = 0; i < e.count(); ++i) {
    const std::size_t at = e.variable(i).at;
    e.note_same(twin.position(at), state.x[i], state);
    e.note_same(twin.velocity(at), state.v[i], state);
    // A force acts on either the particles or the centre of a rigid body.
    if (e.alone().model().bodies()[e.variable(i).body].bound.slot.rigid) continue;
    const double size = kBackground + std::abs(forces[i]);
    e.note(twin.force_at(at), kBackground + forces[i], size, kRounding * size, state, i);
  }
  return true;
}

}  // namespace tomlin::properties
