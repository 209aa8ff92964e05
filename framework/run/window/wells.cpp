#include "framework/run/window/wells.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace tomlin {
namespace {

/// Looks along a period, and times over the run for energies that change.
constexpr int kPointsOfPeriod = 64;
constexpr int kTimesOfRun = 8;
/// Differences of the energy below this part of it are rounding.
constexpr double kRoundingOfEnergy = 1e-10;

/// The only axis that a driver pulls along; -1: there is none.
int axis_of(const Drive& drive) {
  int axis = -1;
  for (std::size_t d = 0; d < drive.velocity.size(); ++d) {
    if (drive.velocity[d] == 0.0) continue;
    if (axis >= 0) return -1;
    axis = static_cast<int>(d);
  }
  return axis;
}

}  // namespace

std::optional<WellOfBody> well_of_body(Model& model, std::size_t body, const Model::Driver& driver,
                                       double period, const DoubleDouble& since, double duration) {
  const Model::Body& pulled = model.bodies()[body];
  const BodySlot<double>& slot = pulled.bound.slot;
  const int axis = axis_of(*driver.drive);
  if (axis < 0 || (slot.mapped && !slot.rigid)) return {};

  SystemView<double>& view = model.system().view;
  std::vector<double> rates(view.rates + 2 * kGroup, 0.0);
  model.evaluate_at(since, view.position, view.velocity, view.integrals, rates.data());
  const double stiffness = driver.drive->stiffness_on(axis);
  const double stretch = rates[static_cast<std::size_t>(driver.first_rate + axis)] / stiffness;
  // All that moves with the body.
  const auto d = static_cast<std::size_t>(axis);
  double* first = view.position + (slot.rigid ? slot.centre + d : slot.offset + d * slot.stride);
  const std::vector<double> starts(first, first + (slot.rigid ? 1 : slot.count));

  double deepest = 0.0;
  std::optional<double> distance;
  const double step = period / kPointsOfPeriod;
  std::vector<double> energy(kPointsOfPeriod + 2);  // but for the spring's
  for (int k = 0; k < kTimesOfRun; ++k) {
    const double later = (duration - static_cast<double>(since)) * k / kTimesOfRun;
    const double pull = stretch + driver.drive->velocity[static_cast<std::size_t>(axis)] * later;
    double size = 0.0;
    for (std::size_t i = 0; i < energy.size(); ++i) {
      const double moved = step * static_cast<double>(i);
      for (std::size_t n = 0; n < starts.size(); ++n) first[n] = starts[n] + moved;
      const double spring = 0.5 * stiffness * (pull - moved) * (pull - moved);
      const double all =
          model.potential_energy(since + later, view.position, view.velocity, view.integrals);
      energy[i] = all - spring;
      size = std::max({size, std::abs(all), spring});
    }
    std::copy(starts.begin(), starts.end(), first);
    // A steady force tilts it.
    const double tilt = (energy[kPointsOfPeriod] - energy[0]) / kPointsOfPeriod;
    for (std::size_t i = 0; i < energy.size(); ++i) energy[i] -= tilt * static_cast<double>(i);
    const auto [low, high] = std::minmax_element(energy.begin(), energy.end());
    const double depth = *high - *low;
    if (!(depth > kRoundingOfEnergy * size) || depth <= deepest) continue;
    double concave = 0.0;
    for (std::size_t i = 1; i + 1 < energy.size(); ++i) {
      concave = std::max(concave, 2.0 * energy[i] - energy[i - 1] - energy[i + 1]);
    }
    if (!(concave > stiffness * step * step)) continue;
    deepest = depth;
    distance = step * static_cast<double>(low - energy.begin());
  }
  model.anchor(since);
  if (!distance) return {};
  const bool forwards = driver.drive->velocity[d] > 0.0;
  const bool held = slot.rigid && !pulled.has_free_rotation();
  return WellOfBody{forwards ? *distance : -*distance, held || (slot.count == 1 && !slot.mapped)};
}

}  // namespace tomlin
