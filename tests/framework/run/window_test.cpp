#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/ring_scenes.hpp"

// Windows whose means say little of sliding are warned of, and good ones are not.

namespace tomlin::test {
namespace {

/// Periods of 10, a slip in each.
TipScene tip(double from, double to, double stiffness = 1.0) {
  return {
      .velocity = 0.1,
      .stiffness = stiffness,
      .damping = 4.0,
      .position = 0.5,
      .duration = to,
      .more = "[measure]\nin = \"time\"\nfrom = " + digits(from) + "\nto = " + digits(to) + "\n"};
}

using Briefs = std::vector<std::string>;

Briefs warnings_of(const TipScene& scene) { return briefs(run_text(scene.text()).warnings); }

TEST(Window, OfWholePeriodsIsNotWarnedOf) { EXPECT_EQ(warnings_of(tip(20.0, 80.0)), Briefs{}); }

TEST(Window, OfPartsOfPeriodsSaysWhichWouldDo) {
  const std::vector<Warning> found = run_text(tip(20.0, 75.0).text()).warnings;
  ASSERT_EQ(briefs(found), Briefs{"drivers.driver [run.window_not_whole]"});
  EXPECT_NE(found[0].text.find("20 to 70"), std::string::npos) << found[0].text;
}

TEST(Window, OfAPartOfAPeriodIsWarnedOf) {
  EXPECT_EQ(warnings_of(tip(0.0, 0.05)), Briefs{"drivers.driver [run.window_too_short]"});
}

TEST(Window, OfWhichRoundingLeavesLittleIsWarnedOf) {
  const Briefs found = warnings_of(tip(20.0, 20.000000001));
  EXPECT_EQ(found,
            (Briefs{"measure [run.window_rounding]", "drivers.driver [run.window_too_short]"}));
}

/// A spring so soft that it is still loaded: its force is not that of sliding.
TEST(Window, InWhichTheBodyHasNotFollowedIsWarnedOf) {
  EXPECT_EQ(warnings_of(tip(0.0, 40.0, 0.02)), Briefs{"drivers.driver [run.window_not_steady]"});
}

/// A body that creeps behind its driver is reported where no force has a period, too.
TEST(Window, InWhichTheBodyHasNotFollowedIsWarnedOfWithoutAPeriod) {
  const auto found = [](double coefficient) {
    return briefs(run_text(R"(
body = [{ name = "slider", type = "point", position = [0.0], particle_mass = 1.0 }]
force = [
  { name = "driver", type = "driving_spring", stiffness = 0.3, velocity = [0.01] },
  { type = "expression", force = ["-)" +
                           digits(coefficient) + R"( * tanh(1e3 * vx) "] },
]
run = { duration = 200.0, integrator = { type = "dopri5" } }
measure = { in = "time", from = 100.0, to = 200.0 }
)")
                      .warnings);
  };
  EXPECT_EQ(found(0.7), Briefs{"drivers.driver [run.window_not_steady]"});
  EXPECT_EQ(found(0.1), Briefs{});
}

TEST(Window, OfFewSlipsIsWarnedOf) {
  EXPECT_EQ(warnings_of(tip(20.0, 40.0)), Briefs{"drivers.driver [run.few_slips]"});
}

/// A pull along no axis: a period of the substrate is passed along x.
TEST(Window, OfAnObliquePullIsNotWarnedOf) {
  for (const char* velocity : {"[0.02, 0.02]", "[0.02, -0.02]", "[-0.0008, 0.02]"}) {
    SCOPED_TRACE(velocity);
    const RunResult found = run_text(R"(
body = [{ name = "tip", type = "point", position = [0.5, 0.0], particle_mass = 1.0 }]
force = [
  { name = "driver", type = "driving_spring", stiffness = 0.8, velocity = )" +
                                     std::string(velocity) + R"( },
  { type = "viscous_damping", coefficient = 1.0 },
  { type = "sinusoidal_substrate", amplitude = 0.001, period = 1.0, decay = 0.0 },
]
run = { duration = 1350.0, integrator = { type = "dopri5" } }
measure = { from = 100.0, to = 1350.0 }
)");
    EXPECT_EQ(briefs(found.warnings), Briefs{});
  }
}

/// A period of an oblique pull is over when all axes have come back, where they ever do.
TEST(Window, OfAnObliquePullIsOfWholePeriodsAlongAllAxes) {
  const auto length = [](const std::string& velocity) {
    const RunResult found = run_text(R"(
body = [{ name = "tip", type = "point", position = [0.0, 0.0], particle_mass = 1.0 }]
force = [
  { name = "driver", type = "driving_spring", stiffness = 2.0, velocity = )" +
                                     velocity + R"( },
  { type = "viscous_damping", coefficient = 2.0 },
  { type = "lattice_substrate", lattice = "square", period = 1.0, amplitude = 0.05 },
]
run = { duration = 50.0, integrator = { type = "rk4", dt = 0.05 } }
measure = { from = 1.0, to = 2.0, in = "driver_periods" }
)");
    return found.window_to - found.window_from;
  };
  EXPECT_DOUBLE_EQ(length("[0.1, 0.0]"), 10.0);
  EXPECT_DOUBLE_EQ(length("[0.1, -0.1]"), 10.0);
  EXPECT_DOUBLE_EQ(length("[0.05, 0.1]"), 20.0);
  EXPECT_DOUBLE_EQ(length("[-0.15, 0.05]"), 20.0);
  EXPECT_THROW(length("[0.1, 0.0618]"), InputError);
}

}  // namespace
}  // namespace tomlin::test
