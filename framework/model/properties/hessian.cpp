#include <algorithm>
#include <cmath>

#include "framework/model/properties/slopes.hpp"

/// Second derivatives against the slopes of the force.
namespace tomlin::properties {
namespace {

/// Second derivatives in parts of the largest force over the longest difference: one at most for a
/// wave, and some times that for terms of many partners that cancel.
constexpr double kMostResolvedCurvature = 100.0;
/// Differences of a slope that have settled to this part of it need not be shorter.
constexpr double kSettledEnough = 1e-6;

/// Second derivatives times a direction, along another: translations for bodies that move as one.
class CurvatureAlong : public HessianSink {
 public:
  CurvatureAlong(const ForceUnderTest& e, const Direction& one, const Direction& other,
                 const Model& model)
      : model_(model), one_(by_coordinate(e, one)), other_(by_coordinate(e, other)) {}

  void site(std::size_t body, std::size_t particle, int a, int b, double value) override {
    add(value * of(one_, body, particle, a), of(other_, body, particle, b));
  }
  void pair(std::size_t body1, std::size_t i, std::size_t body2, std::size_t j, int a, int b,
            double value) override {
    add(value * (of(one_, body2, j, a) - of(one_, body1, i, a)),
        of(other_, body2, j, b) - of(other_, body1, i, b));
  }
  void block(std::size_t body1, std::size_t i, int a, std::size_t body2, std::size_t j, int b,
             double value) override {
    add(value * of(one_, body1, i, a), of(other_, body2, j, b));
  }
  void centre(std::size_t body, const double* weight, int a, int b, double value) override {
    double one = 0.0;
    double other = 0.0;
    for (std::size_t i = 0; i < model_.bodies()[body].bound.slot.count; ++i) {
      one += weight[i] * of(one_, body, i, a);
      other += weight[i] * of(other_, body, i, b);
    }
    add(value * one, other);
  }

  double sum = 0.0;
  double size = 0.0;
  bool given = false;

 private:
  std::vector<double> by_coordinate(const ForceUnderTest& e, const Direction& direction) const {
    std::vector<double> moves(model_.system().view.dofs, 0.0);
    for (std::size_t i = 0; i < e.count(); ++i) moves[e.variable(i).at] = direction[i];
    return moves;
  }
  double of(const std::vector<double>& moves, std::size_t body, std::size_t particle,
            int axis) const {
    const BodySlot<double>& slot = model_.bodies()[body].bound.slot;
    if (slot.rigid) return moves[slot.centre + axis];
    return slot.mapped ? 0.0 : moves[slot.offset + axis * slot.stride + particle];
  }
  void add(double left, double right) {
    given = true;
    sum += left * right;
    size += std::abs(left * right);
  }

  const Model& model_;
  std::vector<double> one_, other_;
};

Direction translation(const ForceUnderTest& e, Random& random) {
  Direction direction = e.random_direction(random);
  for (std::size_t i = 0; i < e.count(); ++i) {
    if (e.variable(i).axis < 0) direction[i] = 0.0;
  }
  return direction;
}

/// A slope of the force by differences, and what it may be off.
struct SlopeOfForce {
  double value = 0.0;
  double size = 0.0;
  double allowed = 0.0;
};

/// By differences of one length; nothing where they have not settled.
std::optional<SlopeOfForce> slope_along(ForceUnderTest& e, const State& state,
                                        const Direction& along, const Direction& seen,
                                        const CurvatureAlong& curvature, double longest) {
  double most = 0.0;
  const Slope slope = slope_of(
      [&](double h) {
        State moved = state;
        for (std::size_t i = 0; i < e.count(); ++i) moved.x[i] += h * along[i];
        const std::vector<double> forces = e.forces(moved);
        most = std::max(most, effort(forces, seen));
        return work(forces, seen);
      },
      longest);
  const double rounding =
      kRounding * (most + e.sensitivity(state) * static_cast<double>(e.count())) / slope.shortest;
  const double size = curvature.size + std::abs(slope.best);
  // More than a force of this size can have within a difference: there are waves in it.
  if (curvature.size > kMostResolvedCurvature * most / longest) return {};
  if (!(slope.unsettled <= kSettled * size + rounding)) return {};
  // At a kink, as of one pair of many at its cutoff, the second derivative is that of either side.
  return SlopeOfForce{
      slope.best, size,
      kRounding * size + rounding + kErrorPerDifference * slope.unsettled + slope.kink};
}

/// Slopes of the force by differences against second derivatives. False where none settle, as at a
/// kink: nothing was compared.
bool compare_curvature(ForceUnderTest& e, const State& state, const Direction& along,
                       const Direction& seen, const CurvatureAlong& curvature) {
  std::optional<SlopeOfForce> best;
  for (const double part : kShorter) {
    const double longest = part * kLongestDifference * e.length();
    if (!is_regular(e, state, along, seen, longest)) continue;
    const auto slope = slope_along(e, state, along, seen, curvature, longest);
    if (slope && (!best || slope->allowed < best->allowed)) best = slope;
    if (best && best->allowed <= kSettledEnough * best->size) break;
  }
  if (!best) return false;
  e.note(curvature.sum, -best->value, best->size, best->allowed, state);
  return true;
}

}  // namespace

bool hessian(ForceUnderTest& e, const State& state) {
  ForceTwin<double>& twin = e.twin();
  const Direction along = translation(e, e.memory().random);
  const Direction seen = translation(e, e.memory().random);
  e.put(state, twin);
  twin.evaluate(state.time);
  CurvatureAlong curvature(e, seen, along, e.alone().model());
  twin.force().curvature->hessian(twin.stage(), curvature);
  if (!curvature.given) return e.withdraw();
  return compare_curvature(e, state, along, seen, curvature);
}

}  // namespace tomlin::properties
