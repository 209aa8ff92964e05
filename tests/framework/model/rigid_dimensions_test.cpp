#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "framework/core/numbers/constants.hpp"
#include "tests/support/ring_scenes.hpp"

// Rigid bodies on a line, and in space with their rotation held: a centre and nothing else.

namespace tomlin::test {
namespace {

std::string run_keys(const std::string& integrator, const std::string& dynamics) {
  return "[run]\nduration = 12.0\ndynamics = \"" + dynamics + "\"\nintegrator = " + integrator +
         "\n";
}

/// A rigid chain of spacing s is a tip of amplitude V0 |sum_i exp(i 2 pi s i / a)| that starts
/// where the sum's phase says.
TEST(RigidLine, AChainIsATip) {
  constexpr int kCount = 4;
  constexpr double kSpacing = 0.3;
  // The centre is the symmetric point, about which the sum is real.
  double share = 0.0;
  for (int i = 0; i < kCount; ++i) share += std::cos(kTau * kSpacing * (i - 0.5 * (kCount - 1)));
  for (const std::string dynamics : {"inertial", "overdamped"}) {
    for (const std::string& integrator : {fixed_step(0.01), verlet(0.01), adaptive(1e-11)}) {
      if (dynamics == "overdamped" && integrator == verlet(0.01)) continue;
      const RunResult chain = run_text(
          "[[body]]\nname = \"chain\"\ntype = \"chain\"\ncount = 4\nspacing = 0.3\n"
          "origin = [-0.35]\nparticle_mass = 0.25\ncoordinates = \"rigid\"\n"
          "[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = 2.0\n"
          "velocity = [0.25]\n[[force]]\ntype = \"viscous_damping\"\ncoefficient = 0.25\n"
          "[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = 0.2\nperiod = 1.0\n" +
          run_keys(integrator, dynamics));
      const TipScene as_tip{.amplitude = 0.2 * share,
                            .duration = 12.0,
                            .integrator = integrator,
                            .more = "dynamics = \"" + dynamics + "\"\n"};
      const RunResult tip = run_text(as_tip.text());
      ASSERT_EQ(chain.status, RunStatus::finished);
      EXPECT_NEAR(chain.body(0)["centre_of_mass"][0], tip.body(0)["centre_of_mass"][0], 1e-9);
      EXPECT_NEAR(chain.driver(0)["mean_force"][0], tip.driver(0)["mean_force"][0], 1e-9);
      EXPECT_EQ(chain.body(0).find("rotation"), nullptr) << "no rotation on a line";
    }
  }
}

std::string molecule(const std::string& hold, const std::string& integrator,
                     const std::string& dynamics) {
  return "[[body]]\nname = \"block\"\ntype = \"particles\"\n"
         "positions = [[0.0, 0.0, 0.0], [1.0, 0.2, 0.0], [0.1, 0.9, 0.4]]\n"
         "particle_mass = [1.0, 2.0, 0.5]\nvelocity = [0.1, -0.2, 0.3]\ncoordinates = \"rigid\"\n" +
         hold +
         "[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = 2.0\n"
         "velocity = [0.25, 0.1, 0.0]\n[[force]]\ntype = \"viscous_damping\"\ncoefficient = 0.3\n" +
         run_keys(integrator, dynamics);
}

/// Three driven, damped oscillators, one an axis: c V is where the force settles.
TEST(RigidSpace, ItsCentreFollowsTheDriver) {
  for (const std::string dynamics : {"inertial", "overdamped"}) {
    for (const std::string& integrator : {fixed_step(0.01), verlet(0.01), adaptive(1e-10)}) {
      if (dynamics == "overdamped" && integrator == verlet(0.01)) continue;
      Engine engine(scene_of(molecule("hold = [\"rotation\"]\n", integrator, dynamics)), {});
      EXPECT_EQ(engine.model().coordinate_count(), 3u);
      const RunResult result = engine.run();
      ASSERT_EQ(result.status, RunStatus::finished);
      const double total_mass = 3.5, c = 0.9, k = 2.0, t = 12.0;
      const double pulls[] = {0.25, 0.1, 0.0};
      const double speeds[] = {0.1, -0.2, 0.3};
      for (int d = 0; d < 3; ++d) {
        double force = 0.0;
        if (dynamics == "overdamped") {
          force = c * pulls[d] * -std::expm1(-k * t / c);
        } else {
          // Stretch s = V t - x: m s'' + c s' + k s = c V, from s = 0, s' = V - v0.
          const double gamma = 0.5 * c / total_mass;
          const double omega = std::sqrt(k / total_mass - gamma * gamma);
          const double rest = c * pulls[d] / k;
          const double b = (pulls[d] - speeds[d] - gamma * rest) / omega;
          force = k * (rest + std::exp(-gamma * t) *
                                  (-rest * std::cos(omega * t) + b * std::sin(omega * t)));
        }
        EXPECT_NEAR(result.driver(0)["final_force"][d], force,
                    integrator == verlet(0.01) ? 2e-5 : 2e-8)
            << dynamics << ", " << integrator << ", axis " << d;
      }
    }
  }
}

}  // namespace
}  // namespace tomlin::test
