#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/numbers/quad.hpp"
#include "tests/support/order.hpp"
#include "tests/support/ring_scenes.hpp"

// One scene in double and quadruple precision.

namespace tomlin::test {
namespace {

std::string in(const std::string& type) { return "number_type = \"" + type + "\"\n"; }

TipScene tip(const std::string& type, double dt) {
  return {.velocity = 0.25, .duration = 0.8, .integrator = fixed_step(dt), .more = in(type)};
}

double end_of(const RunResult& result) { return result.body(0)["centre_of_mass"][0]; }

TEST(NumberTypes, AgreeToTheirDigits) {
  const std::vector<std::string> integrators = {fixed_step(0.01), verlet(0.01), adaptive(1e-5)};
  for (const std::string& integrator : integrators) {
    for (const std::string dynamics : {"inertial", "overdamped"}) {
      if (dynamics == "overdamped" && integrator == verlet(0.01)) continue;
      SCOPED_TRACE(dynamics + ", " + integrator);
      const auto result = [&](const std::string& type) {
        const std::string keys = in(type) + "dynamics = \"" + dynamics + "\"\n";
        return run_text(TipScene{.duration = 6.4, .integrator = integrator, .more = keys}.text());
      };
      const RunResult exact = result("quadruple");
      const double x = end_of(exact);
      const double force = exact.driver(0)["mean_force"][0];
      const RunResult in_double = result("double");
      EXPECT_NEAR(end_of(in_double), x, 2e-13);
      EXPECT_NEAR(in_double.driver(0)["mean_force"][0], force, 2e-13);
    }
  }
}

TEST(NumberTypes, OfRings) {
  for (const std::string coordinates : {"particles", "rigid"}) {
    const auto result = [&](const std::string& type) {
      return run_text(RingScene{.coordinates = coordinates,
                                .bonds = 100.0,
                                .velocity = 0.9,
                                .duration = 3.0,
                                .integrator = fixed_step(0.005),
                                .more = in(type)}
                          .text());
    };
    constexpr double kRounding = 1e-12;  // of 600 steps
    const ResultGroup exact = result("quadruple").body(0);
    const ResultGroup found = result("double").body(0);
    EXPECT_NEAR(*found["rotation"], *exact["rotation"], kRounding) << coordinates;
    for (int d = 0; d < 2; ++d) {
      EXPECT_NEAR(found["centre_of_mass"][d], exact["centre_of_mass"][d], kRounding) << coordinates;
    }
  }
}

/// Quadruple goes on converging with the scheme's order below the rounding of double.
TEST(NumberTypes, QuadrupleConvergesBelowTheRoundingOfDouble) {
  const auto end = [](double h) {
    Engine engine(scene_of(tip("quadruple", h).text()), {});
    engine.run();
    return engine.state().numbers<Quad>("stepped.position")[0];
  };
  std::vector<double> steps, differences;
  for (double h = 0.8 / 1024; h > 0.8 / 10000; h *= 0.5) {
    steps.push_back(h);
    differences.push_back(std::abs(static_cast<double>(end(h) - end(0.5 * h))));
  }
  const double order = fitted_order(steps, differences);
  EXPECT_NEAR(order, 4.0, 0.05);
  EXPECT_LT(differences.back(), 1e-16) << "finer than a double";
  EXPECT_GT(differences.back(), 1e-26);
}

/// Differences in the 22nd digit: dopri5 with steps that double has long given up on.
TEST(NumberTypes, QuadrupleReachesTwentyTwoDigits) {
  const auto end = [](double h) {
    TipScene scene = tip("quadruple", h);

    scene.integrator = adaptive_held_to(h);
    Engine engine(scene_of(scene.text()), {});
    engine.run();
    return engine.state().numbers<Quad>("stepped.position")[0];
  };
  const double h = 0.8 / 8192;
  const double coarse = std::abs(static_cast<double>(end(2.0 * h) - end(h)));
  const double fine = std::abs(static_cast<double>(end(h) - end(0.5 * h)));
  EXPECT_NEAR(std::log2(coarse / fine), 5.0, 0.2);
  EXPECT_LT(fine, 1e-20);
}

}  // namespace
}  // namespace tomlin::test
