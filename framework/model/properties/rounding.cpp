#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "framework/model/properties/force_under_test.hpp"

/// Effect of the rounding of inputs on a force: measured, by small changes of all that it reads.
namespace tomlin::properties {
namespace {

/// Relative perturbations of inputs: one that results follow linearly, mostly; one that they follow
/// linearly to 10^-4 where they follow the first to kMostNonlinearity; and one as small as
/// rounding.
constexpr double kPerturbation = 1e-9;
constexpr double kSmallPerturbation = 1e-12;
constexpr double kRoundingPerturbation = 1e-15;
/// Parts of a change by which it may differ from a linear one.
constexpr double kMostNonlinearity = 0.1;
/// Distinguishes the seeds of perturbations from those of states.
constexpr std::uint64_t kPerturbationSeed = 0x9e3779b97f4a7c15U;
/// All are small by chance once in 10^4 states, and the allowance is 64-fold.
constexpr int kPerturbations = 3;

}  // namespace

/// All that a force reads, by parts of its size.
State ForceUnderTest::perturbed(const State& state, double perturbation, Random& random) const {
  const double size = reach(state);
  State perturbed = state;
  for (std::size_t i = 0; i < count(); ++i) {
    perturbed.x[i] += perturbation * (variable(i).axis >= 0 ? size : 1.0) * random.symmetric();
    perturbed.v[i] *= 1.0 + perturbation * random.symmetric();
  }
  for (double& own : perturbed.own) own *= 1.0 + perturbation * random.symmetric();
  perturbed.time *= 1.0 + perturbation * random.symmetric();
  return perturbed;
}

/// The largest force's change under a perturbation, and by how much more than half of it the half
/// makes.
ForceUnderTest::Change ForceUnderTest::change_by(const State& state, double perturbation) {
  const std::vector<double> before = forces(state);
  Change most;
  for (int k = 0; k < kPerturbations; ++k) {
    Random random(options_.seed ^ (kPerturbationSeed + static_cast<std::uint64_t>(k)));
    Random again = random;
    const std::vector<double> half = forces(perturbed(state, 0.5 * perturbation, random));
    std::vector<double> change = forces(perturbed(state, perturbation, again));
    std::vector<double> nonlinearity(count());
    for (std::size_t i = 0; i < count(); ++i) {
      change[i] -= before[i];
      nonlinearity[i] = change[i] - 2.0 * (half[i] - before[i]);
    }
    const double size = largest(change);
    const double nonlinear = largest(nonlinearity);
    most.linear =
        most.linear && nonlinear <= kMostNonlinearity * size + kRounding * largest(before);
    if (!(size <= most.size)) most.size = size;
    if (!(nonlinear <= most.nonlinearity)) most.nonlinearity = nonlinear;
    if (!std::isfinite(size) || !std::isfinite(nonlinear)) break;
  }
  return most;
}

/// Change of the largest force in quadruple precision, whose own rounding does not show in it.
double ForceUnderTest::exact_change(const State& state, double perturbation) {
  ForceTwin<Quad>& twin = *exact();
  const auto forces_at = [&](const State& from, Random* random) {
    const double size = perturbation * reach(from);
    put(from, twin);
    double elapsed = 0.0;
    if (random != nullptr) {
      for (std::size_t i = 0; i < count(); ++i) {
        const double move = (variable(i).axis >= 0 ? size : perturbation) * random->symmetric();
        twin.position(variable(i).at) = Quad(from.x[i]) + Quad(move);
        twin.velocity(variable(i).at) =
            Quad(from.v[i]) + Quad(from.v[i] * (perturbation * random->symmetric()));
      }
      for (std::size_t k = 0; k < from.own.size(); ++k) {
        twin.own(k) = Quad(from.own[k]) + Quad(from.own[k] * (perturbation * random->symmetric()));
      }
      elapsed = from.time * perturbation * random->symmetric();
    }
    twin.evaluate(from.time, elapsed);
    std::vector<Quad> forces(count());
    for (std::size_t i = 0; i < count(); ++i) forces[i] = twin.force_at(variable(i).at);
    return forces;
  };
  const std::vector<Quad> before = forces_at(state, nullptr);
  double most = 0.0;
  for (int k = 0; k < kPerturbations; ++k) {
    Random random(options_.seed ^ (kPerturbationSeed + static_cast<std::uint64_t>(k)));
    const std::vector<Quad> after = forces_at(state, &random);
    std::vector<double> change(count());
    for (std::size_t i = 0; i < count(); ++i) change[i] = static_cast<double>(after[i] - before[i]);
    const double size = largest(change);
    if (!std::isfinite(size)) return std::numeric_limits<double>::infinity();
    most = std::max(most, size / perturbation);
  }
  return most;
}

ForceUnderTest::Terms ForceUnderTest::terms(const State& state) {
  if (by_terms_ == nullptr) return {};
  ForceTwin<double>& twin = *by_terms_;
  const SystemView<double>& view = twin.view();
  put(state, twin);
  twin.evaluate(state.time);
  const auto position_of = [&](const Hidden& hidden, std::size_t at) -> double& {
    return hidden.mapped ? view.mapped_position[at] : twin.position(at);
  };
  const auto force_of = [&](const Hidden& hidden, std::size_t at) -> double& {
    return (hidden.mapped ? view.mapped_force : view.force)[at];
  };
  const auto all = [&](auto&& use) {
    for (const Hidden& hidden : hidden_) {
      for (const std::size_t at : hidden.at) use(hidden, at);
    }
  };
  // The force's own kernels are run; the sums that they leave to others are not counted.
  const auto acting = [&] {
    all([&](const Hidden& hidden, std::size_t at) { force_of(hidden, at) = 0.0; });
    for (const Pass<double>& pass : passes_) {
      (pass.add != nullptr ? pass.add : pass.set)(pass.arguments, twin.stage());
    }
    std::vector<double> forces;
    all([&](const Hidden& hidden, std::size_t at) { forces.push_back(force_of(hidden, at)); });
    return forces;
  };
  const std::vector<double> before = acting();
  const double heat_before = twin.heat().value_or(0.0);
  Terms terms{gathered(before), 0.0, 0.0, 0.0};
  std::vector<double> positions;  // no evaluation computes those of what does not move again
  all([&](const Hidden& hidden, std::size_t at) {
    positions.push_back(position_of(hidden, at));
    if (alone_.model().bodies()[hidden.body].prescribed())
      terms.speed = std::max(terms.speed, std::abs(view.mapped_velocity[at]));
  });
  const double perturbation = kPerturbation * reach(state);
  for (int again = 0; again < kPerturbations; ++again) {
    Random random(options_.seed ^ (kPerturbationSeed + static_cast<std::uint64_t>(again)));
    all([&, k = std::size_t{0}](const Hidden& hidden, std::size_t at) mutable {
      position_of(hidden, at) = positions[k++] + perturbation * random.symmetric();
    });
    std::vector<double> change = acting();
    for (std::size_t k = 0; k < change.size(); ++k) change[k] -= before[k];
    terms.change = std::max(terms.change, gathered(change) / kPerturbation);
    const double heat = twin.heat().value_or(0.0);
    terms.heat = std::max(terms.heat, std::abs(heat - heat_before) / kPerturbation);
  }
  all([&, k = std::size_t{0}](const Hidden& hidden, std::size_t at) mutable {
    position_of(hidden, at) = positions[k++];
  });
  return terms;
}

/// The largest of the axes and rotations of bodies, to which particles add up, but for those of
/// fixed bodies, of which nothing is a sum; forces come in the order of the hidden ones.
double ForceUnderTest::gathered(const std::vector<double>& hidden_forces) const {
  double most = 0.0;
  std::size_t next = 0;
  std::map<std::size_t, double> torques;
  for (const Hidden& hidden : hidden_) {
    const Model::Body& body = alone_.model().bodies()[hidden.body];
    std::vector<double> levers;
    for (const std::array<double, 3>& arm : body.arms) {
      levers.push_back(std::hypot(arm[0], arm[1], arm[2]));
    }
    const double farthest = levers.empty() ? 0.0 : *std::max_element(levers.begin(), levers.end());
    double sum = 0.0;
    double largest = 0.0;
    for (std::size_t i = 0; i < hidden.at.size(); ++i) {
      const double size = std::abs(hidden_forces[next++]);
      sum += size;
      largest = std::max(largest, size);
      if (hidden.mapped && body.bound.slot.rigid && farthest > 0.0)
        torques[hidden.body] += size * (levers[i] / farthest);
    }
    const BodySlot<double>& slot = body.bound.slot;
    const bool is_fixed = slot.mapped && !slot.rigid && !body.prescribed();
    most = std::max(most, is_fixed ? largest : sum);
  }
  for (const auto& [body, torque] : torques) most = std::max(most, torque);
  return most;
}

double ForceUnderTest::change_of(const State& state,
                                 const std::function<double(const State&)>& number) {
  return changes_of(state, [&](const State& at) { return std::vector{number(at)}; }).front();
}

std::vector<double> ForceUnderTest::changes_of(
    const State& state, const std::function<std::vector<double>(const State&)>& numbers) {
  const std::vector<double> before = numbers(state);
  std::vector<double> most(before.size(), 0.0);
  for (const double perturbation : {kPerturbation, kSmallPerturbation, kRoundingPerturbation}) {
    for (int k = 0; k < kPerturbations; ++k) {
      Random random(options_.seed ^ (kPerturbationSeed + static_cast<std::uint64_t>(k)));
      const std::vector<double> after = numbers(perturbed(state, perturbation, random));
      for (std::size_t i = 0; i < most.size(); ++i) {
        const double change = std::abs(after[i] - before[i]) / perturbation;
        most[i] = std::isfinite(change) ? std::max(most[i], change)
                                        : std::numeric_limits<double>::infinity();
      }
    }
  }
  return most;
}

double ForceUnderTest::sensitivity(const State& state) {
  const auto among = [&](const std::vector<State>& states) {
    return std::any_of(states.begin(), states.end(),
                       [&](const State& known) { return &known == &state; });
  };
  if (!among(near_) && !among(extreme_)) return sensitivity_at(state);
  const auto [at, fresh] = sensitivities_.try_emplace(&state, 0.0);
  if (fresh) at->second = sensitivity_at(state);
  return at->second;
}

/// A formula whose terms nearly cancel loses more digits within than its inputs explain: that is
/// noise, which a perturbation as small as rounding shows.
double ForceUnderTest::sensitivity_at(const State& state) {
  const Change change = change_by(state, kPerturbation);
  const Change small = change_by(state, kSmallPerturbation);
  const Change tiny = change_by(state, kRoundingPerturbation);
  double most = tiny.size / kRoundingPerturbation;
  if (change.linear) {
    most =
        std::max({most, change.size / kPerturbation, small.nonlinearity / kRoundingPerturbation});
  } else if (exact() != nullptr) {
    const double noise =
        std::abs(small.size - kSmallPerturbation * exact_change(state, kSmallPerturbation));
    most =
        std::max({most, exact_change(state, kRoundingPerturbation), noise / kRoundingPerturbation});
  } else {
    most = std::max({most, change.size / kPerturbation, small.size / kSmallPerturbation});
  }
  const bool numbers = std::isfinite(change.size) && std::isfinite(small.nonlinearity) &&
                       std::isfinite(tiny.size) && std::isfinite(most);
  const Terms single = terms(state);
  most += single.size + single.change;
  return numbers && std::isfinite(most) ? most : std::numeric_limits<double>::infinity();
}

}  // namespace tomlin::properties
