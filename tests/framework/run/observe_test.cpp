#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/numbers/random.hpp"
#include "framework/run/events/extremes.hpp"
#include "tests/support/ring_scenes.hpp"

// Extremes, static forces, and rotations that go round many times.

namespace tomlin::test {
namespace {

/// Column of a finely sampled run.
std::vector<double> column(const KeptSamples& kept, const std::string& name) {
  std::vector<double> values;
  for (const auto& row : kept.rows) values.push_back(row[kept.column(name)]);
  return values;
}

constexpr double kSampling = 1e-3;

/// The tip in stick-slip, sampled at every step of a fine run: heights by mere comparison.
struct Reference {
  double high = 0.0, low = 0.0, held = 0.0, speed = 0.0;
};

Reference reference_of(TipScene tip, double from, double to) {
  tip.integrator = fixed_step(kSampling);
  tip.more = "[output]\nevery = " + digits(kSampling) + "\n";
  KeptSamples kept;
  run(scene_of(tip.text()), watched_by(kept));
  const std::vector<double> time = column(kept, "time");
  const std::vector<double> force = column(kept, "driver.force.x");
  const std::vector<double> velocity = column(kept, "tip.velocity.x");
  Reference reference{-1e300, 1e300, 0.0, 0.0};
  for (std::size_t k = 0; k < time.size(); ++k) {
    if (time[k] < from || time[k] > to) continue;
    reference.high = std::max(reference.high, force[k]);
    reference.low = std::min(reference.low, force[k]);
    reference.speed = std::max(reference.speed, std::abs(velocity[k]));
  }
  // Before the first slip: what falls by more than swings in a well do.
  const double fall = 0.25 * tip.stiffness * tip.period;
  for (std::size_t k = 0; k < force.size() && force[k] > reference.held - fall; ++k) {
    reference.held = std::max(reference.held, force[k]);
  }
  return reference;
}

TEST(Extremes, AreThoseOfTheCurveNotOfTheSteps) {
  // A peak of curvature ~ omega^2 seen through a parabola over steps h: the error is of third
  // order, (omega h)^3 with omega about 3, on forces of about 1. Long adaptive steps are looked
  // into by dense output. The reference itself misses peaks by omega^2 (1e-3/2)^2/2, some 1e-6 at
  // most.
  const TipScene tip{.duration = 20.0};
  const Reference reference = reference_of(tip, 8.0, 18.0);
  struct Setting {
    std::string integrator;
    double tolerance;
  };
  for (const Setting& setting : {Setting{fixed_step(0.01), 3e-6}, Setting{fixed_step(0.05), 4e-4},
                                 Setting{adaptive(1e-8), 1e-6}}) {
    SCOPED_TRACE(setting.integrator);
    TipScene coarse = tip;
    coarse.integrator = setting.integrator;
    coarse.more = "[measure]\nin = \"time\"\nfrom = 8.0\nto = 18.0\n";
    const RunResult result = run_text(coarse.text());
    EXPECT_NEAR(result.driver(0)["max_force"][0], reference.high, setting.tolerance);
    EXPECT_NEAR(result.driver(0)["min_force"][0], reference.low, setting.tolerance);
    EXPECT_NEAR(*result.body(0)["max_speed"], reference.speed, setting.tolerance);
    EXPECT_NEAR(*result.driver(0)["static_force"], reference.held, setting.tolerance);
  }
}

/// The window's edges count, and what is outside does not.
TEST(Extremes, AreOfTheWindow) {
  TipScene tip{.duration = 20.0};
  // While the tip sticks the force only rises: extremes are at the edges.
  const Reference reference = reference_of(tip, 1.0, 1.5);
  tip.more = "[measure]\nin = \"time\"\nfrom = 1.0\nto = 1.5\n";
  const RunResult result = run_text(tip.text());
  constexpr double kDense = 1e-8;  // Hermite at steps of 0.01, and the reference's own samples
  EXPECT_NEAR(result.driver(0)["max_force"][0], reference.high, kDense);
  EXPECT_NEAR(result.driver(0)["min_force"][0], reference.low, kDense);
  EXPECT_LT(result.driver(0)["max_force"][0], *result.driver(0)["static_force"]);
}

/// Adaptive steps do not end at the window's edges: a peak within counts, one outside does not.
TEST(Extremes, PeaksBesideTheWindowsEdges) {
  constexpr double kDense = 2e-6;  // the dense output's error at 1e-8, and the reference's samples
  const TipScene tip{.duration = 20.0};
  for (int shift = 0; shift < 16; ++shift) {
    const double from = 8.0 + 0.13 * shift;
    const double to = from + 0.9;
    SCOPED_TRACE(from);
    const Reference reference = reference_of(tip, from - 1e-9, to + 1e-9);
    TipScene long_steps = tip;
    long_steps.integrator = adaptive(1e-8);
    long_steps.more =
        "[measure]\nin = \"time\"\nfrom = " + digits(from) + "\nto = " + digits(to) + "\n";
    const RunResult result = run_text(long_steps.text());
    EXPECT_NEAR(result.driver(0)["max_force"][0], reference.high, kDense);
    EXPECT_NEAR(result.driver(0)["min_force"][0], reference.low, kDense);
    EXPECT_NEAR(*result.body(0)["max_speed"], reference.speed, kDense);
  }
}

/// Blocks of any length leave the same bits as point by point, in and out of the window.
TEST(Extremes, OfBlocksAreThoseOfTheirPoints) {
  constexpr std::size_t kSignals = 3;
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    StateLayout layout;
    Extremes::declare(layout, kSignals);
    RunState states[] = {RunState(layout), RunState(layout)};
    Extremes both[2];
    for (int k = 0; k < 2; ++k) {
      both[k].attach(states[k], kSignals);
      both[k].start();
    }
    std::size_t step = 0;
    for (std::uint64_t block = 0; block < 400; ++block) {
      const auto random = [&](std::uint64_t k) {
        return uniform_symmetric({seed, 0}, {block, k, 0, 0});
      };
      const auto count = static_cast<std::size_t>(8.5 + 8.4 * random(0));
      const bool inside = random(1) > -0.8;
      std::vector<double> times;
      std::vector<double> values;
      for (std::size_t n = 0; n < count; ++n, ++step) {
        times.push_back(0.01 * static_cast<double>(step));
        // Slow, near its extremes in most blocks; quick; and with jumps.
        values.push_back(std::sin(times.back()));
        values.push_back(std::sin(70.0 * times.back()) + 1e-3 * static_cast<double>(step));
        values.push_back(random(n + 2));
      }
      both[0].add_block(times.data(), values.data(), count, inside);
      for (std::size_t n = 0; n < count; ++n) {
        both[1].add(times[n], values.data() + n * kSignals, inside);
      }
      ASSERT_EQ(states[0].to_bytes(), states[1].to_bytes()) << "block " << block;
    }
  }
}

TEST(Extremes, ACubicIsMeasuredExactly) {
  // Extremes of (t - 0.2) (t - 0.7) integrated: a maximum at 0.2, a minimum at 0.7.
  const auto y = [](double t) { return t * t * t / 3.0 - 0.45 * t * t + 0.14 * t; };
  const CubicExtremes found = cubic_extremes(y(0.0), y(1.0 / 3.0), y(2.0 / 3.0), y(1.0));
  ASSERT_EQ(found.count, 2);
  EXPECT_TRUE(found.is_maximum[0]);
  EXPECT_FALSE(found.is_maximum[1]);
  constexpr double kRounding = 1e-14;
  EXPECT_NEAR(found.theta[0], 0.2, kRounding);
  EXPECT_NEAR(found.theta[1], 0.7, kRounding);
  EXPECT_NEAR(found.value[0], y(0.2), kRounding);
  EXPECT_NEAR(found.value[1], y(0.7), kRounding);
  EXPECT_EQ(cubic_extremes(0.0, 1.0, 2.0, 3.0).count, 0) << "a line has none";
}

TEST(Extremes, AParabolaIsMeasuredExactly) {
  const auto y = [](double t) { return 3.0 - 2.0 * (t - 0.37) * (t - 0.37); };
  EXPECT_NEAR(parabola_vertex(0.1, y(0.1), 0.3, y(0.3), 0.9, y(0.9)), 3.0, 1e-14);
  EXPECT_EQ(parabola_vertex(0.0, 1.0, 1.0, 2.0, 2.0, 3.0), 2.0) << "a line has no vertex";
}

/// Nothing is pulled: there is no static force, rather than a zero.
TEST(Extremes, NoStaticForceWithoutAPull) {
  const TipScene tip{.velocity = 0.0, .duration = 5.0};
  EXPECT_FALSE(run_text(tip.text()).driver(0)["static_force"]);
}

// ---- rotation

/// A free ring that spins: velocity omega times (-y, x) of each particle.
std::string spinning(const std::string& coordinates, double omega, double duration, double dt,
                     double bonds = 1e4) {
  constexpr int kCount = 8;
  std::string velocities;
  for (int i = 0; i < kCount; ++i) {
    const double angle = 2.0 * std::acos(-1.0) * i / kCount;
    velocities += std::string(i > 0 ? ", " : "") + "[" + digits(-omega * std::sin(angle)) + ", " +
                  digits(omega * std::cos(angle)) + "]";
  }
  return "[[body]]\nname = \"ring\"\ntype = \"ring\"\ncount = 8\nradius = 1.0\ncentre = [0.0, "
         "0.0]\n"
         "particle_mass = 0.125\nvelocity = [" +
         velocities + "]\ncoordinates = \"" + coordinates +
         "\"\n[[force]]\ntype = \"harmonic_bonds\"\npairs = \"all\"\nstiffness = " + digits(bonds) +
         "\n[run]\nduration = " + digits(duration) + "\nintegrator = " + fixed_step(dt) + "\n";
}

TEST(Rotation, OfARigidRingIsUnwrapped) {
  constexpr double kRounding = 1e-11;  // 250 turns in 10 000 steps
  for (const double omega : {2.0, -80.0}) {
    const RunResult result = run_text(spinning("rigid", omega, 20.0, 0.002));
    EXPECT_NEAR(*result.body(0)["rotation"], omega * 20.0, kRounding * std::abs(omega * 20.0));
    EXPECT_NEAR(*result.body(0)["turns"], omega * 20.0 / (2.0 * std::acos(-1.0)), 1e-9);
  }
}

TEST(Rotation, OfAFlexibleRingIsUnwrapped) {
  // Spinning stretches the ring by m omega^2/(N k) and so slows it by twice that, as its angular
  // momentum stays: parts of 1e-5 at omega = 2, of 5e-3 at 40; the ring breathes about that.
  for (const double omega : {2.0, -2.0, 40.0}) {
    const double duration = 20.0;
    const RunResult result = run_text(spinning("particles", omega, duration, 2e-4));
    ASSERT_EQ(result.status, RunStatus::finished);
    const double stretch = 0.125 * omega * omega / (8 * 1e4);
    const double turned = *result.body(0)["rotation"] / (omega * duration);
    EXPECT_NEAR(turned, 1.0 - 2.0 * stretch, 0.1 * stretch + 1e-6) << omega;
    EXPECT_NEAR(2.0 * std::acos(-1.0) * *result.body(0)["turns"], *result.body(0)["rotation"],
                1e-9);
  }
}

/// A quarter radian a step: who looks every sixteenth step loses count. The long steps damp the
/// ring's breathing, and its stretch of 1.6 % slows it by about twice that.
TEST(Rotation, OfAFlexibleRingThatTurnsFast) {
  constexpr double kDt = 0.002;
  constexpr double kOmega = 125.0;
  const double duration = 1.0;
  const RunResult result = run_text(spinning("particles", kOmega, duration, kDt, 15625.0));
  ASSERT_EQ(result.status, RunStatus::finished);
  EXPECT_NEAR(*result.body(0)["rotation"] / (kOmega * duration), 1.0, 0.06);
  EXPECT_GT(std::abs(*result.body(0)["turns"]), 18.0);
}

}  // namespace
}  // namespace tomlin::test
