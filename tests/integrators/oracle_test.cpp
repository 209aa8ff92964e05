#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <boost/numeric/odeint.hpp>
#include <gtest/gtest.h>

#include "framework/core/numbers/constants.hpp"
#include "tests/support/scenes.hpp"

// Someone else's integrators on someone else's sine: Boost.Odeint on the Prandtl-Tomlinson
// particle.

namespace tomlin::test {
namespace {

namespace odeint = boost::numeric::odeint;
using State = std::array<double, 2>;

/// m = 1, k = 2, V = 0.25, c = 1, amplitude 0.1, period 1.
void tip(const State& s, State& derivative, double t) {
  derivative[0] = s[1];
  derivative[1] = 2.0 * (0.1 + 0.25 * t - s[0]) - 1.0 * s[1] + 0.1 * kTau * std::sin(kTau * s[0]);
}

const std::string kTip = tables(R"([[body]] | name = "tip" | type = "point" | position = [0.1]
particle_mass = 1.0
[[force]] | type = "driving_spring" | stiffness = 2.0 | velocity = [0.25]
[[force]] | type = "viscous_damping" | coefficient = 1.0
[[force]] | type = "sinusoidal_substrate" | amplitude = 0.1 | period = 1.0
[run] | duration = 40.0 | integrator = )");

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
    run(scene_of(kTip + adaptive(tolerance) + "\n[output]\nevery = 0.5\n"), watched_by(kept));
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

/// At tolerances that dopri5 pays dearly for: Fehlberg's pair 7(8) is the other of its kind.
TEST(Odeint, Dop853AgreesWithFehlberg78) {
  constexpr double kTolerance = 1e-13;
  constexpr double kAllowed = 1e-11;  // slips magnify
  KeptSamples kept;
  run(scene_of(kTip + adaptive(kTolerance, "dop853") + "\n[output]\nevery = 0.5\n"),
      watched_by(kept));
  ASSERT_EQ(kept.rows.size(), 81u);
  State s = {0.1, 0.0};
  auto stepper =
      odeint::make_controlled(kTolerance, kTolerance, odeint::runge_kutta_fehlberg78<State>());
  for (std::size_t k = 1; k < kept.rows.size(); ++k) {
    odeint::integrate_adaptive(stepper, tip, s, 0.5 * (k - 1), 0.5 * k, 0.01);
    EXPECT_NEAR(kept.rows[k][kept.column("tip.centre_of_mass.x")], s[0], kAllowed) << k;
    EXPECT_NEAR(kept.rows[k][kept.column("tip.velocity.x")], s[1], kAllowed) << k;
  }
}

/// Two symplectic schemes of fourth order on a tip that swings over one trough for 500 time units.
TEST(Odeint, BlanesMoanAgreesWithMcLachlan) {
  constexpr double kAllowed = 1e-9;  // both at steps whose own errors are below it
  const std::string scene = tables(R"([[body]] | type = "point" | position = [0.3]
particle_mass = 1.0
[[force]] | type = "sinusoidal_substrate" | amplitude = 0.1 | period = 1.0
[run] | duration = 500.0 | integrator = )");
  const RunResult result = run_text(scene + held_to("blanes_moan", 0.01));
  odeint::symplectic_rkn_sb3a_mclachlan<std::array<double, 1>> stepper;
  std::array<double, 1> x = {0.3};
  std::array<double, 1> v = {0.0};
  const auto force = [](const std::array<double, 1>& q, std::array<double, 1>& p) {
    p[0] = 0.1 * kTau * std::sin(kTau * q[0]);
  };
  constexpr double kStep = 0.005;
  for (int n = 0; n < 100'000; ++n)
    stepper.do_step(force, std::make_pair(std::ref(x), std::ref(v)), n * kStep, kStep);
  EXPECT_NEAR(result.body(0)["centre_of_mass"][0], x[0], kAllowed);
  EXPECT_NEAR(result.body(0)["velocity"][0], v[0], kAllowed);
}

}  // namespace
}  // namespace tomlin::test
