#include <algorithm>
#include <cfenv>
#include <cmath>

#include "framework/model/properties/force_under_test.hpp"

/// States in which a force must be a number.
namespace tomlin::properties {
/// Near the start there must be numbers. Far away, too, unless they, or numbers on the way to them,
/// are too large to be written; another NaN there must be a NaN in quadruple precision as well (the
/// logarithm of a negative number). Where particles touch no number is as good as one, since a run
/// stops there, but not where quadruple precision says that there is one.
bool finite(ForceUnderTest& e, const State& state) {
  std::feclearexcept(FE_OVERFLOW);
  const std::vector<double> forces = e.forces(state);
  const double energy = e.alone().energy(state.time);
  const bool overflowed = std::fetestexcept(FE_OVERFLOW) != 0;
  const auto lost = static_cast<std::size_t>(
      std::find_if(forces.begin(), forces.end(), [](double f) { return !std::isfinite(f); }) -
      forces.begin());
  const bool forces_finite = lost == e.count();
  const bool contact = state.kind == StateKind::contact;
  const bool numbers = forces_finite && std::isfinite(energy);
  if (numbers || (overflowed && !contact && !state.is_close())) {
    return e.note_shown(true, state);
  }
  const double found = forces_finite ? energy : forces[lost];
  double expected = 0.0;  // in quadruple precision, where that is available
  bool broken =
      state.is_close() || (std::isnan(found) && !contact) ||
      (!forces_finite && std::isnan(found) && std::isfinite(energy) && e.traits().conservative);
  if (ForceTwin<Quad>* twin = e.exact(); !state.is_close() && twin != nullptr) {
    e.put(state, *twin);
    twin->evaluate(state.time);
    expected =
        static_cast<double>(forces_finite ? twin->energy() : twin->force_at(e.variable(lost).at));
    constexpr double kSquareOverflows = 1e150;
    broken = std::abs(expected) < kSquareOverflows;
  }
  if (!broken) return e.note_shown(true, state);
  e.note(found, expected, std::abs(expected), -1.0, state, forces_finite ? kNone : lost);
  return true;
}

}  // namespace tomlin::properties
