#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "framework/model/properties/force_under_test.hpp"

/// Comparisons of one force on every instruction set and in every number type.
namespace tomlin::properties {
namespace {

/// Results of one evaluation, as doubles: forces on the variables; the energy, heat, and the rates
/// of internal variables and of what a driver reports.
struct Outcome {
  std::vector<double> forces;
  std::vector<double> others;
};
constexpr std::size_t kEnergy = 0;  ///< among the others
constexpr std::size_t kHeat = 1;
constexpr std::size_t kFirstRate = 2;

template <class Real>
Outcome outcome_at(ForceUnderTest& e, const State& state, ForceTwin<Real>& twin) {
  e.put(state, twin);
  twin.evaluate(state.time);
  Outcome outcome;
  for (std::size_t i = 0; i < e.count(); ++i) {
    outcome.forces.push_back(static_cast<double>(twin.force_at(e.variable(i).at)));
  }
  outcome.others.push_back(static_cast<double>(twin.energy()));
  const std::optional<Real> heat = twin.heat();
  outcome.others.push_back(heat ? static_cast<double>(*heat) : 0.0);
  // Rates of prescribed bodies are not this force's alone.
  const std::size_t rates = e.on_prescribed() ? 0 : twin.view().used_rates;
  for (std::size_t k = 0; k < rates; ++k) {
    outcome.others.push_back(static_cast<double>(twin.rate(k)));
  }
  return outcome;
}

/// Units in the last place by which a type may be off, in parts of a result's size and of what it
/// changes by per relative change of what it is made of: the worst that correct forces show is a
/// tenth of it.
constexpr double kAllowedUnits = 64.0;
/// A type whose rounding never shows is another type under its name. A single product is off by a
/// third of a unit on average; the worst of many results is not far below that.
constexpr double kLeastVisibleUnits = 0.05;

/// Change of an energy beside that which a shake of all coordinates shows: particles of rigid
/// bodies are rounded one by one, and at its minimum rounding counts in second order.
double hidden_change(ForceUnderTest& e, const State& state, double sensitivity, double allowed) {
  const double second = allowed * sensitivity * static_cast<double>(e.count());
  return (e.terms(state).size + second) * e.reach(state);
}

/// Compares numbers that are no forces on variables, each by itself.
void compare_others(ForceUnderTest& e, ForceTwin<double>& twin, const Outcome& found,
                    const Outcome& expected, const State& state, double sensitivity,
                    double allowed) {
  std::vector<double> changes =
      e.changes_of(state, [&](const State& at) { return outcome_at(e, at, twin).others; });
  changes[kEnergy] += hidden_change(e, state, sensitivity, allowed);
  const ForceUnderTest::Terms terms = e.terms(state);
  changes[kHeat] += terms.heat + (terms.size + terms.change) * terms.speed;
  if (const Drive* drive = e.force().driving->drive(); drive != nullptr && !e.on_prescribed()) {
    // A driver also reports the forces on held coordinates.
    double fastest = 0.0;
    for (const double v : drive->velocity) fastest = std::max(fastest, std::abs(v));
    const std::size_t first = kFirstRate + static_cast<std::size_t>(e.alone().force().first_rate);
    const std::size_t axes = drive->velocity.size();
    for (std::size_t d = 0; d <= axes; ++d) {
      changes[first + d] += (terms.size + terms.change) * (d < axes ? 1.0 : fastest);
    }
  }
  for (std::size_t k = 0; k < expected.others.size(); ++k) {
    if (!std::isfinite(changes[k]) || !std::isfinite(found.others[k])) continue;
    const double size = std::abs(expected.others[k]);
    e.note(found.others[k], expected.others[k], size, allowed * (size + changes[k]) + kSmallest,
           state);
  }
}

/// False where there are no numbers to compare.
bool compare_with_exact(ForceUnderTest& e, ForceTwin<double>& twin, const State& state) {
  constexpr double kAllowed = kAllowedUnits * std::numeric_limits<double>::epsilon();
  const Outcome expected = outcome_at(e, state, *e.exact());
  const Outcome found = outcome_at(e, state, twin);
  const double sensitivity = e.sensitivity(state);
  const double size = e.largest(expected.forces);
  // Numbers that are not finite are checked elsewhere.
  if (!std::isfinite(sensitivity) || !std::isfinite(e.largest(found.forces))) return false;
  double unit = 1.0;
  for (std::size_t i = 0; i < e.count(); ++i) unit = std::max(unit, e.variable(i).unit);
  e.note(found.forces, expected.forces, size, kAllowed * (size + sensitivity) + kSmallest * unit,
         state);
  compare_others(e, twin, found, expected, state, sensitivity, kAllowed);
  return true;
}

/// Whether the rounding of a type shows in forces, against those in quadruple precision.
bool rounds(ForceUnderTest& e, ForceTwin<double>& twin, const State& state) {
  ForceTwin<Quad>& exact = *e.exact();
  const auto evaluate = [&](auto& evaluated) {
    e.put(state, evaluated);
    evaluated.evaluate(state.time);
  };
  evaluate(exact);
  evaluate(twin);
  const double size = e.largest(e.forces(state)) + e.sensitivity(state);
  for (std::size_t i = 0; i < e.count(); ++i) {
    const std::size_t at = e.variable(i).at;
    const double apart = static_cast<double>(Quad(twin.force_at(at)) - exact.force_at(at));
    if (std::abs(e.at_edge(i, apart)) >
        kLeastVisibleUnits * std::numeric_limits<double>::epsilon() * size)
      return true;
  }
  return false;
}

}  // namespace

/// Forces, energies, heat and all rates.
bool same_bits(ForceUnderTest& e, const State& state) {
  const std::vector<double> forces = e.forces(state);
  std::optional<Outcome> first;
  for (const InstructionSet set : supported_sets()) {
    Outcome found = outcome_at(e, state, e.twin(set));
    if (!first) first = found;
    e.note_same(found.forces, first->forces, state);
    e.note_same_numbers(found.others, first->others, state);
  }
  e.note_same(first->forces, forces, state);
  return true;
}

bool number_types(ForceUnderTest& e, const State& state) {
  return compare_with_exact(e, e.twin(), state);
}

/// Nothing of a force that is the same everywhere, and may be exact, or on rigid and prescribed
/// bodies, whose sums round in any case.
bool shows_digits(ForceUnderTest& e) {
  if (e.exact() == nullptr) return false;
  bool changes = false;
  for (const State& state : e.near()) {
    if (e.terms(state).size > 0.0) return false;
    changes = changes || e.sensitivity(state) > 0.0;
  }
  return changes;
}

bool digits(ForceUnderTest& e, const State& state) {
  return e.note_shown(std::isfinite(e.sensitivity(state)) && rounds(e, e.twin(), state), state);
}

}  // namespace tomlin::properties
