#include <algorithm>
#include <cmath>

#include "framework/model/properties/slopes.hpp"

/// Forces in quadruple precision against energies and heat in the same: no constant in any of them
/// is good to double precision only. Other properties rely on them.
namespace tomlin::properties {
namespace {

/// Time over which internal variables go on as they change now: a power of two, in which they
/// change by about as much as they are. What they store is quadratic in them: the central
/// difference is exact but for rounding, which is then least.
double time_of_change(const std::vector<double>& own, const std::vector<Quad>& rates) {
  double size = 0.0;
  double rate = 0.0;
  for (std::size_t k = 0; k < rates.size(); ++k) {
    size = std::max(size, std::abs(own[k]));
    rate = std::max(rate, std::abs(static_cast<double>(rates[k])));
  }
  return size > 0.0 && rate > 0.0 ? std::ldexp(1.0, std::ilogb(size / rate)) : 1.0;
}

/// Parts of the largest force that it may change by within a difference of energies: 1e-11 of waves
/// of the shortest length.
constexpr double kMostRelativeChange = 1e-3;

Quad power_of(ForceUnderTest& e, const ForceTwin<Quad>& twin, const State& state) {
  Quad power(0.0);
  for (std::size_t i = 0; i < e.count(); ++i) {
    power += twin.force_at(e.variable(i).at) * Quad(state.v[i]);
  }
  return power;
}

/// Power that goes into the stored energy by way of internal variables.
Quad stored(ForceUnderTest& e, ForceTwin<Quad>& twin, const State& state) {
  if (state.own.empty()) return Quad(0.0);
  std::vector<Quad> rates;
  for (std::size_t k = 0; k < state.own.size(); ++k) rates.push_back(twin.rate(k));
  const auto energy_after = [&](double h) {
    for (std::size_t k = 0; k < rates.size(); ++k) {
      twin.own(k) = Quad(state.own[k]) + Quad(h) * rates[k];
    }
    return twin.energy();
  };
  const double h = time_of_change(state.own, rates);
  const Quad gained = energy_after(h) - energy_after(-h);
  e.put(state, twin);
  return gained / Quad(2.0 * h);
}

/// -F.v = heat + what is stored.
void compare_heat(ForceUnderTest& e, const State& state) {
  ForceTwin<Quad>& twin = *e.exact();
  e.put(state, twin);
  twin.evaluate(state.time);
  const Quad heat = *twin.heat();
  const Quad taken = -power_of(e, twin, state) - stored(e, twin, state);
  double size = std::abs(static_cast<double>(heat));
  double noise = 0.0;
  for (std::size_t i = 0; i < e.count(); ++i) {
    size += std::abs(static_cast<double>(twin.force_at(e.variable(i).at)) * state.v[i]);
    noise += e.sensitivity(state) * std::abs(state.v[i]) / e.variable(i).unit;
  }
  e.note(static_cast<double>(heat - taken), 0.0, size, kExactRounding * (size + noise), state);
}

/// Along all coordinates at once, where a fault of any part shows.
void compare_gradient(ForceUnderTest& e, const State& state, const Direction& direction) {
  ForceTwin<Quad>& twin = *e.exact();
  e.put(state, twin);
  twin.evaluate(state.time);
  Quad force(0.0);
  double size = 0.0;
  for (std::size_t i = 0; i < e.count(); ++i) {
    const Quad part = twin.force_at(e.variable(i).at) * Quad(direction[i]);
    force += part;
    size += std::abs(static_cast<double>(part));
  }
  const ExactSlope slope = exact_slope(e, state, direction);
  const auto energy_at = [&](const State& at) {
    e.put(at);
    return e.alone().energy(at.time);
  };
  const double energy = std::abs(energy_at(state)) + e.change_of(state, energy_at);
  const double allowed = kExactRounding * (size + e.sensitivity(state) * length_of(e, direction)) +
                         kExactRounding * energy / slope.step +
                         kErrorPerDifference * slope.unsettled;
  e.note(static_cast<double>(force + slope.best), 0.0, size, allowed, state);
}

}  // namespace

bool quadruple_gradient(ForceUnderTest& e, const State& state) {
  if (!state.is_close()) return false;
  const double sensitivity = e.sensitivity(state);
  if (!std::isfinite(sensitivity)) return false;
  // Over a wave much shorter than any length that is known, differences say nothing.
  const double moved = sensitivity * kTinyDifference * e.length() / e.reach(state);
  if (moved > kMostRelativeChange * e.largest(e.forces(state))) return false;
  compare_gradient(e, state, e.random_direction(e.memory().random));
  return true;
}

bool quadruple_heat(ForceUnderTest& e, const State& state) {
  if (!state.is_close() || !std::isfinite(e.sensitivity(state))) return false;
  compare_heat(e, state);
  return true;
}

}  // namespace tomlin::properties
