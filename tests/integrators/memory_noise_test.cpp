#include <cmath>
#include <string>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "framework/run/results/observables.hpp"
#include "tests/support/scenes.hpp"

// Coloured noise: drag that remembers, in a bath.

namespace tomlin::test {
namespace {

constexpr double kBath = 0.3;
/// Long memories exchange energy with their bath rarely.
constexpr double kLargestError = 0.06;
/// Standard errors that a mean may be off: one in 16 000.
constexpr double kFourSigma = 4.0;

RunResult in_a_trap(const std::string& memory_time, std::int64_t stream) {
  const std::string text = tables(R"([[body]] | type = "point" | name = "tip" | position = [0.0]
particle_mass = 2.0
[[force]] | type = "expression" | name = "trap" | energy = "0.5 * x^2"
[[force]] | type = "memory_damping" | name = "bath" | coefficient = 1.5 | temperature = 0.3
memory_time = )") + memory_time +
                           tables(R"(
[run] | duration = 2e4 | ledger = true | stream = )") +
                           std::to_string(stream) +
                           R"(
integrator = { type = "baoab", dt = 0.2 }
[measure]
from = 100
)";
  return run_text(text);
}

double number(const RunResult& result, const std::string& path) {
  return observable(result, path).value();
}

/// From short memories, friction, to long ones, a second spring.
TEST(MemoryNoise, HasTheTemperatureOfItsBath) {
  for (const char* memory_time : {"0.01", "0.5", "5.0"}) {
    for (const std::int64_t stream : {0, 1}) {
      SCOPED_TRACE(std::string(memory_time) + ", " + std::to_string(stream));
      const RunResult result = in_a_trap(memory_time, stream);
      ASSERT_EQ(result.status, RunStatus::finished);
      EXPECT_NEAR(number(result, "bodies.tip.temperature"), kBath,
                  kFourSigma * *stated_error(result, "bodies.tip.temperature"));
      EXPECT_LT(*stated_error(result, "bodies.tip.temperature"), kLargestError * kBath);
    }
  }
}

/// Friction beside it does not commute with its flow. The exact covariance S of x, v and the memory
/// u solves A S + S A^T + B = 0.
TEST(MemoryNoise, BesideFrictionIsOfSecondOrder) {
  constexpr double kFriction = 1.0;
  constexpr double kPull = 1.0;  // coefficient
  constexpr double kRate = 2.0;  // 1/memory_time
  constexpr double kTemperature = 0.1;
  Eigen::Matrix3d a;
  a << 0, 1, 0, -1, -kFriction, -kPull, 0, kRate, -kRate;
  Eigen::Matrix3d b = Eigen::Matrix3d::Zero();
  b(2, 2) = 2.0 * kRate * kRate * kTemperature / kPull;
  Eigen::Matrix<double, 9, 9> lyapunov;
  for (int k = 0; k < 9; ++k) {
    Eigen::Matrix3d unit = Eigen::Matrix3d::Zero();
    unit(k % 3, k / 3) = 1.0;
    const Eigen::Matrix3d column = a * unit + unit * a.transpose();
    lyapunov.col(k) = Eigen::Map<const Eigen::Matrix<double, 9, 1>>(column.data());
  }
  const Eigen::Matrix<double, 9, 1> solved =
      lyapunov.fullPivLu().solve(-Eigen::Map<const Eigen::Matrix<double, 9, 1>>(b.data()));
  const double exact = solved(4);  // <v^2>

  const std::string text = tables(R"([[body]] | type = "point" | name = "tip" | position = [0.0]
particle_mass = 1.0
[[force]] | type = "driving_spring" | name = "trap" | stiffness = 1.0 | velocity = [0.0]
[[force]] | type = "memory_damping" | name = "bath" | coefficient = 1.0 | temperature = 0.1
memory_time = 0.5
[[force]] | type = "viscous_damping" | coefficient = 1.0
[run] | duration = 6e4 | integrator = { type = "baoab", dt = 0.2 }
[measure] | from = 100
)");
  const RunResult result = run_text(text);
  // In one order instead of two it would be 17 % less; of second order are some h^2.
  constexpr double kSecondOrder = 0.05;
  EXPECT_NEAR(number(result, "bodies.tip.temperature"), exact,
              kSecondOrder * exact + kFourSigma * *stated_error(result, "bodies.tip.temperature"));
  EXPECT_LT(*stated_error(result, "bodies.tip.temperature"), 0.01 * exact);
}

TEST(MemoryNoise, IsRefusedWhereItHasNoFlow) {
  const std::string text = tables(R"([[body]] | type = "ring" | name = "ring" | count = 4
radius = 1.0 | centre = [0.0, 1.0] | particle_mass = 1.0 | coordinates = "rigid"
[[force]] | type = "memory_damping" | name = "bath" | coefficient = 1.5 | temperature = 0.3
memory_time = 1.0
[run] | duration = 10 | integrator = { type = "baoab", dt = 0.1 }
)");
  EXPECT_NE(refusal(text).find("has no noise of the force \"bath\""), std::string::npos);
}

}  // namespace
}  // namespace tomlin::test
