#include <algorithm>
#include <cmath>
#include <complex>
#include <string>

#include <gtest/gtest.h>

#include "framework/core/records/integrator.hpp"
#include "tests/support/oscillator.hpp"

// Friction from a thousandth of what stops a motion within a step to a thousand times that, under
// every scheme: speed, position, heat and work against closed forms. A refusal or a warning is
// right only where the scheme is unstable or known to drag too easily, by its own growth factor.

namespace tomlin::test {
namespace {

constexpr double kStep = 0.05;
/// The error of schemes of second order with steps of 0.05/omega, and of rounding.
constexpr double kStepError = 5e-3;
constexpr double kTolerance = 1e-9;  ///< of adaptive schemes

/// Friction's heat over the run, from the energy balance of the closed form.
double heat_of(const Oscillator& o) {
  const State end = o.at(o.duration);
  const double stored = [&](double t, const State& s) {
    const double stretch = o.pull * t - s.x;
    return 0.5 * o.k * stretch * stretch + 0.5 * o.m * s.v * s.v;
  }(o.duration, end) - (0.5 * o.k * o.x0 * o.x0 + 0.5 * o.m * o.v0 * o.v0);
  return o.pull * o.mean_force() * o.duration - stored;
}

/// Largest of the errors in units of what the motion has of each; or why there is no number.
struct Outcome {
  double error = 0.0;
  std::string said;
};

Outcome outcome(const Oscillator& o, const IntegratorRecord& scheme) {
  const std::string text =
      o.scene(scheme.adaptive ? adaptive(kTolerance, scheme.name) : held_to(scheme.name, kStep),
              "ledger = true\n[measure]\nfrom = 0.0\n");
  Outcome outcome;
  outcome.said = refusal(text);
  if (!outcome.said.empty()) return outcome;
  const RunResult result = run_text(text);
  if (result.failure) outcome.said = result.failure->what;
  for (const Warning& warning : result.warnings) {
    // Warnings of windows and the like do not concern friction.
    if (warning.code == FaultCode::integrator_weak_drag) outcome.said = warning.text;
  }
  if (!outcome.said.empty()) return outcome;
  const State exact = o.at(o.duration);
  const double drawn = std::abs(o.x0) * std::min(std::sqrt(o.k / o.m), o.k / o.c);
  const double speed = std::max({std::abs(o.v0), std::abs(o.pull), drawn});
  const double length = std::max(std::abs(exact.x - o.x0), speed * o.m / o.c);
  const double heat = heat_of(o);
  const auto add = [&](double found, double expected, double scale) {
    outcome.error = std::max(outcome.error, std::abs(found - expected) / scale);
  };
  add(result.body(0)["centre_of_mass"][0], exact.x, length);
  add(result.body(0)["velocity"][0], exact.v, speed);
  add(*result.group("energy")["heat_out"], heat, heat);
  if (o.pull > 0.0) {
    add(*result.driver(0)["work"], o.pull * o.mean_force() * o.duration,
        o.pull * o.mean_force() * o.duration);
  }
  return outcome;
}

/// Whether a scheme has a reason to refuse a step or to warn of it.
enum class Reason { none, perhaps, surely };

/// Bounds of eigenvalues, from which the program finds the stable step, exceed them by less.
constexpr double kLooseBound = 2.0;
/// Part of the force by which steady drag may be wrong without a word.
constexpr double kSmallDragError = 0.01;

Reason reason(const Oscillator& o, const IntegratorRecord& scheme) {
  if (scheme.conservative_only || !scheme.with_inertia) return Reason::surely;
  if (scheme.adaptive) return Reason::none;
  const double rate = o.c / o.m;
  const auto is_unstable = [&](double step) {
    if (scheme.stable_step != nullptr) {
      return step > scheme.stable_step(std::sqrt(o.k / o.m), rate);
    }
    if (scheme.growth == nullptr) return false;
    const std::complex<double> root =
        std::sqrt(std::complex<double>(0.25 * rate * rate - o.k / o.m));
    constexpr double kRounding = 1e-9;
    return std::max(scheme.growth(step * (-0.5 * rate + root)),
                    scheme.growth(step * (-0.5 * rate - root))) > 1.0 + kRounding;
  };
  const double wrong = scheme.drag_error == nullptr ? 0.0 : scheme.drag_error(rate * kStep);
  if (is_unstable(kStep) || wrong > kLooseBound * kSmallDragError) return Reason::surely;
  return is_unstable(kLooseBound * kStep) || wrong > kSmallDragError ? Reason::perhaps
                                                                     : Reason::none;
}

void expect_right_or_refused(const Oscillator& o, const IntegratorRecord& scheme) {
  const Outcome found = outcome(o, scheme);
  const double damped = o.c / o.m * kStep;
  const Reason why = reason(o, scheme);
  if (found.said.empty()) {
    EXPECT_NE(why, Reason::surely) << "step * rate = " << damped;
  } else {
    EXPECT_NE(why, Reason::none) << "step * rate = " << damped << ": " << found.said;
    return;
  }
  // Friction as an exact flow has no error; elsewhere it has that of the scheme's order.
  const bool exact = scheme.splits_friction && scheme.drag_error == nullptr;
  const double of_friction = exact ? 0.0 : 0.5 * std::pow(std::min(damped, 1.0), scheme.order);
  EXPECT_LE(found.error, kStepError + of_friction) << "step * rate = " << damped;
}

template <class Scene>
void for_every_scheme(const Scene& scene) {
  for (const auto& scheme : standard().integrators()) {
    // That of Gronbech-Jensen and Farago moves exactly as far, and stops by turning round in every
    // step: langevin_scheme_test.cpp.
    if (scheme->follows_equilibria || scheme->name == "gjf") continue;
    SCOPED_TRACE(scheme->name);
    for (int k = -6; k <= 6; ++k) {
      expect_right_or_refused(scene(std::pow(10.0, 0.5 * k)), *scheme);
    }
  }
}

Oscillator damped_by(double damped) {
  Oscillator o;
  o.m = 1.0;
  o.k = 1.0;
  o.c = damped / kStep;
  o.duration = 10.0;
  return o;
}

TEST(FrictionRange, ParticlesCoastToAStop) {
  for_every_scheme([](double damped) {
    Oscillator o = damped_by(damped);
    o.k = o.pull = 0.0;
    o.v0 = 1.0;
    return o;
  });
}

TEST(FrictionRange, SpringsComeToRest) {
  for_every_scheme([](double damped) {
    Oscillator o = damped_by(damped);
    o.pull = 0.0;
    o.x0 = 0.7;
    o.v0 = 0.0;
    return o;
  });
}

TEST(FrictionRange, SteadyDragStaysSteady) {
  for_every_scheme([](double damped) {
    Oscillator o = damped_by(damped);
    o.v0 = o.pull;
    o.x0 = -o.c * o.pull / o.k;
    return o;
  });
}

TEST(FrictionRange, DragFromRest) {
  for_every_scheme([](double damped) {
    Oscillator o = damped_by(damped);
    o.x0 = o.v0 = 0.0;
    return o;
  });
}

/// Under friction that no scheme minds, none has a reason; beyond their limits those have that have
/// one.
TEST(FrictionRange, ReasonsAreThoseOfTheScheme) {
  for (const auto& scheme : standard().integrators()) {
    if (scheme->follows_equilibria || scheme->conservative_only || !scheme->with_inertia) continue;
    EXPECT_EQ(reason(damped_by(1e-3), *scheme), Reason::none) << scheme->name;
  }
  for (const char* limited : {"rk4", "velocity_verlet"}) {
    EXPECT_EQ(reason(damped_by(1e3), *standard().integrator(limited)), Reason::surely) << limited;
  }
}

/// Schemes that nothing limits take the whole range.
TEST(FrictionRange, IsNotRefusedWhereFrictionIsExact) {
  for (const double damped : {1e-3, 1.0, 1e3}) {
    const Outcome found = outcome(damped_by(damped), *standard().integrator("exponential_verlet"));
    EXPECT_EQ(found.said, "") << damped;
  }
  EXPECT_NE(outcome(damped_by(1e3), *standard().integrator("velocity_verlet")).said, "");
}

}  // namespace
}  // namespace tomlin::test
