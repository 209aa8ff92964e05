// scenarios/tip_in_two_dimensions: scan lines, and motion that is locked to the lattice.

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "framework/run/results/observables.hpp"
#include "tests/scenarios/scenario_fixture.hpp"

namespace tomlin::test {
namespace {

const std::string kScanLine = "tip_in_two_dimensions/scan.toml";
const std::string kLocking = "tip_in_two_dimensions/locking.toml";

double number_at(const RunResult& result, const std::string& path) {
  return observable(result, path).value();
}

TEST(TipInTwoDimensions, AlongARowItIsATipInOne) {
  const RunResult scan = run_shipped(kScanLine);
  // The second tip moves on -2 V0 cos(2 pi x/a); both take steps of rk4.
  const RunResult tip = run_text(tables(R"(
[[body]] | type = "point" | position = [0.0] | particle_mass = 1.0
[[force]] | name = "driver" | type = "driving_spring" | stiffness = 1.0 | velocity = [1e-2]
[[force]] | type = "viscous_damping" | coefficient = 2.0
[[force]] | type = "sinusoidal_substrate" | amplitude = -0.2 | period = 1.0
[run] | duration = 1000.0 | integrator = { type = "rk4", dt = 0.02 }
[measure] | from = 400.0 | to = 1000.0 | in = "time"
)"));
  EXPECT_GT(number_at(scan, "events.slips"), 5.0);
  EXPECT_NEAR(number_at(scan, "driver.mean_force.x"), number_at(tip, "driver.mean_force.x"), 1e-9);
  EXPECT_NEAR(number_at(scan, "driver.max_force.x"), number_at(tip, "driver.max_force.x"), 1e-9);
  EXPECT_NEAR(number_at(scan, "driver.mean_force.y"), 0.0, 1e-12);
}

double direction_of_motion(double force, double angle) {
  const RunResult result =
      run_shipped(kLocking, {{"F", text_of(force)}, {"angle", text_of(angle)}});
  const double x = number_at(result, "tip.mean_velocity.x");
  return x == 0.0 ? 0.0 : std::atan2(number_at(result, "tip.mean_velocity.y"), x);
}

TEST(TipInTwoDimensions, MovesAlongTheLatticeWhateverTheForce) {
  // Over 200 time units the position across is known to a lattice constant.
  constexpr double kLocked = 1.0 / 160.0;
  for (const double angle : {0.1, 0.3, 0.45}) {
    EXPECT_NEAR(direction_of_motion(1.5, angle), 0.0, kLocked) << angle;
  }
  EXPECT_NEAR(direction_of_motion(3.0, 0.1), 0.0, kLocked);
  EXPECT_NEAR(direction_of_motion(3.0, 0.5), 0.493, 0.01);
  // Six directions are alike.
  EXPECT_NEAR(direction_of_motion(1.5, kPi / 3.0 + 0.2), kPi / 3.0, kLocked);
}

}  // namespace
}  // namespace tomlin::test
