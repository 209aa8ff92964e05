#include "framework/run/observers/total_forces.hpp"

#include <algorithm>
#include <set>

#include "framework/model/force_twin.hpp"

namespace tomlin::observers {

TotalForces::TotalForces(const ObserverParts& parts) : parts_(parts) {
  const Model& model = parts.run.model;
  if (parts.selection.is_all()) return;
  for (const Model::Force& force : model.forces()) list_bodies_of(force);
  if (pairs_.empty()) return;
  std::size_t mapped = 0;
  for (const Model::Body& body : model.bodies()) {
    const BodySlot<double>& slot = body.bound.slot;
    if (slot.mapped) mapped = std::max(mapped, slot.offset + slot.stride * parts.axes());
  }
  force_.assign(model.system().view.dofs + 2 * kGroup, 0.0);
  mapped_force_.assign(mapped + 2 * kGroup, 0.0);
  rates_.assign(model.system().view.rates + 2 * kGroup, 0.0);
}

void TotalForces::list_bodies_of(const Model::Force& force) {
  const auto& acts_on = force.bodies;
  if (std::none_of(acts_on.begin(), acts_on.end(),
                   [&](std::size_t b) { return wants(force, b); })) {
    return;
  }
  const std::vector<Pass<double>> passes = force.own_passes();
  std::set<std::size_t> bodies;
  for (const Pass<double>& pass : passes) {
    for (const Region& region : pass.writes) bodies.insert(region.body);
  }
  for (const std::size_t body : bodies) {
    if (!wants(force, body)) continue;
    pairs_.push_back({&force, body, passes});
    names_.push_back(name_of(force, body));
  }
}

std::string TotalForces::name_of(const Model::Force& force, std::size_t body) const {
  return force.name + ".on." + parts_.run.model.bodies()[body].bound.name;
}

bool TotalForces::wants(const Model::Force& force, std::size_t body) const {
  const std::string name = name_of(force, body);
  const auto keys = {"mean_force", "max_force", "min_force", "final_force"};
  return std::any_of(keys.begin(), keys.end(),
                     [&](const char* key) { return parts_.selection.wants("forces", name, key); });
}

void TotalForces::evaluate(const RunMoment& moment,
                           const std::function<void(std::size_t, std::size_t, double)>& take) {
  const SystemView<double>& view = parts_.run.model.system().view;
  // No force reads velocities of rigid bodies' particles where friction is an operator.
  place_velocities(parts_.run.model.bodies(), parts_.run.model.dimension(), moment.position,
                   moment.velocity, view.mapped_velocity);
  Stage<double> stage = stage_of(view, moment.position, moment.velocity, moment.integrals,
                                 rates_.data(), moment.elapsed);
  stage.force = force_.data();
  stage.mapped_force = mapped_force_.data();
  const Model::Force* last = nullptr;
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const Pair& pair = pairs_[k];
    if (pair.force != last) {
      std::fill(force_.begin(), force_.end(), 0.0);
      std::fill(mapped_force_.begin(), mapped_force_.end(), 0.0);
      for (const Pass<double>& pass : pair.passes) pass.add(pass.arguments, stage);
      last = pair.force;
    }
    for (std::size_t d = 0; d < parts_.axes(); ++d) take(k, d, total_on(pair.body, d));
  }
}

/// Particles' shares, and what acts on a rigid body's centre.
double TotalForces::total_on(std::size_t body, std::size_t axis) const {
  const BodySlot<double>& slot = parts_.run.model.bodies()[body].bound.slot;
  const AlignedVector<double>& forces = slot.mapped ? mapped_force_ : force_;
  const double* first = forces.data() + slot.offset + axis * slot.stride;
  double total = slot.rigid ? force_[slot.centre + axis] : 0.0;
  for (std::size_t i = 0; i < slot.count; ++i) total += first[i];
  return total;
}

}  // namespace tomlin::observers
