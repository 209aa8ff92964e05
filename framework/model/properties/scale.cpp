#include "framework/model/properties/scale.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "framework/model/properties/force_under_test.hpp"

namespace tomlin::properties {
namespace {

/// Ratio of steps that follow one another, from where a wave cannot be missed.
constexpr double kStepRatio = 4.0;
/// Parts of the largest force that its fourth difference may be while it is as good as cubic: a
/// sine's is there at 1/200 of a wave.
constexpr double kMostFourthDifferenceOfCubic = 1e-6;
constexpr double kStepsOfAWave = 200.0;
/// Steps that are looked at, in parts of the numbers that positions are made of.
constexpr double kShortest = 1e-12;
constexpr double kLongest = 1e12;
/// The shortest of all where everything starts at 0, in any units.
constexpr double kShortestOfAll = 1e-25;
/// A declared length is good unless the force has one so many times shorter.
constexpr double kMuchShorter = 10.0;
constexpr double kLeastPartOfDeclared = 1e-8;
constexpr int kDirections = 4;
/// When forces are looked at that time may switch on and off, in parts of the duration.
constexpr double kPartOfDuration = 0.37;

/// A force along ways away from its start.
class Probe {
 public:
  explicit Probe(SingleForce& alone)
      : alone_(alone), time_(kPartOfDuration * alone.model().scene().run.duration) {
    alone.restart();
    for (const SingleForce::Variable& variable : alone.variables()) {
      start_.push_back(alone.position(variable));
      if (variable.axis >= 0) reach_ = std::max(reach_, std::abs(start_.back()));
    }
  }

  double reach() const { return reach_; }

  /// Both ways along every coordinate, none of them short.
  void turn(Random& random) {
    way_.clear();
    for (const SingleForce::Variable& variable : alone_.variables()) {
      const double part = random.symmetric();
      way_.push_back(variable.unit * (part < 0.0 ? part - 1.0 : part + 1.0) * 0.5);
    }
  }

  /// Not at the start itself, where a force may be odd or have a kink.
  bool is_bent(double step) const {
    constexpr double kWeight[] = {1.0, -4.0, 6.0, -4.0, 1.0};
    double fourth = 0.0;
    double size = 0.0;
    double least = std::numeric_limits<double>::infinity();
    double most = -least;
    for (int k = 0; k < 5; ++k) {
      const double along = force_at((k + 1) * step, size);
      fourth += kWeight[k] * along;
      least = std::min(least, along);
      most = std::max(most, along);
    }
    // Positions are rounded, and the force follows.
    const double rounding = kRounding * (size + (most - least) * reach_ / step);
    return !(std::abs(fourth) <= kMostFourthDifferenceOfCubic * size + 16.0 * rounding);
  }

  std::optional<double> first_bent(double shortest, double longest) const {
    if (is_bent(shortest)) return std::nullopt;
    for (double step = shortest; step <= longest; step *= kStepRatio) {
      if (is_bent(step)) return step;
    }
    return std::nullopt;
  }

 private:
  /// Along the way; the largest effort so far in `size`.
  double force_at(double by, double& size) const {
    for (std::size_t i = 0; i < start_.size(); ++i) {
      alone_.position(alone_.variables()[i]) = start_[i] + by * way_[i];
    }
    const double* forces = alone_.forces(time_);
    double sum = 0.0;
    double effort = 0.0;
    for (std::size_t i = 0; i < start_.size(); ++i) {
      const double part = forces[alone_.variables()[i].at] * way_[i];
      sum += part;
      effort += std::abs(part);
    }
    size = std::max(size, effort);
    return sum;
  }

  SingleForce& alone_;
  double time_;
  double reach_ = 0.0;
  std::vector<double> start_;
  std::vector<double> way_;
};

}  // namespace

/// The longest of those along some ways: near a kink or a pole one may be short by chance.
std::optional<double> length_of(SingleForce& alone, double declared) {
  Probe probe(alone);
  Random random(1);
  const double shortest = std::max(
      kShortest * probe.reach(), declared > 0.0 ? kLeastPartOfDeclared * declared : kShortestOfAll);
  const double longest = declared > 0.0 ? declared / (kMuchShorter * kStepsOfAWave)
                                        : kLongest * std::max(1.0, probe.reach());
  std::optional<double> length = 0.0;
  for (int k = 0; k < kDirections && length; ++k) {
    probe.turn(random);
    const std::optional<double> step = probe.first_bent(shortest, longest);
    length = step ? std::optional(std::max(*length, kStepsOfAWave * *step)) : std::nullopt;
  }
  alone.restart();
  return length;
}

}  // namespace tomlin::properties
