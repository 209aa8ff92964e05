#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <boost/numeric/odeint.hpp>
#include <gtest/gtest.h>

#include "tests/support/scenes.hpp"

// Someone else's integrators on someone else's sine: Boost.Odeint on the Prandtl-Tomlinson
// particle.

namespace tomlin::test {
namespace {

namespace odeint = boost::numeric::odeint;
using State = std::array<double, 2>;

constexpr double kTau = 6.283185307179586;

/// m = 1, k = 2, V = 0.25, c = 1, amplitude 0.1, period 1.
void tip(const State& s, State& derivative, double t) {
  derivative[0] = s[1];
  derivative[1] = 2.0 * (0.1 + 0.25 * t - s[0]) - 1.0 * s[1] + 0.1 * kTau * std::sin(kTau * s[0]);
}

const char* const kTip = R"([[body]]
name = "tip"
type = "point"
position = [0.1]
particle_mass = 1.0
[[force]]
type = "driving_spring"
stiffness = 2.0
velocity = [0.25]
[[force]]
type = "viscous_damping"
coefficient = 1.0
[[force]]
type = "sinusoidal_substrate"
amplitude = 0.1
period = 1.0
[run]
duration = 40.0
integrator = )";

TEST(Odeint, Rk4AgreesStepByStep) {
  constexpr double kRounding = 1e-13;  // two ways of rounding, 4000 damped steps
  constexpr double kStep = 0.01;
  Engine engine(scene_of(kTip + fixed_step(kStep)), {});
  odeint::runge_kutta4<State> stepper;
  State s = {0.1, 0.0};
  for (int n = 0; n < 4000; ++n) {
    engine.advance(1);
    stepper.do_step(tip, s, n * kStep, kStep);
    const double cells = static_cast<double>(engine.state().integers("origin_cells")[0]);
    ASSERT_NEAR(engine.state().reals("position")[0] + cells, s[0], kRounding) << "step " << n;
    ASSERT_NEAR(engine.state().reals("velocity")[0], s[1], kRounding) << "step " << n;
  }
  EXPECT_GT(s[0], 5.0) << "the tip has crossed periods";
}

TEST(Odeint, Dopri5StepsAgree) {
  // Fixed steps of the same tableau: rounding only, which the start of a slip magnifies.
  constexpr double kRounding = 1e-12;
  constexpr double kStep = 0.03125;
  Engine engine(scene_of(kTip + adaptive_held_to(kStep)), {});
  odeint::runge_kutta_dopri5<State> stepper;
  State s = {0.1, 0.0};
  for (int n = 0; n < 1280; ++n) {
    engine.advance(1);
    stepper.do_step(tip, s, n * kStep, kStep);
    const double cells = static_cast<double>(engine.state().integers("origin_cells")[0]);
    ASSERT_NEAR(engine.state().reals("position")[0] + cells, s[0], kRounding) << "step " << n;
    ASSERT_NEAR(engine.state().reals("velocity")[0], s[1], kRounding) << "step " << n;
  }
}

TEST(Odeint, Dopri5TrajectoriesAgreeWithinTolerance) {
  for (const double tolerance : {1e-6, 1e-9, 1e-12}) {
    KeptSamples kept;
    RunOptions options;
    options.sink = &kept;
    run(scene_of(kTip + adaptive(tolerance) + "\n[output]\nevery = 0.5\n"), options);
    ASSERT_EQ(kept.rows.size(), 81u);
    State s = {0.1, 0.0};
    auto stepper =
        odeint::make_controlled(tolerance, tolerance, odeint::runge_kutta_dopri5<State>());
    // Slips are steep but damped: errors of steps do not pile up beyond some hundred tolerances.
    const double allowed = 300.0 * tolerance;
    for (std::size_t k = 1; k < kept.rows.size(); ++k) {
      odeint::integrate_adaptive(stepper, tip, s, 0.5 * (k - 1), 0.5 * k, 0.01);
      EXPECT_NEAR(kept.rows[k][kept.column("tip.centre_of_mass.x")], s[0], allowed) << tolerance;
      EXPECT_NEAR(kept.rows[k][kept.column("tip.velocity.x")], s[1], allowed) << tolerance;
    }
  }
}

}  // namespace
}  // namespace tomlin::test
