#include <cmath>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "tests/support/ring_scenes.hpp"

// Time is counted in steps; who looks at a run does not change it; a run far from the origin is
// the run at the origin.

namespace tomlin::test {
namespace {

std::string flight(double duration, double dt) {
  return "[[body]]\ntype = \"point\"\nposition = [0.0]\nvelocity = [1.0]\nparticle_mass = 1.0\n"
         "[run]\nduration = " +
         digits(duration) + "\nintegrator = " + fixed_step(dt) + "\n";
}

/// Runs end exactly where they should; the last step is shortened. Below 1e-9 of a step there is
/// none, above there is one, on either side of the grid.
TEST(Time, EndsExactly) {
  constexpr double kRounding = 1e-14;
  constexpr double kNoStep = 1e-10;  // 1e-9 of a step: what is left of the run there
  for (const auto& [duration, steps] : {std::pair(1e5, 1'000'000u),
                                        {1.05, 11u},
                                        {1.0 + 0.9e-10, 10u},
                                        {1.0 + 1.1e-10, 11u},
                                        {1.0 - 0.9e-10, 10u},
                                        {0.03, 1u}}) {
    SCOPED_TRACE(duration);
    const RunResult result = run_text(flight(duration, 0.1));
    EXPECT_EQ(result.steps, steps);
    EXPECT_EQ(result.end_time, duration);
    if (steps > 11u) continue;  // positions add up their roundings
    EXPECT_NEAR(result.body(0)["centre_of_mass"][0], duration, steps == 10u ? kNoStep : kRounding);
  }
}

/// Step n ends at n dt, rounded once: a clock that adds 0.1 is off by 1e-6 by then.
TEST(Time, IsAProductAtEveryStep) {
  Engine engine(scene_of(flight(1e5, 0.1)), {});
  std::uint64_t steps = 0;
  double added = 0.0;
  for (const std::uint64_t more : {1u, 6u, 16u, 100u, 10000u, 700000u}) {
    engine.advance(more);
    steps += more;
    for (std::uint64_t k = 0; k < more; ++k) added += 0.1;
    EXPECT_EQ(engine.time(), 0.1 * static_cast<double>(steps)) << steps;
  }
  EXPECT_GT(std::abs(added - engine.time()), 1e-7) << "the test would not see a clock that adds";
}

TEST(Time, AnAdaptiveRunEndsExactly) {
  TipScene tip{.duration = 12.345};
  tip.integrator = adaptive(1e-7);
  EXPECT_EQ(run_text(tip.text()).end_time, 12.345);
}

// ---- looking changes nothing

std::vector<std::string> looks(double dt, double duration) {
  const auto every = [](double interval) { return "[output]\nevery = " + digits(interval) + "\n"; };
  const auto window = [](double from, double to) {
    return "[measure]\nin = \"time\"\nfrom = " + digits(from) + "\nto = " + digits(to) + "\n";
  };
  return {every(dt),
          every(0.3 * dt),
          every(16.0 * dt),
          every(0.377),
          every(duration),
          window(0.0, 0.5 * duration),
          window(1.2345, 0.8 * duration),
          window(16.0 * dt, 32.0 * dt) + every(7.0 * dt),
          window(0.9 * duration, duration) + every(1.1)};
}

struct Looked {
  const char* what;
  std::string text;
  double dt;
  double duration;
};

std::vector<Looked> looked() {
  TipScene tip{.velocity = 1.5, .duration = 8.0};
  TipScene tip_adaptive = tip;
  tip_adaptive.integrator = adaptive(1e-7);
  // The tip flies ahead and the driver decides when the origin moves, just at a sixteenth step.
  TipScene ahead{.velocity = 6.25,
                 .stiffness = 1e-3,
                 .damping = 0.0,
                 .amplitude = 0.01,
                 .start_velocity = 10.0,
                 .duration = 4.0};
  RingScene flexible{.velocity = 1.5, .duration = 4.0};
  RingScene rigid = flexible;
  rigid.coordinates = "rigid";
  rigid.integrator = fixed_step(0.01);
  RingScene rigid_adaptive = rigid;
  rigid_adaptive.integrator = adaptive(1e-7);
  TipScene tip_verlet = tip;
  tip_verlet.integrator = verlet(0.01);
  RingScene rigid_verlet = rigid;
  rigid_verlet.integrator = verlet(0.01);
  const std::string in_quadruple = "number_type = \"quadruple\"\n";
  const std::string without_inertia = "dynamics = \"overdamped\"\n";
  const auto with = [](auto scene, const std::string& keys) {
    scene.more = keys;
    return scene.text();
  };
  return {{"tip, rk4", tip.text(), 0.01, 8.0},
          {"tip, dopri5", tip_adaptive.text(), 0.1, 8.0},
          {"tip ahead of its driver, rk4", ahead.text(), 0.01, 4.0},
          {"flexible ring, rk4", flexible.text(), 0.002, 4.0},
          {"rigid ring, rk4", rigid.text(), 0.01, 4.0},
          {"rigid ring, dopri5", rigid_adaptive.text(), 0.1, 4.0},
          {"tip, velocity_verlet", tip_verlet.text(), 0.01, 8.0},
          {"rigid ring, velocity_verlet", rigid_verlet.text(), 0.01, 4.0},
          {"tip, rk4, quadruple", with(tip, in_quadruple), 0.01, 8.0},
          {"tip, velocity_verlet, quadruple", with(tip_verlet, in_quadruple), 0.01, 8.0},
          {"rigid ring, dopri5, quadruple", with(rigid_adaptive, in_quadruple), 0.1, 4.0},
          {"tip, rk4, overdamped", with(tip, without_inertia), 0.01, 8.0},
          {"tip, dopri5, overdamped", with(tip_adaptive, without_inertia), 0.1, 8.0},
          {"rigid ring, rk4, overdamped", with(rigid, without_inertia), 0.01, 4.0}};
}

TEST(Looking, NeverAltersTheMotion) {
  for (const Looked& c : looked()) {
    SCOPED_TRACE(c.what);
    Engine alone(scene_of(c.text), {});
    const RunResult expected = alone.run();
    ASSERT_EQ(expected.status, RunStatus::finished);
    for (const std::string& more : looks(c.dt, c.duration)) {
      SCOPED_TRACE(more);
      KeptSamples kept;
      Engine watched(scene_of(c.text + more), watched_by(kept));
      const RunResult result = watched.run();
      EXPECT_EQ(result.steps, expected.steps);
      EXPECT_TRUE(Motion(watched) == Motion(alone));
    }
  }
}

/// Samples come at their times, all of them, the last at the end of the run.
TEST(Looking, SamplesAreAllThere) {
  TipScene tip{.duration = 2.0};
  tip.more = "[output]\nevery = 0.1\n";
  for (const std::string& integrator : {fixed_step(0.01), fixed_step(0.03), adaptive(1e-6)}) {
    tip.integrator = integrator;
    KeptSamples kept;
    run(scene_of(tip.text()), watched_by(kept));
    ASSERT_EQ(kept.rows.size(), 21u) << integrator;
    for (std::size_t k = 0; k < kept.rows.size(); ++k) {
      EXPECT_EQ(kept.rows[k][0], k == 20 ? 2.0 : static_cast<double>(k) * 0.1);
    }
  }
}

// ---- far out

// Offsets within a cell keep all their digits; what is left are other roundings of the start, which
// damping forgets. Twenty periods' worth of steps.
constexpr double kFarOut = 1e-9;

TEST(FarOut, TheMeanForceOfARing) {
  RingScene ring{.coordinates = "rigid", .velocity = 0.05, .duration = 60.0};
  ring.integrator = adaptive(1e-11);
  for (const double period : {1.0, 0.75}) {
    ring.period = period;
    ring.centre = 0.0;
    const RunResult here = run_text(ring.text());
    for (const double cells : {1e9, 1e12, -1e9}) {
      ring.centre = cells * period;
      const RunResult far = run_text(ring.text());
      ASSERT_EQ(far.status, RunStatus::finished);
      const double expected = here.driver(0)["mean_force"][0];
      EXPECT_NEAR(far.driver(0)["mean_force"][0], expected, kFarOut * expected) << cells;
      EXPECT_NEAR(*far.body(0)["turns"], *here.body(0)["turns"], kFarOut);
      EXPECT_GT(std::abs(*here.body(0)["turns"]), 0.03) << "it should have rolled";
    }
  }
}

/// A flexible ring far out keeps its bonds: lengths are differences of offsets.
TEST(FarOut, TheMeanForceOfAFlexibleRing) {
  RingScene ring{.velocity = 0.5, .duration = 4.0};
  const RunResult here = run_text(ring.text());
  ring.centre = 1e9;
  const RunResult far = run_text(ring.text());
  EXPECT_NEAR(far.driver(0)["mean_force"][0], here.driver(0)["mean_force"][0],
              kFarOut * here.driver(0)["mean_force"][0]);
}

// ---- many cells

/// A flat substrate declares its period all the same. Steady sliding: the spring pulls c V, and
/// lags c V/k behind, however many cells it has come.
TEST(ManyCells, SteadySlidingIsExact) {
  // Extension c V/k = 20 to its last digits; without cells it would be off by 1e-10 at 6e5 cells.
  // The step is a binary fraction, so that the last one ends where the run does.
  constexpr double kRounding = 1e-14;
  constexpr double kVelocity = 40.0;
  const TipScene tip{.velocity = kVelocity,
                     .stiffness = 2.0,
                     .damping = 1.0,
                     .amplitude = 0.0,
                     .position = 0.0,
                     .start_velocity = kVelocity,
                     .duration = 15625.0,
                     .integrator = fixed_step(0.015625)};
  Engine engine(scene_of(tip.text()), {});
  const RunResult result = engine.run();
  ASSERT_EQ(result.status, RunStatus::finished);
  EXPECT_NEAR(result.driver(0)["final_force"][0], kVelocity, kRounding * kVelocity);
  EXPECT_NEAR(result.body(0)["velocity"][0], kVelocity, kRounding * kVelocity);
  EXPECT_NEAR(result.body(0)["centre_of_mass"][0], kVelocity * 15625.0 - 20.0, 2e-10);
  EXPECT_GT(integers_of(engine, "origin_cells")[0], 624'000);
}

/// Against a loop in extended precision without any cells.
TEST(ManyCells, AgreesWithAReferenceWithoutCells) {
  // 20 000 steps with a force of 0.6: roundings of 1e-16 each, damped within a few hundred steps.
  constexpr double kRounding = 1e-12;
  constexpr double kDt = 0.01;
  constexpr int kSteps = 20000;
  const TipScene tip{.velocity = 3.0, .duration = kDt * kSteps, .integrator = fixed_step(kDt)};
  using Real = long double;
  const Real tau = 2 * std::acos(Real(-1));
  const auto acceleration = [&](Real t, Real x, Real v) {
    return Real(tip.stiffness) * (Real(tip.position) + Real(tip.velocity) * t - x) -
           Real(tip.damping) * v + tau * Real(tip.amplitude) * std::sin(tau * x);
  };
  Real x = tip.position;
  Real v = 0.0;
  const Real h = kDt;
  for (int n = 0; n < kSteps; ++n) {
    const Real t = n * h;
    const Real a1 = acceleration(t, x, v);
    const Real v2 = v + h / 2 * a1;
    const Real a2 = acceleration(t + h / 2, x + h / 2 * v, v2);
    const Real v3 = v + h / 2 * a2;
    const Real a3 = acceleration(t + h / 2, x + h / 2 * v2, v3);
    const Real v4 = v + h * a3;
    const Real a4 = acceleration(t + h, x + h * v3, v4);
    x += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
    v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  const RunResult result = run_text(tip.text());
  EXPECT_NEAR(result.body(0)["velocity"][0], static_cast<double>(v), kRounding);
  const double force = static_cast<double>(
      Real(tip.stiffness) * (Real(tip.position) + Real(tip.velocity) * h * kSteps - x));
  EXPECT_NEAR(result.driver(0)["final_force"][0], force, kRounding);
}

TEST(ManyCells, BackwardsIsTheMirrorImage) {
  const TipScene forward{.velocity = 2.0, .position = 0.0, .start_velocity = 0.5};
  TipScene backward = forward;
  backward.velocity = -2.0;
  backward.start_velocity = -0.5;
  const RunResult a = run_text(forward.text());
  const RunResult b = run_text(backward.text());
  EXPECT_TRUE(same_bits(a.body(0)["centre_of_mass"][0], -b.body(0)["centre_of_mass"][0]));
  EXPECT_TRUE(same_bits(a.driver(0)["mean_force"][0], -b.driver(0)["mean_force"][0]));
  EXPECT_GT(a.body(0)["centre_of_mass"][0], 30.0);
}

}  // namespace
}  // namespace tomlin::test
