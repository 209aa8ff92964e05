#include <algorithm>
#include <cfenv>
#include <cmath>
#include <type_traits>

#include "framework/model/claims/force_under_test.hpp"

/// The same force on every instruction set and in every number type.
namespace tomlin::claims {
namespace {

/// Numbers that this type has exactly.
template <class Real>
State rounded(const State& state) {
  State rounded = state;
  const auto round = [](double& x) { x = static_cast<double>(static_cast<Real>(x)); };
  for (auto* numbers : {&rounded.x, &rounded.v, &rounded.own}) {
    for (double& x : *numbers) round(x);
  }
  round(rounded.time);
  return rounded;
}

template <class Real>
std::vector<double> forces_of(ForceUnderTest& e, const State& state, ForceTwin<Real>& twin) {
  e.put(state, twin);
  twin.evaluate(state.time);
  std::vector<double> forces(e.count());
  for (std::size_t i = 0; i < e.count(); ++i) {
    forces[i] = static_cast<double>(twin.force_at(e.variable(i).at));
  }
  return forces;
}

/// Whether numbers since the last call became too large or too small for their type. Floats do so
/// early, as in a twelfth power of some hundreds: that is their range, not the force's fault.
bool left_the_range() {
  constexpr int kRange = FE_OVERFLOW | FE_UNDERFLOW;
  const bool left = std::fetestexcept(kRange) != 0;
  std::feclearexcept(kRange);
  return left;
}

/// False where there are no numbers to compare.
template <class Real>
bool compare_with_exact(ForceUnderTest& e, ForceTwin<Real>& twin, const State& given) {
  constexpr double kEps = std::numeric_limits<Real>::epsilon();
  constexpr double kUnits = kRounding / std::numeric_limits<double>::epsilon() * kEps;
  constexpr double kLeast = std::numeric_limits<Real>::min() / kEps;
  const State state = rounded<Real>(given);
  const std::vector<double> due = forces_of(e, state, *e.exact());
  left_the_range();
  const std::vector<double> found = forces_of(e, state, twin);
  if (std::is_same_v<Real, float> && left_the_range()) return false;
  const double sensitivity = e.sensitivity(state);
  const double size = e.largest(due);
  // What has no number is looked at as such elsewhere.
  if (!std::isfinite(sensitivity) || !std::isfinite(e.largest(found))) return false;
  double unit = 1.0;
  for (std::size_t i = 0; i < e.count(); ++i) unit = std::max(unit, e.variable(i).unit);
  e.note(found, due, size, kUnits * (size + sensitivity) + kLeast * unit, state);
  return true;
}

}  // namespace

std::optional<ClaimResult> same_bits(ForceUnderTest& e) {
  e.begin("same bits", "on every instruction set of this machine");
  std::vector<std::unique_ptr<ForceTwin<double>>> twins;
  for (const InstructionSet set :
       {InstructionSet::baseline, InstructionSet::avx2, InstructionSet::avx512}) {
    if (is_supported(set)) twins.push_back(e.twin(set));
  }
  for (const State* state : e.everywhere()) {
    const std::vector<double> forces = e.forces(*state);
    for (const auto& twin : twins) e.note_same(forces_of(e, *state, *twin), forces, *state);
    e.looked();
  }
  return e.end();
}

std::optional<ClaimResult> number_types(ForceUnderTest& e) {
  if (e.exact() == nullptr) return std::nullopt;
  e.begin("number types", "the same in float, double and quadruple numbers, each to its rounding");
  const auto in_double = e.twin();
  left_the_range();
  const auto in_float = e.in_float();
  const bool looks_at_float = in_float != nullptr && !left_the_range();
  for (const State* state : e.everywhere()) {
    bool compared = compare_with_exact(e, *in_double, *state);
    const bool close = state->place == Place::near || state->place == Place::start;
    if (looks_at_float && close) {
      compared = compare_with_exact(e, *in_float, *state) || compared;
    }
    if (compared) e.looked();
  }
  return e.end();
}

}  // namespace tomlin::claims
