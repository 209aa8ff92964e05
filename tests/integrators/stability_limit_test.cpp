#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/records/integrator.hpp"
#include "framework/model/stability.hpp"
#include "tests/support/oscillator.hpp"
#include "tests/support/scenes.hpp"

// The limits that records state, against what oscillators do a little below and above them.

namespace tomlin::test {
namespace {

constexpr double kBelow = 0.97;
constexpr double kAbove = 1.03;
// Beyond its limit blanes_moan has a narrow window of growth, then stable steps again up to
// h omega = 5.03: the window is what the limit is for. Its middle is 0.1 % above the limit.
constexpr double kAboveOfBlanesMoan = 1.0009;
constexpr std::uint64_t kSteps = 6000;
constexpr double kGrown = 10.0;
constexpr double kNotGrown = 2.0;  // in the norm of positions and velocities, h omega being about 3

struct Case {
  std::string scheme;
  double damping = 0.0;  ///< c of an oscillator of k = m = 1
};

Oscillator oscillator(const Case& c) {
  return {.m = 1.0, .k = 1.0, .c = c.damping, .pull = 0.0, .x0 = 1.0, .v0 = 0.0, .duration = 1e9};
}

double limit_of(const Case& c) {
  const std::string any = held_to(c.scheme, 0.01);
  Engine engine(scene_of(oscillator(c).scene(any), {{"run.allow_unstable", "true"}}), {});
  return stable_step_of(engine.model(), *standard().integrator(c.scheme));
}

/// The largest size that the motion comes to; infinite when the run fails.
double largest_size(const Case& c, double step) {
  Engine engine(
      scene_of(oscillator(c).scene(held_to(c.scheme, step)), {{"run.allow_unstable", "true"}}), {});
  double most = 0.0;
  for (std::uint64_t taken = 0; taken < kSteps; taken += 50) {
    engine.advance(50);
    if (engine.done()) return INFINITY;
    const SystemView<double>& view = engine.model().system().view;
    most = std::max(most, std::hypot(view.position[0], view.velocity[0]));
  }
  return most;
}

TEST(StableStep, IsWhereOscillatorsBeginToGrow) {
  const std::vector<Case> cases = {{"rk4", 0.0},      {"rk4", 0.5},       {"velocity_verlet", 0.0},
                                   {"midpoint", 0.5}, {"midpoint", 20.0}, {"blanes_moan", 0.0}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.scheme + ", c = " + digits(c.damping));
    const double limit = limit_of(c);
    ASSERT_TRUE(std::isfinite(limit));
    EXPECT_LT(largest_size(c, kBelow * limit), kNotGrown);
    const double above = c.scheme == "blanes_moan" ? kAboveOfBlanesMoan : kAbove;
    EXPECT_GT(largest_size(c, above * limit), kGrown);
  }
}

/// The midpoint scheme lets undamped oscillations grow at any step: what it is refused at is a
/// growth that shows in 1e9 steps.
TEST(StableStep, OfMidpointNeedsFriction) {
  const double without = limit_of({"midpoint", 0.0});
  EXPECT_LT(without, 0.01);
  EXPECT_GT(limit_of({"midpoint", 0.5}), 100.0 * without);
}

/// At the limit itself an oscillation does not decay, and with velocity_verlet it grows with the
/// number of steps: k = m = 1, and without inertia k = c = 1.
TEST(StableStep, TheLimitItselfIsRefused) {
  for (const std::string scheme :
       {"velocity_verlet", "baoab", "gjf", "rk4", "euler_maruyama", "leimkuhler_matthews"}) {
    SCOPED_TRACE(scheme);
    const bool inertial = standard().integrator(scheme)->with_inertia;
    const auto outcome = [&](double step, const std::string& insists) {
      std::string text = oscillator({scheme, inertial ? 0.0 : 1.0}).scene(held_to(scheme, step));
      if (!inertial) text += "dynamics = \"overdamped\"\n";
      return Engine(scene_of(text, {{"run.duration", digits(10.0 * step)},
                                    {"run.allow_unstable", insists}}),
                    {})
          .run();
    };
    const double limit = scheme == "rk4" ? limit_of({scheme, 0.0}) : 2.0;
    EXPECT_EQ(outcome(limit, "false").status, RunStatus::failed);
    EXPECT_EQ(outcome(limit, "false").failure->code, FaultCode::run_step_unstable);
    EXPECT_EQ(count_of(FaultCode::integrator_beyond_stability, outcome(limit, "true").warnings),
              1U);
    EXPECT_EQ(outcome(limit * (1.0 - 1e-6), "false").status, RunStatus::finished);
  }
}

}  // namespace
}  // namespace tomlin::test
