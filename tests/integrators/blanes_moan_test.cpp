#include "integrators/blanes_moan.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/records/integrator.hpp"
#include "tests/support/order.hpp"
#include "tests/support/pendulum.hpp"
#include "tests/support/ring_scenes.hpp"

// Properties of the symplectic scheme beyond its order for one particle (order_test.cpp).

namespace tomlin::test {
namespace {

constexpr Window kFourth{3.8, 4.3};

std::string scheme(double dt) { return held_to("blanes_moan", dt); }

TEST(BlanesMoanEnergy, StaysBoundedOverAHundredThousandPeriods) {
  const Swings swings(scheme(0.5), 1'200'000);
  EXPECT_GT(swings.early, 1e-10) << "nothing to see";
  EXPECT_NEAR(swings.late / swings.early, 1.0, 0.05) << "a drift";
}

TEST(BlanesMoanEnergy, SwingsWithTheFourthPowerOfTheStep) {
  const double order = power_of_swings("blanes_moan", 0.8, 0.15);
  EXPECT_TRUE(kFourth.holds(order)) << order;
}

/// A flexible ring that is pulled over the corrugation without friction: positions, and what is
/// integrated along the way.
TEST(BlanesMoanOrder, OfARingAndOfItsWork) {
  const auto text = [](const std::string& integrator) {
    std::string scene = RingScene{.coordinates = "particles",
                                  .bonds = 40.0,
                                  .velocity = 0.6,
                                  .duration = 4.0,
                                  .integrator = integrator}
                            .text();
    const auto from = scene.find("[[force]]\ntype = \"viscous_damping\"");
    EXPECT_NE(from, std::string::npos);
    scene.erase(from, scene.find("[[", from + 2) - from);
    return scene;
  };
  const RunResult exact = run_text(text(adaptive(1e-14, "dop853")));
  std::vector<double> steps;
  std::vector<double> position, work, force;
  for (double h = 0.04; h > 0.004; h *= 0.5) {
    const RunResult result = run_text(text(scheme(h)));
    ASSERT_EQ(result.status, RunStatus::finished);
    steps.push_back(h);
    position.push_back(
        std::abs(result.body(0)["centre_of_mass"][0] - exact.body(0)["centre_of_mass"][0]));
    work.push_back(std::abs(*result.driver(0)["work"] - *exact.driver(0)["work"]));
    force.push_back(std::abs(result.driver(0)["mean_force"][0] - exact.driver(0)["mean_force"][0]));
  }
  for (const auto& errors : {position, work, force}) {
    const double order = fitted_order(steps, errors, 1e-14);
    EXPECT_TRUE(kFourth.holds(order)) << order;
  }
}

// ---- refusals

const std::string kUnsuitable = "run.integrator.type = \"blanes_moan\" [integrator.unsuitable]";

TEST(BlanesMoanRefuses, Friction) {
  const std::string text = TipScene{.integrator = scheme(0.01)}.text();
  EXPECT_EQ(brief_refusal(text), "21:14 " + kUnsuitable);
  EXPECT_NE(refusal(text).find("\"viscous_damping\""), std::string::npos);
}

TEST(BlanesMoanRefuses, DynamicsWithoutInertia) {
  const TipScene tip{.integrator = scheme(0.01), .more = "dynamics = \"overdamped\"\n"};
  // For the dynamics, and for the friction.
  EXPECT_EQ(brief_refusal(tip.text()), "21:14 " + kUnsuitable + "\n21:14 " + kUnsuitable);
}

TEST(BlanesMoanRefuses, MotionsPrescribedInTime) {
  const auto text = [](const std::string& velocity) {
    return "[[body]]\nname = \"slab\"\ntype = \"point\"\nposition = [0.0]\nparticle_mass = 1.0\n"
           "coordinates = \"prescribed\"\nmotion = { velocity = [" +
           velocity +
           "] }\n[[body]]\nname = \"tip\"\ntype = \"point\"\nposition = [0.5]\n"
           "particle_mass = 1.0\n[[force]]\ntype = \"harmonic_bonds\"\nbodies = [\"slab\", "
           "\"tip\"]\npairs = \"all\"\nstiffness = 1.0\n[run]\nduration = 1.0\nintegrator = " +
           scheme(0.01) + "\n";
  };
  EXPECT_EQ(brief_refusal(text("\"sin(t)\"")), "20:14 " + kUnsuitable);
  EXPECT_NE(refusal(text("\"sin(t)\"")).find("\"slab\""), std::string::npos);
  EXPECT_EQ(refusal(text("0.1")), "") << "a steady one is a place that follows from the time";
}

}  // namespace
}  // namespace tomlin::test
