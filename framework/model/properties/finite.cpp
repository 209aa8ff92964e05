#include <cfenv>
#include <cmath>

#include "framework/model/properties/force_under_test.hpp"

/// States in which a force must be a number.
namespace tomlin::properties {
/// Near the start there must be numbers. Far away, too, unless they, or numbers on the way to them,
/// are too large to be written; another NaN there must be a NaN in quadruple precision as well (the
/// logarithm of a negative number). Where particles touch no number is as good as one, since a run
/// stops there, but not where quadruple precision says that there is one.
std::optional<PropertyResult> finite(ForceUnderTest& e) {
  e.begin("finite", "forces and energies are numbers, near, far, high and touching");
  for (const State* state : e.everywhere()) {
    std::feclearexcept(FE_OVERFLOW);
    const std::vector<double> forces = e.forces(*state);
    const double energy = e.alone().energy(state->time);
    const bool overflowed = std::fetestexcept(FE_OVERFLOW) != 0;
    e.count_state();
    std::size_t lost = kNone;
    for (std::size_t i = e.count(); i-- > 0;) {
      if (!std::isfinite(forces[i])) lost = i;
    }
    const bool close = state->kind == StateKind::near || state->kind == StateKind::start;
    const bool numbers = lost == kNone && std::isfinite(energy);
    if (numbers || (overflowed && state->kind != StateKind::contact && !close)) {
      e.note(0.0, 0.0, 0.0, 0.0, *state);
      continue;
    }
    const double found = lost == kNone ? energy : forces[lost];
    double expected = 0.0;  // what it says where it can be told
    bool broken =
        close || (std::isnan(found) && state->kind != StateKind::contact) ||
        (lost != kNone && std::isnan(found) && std::isfinite(energy) && e.traits().conservative);
    if (ForceTwin<Quad>* twin = e.exact(); !close && twin != nullptr) {
      e.put(*state, *twin);
      twin->evaluate(state->time);
      expected =
          static_cast<double>(lost == kNone ? twin->energy() : twin->force_at(e.variable(lost).at));
      constexpr double kNearOverflow = 1e150;  // squares of it are too large
      broken = std::abs(expected) < kNearOverflow;
    }
    if (broken) {
      e.note(found, expected, std::abs(expected), -1.0, *state, lost);
    } else {
      e.note(0.0, 0.0, 0.0, 0.0, *state);
    }
  }
  return e.end();
}

}  // namespace tomlin::properties
