#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/scenarios/rigid_ring.hpp"
#include "tests/scenarios/scenario_fixture.hpp"
#include "tests/scenarios/trace.hpp"

/// Fixture of the tests of the figures of Sircar and Patra.
namespace tomlin::test {

inline constexpr int kParticles = 8;
inline constexpr double kDamping = 2.8284271247461903;  // 2 sqrt(2)

/// Keeps a ring from turning.
inline const Setting kHeld = {"body.ring.hold", "[\"rotation\"]"};

inline double turns(const RunResult& result) { return *result.body(0)["turns"]; }
inline double max_speed(const RunResult& result) { return *result.body(0)["max_speed"]; }

/// Sum over the ring of exp(-b y^2) exp(i 2 pi x/a), per particle: the share of the corrugation
/// that a ring feels at rest at its height, not turned. Mass and lattice period are 1.
inline std::complex<double> share(int count, double radius, double b = 0.0) {
  std::complex<double> sum = 0.0;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * kPi * i / count;
    const double y = radius * (1.0 + std::sin(angle));
    sum += std::exp(std::complex<double>(-b * y * y, 2.0 * kPi * radius * std::cos(angle)));
  }
  return sum / static_cast<double>(count);
}

/// A short form of a scene: its first two periods, with the trace.
inline Trace two_periods(const char* scene, std::vector<Setting> settings) {
  settings.insert(settings.end(), {{"run.duration", "2 * a / v"},
                                   {"measure.from", "0"},
                                   {"measure.to", "2"},
                                   {"output.every", "0.01 * a / v"}});
  Trace trace;
  run_shipped(scene, settings, &trace);
  return trace;
}

/// Largest difference of a trace to the same ring moved by hand, over positions, rotation and
/// forces.
inline double difference_to(const std::vector<RigidRing::Sample>& samples, const Trace& trace) {
  double largest = 0.0;
  const auto look = [&](const char* column, double RigidRing::Sample::*quantity) {
    const auto& values = trace[column];
    for (std::size_t n = 0; n < samples.size(); ++n) {
      largest = std::max(largest, std::abs(values[n] - samples[n].*quantity));
    }
  };
  look("ring.centre_of_mass.x", &RigidRing::Sample::x);
  look("ring.centre_of_mass.y", &RigidRing::Sample::y);
  look("ring.rotation", &RigidRing::Sample::rotation);
  look("driver.force.x", &RigidRing::Sample::force_x);
  look("driver.force.y", &RigidRing::Sample::force_y);
  look("driver.position.x", &RigidRing::Sample::driver);
  return largest;
}

/// Takes a trace that is sampled each hundredth of a period, with `steps` between samples.
inline double difference_to(const RigidRing& ring, const Trace& trace, int steps) {
  const auto intervals = static_cast<int>(trace["time"].size()) - 1;
  return difference_to(ring.trace(intervals, 0.01 / ring.velocity, steps), trace);
}

// Runs at 1e-10 per step, by hand at 2e-2 and less per step of fourth order; a slip, where
// positions change by 0.1 per unit of time, turns an error of its moment into one of position.
inline constexpr double kSameTrace = 2e-6;

/// The samples of one period in a run of `periods`: 0 is the first.
inline std::vector<double> period(const std::vector<double>& column, int periods, int which) {
  const auto length = static_cast<std::ptrdiff_t>(column.size() - 1) / periods;
  const auto first = column.begin() + which * length;
  return {first, first + length + 1};
}

}  // namespace tomlin::test
