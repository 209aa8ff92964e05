#include "framework/study/tradeoff/sensitivity.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include <fmt/format.h>

#include "framework/core/numbers/math.hpp"
#include "framework/scene/natural_units.hpp"

namespace tomlin {
namespace {

constexpr double kSizesOfNoise[] = {1e-12, 1e-9};
constexpr std::uint64_t kRunsOfEachSize = 2;
constexpr double kShareOfBudget = 0.2;
constexpr double kMostDigits = 17.0;  // of a double
constexpr double kLog10 = 2.302585092994046;
/// A spread of more integration errors than this has another cause.
constexpr double kIntegrationErrors = 10.0;

/// Noise on every body's start.
Perturbation noise_on(const Scene& scene, double size, std::uint64_t stream) {
  Perturbation noise;
  noise.bodies.resize(scene.bodies.size());
  std::iota(noise.bodies.begin(), noise.bodies.end(), std::size_t{0});
  noise.size = size;
  noise.seed = static_cast<std::uint64_t>(scene.run.seed);
  noise.stream = stream;
  return noise;
}

const Method& named(const std::vector<Method>& methods, const std::string& name) {
  return *std::find_if(methods.begin(), methods.end(),
                       [&name](const Method& method) { return method.name == name; });
}

void judge(Sensitivity& found, const Reference& reference, double tolerance) {
  const ErrorScale scale = error_scale(reference);
  const double largest = std::max(std::abs(found.min), std::abs(found.max));
  if (found.spread <= 0.0) {
    found.digits = kMostDigits;
  } else if (largest > 0.0) {
    found.digits = std::clamp(log(largest / found.spread) / kLog10, 0.0, kMostDigits);
  }
  // An error that no tightening makes smaller is no error of the steps.
  const bool of_the_steps = reference.settled || !reference.finest;
  const bool beyond_errors =
      !of_the_steps || found.spread > kIntegrationErrors * found.integration_error;
  if (scale.resolved && found.spread <= tolerance * scale.size) {
    found.verdict = Sensitivity::Verdict::determined;
  } else if (beyond_errors && found.spread > tolerance * std::abs(reference.value)) {
    found.verdict = Sensitivity::Verdict::not_determined;
  } else if (!scale.resolved) {
    found.why = "the reference is not resolved";
  } else {
    found.why = fmt::format("the spread {:.2g} is no larger than ten estimated errors, {:.2g}",
                            found.spread, kIntegrationErrors * found.integration_error);
  }
}

}  // namespace

Sensitivity find_sensitivity(const Variants& variants, const std::vector<Method>& methods,
                             const Reference& reference, Measurer& measurer, double tolerance) {
  Sensitivity found;
  const Scene& scene = variants.scene();
  const Method& method = named(methods, reference.method);
  const double until = measurer.used() + kShareOfBudget * measurer.budget();
  found.min = found.max = reference.value;
  found.integration_error = reference.move;
  std::uint64_t stream = 0;
  for (const double size : kSizesOfNoise) {
    for (std::uint64_t seed = 0; seed < kRunsOfEachSize; ++seed) {
      const double disturbed = size * natural_units(scene).length;
      const Measurement run =
          measurer.with(method.at(reference.resolution_value), until - measurer.used(),
                        noise_on(scene, disturbed, ++stream));
      if (!run.defined()) {
        found.why = run.why;
        continue;
      }
      found.sizes.push_back(disturbed);
      found.values.push_back(*run.value);
      found.min = std::min(found.min, *run.value);
      found.max = std::max(found.max, *run.value);
    }
  }
  found.spread = found.max - found.min;
  if (!found.values.empty()) judge(found, reference, tolerance);
  return found;
}

}  // namespace tomlin
