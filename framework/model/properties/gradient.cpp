#include <algorithm>
#include <cmath>

#include "framework/model/properties/slopes.hpp"

/// Forces against the slopes of their energies.
namespace tomlin::properties {
namespace {

/// Variables that are looked at one by one to find where a slope is wrong.
constexpr std::size_t kMostSearched = 2000;

/// Parts of the longest difference that are tried besides where two particles almost touch.
constexpr double kDifferencesAtContact[] = {1e-5, 1e-6};

/// Rounding of an energy's difference, and the effort along the displacement.
struct Scale {
  double rounding = 0.0;
  double effort = 0.0;
};

Scale scale_of(ForceUnderTest& e, const State& state, const Direction& direction, double longest) {
  Scale scale;
  const double terms = e.terms(state).size * e.reach(state);
  e.put(state);
  for (const double h : {longest, -longest}) {
    e.put_moved(state, direction, h);
    const double* force = e.alone().forces(state.time);
    double size = 0.0;
    double sum = 0.0;
    for (std::size_t i = 0; i < e.count(); ++i) {
      const double f = std::abs(force[e.variable(i).at]);
      size += f * (std::abs(state.x[i]) + e.length() * e.variable(i).unit);
      sum += f * std::abs(direction[i]);
    }
    const double energy = std::abs(e.alone().energy(state.time));
    scale.rounding = std::max(scale.rounding, kRounding * (size + terms + energy));
    scale.effort = std::max(scale.effort, sum);
  }
  return scale;
}

std::vector<double> parts_at(const State& state) {
  std::vector<double> parts(std::begin(kShorter), std::end(kShorter));
  if (state.kind == StateKind::contact) {
    parts.insert(parts.end(), std::begin(kDifferencesAtContact), std::end(kDifferencesAtContact));
  }
  return parts;
}

/// Differences of the energy along a direction against the force; shorter ones where there is a
/// kink or a wave within them. False where none are short enough: nothing was compared.
bool compare_by_differences(ForceUnderTest& e, const State& state, const Direction& direction,
                            std::size_t variable) {
  const auto energy_at = [&](const State& at) {
    e.put(at);
    return e.alone().energy(at.time);
  };
  const double energy_noise = kRounding * e.change_of(state, energy_at);
  const double noise = kRounding * e.sensitivity(state) * length_of(e, direction);
  bool regular = false;  // throughout, and yet no slope
  double slope_found = 0.0;
  double most = 0.0;
  for (const double part : parts_at(state)) {
    const double longest = part * kLongestDifference * e.length();
    const bool first = part == kShorter[0];
    const bool smooth = is_regular(e, state, direction, direction, longest);
    regular = smooth && (first || regular);
    if (!smooth) continue;
    const Scale scale = scale_of(e, state, direction, longest);
    e.put(state);
    const Slope slope = slope_of(
        [&](double h) {
          e.put_moved(state, direction, h);
          return e.alone().energy(state.time);
        },
        longest);
    const double floor =
        (scale.rounding + energy_noise + kSmallest) / slope.shortest + noise + kSmallest;
    slope_found = slope.best;
    most = scale.effort;
    if (!(slope.unsettled <= kSettled * most + floor)) continue;
    e.note(work(e.forces(state), direction), -slope.best, most,
           floor + kErrorPerDifference * slope.unsettled, state, variable);
    return true;
  }
  // A force without kinks, of an energy with some.
  if (!regular || !state.is_close()) return false;
  e.note(work(e.forces(state), direction), -slope_found, most, -1.0, state, variable);
  return true;
}

/// The energy in quadruple precision, differentiated, against the force in double precision.
bool compare_exactly(ForceUnderTest& e, const State& state, const Direction& direction,
                     const std::vector<double>& forces, double sensitivity, std::size_t variable) {
  const ExactSlope difference = exact_slope(e, state, direction);
  const double slope = static_cast<double>(difference.best);
  const double length = length_of(e, direction);
  const double size = effort(forces, direction);
  e.put(state);
  const double energy = std::abs(e.alone().energy(state.time));
  const double allowed = kRounding * (size + sensitivity * length) + kSmallest * length +
                         kExactRounding * energy / (kTinyDifference * e.length()) +
                         kErrorPerDifference * difference.unsettled;
  const double force = work(forces, direction);
  e.note(force, -slope, size, allowed, state, variable);
  return std::abs(force + slope) <= allowed;
}

bool is_number(ForceUnderTest& e, const State& state) {
  const bool forces = std::isfinite(e.largest(e.forces(state)));
  return forces && std::isfinite(e.alone().energy(state.time)) &&
         std::isfinite(e.sensitivity(state));
}

}  // namespace

/// All coordinates at once, where a fault of any part shows, and one alone, where it shows best.
/// Far away and at contact, too, where there is no quadruple precision to look there.
bool conservative(ForceUnderTest& e, const State& state) {
  if (!state.is_close() && (e.exact() != nullptr || !is_number(e, state))) return false;
  Random& random = e.memory().random;
  const bool together = compare_by_differences(e, state, e.random_direction(random), kNone);
  const std::size_t chosen = random.below(e.count());
  const bool alone = compare_by_differences(e, state, e.along(chosen), chosen);
  return together || alone;
}

bool exact(ForceUnderTest& e, const State& state) {
  const std::vector<double> forces = e.forces(state);
  const double sensitivity = e.sensitivity(state);
  const bool numbers = std::isfinite(e.largest(forces)) && std::isfinite(sensitivity);
  if (!numbers && !state.is_close()) return false;
  Random& random = e.memory().random;
  const bool together =
      compare_exactly(e, state, e.random_direction(random), forces, sensitivity, kNone);
  const std::size_t chosen = random.below(e.count());
  compare_exactly(e, state, e.along(chosen), forces, sensitivity, chosen);
  if (together || e.memory().searched) return true;
  e.memory().searched = true;
  for (std::size_t i = 0; i < std::min(e.count(), kMostSearched); ++i) {
    compare_exactly(e, state, e.along(i), forces, sensitivity, i);
  }
  return true;
}

}  // namespace tomlin::properties
