#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/ring_scenes.hpp"

// Far from the origin a run is as good as near it, in every number type.

namespace tomlin::test {
namespace {

/// The mean force from the second of a tip's periods on.
double mean_force(double period, double position, const std::string& number_type) {
  const TipScene tip{.velocity = 0.5,
                     .period = period,
                     .position = position,
                     .duration = 8.0 * period,
                     .integrator = fixed_step(0.01),
                     .more = "number_type = \"" + number_type +
                             "\"\n[measure]\nin = \"driver_periods\"\nfrom = 1\n"};
  const RunResult result = run_text(tip.text());
  EXPECT_EQ(result.status, RunStatus::finished);
  return result.driver(0)["mean_force"][0];
}

TEST(FarOutTypes, ATipsMeanForceIsThatAtTheOrigin) {
  constexpr double kRounding = 1e-12;
  for (const double period : {1.0, 0.3}) {
    for (const std::string type : {"double", "quadruple"}) {
      for (const double cells : {1e9, -1e9, 1e12}) {
        const double position = (cells + 0.25) * period;
        // The part of a period that this number stands for, exactly.
        const double offset = std::fma(-cells, period, position);
        const double here = mean_force(period, offset, type);
        EXPECT_NEAR(mean_force(period, position, type), here, kRounding * here)
            << type << ", period " << period << ", cells " << cells;
      }
    }
  }
}

TEST(FarOutTypes, TheRingOfTableI) {
  const auto of = [](double centre) {
    const RingScene ring{.coordinates = "rigid",
                         .velocity = 0.01,
                         .centre = centre,
                         .duration = 1000.0,
                         .integrator = adaptive(1e-11),
                         .more = "[measure]\nin = \"driver_periods\"\nfrom = 1\nto = 10\n"};
    return run_text(ring.text());
  };
  const RunResult here = of(0.0);
  const double force = here.driver(0)["mean_force"][0];
  EXPECT_NEAR(of(1e9).driver(0)["mean_force"][0], force, 1e-9 * force);
  EXPECT_GT(std::abs(*here.body(0)["turns"]), 1.0) << "it should have rolled";
}

}  // namespace
}  // namespace tomlin::test
