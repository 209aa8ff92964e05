#include <algorithm>
#include <cmath>

#include "framework/model/claims/slopes.hpp"

/// Forces against the slopes of their energies.
namespace tomlin::claims {
namespace {

/// In quadruple numbers, in parts of the shortest length: what two orders leave is below 1e-20 of
/// the slope even a millionth of a length apart, and so is what rounding to 1e-34 leaves.
constexpr double kTinyDifference = 1e-12;
/// Variables that are looked at one by one to find where a slope is wrong.
constexpr std::size_t kMostSearched = 2000;

/// The same in quadruple numbers, to all digits of a double.
template <class Function>
double exact_slope(Function&& f, double length) {
  const Quad h = Quad(kTinyDifference) * Quad(length);
  const Quad near = (f(h) - f(-h)) / (Quad(2.0) * h);
  const Quad far = (f(h + h) - f(-(h + h))) / (Quad(4.0) * h);
  return static_cast<double>((Quad(4.0) * near - far) / Quad(3.0));
}

/// What rounding makes of an energy's difference, and the effort along the way.
struct Scale {
  double rounding = 0.0;
  double effort = 0.0;
};

Scale scale_of(Examination& e, const State& state, const Direction& direction, double longest) {
  Scale scale;
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
    scale.rounding = std::max(scale.rounding, kRounding * (size + energy));
    scale.effort = std::max(scale.effort, sum);
  }
  return scale;
}

/// Differences of the energy along a direction against the force; shorter ones where there is a
/// kink or a wave within them. False where none are short enough: nothing was compared.
bool compare_by_differences(Examination& e, const State& state, const Direction& direction,
                            std::size_t variable) {
  bool regular = false;  // throughout, and yet no slope
  double slope_found = 0.0;
  double most = 0.0;
  for (const double part : kShorter) {
    const double longest = part * kLongestDifference * e.length();
    const bool first = part == kShorter[0];
    const bool smooth = is_regular(e, state, direction, direction, longest);
    regular = smooth && (first || regular);
    if (!smooth) continue;
    const Scale scale = scale_of(e, state, direction, longest);
    const Slope slope = slope_of(
        [&](double h) {
          e.put_moved(state, direction, h);
          return e.alone().energy(state.time);
        },
        longest);
    const double floor = scale.rounding / slope.shortest;
    slope_found = slope.best;
    most = scale.effort;
    if (!(slope.unsettled <= kSettled * most + floor)) continue;
    e.note(work(e.forces(state), direction), -slope.best, most, floor + kTrust * slope.unsettled,
           state, variable);
    return true;
  }
  // A force without kinks, of an energy with some.
  if (regular) e.note(work(e.forces(state), direction), -slope_found, most, -1.0, state, variable);
  return regular;
}

/// The energy in quadruple numbers, differentiated, against the force in double ones.
bool compare_exactly(Examination& e, const State& state, const Direction& direction,
                     const std::vector<double>& forces, double sensitivity, std::size_t variable) {
  ForceTwin<Quad>& twin = *e.exact();
  e.put(state);
  e.put(state, twin);
  const double slope = exact_slope(
      [&](const Quad& h) {
        for (std::size_t i = 0; i < e.count(); ++i) {
          twin.position(e.variable(i).at) = Quad(state.x[i]) + h * Quad(direction[i]);
        }
        twin.evaluate(state.time);
        return twin.energy();
      },
      e.length());
  double length = 0.0;  // of the direction
  for (std::size_t i = 0; i < e.count(); ++i) {
    length += std::abs(direction[i]) / e.variable(i).unit;
  }
  const double size = effort(forces, direction);
  const double energy = std::abs(e.alone().energy(state.time));
  const double allowed = kRounding * (size + sensitivity * length) + kSmallest * length +
                         kExactRounding * energy / (kTinyDifference * e.length());
  const double force = work(forces, direction);
  e.note(force, -slope, size, allowed, state, variable);
  return std::abs(force + slope) <= allowed;
}

}  // namespace

/// All coordinates at once, where a fault of any part shows, and one alone, where it shows best.
std::optional<ClaimResult> conservative(Examination& e) {
  if (!e.traits().conservative) return std::nullopt;
  e.begin("conservative", "force = -gradient of its energy, by differences");
  Random random(e.seed());
  for (const State& state : e.near()) {
    const bool together = compare_by_differences(e, state, e.random_direction(random), kNone);
    const std::size_t chosen = random.below(e.count());
    const bool alone = compare_by_differences(e, state, e.along(chosen), chosen);
    if (together || alone) e.looked();
  }
  return e.end();
}

std::optional<ClaimResult> exact(Examination& e) {
  if (!e.traits().conservative || e.exact() == nullptr) return std::nullopt;
  e.begin("exact", "force = -gradient of its energy, differentiated in quadruple numbers");
  Random random(e.seed());
  bool searched = false;
  for (const State* state : e.everywhere()) {
    const std::vector<double> forces = e.forces(*state);
    const double sensitivity = e.sensitivity(*state);
    const bool numbers = std::isfinite(e.largest(forces)) && std::isfinite(sensitivity);
    if (!numbers && state->place != Place::near && state->place != Place::start) continue;
    e.looked();
    const bool together =
        compare_exactly(e, *state, e.random_direction(random), forces, sensitivity, kNone);
    const std::size_t chosen = random.below(e.count());
    compare_exactly(e, *state, e.along(chosen), forces, sensitivity, chosen);
    if (together || searched) continue;
    searched = true;
    for (std::size_t i = 0; i < std::min(e.count(), kMostSearched); ++i) {
      compare_exactly(e, *state, e.along(i), forces, sensitivity, i);
    }
  }
  return e.end();
}

}  // namespace tomlin::claims
