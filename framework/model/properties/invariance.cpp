#include <algorithm>
#include <cmath>
#include <utility>

#include "framework/model/properties/force_under_test.hpp"

/// Changes that a force must not notice: whole periods, where positions are counted from, what it
/// does not depend on, and what was evaluated before.
namespace tomlin::properties {
namespace {

constexpr double kPeriods[] = {1.0, -1.0, 1000.0, -1e6};
/// Cells by which an origin has moved after a long run.
constexpr std::int64_t kCells[] = {5, -1000003};
/// Whole periods by which an origin has moved: beyond 2^31 of them a phase has no digit left unless
/// they are counted.
constexpr std::int64_t kPeriodsOfOrigin[] = {3, -7, 2000000011};

/// Lengths per time that nothing else here comes near, where the shorter of a unit of time and the
/// run's is the time.
constexpr double kUnusualSpeed = 1e3;
/// Part of a time that has elapsed since the start of a step.
constexpr double kElapsedPart = 0.37;

/// Forces of a twin at a state, of each variable.
std::vector<double> forces_of(ForceUnderTest& e, const State& state, ForceTwin<double>& twin,
                              double elapsed = 0.0) {
  e.put(state, twin);
  twin.evaluate(state.time - elapsed, elapsed);
  std::vector<double> forces(e.count());
  for (std::size_t i = 0; i < e.count(); ++i) forces[i] = twin.force_at(e.variable(i).at);
  return forces;
}

State shifted(const ForceUnderTest& e, const State& state, int axis, double by) {
  State moved = state;
  for (std::size_t i = 0; i < e.count(); ++i) {
    if (e.variable(i).axis == axis) moved.x[i] += by;
  }
  return moved;
}

/// Period along an axis; 0 where the force declares none.
double period_of(ForceUnderTest& e, int axis) {
  return e.described().record->period(e.described().description.get(), axis);
}

/// A body of the force that is held along an axis stays behind where the others are shifted.
bool one_is_held(ForceUnderTest& e, int axis) {
  const auto& bodies = e.alone().force().bodies;
  return std::any_of(bodies.begin(), bodies.end(),
                     [&](std::size_t b) { return e.alone().model().bodies()[b].held[axis]; });
}

}  // namespace

bool has_period(ForceUnderTest& e) {
  for (int axis = 0; axis < e.alone().model().dimension(); ++axis) {
    if (period_of(e, axis) > 0.0) return true;
  }
  return false;
}

bool declares_period_if_periodic(ForceUnderTest& e) {
  if (e.traits().periodic == has_period(e)) return true;
  e.contradict(has_period(e) ? 1.0 : 0.0, e.traits().periodic ? 1.0 : 0.0);
  return false;
}

/// Forces and energy.
bool periodic(ForceUnderTest& e, const State& state) {
  double& largest = e.memory().largest;  // over the states so far: a force may vanish at the start
  const std::vector<double> before = e.forces(state);
  const double energy = e.alone().energy(state.time);
  largest = std::max(largest, e.largest(before));
  for (int axis = 0; axis < e.alone().model().dimension(); ++axis) {
    const double period = period_of(e, axis);
    if (period < 0.0) e.contradict(period, 0.0);
    if (!(period > 0.0)) continue;
    for (const double periods : kPeriods) {
      // Positions are rounded, and what a force makes of it grows with its own steepness.
      const State moved = shifted(e, state, axis, periods * period);
      const double steepness = e.sensitivity(moved);
      const double turns = e.reach(moved) / period * largest;
      const double allowed = kRounding * (largest + steepness + turns);
      e.note(e.forces(moved), before, largest, allowed, moved);
      // An energy follows its forces over the same rounded positions.
      const double size = std::abs(energy) + e.length() * largest;
      e.put(moved);
      e.note(e.alone().energy(moved.time), energy, size,
             allowed * e.length() * static_cast<double>(e.count()) + kRounding * size, moved);
    }
  }
  return true;
}

/// The origin moved by whole periods and positions, relative to it, as they are: phases are those
/// of the first origin, to the last bit.
bool rebase(ForceUnderTest& e, const State& state) {
  ForceTwin<double>& twin = e.twin();
  const Origin first = twin.origin();
  const std::vector<double> before = forces_of(e, state, twin);
  const double energy = twin.energy();
  for (int axis = 0; axis < e.alone().model().dimension(); ++axis) {
    if (!(period_of(e, axis) > 0.0)) continue;
    for (const std::int64_t cells : kPeriodsOfOrigin) {
      Origin moved = first;
      moved.unit[axis] = period_of(e, axis);
      moved.cells[axis] += cells;
      twin.rebase(moved);
      e.note_same(forces_of(e, state, twin), before, state);
      e.note_same(twin.energy(), energy, state);
    }
    twin.rebase(first);
  }
  return true;
}

/// Moves the origin as the engine does: by whole cells, and positions are relative to the new one.
bool origin(ForceUnderTest& e, const State& state) {
  // Without a period an axis never moves, unless another force declares one: bound as if there were
  // such a force.
  AssemblyPlan plan = e.alone().model().plan();
  for (int axis = 0; axis < e.alone().model().dimension(); ++axis) {
    if (!(plan.origin.unit[axis] > 0.0)) plan.origin.unit[axis] = e.length();
  }
  ForceTwin<double>& twin = e.twin(plan);
  const Origin first = twin.origin();
  const std::vector<double> before = forces_of(e, state, twin);
  const double energy = twin.energy();
  const double largest = e.largest(before);
  for (int axis = 0; axis < e.alone().model().dimension(); ++axis) {
    const bool all_shift = !one_is_held(e, axis);
    for (const std::int64_t cells : kCells) {
      Origin moved = first;
      moved.cells[axis] += cells;
      const double by =
          -static_cast<double>(moved.cells[axis] - first.cells[axis]) * moved.unit[axis];
      const State seen = shifted(e, state, axis, by);
      const double steepness = e.sensitivity(state) * std::max(1.0, e.reach(seen) / e.reach(state));
      twin.rebase(moved);
      const std::vector<double> after = forces_of(e, seen, twin);
      // The sensitivity of a mean over many particles is too small by the root of their number:
      // the random changes that it is measured by cancel, the rounding of its sum does not.
      const double far = std::sqrt(static_cast<double>(e.count())) * steepness;
      const double rounding = kRounding * largest + rounding_of_sum(e.count()) * far;
      if (all_shift) e.note(after, before, largest, rounding, seen);
      twin.rebase(first);
      e.note_same(forces_of(e, state, twin), before, state);
      e.note_same(twin.energy(), energy, state);
    }
  }
  return true;
}

bool velocity(ForceUnderTest& e, const State& state) {
  const std::vector<double> expected = e.forces(state);
  const double run = e.alone().model().scene().run.duration;
  for (const double speed : {1.0, kUnusualSpeed / std::min(1.0, run)}) {
    State other = state;
    for (std::size_t i = 0; i < e.count(); ++i) {
      other.v[i] = -3.0 * state.v[i] + speed * e.length() * e.variable(i).unit;
    }
    e.note_same(e.forces(other), expected, other);
  }
  return true;
}

/// Time advances only for a force that declares it when it is bound.
bool time_is_bound_as_declared(ForceUnderTest& e) {
  const bool depends = e.traits().depends_on_time;
  if (e.force().bound->depends_on_time() != depends)
    e.contradict(depends ? 0.0 : 1.0, depends ? 1.0 : 0.0);
  return true;
}

/// Time is the start of a step plus what has elapsed since: much of it, and some of a run's.
bool same_at_all_times(ForceUnderTest& e, const State& state) {
  const std::vector<double> before = forces_of(e, state, e.twin());
  const double energy = e.twin().energy();
  State later = state;
  later.time = 2.0 * state.time + 1.0;
  const double run = e.alone().model().scene().run.duration;
  for (const double elapsed : {0.0, kElapsedPart * later.time, kElapsedPart * run}) {
    e.note_same(forces_of(e, later, e.twin(), elapsed), before, later);
    e.note_same(e.twin().energy(), energy, later);
  }
  return true;
}

bool divided_time(ForceUnderTest& e, const State& state) {
  const std::vector<double> before = forces_of(e, state, e.twin());
  const std::vector<double> divided = forces_of(e, state, e.twin(), 0.25 * state.time);
  const double largest = e.largest(before);
  e.note(divided, before, largest, kRounding * (largest + e.sensitivity(state)), state);
  return true;
}

bool evaluate_forwards(ForceUnderTest& e) {
  for (const State& state : e.near()) {
    std::vector<double> numbers = e.forces(state);
    numbers.push_back(e.alone().energy(state.time));
    e.memory().numbers[&state] = std::move(numbers);
  }
  return true;
}

/// States come backwards, so that the evaluation before is of another state each time; then each
/// twice in a row.
bool repeatable(ForceUnderTest& e, const State& state) {
  std::vector<double> forces = e.memory().numbers.at(&state);
  const double energy = forces.back();
  forces.pop_back();
  for (int again = 0; again < 2; ++again) {
    e.note_same(e.forces(state), forces, state);
    e.note_same(e.alone().energy(state.time), energy, state);
  }
  return true;
}

}  // namespace tomlin::properties
