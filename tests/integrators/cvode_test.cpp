#include "tests/support/cvode.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/numbers/constants.hpp"
#include "framework/core/records/integrator.hpp"
#include "tests/support/order.hpp"
#include "tests/support/scenes.hpp"

// SUNDIALS' CVODE, Adams and BDF, on the equations of three models written out by hand, against
// every adaptive scheme: other methods on another's sine and another's rigid body.

namespace tomlin::test {
namespace {

#ifdef TOMLIN_HAS_CVODE

// Asked of the schemes, and of CVODE, whose errors pile up over many more steps.
constexpr double kTolerance = 1e-9;
constexpr double kCvodeTolerance = 1e-12;
// Slips and rolls over magnify what a step adds, some hundred times; damping forgets it again.
constexpr double kAllowed = 1000.0 * kTolerance;
// Two of CVODE's methods on the same equations.
constexpr double kCvodeAllowed = 2e-9;

struct Problem {
  std::string what;
  std::string scene;  ///< up to "integrator = "
  Equations equations;
  std::vector<double> start;
  double duration = 0.0;
  /// Numbers to be compared, from the equations' state and from the run's result.
  std::function<std::vector<double>(const std::vector<double>&)> seen;
  std::function<std::vector<double>(const RunResult&)> found;
};

Problem tip() {
  Problem p;
  p.what = "tip";
  p.duration = 20.0;
  p.scene = tables(R"([[body]] | type = "point" | position = [0.1] | particle_mass = 1.0
[[force]] | type = "driving_spring" | stiffness = 2.0 | velocity = [0.25]
[[force]] | type = "viscous_damping" | coefficient = 1.0
[[force]] | type = "sinusoidal_substrate" | amplitude = 0.1 | period = 1.0
[run] | duration = 20.0 | integrator = )");
  p.equations = [](double t, const double* s, double* slope) {
    slope[0] = s[1];
    slope[1] = 2.0 * (0.1 + 0.25 * t - s[0]) - s[1] + 0.1 * kTau * std::sin(kTau * s[0]);
    slope[2] = 2.0 * (0.1 + 0.25 * t - s[0]);
  };
  p.start = {0.1, 0.0, 0.0};
  p.seen = [](const std::vector<double>& y) { return std::vector{y[0], y[1], y[2] / 20.0}; };
  p.found = [](const RunResult& r) {
    return std::vector{r.body(0)["centre_of_mass"][0], r.body(0)["velocity"][0],
                       r.driver(0)["mean_force"][0]};
  };
  return p;
}

/// Eight particles on a rigid ring: the paper's model with a fast driver.
Problem ring() {
  constexpr int kCount = 8;
  constexpr double kSpring = 2.0, kSpeed = 0.3, kAmplitude = 0.1 / kCount, kDecay = 1.0;
  static const double kFriction = 2.0 * std::sqrt(2.0) / kCount;
  Problem p;
  p.what = "rigid ring";
  p.duration = 12.0;
  p.scene = tables(R"([[body]] | type = "ring" | count = 8 | radius = 1.0
particle_mass = "1 / 8" | centre = [0.0, 1.0] | coordinates = "rigid"
[[force]] | type = "driving_spring" | stiffness = 2.0 | velocity = [0.3, 0.0]
[[force]] | type = "viscous_damping" | coefficient = "2 * sqrt(2) / 8"
[[force]] | type = "sinusoidal_substrate" | amplitude = "0.1 / 8" | period = 1.0 | decay = 1.0
[run] | duration = 12.0 | integrator = )");
  // x, y, phi, their velocities, and the integral of the driver's force. Particle 0 is at the
  // lowest point or wherever the scene's ring starts: its angles are read off the scene.
  Engine engine(scene_of(p.scene + adaptive(kTolerance)), {});
  std::vector<double> angle;
  for (const auto& arm : engine.model().bodies()[0].arms) {
    angle.push_back(std::atan2(arm[1], arm[0]));
  }
  p.equations = [angle](double t, const double* s, double* slope) {
    double force[2] = {kSpring * (kSpeed * t - s[0]), kSpring * (1.0 - s[1])};
    slope[6] = force[0];
    double torque = 0.0;
    for (const double a : angle) {
      const double arm[2] = {std::cos(a + s[2]), std::sin(a + s[2])};
      const double x = s[0] + arm[0];
      const double y = s[1] + arm[1];
      const double v[2] = {s[3] - arm[1] * s[5], s[4] + arm[0] * s[5]};
      const double depth = kAmplitude * std::exp(-kDecay * y * y);
      const double f[2] = {kTau * depth * std::sin(kTau * x) - kFriction * v[0],
                           2.0 * kDecay * y * depth * std::cos(kTau * x) - kFriction * v[1]};
      force[0] += f[0];
      force[1] += f[1];
      torque += arm[0] * f[1] - arm[1] * f[0];
    }
    for (int k = 0; k < 3; ++k) slope[k] = s[3 + k];
    slope[3] = force[0];
    slope[4] = force[1];
    slope[5] = torque;  // mass and radius are 1
  };
  p.start = {0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  p.seen = [](const std::vector<double>& y) {
    return std::vector{y[0], y[1], y[2], y[3], y[4], y[6] / 12.0};
  };
  p.found = [](const RunResult& r) {
    return std::vector{r.body(0)["centre_of_mass"][0], r.body(0)["centre_of_mass"][1],
                       *r.body(0)["rotation"],         r.body(0)["velocity"][0],
                       r.body(0)["velocity"][1],       r.driver(0)["mean_force"][0]};
  };
  return p;
}

/// Frenkel and Kontorova's chain, pulled by its centre of mass.
Problem chain() {
  constexpr int kCount = 12;
  constexpr double kSpacing = 1.618033988749895;
  Problem p;
  p.what = "chain";
  p.duration = 20.0;
  p.scene = tables(R"([[body]] | type = "chain" | count = 12 | spacing = 1.618033988749895
particle_mass = 1.0
[[force]] | type = "harmonic_bonds" | pairs = "neighbours" | stiffness = 1.0
[[force]] | type = "driving_spring" | stiffness = 1.0 | velocity = [0.2]
[[force]] | type = "viscous_damping" | coefficient = 0.1
[[force]] | type = "sinusoidal_substrate" | amplitude = 0.05 | period = 1.0
[run] | duration = 20.0 | integrator = )");
  p.equations = [](double t, const double* s, double* slope) {
    const double* x = s;
    const double* v = s + kCount;
    double centre = 0.0;
    for (int i = 0; i < kCount; ++i) centre += x[i] / kCount;
    const double pull = kSpacing * (kCount - 1) / 2.0 + 0.2 * t - centre;
    for (int i = 0; i < kCount; ++i) {
      double force = pull / kCount - 0.1 * v[i] + 0.05 * kTau * std::sin(kTau * x[i]);
      if (i > 0) force -= x[i] - x[i - 1] - kSpacing;
      if (i + 1 < kCount) force += x[i + 1] - x[i] - kSpacing;
      slope[i] = v[i];
      slope[kCount + i] = force;
    }
    slope[2 * kCount] = pull;
  };
  p.start.assign(2 * kCount + 1, 0.0);
  for (int i = 0; i < kCount; ++i) p.start[i] = kSpacing * i;
  p.seen = [](const std::vector<double>& y) {
    double centre = 0.0;
    double speed = 0.0;
    for (int i = 0; i < kCount; ++i) {
      centre += y[i] / kCount;
      speed += y[kCount + i] / kCount;
    }
    return std::vector{centre, speed, y[2 * kCount] / 20.0};
  };
  p.found = [](const RunResult& r) {
    return std::vector{r.body(0)["centre_of_mass"][0], r.body(0)["velocity"][0],
                       r.driver(0)["mean_force"][0]};
  };
  return p;
}

std::vector<double> by_cvode(const Problem& problem, int method) {
  Cvode cvode(problem.equations, problem.start, method, kCvodeTolerance);
  return problem.seen(cvode.at(problem.duration));
}

TEST(Cvode, AgreesWithEveryAdaptiveScheme) {
  for (const Problem& problem : {tip(), ring(), chain()}) {
    const std::vector<double> adams = by_cvode(problem, CV_ADAMS);
    EXPECT_LT(largest_difference(adams, by_cvode(problem, CV_BDF)), kCvodeAllowed) << problem.what;
    for (const auto& record : standard().integrators()) {
      if (!record->adaptive || record->follows_equilibria || record->conservative_only) continue;
      const RunResult run = run_text(problem.scene + adaptive(kTolerance, record->name));
      ASSERT_EQ(run.status, RunStatus::finished) << record->name;
      EXPECT_LT(largest_difference(problem.found(run), adams), kAllowed)
          << record->name << ", " << problem.what;
    }
  }
}

TEST(Cvode, AnotherParameterIsSeen) {
  Problem other = tip();
  const std::string key = "coefficient = 1.0";
  other.scene.replace(other.scene.find(key), key.size(), "coefficient = 1.0001");
  const RunResult run = run_text(other.scene + adaptive(kTolerance));
  EXPECT_GT(largest_difference(other.found(run), by_cvode(other, CV_ADAMS)), kAllowed);
}

#else

TEST(Cvode, AgreesWithEveryAdaptiveScheme) {
  GTEST_SKIP() << "SUNDIALS' CVODE was not found when this was configured";
}

#endif

}  // namespace
}  // namespace tomlin::test
