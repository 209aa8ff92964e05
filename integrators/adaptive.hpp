#pragma once

#include <cstdint>

#include "framework/core/records/integrator.hpp"

/// Settings of the schemes that choose their steps.
namespace tomlin {

/// A remainder below this part of a step is taken along with it.
inline constexpr double kStretchOfStep = 1.01;

struct AdaptiveDescription {
  double absolute_tolerance = 0.0;
  double relative_tolerance = 0.0;
  double initial_step = 0.0;
  double smallest_step = 0.0;
  double largest_step = 0.0;
  std::int64_t most_steps = 0;
};

/// Adds what their records share: parameters and their checks, with the default of both tolerances.
void describe_adaptive(IntegratorRecord& record, double default_tolerance);

}  // namespace tomlin
