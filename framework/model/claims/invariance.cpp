#include <algorithm>
#include <cmath>

#include "framework/model/claims/force_under_test.hpp"

/// What must not change a force: whole periods, where positions are counted from, what it does not
/// depend on, and what was evaluated before.
namespace tomlin::claims {
namespace {

constexpr double kPeriods[] = {1.0, -1.0, 1000.0, -1e6};
/// Cells by which an origin has moved after a long run.
constexpr std::int64_t kCells[] = {5, -1000003};

/// Lengths per time that nothing else here comes near, where the shorter of a unit of time and the
/// run's is the time.
constexpr double kFast = 1e3;
/// Part of a time that has elapsed since the start of a step.
constexpr double kElapsed = 0.37;

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

}  // namespace

std::optional<ClaimResult> periodic(ForceUnderTest& e) {
  if (!e.traits().periodic) return std::nullopt;
  e.begin("periodic", "a shift by its period, and by a million, changes nothing");
  const SceneForce& from = e.described();
  double largest = 0.0;  // over the states so far: a force may vanish at the start
  for (const State& state : e.near()) {
    const std::vector<double> before = e.forces(state);
    largest = std::max(largest, e.largest(before));
    for (int axis = 0; axis < e.alone().model().dimension(); ++axis) {
      const double period = from.record->period(from.description.get(), axis);
      if (!(period > 0.0)) continue;
      for (const double periods : kPeriods) {
        // Places are rounded, and what a force makes of it grows with its own steepness.
        const State moved = shifted(e, state, axis, periods * period);
        const double steepness = e.sensitivity(moved);
        const double turns = e.reach(moved) / period * largest;
        e.note(e.forces(moved), before, largest, kRounding * (largest + steepness + turns), moved);
      }
    }
    e.looked();
  }
  return e.end();
}

/// As the engine does it: the origin moves by whole cells, places are relative to the new one.
std::optional<ClaimResult> origin(ForceUnderTest& e) {
  if (e.on_prescribed()) return std::nullopt;
  e.begin("origin", "nothing changes when the origin moves, and all comes back with it");
  // Without a period an axis never moves, unless another force declares one: bound as if there were
  // such a force.
  AssemblyPlan plan = e.alone().model().plan();
  for (int axis = 0; axis < e.alone().model().dimension(); ++axis) {
    if (!(plan.origin.unit[axis] > 0.0)) plan.origin.unit[axis] = e.length();
  }
  const auto twin = std::make_unique<ForceTwin<double>>(plan);
  const Origin first = twin->origin();
  for (const State& state : e.near()) {
    const std::vector<double> before = forces_of(e, state, *twin);
    const double energy = twin->energy();
    const double largest = e.largest(before);
    for (int axis = 0; axis < e.alone().model().dimension(); ++axis) {
      for (const std::int64_t cells : kCells) {
        Origin moved = first;
        moved.cells[axis] += cells;
        const double by =
            -static_cast<double>(moved.cells[axis] - first.cells[axis]) * moved.unit[axis];
        const State seen = shifted(e, state, axis, by);
        const double steepness =
            e.sensitivity(state) * std::max(1.0, e.reach(seen) / e.reach(state));
        twin->rebase(moved);
        const std::vector<double> after = forces_of(e, seen, *twin);
        e.note(after, before, largest, kRounding * (largest + steepness), seen);
        twin->rebase(first);
        e.note_same(forces_of(e, state, *twin), before, state);
        e.note_same(twin->energy(), energy, state);
      }
    }
    e.looked();
  }
  return e.end();
}

std::optional<ClaimResult> velocity(ForceUnderTest& e) {
  if (e.traits().depends_on_velocity) return std::nullopt;
  e.begin("velocity", "independent of velocities");
  for (const State& state : e.near()) {
    const std::vector<double> due = e.forces(state);
    const double run = e.alone().model().scene().run.duration;
    for (const double speed : {1.0, kFast / std::min(1.0, run)}) {
      State other = state;
      for (std::size_t i = 0; i < e.count(); ++i) {
        other.v[i] = -3.0 * state.v[i] + speed * e.length() * e.variable(i).unit;
      }
      e.note_same(e.forces(other), due, other);
    }
    e.looked();
  }
  return e.end();
}

/// Time is the start of a step plus what has elapsed since: much of it, and some of a run's.
std::optional<ClaimResult> time(ForceUnderTest& e) {
  if (e.on_prescribed()) return std::nullopt;
  const bool depends = e.traits().depends_on_time;
  e.begin("time", depends ? "the same however time is divided into steps"
                          : "force and energy are the same at all times");
  const auto twin = e.twin();
  for (const State& state : e.near()) {
    const std::vector<double> before = forces_of(e, state, *twin);
    const double energy = twin->energy();
    e.looked();
    if (!depends) {
      State later = state;
      later.time = 2.0 * state.time + 1.0;
      const double run = e.alone().model().scene().run.duration;
      for (const double elapsed : {0.0, kElapsed * later.time, kElapsed * run}) {
        e.note_same(forces_of(e, later, *twin, elapsed), before, later);
        e.note_same(twin->energy(), energy, later);
      }
      continue;
    }
    const std::vector<double> divided = forces_of(e, state, *twin, 0.25 * state.time);
    const double largest = e.largest(before);
    const double allowed = kRounding * (largest + e.sensitivity(state));
    e.note(divided, before, largest, allowed, state);
  }
  return e.end();
}

std::optional<ClaimResult> repeatable(ForceUnderTest& e) {
  if (e.traits().stochastic) return std::nullopt;
  e.begin("repeatable", "the same bits after other evaluations");
  const std::vector<State>& states = e.near();
  std::vector<std::vector<double>> forces;
  std::vector<double> energies;
  for (const State& state : states) {
    forces.push_back(e.forces(state));
    energies.push_back(e.alone().energy(state.time));
  }
  // Backwards, so that what came before is another state each time; then each twice in a row.
  for (std::size_t k = states.size(); k-- > 0;) {
    for (int again = 0; again < 2; ++again) {
      e.note_same(e.forces(states[k]), forces[k], states[k]);
      e.note_same(e.alone().energy(states[k].time), energies[k], states[k]);
    }
    e.looked();
  }
  return e.end();
}

}  // namespace tomlin::claims
