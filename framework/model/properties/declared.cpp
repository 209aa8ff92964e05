#include <cmath>
#include <cstddef>

#include "framework/model/properties/slopes.hpp"

/// Declarations and denials of a record that a single state cannot refute: that a force is no
/// gradient, is not internal, depends on velocities or on time. Each is to be seen at one state at
/// least; a scene in which none shows it (a driver at rest) has nothing to compare, and the
/// conformance test asks for one that does.
namespace tomlin::properties {
namespace {

/// Parts of a force's size beyond which two numbers are different ones: far above what differences
/// and rounding leave, at 1e-9, and below what a wrong declaration is about, which is all of it.
constexpr double kLeastDifference = 1e-3;

bool differ(const std::vector<double>& found, const std::vector<double>& expected) {
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i] != expected[i] && !(std::isnan(found[i]) && std::isnan(expected[i]))) return true;
  }
  return false;
}

/// Forces, energy and the rates of what the force integrates, its internal variables first.
std::vector<double> all_numbers(ForceUnderTest& e, const State& state) {
  std::vector<double> numbers = e.forces(state);
  const double* const rates = e.alone().rates();
  numbers.insert(numbers.end(), rates, rates + e.alone().model().system().view.used_rates);
  numbers.push_back(e.alone().energy(state.time));
  return numbers;
}

}  // namespace

bool not_conservative(ForceUnderTest& e, const State& state) {
  const Direction direction = e.random_direction(e.memory().random);
  const std::vector<double> forces = e.forces(state);
  const Slope slope = slope_of(
      [&](double h) {
        e.put_moved(state, direction, h);
        return e.alone().energy(state.time);
      },
      kLongestDifference * e.length());
  const double apart = std::abs(work(forces, direction) + slope.best);
  return e.note_shown(apart > kLeastDifference * effort(forces, direction), state);
}

bool not_internal(ForceUnderTest& e, const State& state) {
  const double size = e.largest(e.forces(state)) + e.terms(state).size;
  const SingleForce::Wrench total = total_of(e);
  const double net = std::hypot(total.force[0], total.force[1], total.force[2]);
  // Forces that vanish sum to their rounding.
  const double rounding = kRounding * e.sensitivity(state) * static_cast<double>(e.count());
  return e.note_shown(net > kLeastDifference * size + rounding, state);
}

bool uses_velocity(ForceUnderTest& e, const State& state) {
  State other = state;
  for (std::size_t i = 0; i < e.count(); ++i) {
    other.v[i] = -3.0 * state.v[i] + e.length() * e.variable(i).unit;
  }
  return e.note_shown(differ(all_numbers(e, other), all_numbers(e, state)), state);
}

bool uses_time(ForceUnderTest& e, const State& state) {
  State later = state;
  // Both near the start and at some part of the run: laws of time may switch on and off.
  for (const double by : {0.37 * e.alone().model().scene().run.duration, state.time}) {
    later.time = state.time + by;
    if (differ(all_numbers(e, later), all_numbers(e, state))) return e.note_shown(true, state);
  }
  return false;
}

}  // namespace tomlin::properties
