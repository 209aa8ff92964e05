#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "framework/model/single_force.hpp"
#include "tests/framework/plugin/kim/kim_scenes.hpp"
#include "tests/support/resumed.hpp"

// Motion under models by the KIM API: energy, momentum, and resumed runs.

namespace tomlin::test {
namespace {

constexpr std::array<double, 3> kBoxOfMotion = {20.8, 20.5, 21.1};
/// Some thousand roundings of forces of order 1.
constexpr double kRoundingOfSums = 1e-12;

std::string moving(const std::string& model, const std::string& more = "") {
  return kMetal + box_of(kBoxOfMotion, "[true, true, true]") +
         atoms("a", crystal({5, 3, 3}, 4.1, 0.2, 21), "Ar", "Kr", "start_temperature = 60.0\n") +
         kim_force(model, "[\"a\"]") +
         "[run]\nduration = 0.4\nledger = true\nseed = 3\nintegrator = " + verlet(0.01) + "\n" +
         more;
}

double energy_error(const std::string& model, const std::string& dt) {
  const RunResult result = run(kim_scene(moving(model), {{"run.integrator.dt", dt}}), {});
  EXPECT_EQ(result.status, RunStatus::finished);
  return *result.group("energy")["numerical_work"];
}

/// The error of the energy at a time is dt^2 times a function of that time, and terms of dt^4.
TEST(KimMotion, TheEnergysErrorFallsAsTheSquareOfTheStep) {
  for (const char* model : {"tomlin_test_pair", "tomlin_test_coordinated"}) {
    SCOPED_TRACE(model);
    const double wide = energy_error(model, "0.005");
    const double half = energy_error(model, "0.0025");
    const double quarter = energy_error(model, "0.00125");
    EXPECT_GT(std::abs(wide), 1e-9) << "nothing moved";
    EXPECT_NEAR(wide / half, 4.0, 0.2);
    EXPECT_NEAR(half / quarter, 4.0, 0.05);
  }
}

TEST(KimMotion, ForcesAddUpToNothing) {
  for (const char* model : {"tomlin_test_pair", "tomlin_test_coordinated"}) {
    const auto scene = kim_scene(moving(model));
    SingleForce alone(*scene, 0);
    const double* f = alone.forces(0.0);
    double total[3] = {};
    double size = 0.0;
    for (const auto& variable : alone.variables()) {
      total[variable.axis] += f[variable.at];
      size += std::abs(f[variable.at]);
    }
    EXPECT_GT(size, 0.1);
    for (const double sum : total) EXPECT_NEAR(sum, 0.0, kRoundingOfSums * size);
  }
}

/// No list is part of the state: one that is made where a run is resumed gives the same bits.
TEST(KimMotion, IsResumedWithTheSameBits) {
  for (const char* model : {"tomlin_test_pair", "tomlin_test_coordinated"}) {
    SCOPED_TRACE(model);
    const auto scene = kim_scene(moving(model, "[output]\nevery = 0.02\n"));
    expect_same_from_any_step(scene, [](const RunResult& expected, const RunResult& result) {
      EXPECT_TRUE(same_bits(*expected.group("energy")["numerical_work"],
                            *result.group("energy")["numerical_work"]));
    });
  }
}

}  // namespace
}  // namespace tomlin::test
