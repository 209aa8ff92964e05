#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "framework/run/results/observables.hpp"
#include "tests/support/scenes.hpp"

// The friction of Carlson and Langer: its magnitude in steady sliding, its limits, and the exact
// condition under which a block on a spring slides steadily or sticks and slips.

namespace tomlin::test {
namespace {

constexpr double kSliderMass = 1.3;
constexpr double kSliderSpring = 2.0;

struct Weakening {
  double force = 0.7;
  double weakening = 0.5;
  double width = 0.05;

  double friction(double v) const {
    const double u = std::hypot(v, width);
    return force * v / u / (1.0 + u / weakening);
  }
  /// dF/dv.
  double slope(double v) const {
    const double u = std::hypot(v, width);
    const double left = 1.0 / (1.0 + u / weakening);
    return force * left / u * (width * width / (u * u) - v * v * left / (u * weakening));
  }
  /// Returns the speed of zero slope: u^3 - 2 w^2 u - w^2 v_w = 0 with u^2 = v^2 + w^2, by Newton's
  /// method from above.
  double strongest_at() const {
    const double square = width * width;
    double u = 2.0 * width + weakening;
    for (int pass = 0; pass < 100; ++pass) {
      u -= (u * u * u - 2.0 * square * u - square * weakening) / (3.0 * u * u - 2.0 * square);
    }
    return std::sqrt(u * u - square);
  }
  std::string text() const {
    return "[[force]]\nname = \"friction\"\ntype = \"velocity_weakening\"\nforce = " +
           digits(force) + "\nweakening_velocity = " + digits(weakening) +
           "\nwidth = " + digits(width) + "\n";
  }
};

/// A block on a spring whose end moves at `speed`. It starts at that speed, `offset` beside where
/// the spring balances friction.
std::string pulled_block(const Weakening& law, double speed, double offset, double duration,
                         const std::string& more = "", const std::string& integrator = "") {
  const double stretch = law.friction(speed) / kSliderSpring;
  return "[[body]]\nname = \"block\"\ntype = \"point\"\nposition = [" + digits(offset) +
         "]\nvelocity = [" + digits(speed) + "]\nparticle_mass = " + digits(kSliderMass) +
         "\n[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = " +
         digits(kSliderSpring) + "\nvelocity = [" + digits(speed) + "]\nstart = [" +
         digits(stretch) + "]\n" + law.text() + "[run]\nduration = " + digits(duration) +
         "\nintegrator = " + (integrator.empty() ? adaptive(1e-12) : integrator) + "\n" + more;
}

double number_of(const RunResult& result, const std::string& path) {
  EXPECT_EQ(result.status, RunStatus::finished);
  return observable(result, path).value();
}

TEST(VelocityWeakening, SteadySlidingTakesTheFrictionOfItsSpeed) {
  // Below the speed of the strongest friction, where sliding is stable.
  constexpr double kRounding = 1e-9;
  const Weakening law;
  for (const double part : {0.02, 0.3, 0.8}) {
    const double v = part * law.strongest_at();
    const RunResult result = run_text(pulled_block(law, v, 0.0, 5.0, "ledger = true\n"));
    EXPECT_NEAR(number_of(result, "driver.final_force.x"), law.friction(v), kRounding);
    EXPECT_NEAR(number_of(result, "energy.heat_out"), law.friction(v) * v * 5.0, kRounding);
    EXPECT_NEAR(number_of(result, "energy.numerical_work"), 0.0, kRounding);
  }
}

/// phi(y) = 1/(1 + y) between w and beyond v_w; Coulomb's law where v_w is large.
TEST(VelocityWeakening, HasTheLimitsOfTheLaw) {
  const Weakening sharp{.force = 1.0, .weakening = 0.5, .width = 1e-6};
  constexpr double kWidthOverSpeed = 1e-9;  // (w/v)^2, and w/v_w
  for (const double v : {1e-2, 0.5, 3.0}) {
    EXPECT_NEAR(sharp.friction(v), 1.0 / (1.0 + v / 0.5), kWidthOverSpeed * 10.0);
    const RunResult result = run_text(
        "[[body]]\nname = \"block\"\ntype = \"point\"\nposition = "
        "[0.0]\nvelocity = [" +
        digits(v) + "]\nparticle_mass = 1.0\n" + sharp.text() +
        "[run]\nduration = 1e-6\nintegrator = " + adaptive(1e-14) + "\n");
    // Over a microsecond the friction changes by its slope times the change of velocity.
    EXPECT_NEAR((v - number_of(result, "block.velocity.x")) / 1e-6, 1.0 / (1.0 + v / 0.5), 1e-5);
  }
  const Weakening weak{.force = 0.7, .weakening = 1e9, .width = 0.05};
  EXPECT_NEAR(weak.friction(0.3), 0.7 * 0.3 / std::hypot(0.3, 0.05), 1e-9);
}

/// Free sliding for w -> 0 has a closed form: with y = 1 + v/v_w the speed obeys
/// y^2 = y0^2 - 2 f t / (m v_w).
TEST(VelocityWeakening, AFreeBlockStopsLaterThanByCoulombsLaw) {
  const Weakening law{.force = 0.7, .weakening = 0.5, .width = 1e-5};
  constexpr double kSpeed = 2.0;
  const double y0 = 1.0 + kSpeed / law.weakening;
  const double stop = 0.5 * (y0 * y0 - 1.0) * kSliderMass * law.weakening / law.force;
  for (const double part : {0.3, 0.7, 0.99}) {
    const double t = part * stop;
    const RunResult result =
        run_text("[[body]]\nname = \"block\"\ntype = \"point\"\nposition = [0.0]\nvelocity = [" +
                 digits(kSpeed) + "]\nparticle_mass = " + digits(kSliderMass) + "\n" + law.text() +
                 "[run]\nduration = " + digits(t) + "\nintegrator = " + adaptive(1e-12) + "\n");
    const double y = std::sqrt(y0 * y0 - 2.0 * law.force * t / (kSliderMass * law.weakening));
    // The width takes off w/v_w of the friction.
    EXPECT_NEAR(number_of(result, "block.velocity.x"), law.weakening * (y - 1.0), 10.0 * law.width);
  }
}

/// A small offset d from steady sliding follows m d'' + F'(v) d' + k d = 0 exactly as d -> 0: it
/// grows where F' < 0 and decays where F' > 0.
TEST(VelocityWeakening, SteadySlidingIsUnstableWhereFrictionFallsWithSpeed) {
  constexpr double kOffset = 1e-6;
  // Relative error: the square of the offset over the width, grown over the run; and the tolerance.
  constexpr double kNonlinear = 1e-3;
  const Weakening law;
  const double critical = law.strongest_at();
  EXPECT_NEAR(law.slope(critical), 0.0, 1e-12);
  for (const double part : {0.7, 0.95, 1.05, 1.5, 4.0}) {
    const double v = part * critical;
    const double decay = 0.5 * law.slope(v) / kSliderMass;
    EXPECT_EQ(decay<0.0, part> 1.0);
    const double omega = std::sqrt(kSliderSpring / kSliderMass - decay * decay);
    // Whole periods: the offset is then exp(-decay t) of that at the start.
    const double t = 3.0 * 2.0 * M_PI / omega;
    const RunResult result = run_text(pulled_block(law, v, kOffset, t, "", adaptive(1e-14)));
    const double offset = number_of(result, "block.centre_of_mass.x") - v * t;
    EXPECT_NEAR(offset / kOffset, std::exp(-decay * t), kNonlinear * std::exp(-decay * t)) << part;
  }
}

/// Beyond linear growth the block sticks and slips about the pulling speed; below, nothing is left
/// of the offset.
TEST(VelocityWeakening, ABlockSticksAndSlipsOnlyAboveTheCriticalSpeed) {
  const Weakening law;
  const double critical = law.strongest_at();
  const auto range = [&](double speed) {
    const RunResult result = run_text(
        pulled_block(law, speed, 0.05, 400.0, "[measure]\nfrom = 300.0\n", adaptive(1e-9)));
    return number_of(result, "driver.max_force.x") - number_of(result, "driver.min_force.x");
  };
  constexpr double kNothing = 1e-4;  // of the friction force
  EXPECT_LT(range(0.6 * critical), kNothing * law.force);
  EXPECT_GT(range(1.6 * critical), 0.1 * law.force);
}

/// Pulled from rest, the block creeps until friction is at its strongest, f (1 - 3/2 (w/v_w)^(2/3))
/// to leading order: the static friction of the regularised law. The spring goes on being pulled
/// until the block is as fast, which takes sqrt(2 m/k) at most, as friction grows weaker.
TEST(VelocityWeakening, TheStaticForceIsTheStrongestFriction) {
  constexpr double kPull = 0.05;
  const Weakening law{.force = 1.0, .weakening = 0.5, .width = 1e-3};
  ASSERT_GT(kPull, law.strongest_at());
  const double strongest = law.friction(law.strongest_at());
  const double part = std::pow(law.width / law.weakening, 2.0 / 3.0);
  EXPECT_NEAR(strongest, law.force * (1.0 - 1.5 * part), 3.0 * part * part);
  const RunResult result =
      run_text("[[body]]\nname = \"block\"\ntype = \"point\"\nposition = [0.0]\nparticle_mass = " +
               digits(kSliderMass) +
               "\n[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = " +
               digits(kSliderSpring) + "\nvelocity = [" + digits(kPull) + "]\n" + law.text() +
               "[run]\nduration = 20.0\nintegrator = " + adaptive(1e-9) + "\n");
  const double found = number_of(result, "driver.static_force");
  EXPECT_GT(found, strongest);
  EXPECT_LT(found, strongest + kPull * std::sqrt(2.0 * kSliderMass * kSliderSpring));
}

}  // namespace
}  // namespace tomlin::test
