#include <cmath>
#include <complex>
#include <string>

#include <gtest/gtest.h>

#include "framework/core/numbers/constants.hpp"
#include "tests/support/ring_scenes.hpp"

// Frozen coordinates.

namespace tomlin::test {
namespace {

constexpr int kCount = 8;
constexpr double kPeriod = 1.0;

/// On a corrugation that does not decay, a ring of radius R that cannot turn is a particle:
/// amplitude (V0/N) |sum_i exp(i 2 pi (R/a) cos theta_i)|, or negative.
double amplitude_of(double radius) {
  std::complex<double> sum;
  for (int i = 0; i < kCount; ++i) {
    sum += std::exp(
        std::complex<double>(0.0, kTau * (radius / kPeriod) * std::cos(kTau * i / kCount)));
  }
  EXPECT_NEAR(sum.imag(), 0.0, 1e-12) << "an even ring";
  return sum.real() / kCount;
}

std::string driven(const std::string& hold, double radius, const std::string& run) {
  return "[[body]]\nname = \"ring\"\ntype = \"ring\"\ncount = 8\nradius = " + digits(radius) +
         "\nparticle_mass = 0.125\ncentre = [0.1, 1.0]\ncoordinates = \"rigid\"\nhold = " + hold +
         "\n[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = 2.0\n"
         "velocity = [0.25, 0.0]\n[[force]]\ntype = \"viscous_damping\"\ncoefficient = 0.125\n"
         "[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = 0.025\nperiod = 1.0\n"
         "[run]\nduration = 12.0\n" +
         run + "\n";
}

TEST(Hold, ARingThatCannotTurnIsATip) {
  for (const double radius : {0.3, 1.0, 1.7}) {
    for (const std::string dynamics : {"inertial", "overdamped"}) {
      for (const std::string& integrator : {fixed_step(0.01), adaptive(1e-11), verlet(0.01)}) {
        if (dynamics == "overdamped" && integrator == verlet(0.01)) continue;
        SCOPED_TRACE(digits(radius) + ", " + dynamics + ", " + integrator);
        const std::string keys = "dynamics = \"" + dynamics + "\"\n";
        const RunResult ring =
            run_text(driven("[\"rotation\"]", radius, keys + "integrator = " + integrator));
        const TipScene as_tip{.amplitude = 0.2 * amplitude_of(radius),
                              .duration = 12.0,
                              .integrator = integrator,
                              .more = keys};
        const RunResult tip = run_text(as_tip.text());
        EXPECT_NEAR(ring.driver(0)["mean_force"][0], tip.driver(0)["mean_force"][0], 1e-9);
        EXPECT_NEAR(ring.body(0)["centre_of_mass"][0], tip.body(0)["centre_of_mass"][0], 1e-9);
        EXPECT_EQ(*ring.body(0)["rotation"], 0.0);
      }
    }
  }
}

TEST(Hold, EachAxisStaysWhereItStarts) {
  for (const std::string coordinates : {"particles", "rigid"}) {
    for (const std::string& integrator : {fixed_step(0.002), adaptive(1e-8), verlet(0.002)}) {
      for (const int held : {0, 1}) {
        const std::string body =
            RingScene{.coordinates = coordinates, .duration = 4.0, .integrator = integrator}.text();
        const std::string key = "coordinates = ";
        std::string text = body;
        text.insert(text.find(key), held == 0 ? "hold = [\"x\"]\n" : "hold = [\"y\"]\n");
        const RunResult result = run_text(text);
        ASSERT_EQ(result.status, RunStatus::finished);
        const auto& position = result.body(0)["centre_of_mass"];
        EXPECT_EQ(result.body(0)["velocity"][held], 0.0);
        // A flexible ring's centre is a mean of positions that have not moved.
        EXPECT_NEAR(position[held], held == 0 ? 0.0 : 1.0, 1e-15);
        EXPECT_GT(std::abs(position[1 - held] - (held == 0 ? 1.0 : 0.0)), 1e-4)
            << "the other moves";
      }
    }
  }
}

TEST(Hold, TakesCoordinatesAway) {
  Model free(scene_of(driven("[]", 1.0, "integrator = " + fixed_step(0.01))));
  Model held(scene_of(driven("[\"rotation\"]", 1.0, "integrator = " + fixed_step(0.01))));
  Model line(scene_of(driven("[\"y\", \"rotation\"]", 1.0, "integrator = " + fixed_step(0.01))));
  EXPECT_EQ(free.coordinate_count(), 3u);
  EXPECT_EQ(held.coordinate_count(), 2u);
  EXPECT_EQ(line.coordinate_count(), 1u);
}

}  // namespace
}  // namespace tomlin::test
