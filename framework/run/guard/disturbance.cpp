#include "framework/run/guard/disturbance.hpp"

#include <algorithm>

#include "framework/core/numbers/random.hpp"
#include "framework/core/system/tolerance.hpp"
#include "framework/model/stability.hpp"

namespace tomlin {
namespace {

/// The numbers that runs from disturbed starts draw beside those of their starts.
constexpr std::uint64_t kDrawOfDisturbance = 7;

}  // namespace

/// Runs in other precisions keep their state elsewhere: their disturbances are those of the start.
double memory_of_disturbances(Model& model) {
  if (model.scene().run.number_type != NumberType::double_precision) return 0.0;
  const Stiffness rates = stiffness_of(model);
  const double fastest = model.system().view.inertial ? rates.damping_rate : rates.relaxation_rate;
  return fastest > 0.0 ? 1.0 / fastest : 0.0;
}

void disturb(const Perturbation& noise, std::uint64_t moment, Model& model) {
  const SystemView<double>& view = model.system().view;
  const auto displace = [&](std::size_t k) {
    if (view.inverse_mass[k] == 0.0) return;
    view.position[k] +=
        noise.size / tolerance_scales(view).in_units[k] *
        uniform_symmetric({noise.seed, noise.stream}, {k, kDrawOfDisturbance, moment, 0});
  };
  for (const Model::Body& body : model.bodies()) {
    const auto& meant = noise.bodies;
    if (std::find(meant.begin(), meant.end(), body.bound.index) == meant.end()) continue;
    const BodySlot<double>& slot = body.bound.slot;
    for (int d = 0; d < model.dimension(); ++d) {
      if (slot.rigid) {
        displace(slot.centre + d);
      } else if (!slot.mapped) {
        for (std::size_t i = 0; i < slot.count; ++i) displace(slot.offset + d * slot.stride + i);
      }
    }
    for (std::size_t d = 3; body.rotor && d < 6; ++d) displace(slot.centre + d);
    if (slot.rigid && model.dimension() == 2) displace(slot.centre + kRotation);
  }
}

}  // namespace tomlin
