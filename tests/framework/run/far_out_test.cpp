#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/ring_scenes.hpp"

// Far from the origin and after many small steps a run is as good as at the start, in every number
// type.

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
  const std::vector<std::pair<std::string, double>> types = {
      {"double", 1e-12}, {"float", 1e-5}, {"quadruple", 1e-12}};
  for (const double period : {1.0, 0.3}) {
    for (const auto& [type, tolerance] : types) {
      for (const double cells : {1e9, -1e9, 1e12}) {
        const double place = (cells + 0.25) * period;
        // The part of a period that this number stands for, exactly.
        const double offset = std::fma(-cells, period, place);
        const double here = mean_force(period, offset, type);
        EXPECT_NEAR(mean_force(period, place, type), here, tolerance * here)
            << type << ", period " << period << ", cells " << cells;
      }
    }
  }
}

TEST(FarOutTypes, TheRingOfTableI) {
  const auto of = [](double centre, const std::string& type) {
    const RingScene ring{.coordinates = "rigid",
                         .velocity = 0.01,
                         .centre = centre,
                         .duration = 1000.0,
                         .integrator = type == "float" ? fixed_step(0.02) : adaptive(1e-11),
                         .more = "number_type = \"" + type +
                                 "\"\n[measure]\nin = \"driver_periods\"\nfrom = 1\nto = 10\n"};
    return run_text(ring.text());
  };
  const RunResult here = of(0.0, "double");
  const double force = here.driver(0)["mean_force"][0];
  EXPECT_NEAR(of(1e9, "double").driver(0)["mean_force"][0], force, 1e-9 * force);
  EXPECT_NEAR(of(1e9, "float").driver(0)["mean_force"][0], force, 1e-4 * force);
  EXPECT_GT(std::abs(*here.body(0)["turns"]), 1.0) << "it should have rolled";
}

// ---- many small steps in float

struct Windows {
  double second = 0.0;  ///< mean force over the second period
  double last = 0.0;
};

Windows windows_of(const std::string& type, int periods, double dt) {
  const auto mean = [&](int from) {
    const TipScene tip{.velocity = 1.0,
                       .position = 0.25,
                       .duration = static_cast<double>(periods),
                       .integrator = fixed_step(dt),
                       .more = "number_type = \"" + type +
                               "\"\n[measure]\nin = \"driver_periods\"\nfrom = " +
                               std::to_string(from) + "\nto = " + std::to_string(from + 1) + "\n"};
    return run_text(tip.text()).driver(0)["mean_force"][0];
  };
  return {mean(1), mean(periods - 1)};
}

/// The mean is a difference of two running integrals, which grow with the run. Compensated, a
/// float loses nothing by that.
TEST(FarOutTypes, AFloatsLastPeriodIsAsGoodAsItsSecond) {
  constexpr int kPeriods = 1000;
  constexpr double kDt = 1e-3;
  const Windows exact = windows_of("double", kPeriods, kDt);
  const Windows found = windows_of("float", kPeriods, kDt);
  const double early = std::abs(found.second - exact.second);
  const double late = std::abs(found.last - exact.last);
  constexpr double kFloat = 1e-5;
  EXPECT_LT(early, kFloat);
  EXPECT_LT(late, kFloat);
  EXPECT_GT(early + late, 1e-10) << "that is a double";

  // Without compensation: the same mean force, added up in a million float steps.
  float sum = 0.0f;
  float before = 0.0f;
  const int steps = static_cast<int>(std::lround(1.0 / kDt));
  for (int k = 0; k < kPeriods * steps; ++k) {
    if (k == (kPeriods - 1) * steps) before = sum;
    sum += static_cast<float>(exact.last * kDt);
  }
  EXPECT_GT(std::abs(static_cast<double>(sum - before) - exact.last), 10.0 * kFloat)
      << "the test would not see a plain sum";
}

}  // namespace
}  // namespace tomlin::test
