#include <string>

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

std::string warnings_of(const TipScene& scene) {
  std::string all;
  for (const std::string& warning : run_text(scene.text()).warnings) all += warning + "\n";
  return all;
}

TEST(Window, OfWholePeriodsIsNotWarnedOf) { EXPECT_EQ(warnings_of(tip(20.0, 80.0)), ""); }

TEST(Window, OfPartsOfPeriodsSaysWhichWouldDo) {
  const std::string found = warnings_of(tip(20.0, 75.0));
  EXPECT_NE(found.find("5.5 periods of driver"), std::string::npos) << found;
  EXPECT_NE(found.find("from 20 to 70 it would be 5"), std::string::npos) << found;
}

/// A spring so soft that it is still loaded: its force is not that of sliding.
TEST(Window, InWhichTheBodyHasNotFollowedIsWarnedOf) {
  const std::string found = warnings_of(tip(0.0, 40.0, 0.02));
  EXPECT_NE(found.find("still being loaded"), std::string::npos) << found;
}

TEST(Window, OfFewSlipsIsWarnedOf) {
  const std::string found = warnings_of(tip(20.0, 40.0));
  EXPECT_NE(found.find("2 slips of driver begin within the window"), std::string::npos) << found;
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
    EXPECT_TRUE(found.warnings.empty()) << found.warnings.front();
  }
}

}  // namespace
}  // namespace tomlin::test
