#include "integrators/adaptive.hpp"

#include <algorithm>
#include <vector>

namespace tomlin {
namespace {

double step(const void*) { return 0.0; }

/// If one of the two tolerances is zero, the other rules. (The absolute one is a length: see
/// tolerance_of() in framework/scene/natural_units.hpp.)
double tolerance(const void* description) {
  const auto& d = *static_cast<const AdaptiveDescription*>(description);
  return std::max(d.absolute_tolerance, d.relative_tolerance);
}

std::int64_t most_steps(const void* description) {
  return static_cast<const AdaptiveDescription*>(description)->most_steps;
}

std::vector<Complaint> complaints(const void* description) {
  const auto& d = *static_cast<const AdaptiveDescription*>(description);
  std::vector<Complaint> found;
  if (d.absolute_tolerance == 0.0 && d.relative_tolerance == 0.0) {
    found.push_back({"absolute_tolerance", "one of the two tolerances must not be 0", "> 0"});
  }
  if (d.smallest_step > d.largest_step) {
    found.push_back({"smallest_step", "above largest_step", "<= largest_step"});
  }
  if (d.initial_step > 0.0 && d.initial_step < d.smallest_step) {
    found.push_back({"initial_step", "below smallest_step", ">= smallest_step"});
  }
  return found;
}

}  // namespace

void describe_adaptive(IntegratorRecord& record, double default_tolerance) {
  record.adaptive = true;
  record.make_description = &make_description<AdaptiveDescription>;
  record.parameters = {
      parameter("absolute_tolerance", &AdaptiveDescription::absolute_tolerance, dimension::length,
                "largest error per step of a coordinate; by the scene's time, of a velocity; by "
                "its length, of an angle in rad")
          .in(non_negative)
          .by_default(default_tolerance),
      parameter("relative_tolerance", &AdaptiveDescription::relative_tolerance, dimension::none,
                "largest error per step, relative to each coordinate and velocity")
          .in(non_negative)
          .by_default(default_tolerance),
      parameter("initial_step", &AdaptiveDescription::initial_step, dimension::time,
                "the first step to try; 0: guessed")
          .in(non_negative)
          .by_default(0.0),
      parameter("smallest_step", &AdaptiveDescription::smallest_step, dimension::time,
                "a run that needs less fails")
          .in(positive)
          .by_default(1e-12),
      parameter("largest_step", &AdaptiveDescription::largest_step, dimension::time,
                "never step further")
          .in(positive)
          .by_default(1e300),
      parameter("most_steps", &AdaptiveDescription::most_steps, dimension::none,
                "a run that needs more fails")
          .in(positive)
          .by_default(std::int64_t{1'000'000'000})};
  record.step = &step;
  record.tolerance = &tolerance;
  record.most_steps = &most_steps;
  record.complaints = &complaints;
}

}  // namespace tomlin
