#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "framework/model/properties/slopes.hpp"

/// The declared bound on curvatures, from which the stable step follows.
namespace tomlin::properties {
namespace {

/// By so much a bound may be passed: some are found by searching, and stable steps have a margin.
constexpr double kMostRelativeExcess = 0.05;
/// Random phases of a periodic force that are looked at besides each state.
constexpr int kPhases = 8;
/// A bound that is never half reached is no estimate: steps are half as long as they could be.
constexpr double kTightness = 0.5;
/// Squarings that settle the largest of eigenvalues, also where two are close.
constexpr int kPowerIterations = 100;

using Block = std::array<double, 9>;

/// Second derivatives in the position of each particle alone.
class Blocks : public HessianSink {
 public:
  explicit Blocks(const Model& model) {
    for (const Model::Body& body : model.bodies()) {
      of_particle.emplace_back(body.bound.slot.count, Block{});
    }
  }

  void site(std::size_t body, std::size_t particle, int a, int b, double value) override {
    given = true;
    of_particle[body][particle][3 * static_cast<std::size_t>(a) + static_cast<std::size_t>(b)] +=
        value;
  }
  void pair(std::size_t body1, std::size_t i, std::size_t body2, std::size_t j, int a, int b,
            double value) override {
    site(body1, i, a, b, value);
    site(body2, j, a, b, value);
  }
  void block(std::size_t, std::size_t, int, std::size_t, std::size_t, int, double) override {}
  void centre(std::size_t body, const double* weight, int a, int b, double value) override {
    for (std::size_t i = 0; i < of_particle[body].size(); ++i) {
      site(body, i, a, b, weight[i] * weight[i] * value);
    }
  }

  std::vector<std::vector<Block>> of_particle;
  bool given = false;
};

/// The largest size of an eigenvalue, by iteration from below.
double norm_of(const Block& block) {
  std::array<double, 3> u{0.6, 0.5, 0.4};
  double norm = 0.0;
  for (int pass = 0; pass < kPowerIterations; ++pass) {
    std::array<double, 3> w{};
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b < 3; ++b) w[a] += block[3 * a + b] * u[b];
    }
    const double size = std::hypot(w[0], w[1], w[2]);
    if (!(size > 0.0)) return size;
    norm = size / std::hypot(u[0], u[1], u[2]);
    for (std::size_t a = 0; a < 3; ++a) u[a] = w[a] / size;
  }
  return norm;
}

void note_bound(ForceUnderTest& e, double curvature, double bound, const State& state) {
  const double found = std::max(curvature, bound);
  e.note(std::isnan(curvature) ? curvature : found, bound, bound,
         kMostRelativeExcess * bound + kRounding * found + kSmallest, state);
}

/// Largest curvature of all particles, where a force gives second derivatives.
struct LargestCurvature {
  double most = 0.0;
  std::array<double, 3> along{};
};

std::optional<LargestCurvature> largest_curvature(ForceUnderTest& e, ForceTwin<double>& twin,
                                                  const State& state) {
  e.put(state, twin);
  twin.evaluate(state.time);
  Blocks blocks(e.alone().model());
  twin.force().curvature->hessian(twin.stage(), blocks);
  if (!blocks.given) return std::nullopt;
  const auto axes = static_cast<std::size_t>(e.alone().model().dimension());
  LargestCurvature largest;
  for (const auto& of_body : blocks.of_particle) {
    for (const Block& block : of_body) {
      largest.most = std::max(largest.most, norm_of(block));
      for (std::size_t d = 0; d < axes; ++d) {
        largest.along[d] = std::max(largest.along[d], std::abs(block[4 * d]));
      }
    }
  }
  return largest;
}

/// False where a force gives no second derivatives.
bool compare_blocks(ForceUnderTest& e, ForceTwin<double>& twin, const State& state) {
  const auto largest = largest_curvature(e, twin, state);
  if (!largest) return false;
  const Curvature<double>& curvature = *twin.force().curvature;
  note_bound(e, largest->most, curvature.curvature_bound(), state);
  for (int d = 0; d < e.alone().model().dimension(); ++d) {
    const double bound = curvature.curvature_bound_along(d);
    const double along = largest->along[static_cast<std::size_t>(d)];
    // In parts of the largest, of which the others are rounded.
    if (bound >= 0.0 && along > kRounding * largest->most) note_bound(e, along, bound, state);
  }
  return true;
}

/// Slopes of the force along a coordinate where it does not. False where none settles.
bool compare_slope(ForceUnderTest& e, const State& state, std::size_t i) {
  const Direction along = e.along(i);
  const double longest = kLongestDifference * e.length();
  if (e.variable(i).axis < 0 || !is_regular(e, state, along, along, longest)) return false;
  double most = 0.0;
  const Slope slope = slope_of(
      [&](double h) {
        State moved = state;
        moved.x[i] += h;
        const std::vector<double> forces = e.forces(moved);
        most = std::max(most, std::abs(forces[i]));
        return forces[i];
      },
      longest);
  const double rounding = kRounding * (most + e.sensitivity(state)) / slope.shortest;
  const double error = rounding + kErrorPerDifference * slope.unsettled;
  if (!(error <= kSettled * std::abs(slope.best))) return false;
  const auto& slot = e.alone().model().bodies()[e.variable(i).body].bound.slot;
  const double particles = slot.rigid ? static_cast<double>(slot.count) : 1.0;
  note_bound(e, std::abs(slope.best),
             particles * e.force().curvature->curvature_bound_along(e.variable(i).axis), state);
  return true;
}

int phases_of(ForceUnderTest& e) { return e.traits().periodic ? 1 + kPhases : 1; }

/// The state itself is the first phase; for others it is moved along every axis with a period by a
/// random part of it.
State in_phase(ForceUnderTest& e, const State& state, int phase) {
  State moved = state;
  const SceneForce& from = e.described();
  for (int axis = 0; phase > 0 && axis < 3; ++axis) {
    const double by =
        from.record->period(from.description.get(), axis) * e.memory().random.symmetric();
    for (std::size_t i = 0; i < e.count(); ++i) {
      if (e.variable(i).axis == axis) moved.x[i] += by;
    }
  }
  return moved;
}

}  // namespace

bool stiffness(ForceUnderTest& e, const State& state) {
  bool compared = false;
  for (int phase = 0; phase < phases_of(e); ++phase) {
    const State here = in_phase(e, state, phase);
    compared = compare_blocks(e, e.twin(), here) ||
               compare_slope(e, here, e.memory().random.below(e.count())) || compared;
  }
  return compared;
}

/// There is nothing to compare where a scene stays away from the largest curvature, as high above a
/// substrate that decays.
bool tight(ForceUnderTest& e, const State& state) {
  for (int phase = 0; phase < phases_of(e); ++phase) {
    const State here = in_phase(e, state, phase);
    const auto largest = largest_curvature(e, e.twin(), here);
    if (!largest) return e.withdraw();
    if (largest->most > kTightness * e.force().curvature->curvature_bound())
      return e.note_shown(true, here);
  }
  return false;
}

}  // namespace tomlin::properties
