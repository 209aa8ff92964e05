#include "framework/run/observers/shown_scene.hpp"

#include <cmath>
#include <set>
#include <stdexcept>

#include "framework/scene/text.hpp"

namespace tomlin::observers {

ShownScene::ShownScene(const ObserverParts& parts) : parts_(parts) {
  for (const Model::Body& body : parts.run.model.bodies()) {
    positions_.emplace_back(body.bound.slot.count * parts.axes());
    velocities_.emplace_back(body.bound.slot.count * parts.axes());
  }
  const std::vector<Model::Driver>& drivers = parts.signals.drivers();
  forces_.resize(drivers.size() * parts.axes());
  for (std::size_t k = 0; k < drivers.size(); ++k) {
    drivers_.push_back({drivers[k].name, {forces_.data() + k * parts.axes(), parts.axes()}});
  }
}

void ShownScene::look(const RunMoment& moment) {
  const Model& model = parts_.run.model;
  const std::size_t axes = parts_.axes();
  const SystemView<double>& view = model.system().view;
  time_ = moment.time;
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const BodySlot<double>& slot = model.bodies()[b].bound.slot;
    model.place_particles(b, moment.position, positions_[b].data());
    const double* from = (slot.mapped ? view.mapped_velocity : moment.velocity) + slot.offset;
    for (std::size_t i = 0; i < slot.count; ++i) {
      for (std::size_t d = 0; d < axes; ++d) {
        velocities_[b][i * axes + d] = from[d * slot.stride + i];
      }
    }
  }
  parts_.signals.write_forces(moment.rates, forces_.data());
}

ObservedMoment ShownScene::to(const SceneObserver& observer) {
  bodies_.clear();
  for (const std::size_t b : observer.bodies) {
    const BoundBody<double>& body = parts_.run.model.bodies()[b].bound;
    bodies_.push_back({body.name, body.mass, positions_[b], velocities_[b]});
  }
  return {time_, parts_.run.model.dimension(), bodies_, drivers_};
}

SceneOutline outline_of(const SceneObserver& observer, const Model& model) {
  SceneOutline outline;
  outline.dimension = model.dimension();
  for (const std::size_t b : observer.bodies) {
    const BoundBody<double>& body = model.bodies()[b].bound;
    outline.bodies.push_back(
        {body.name, static_cast<std::int64_t>(body.slot.count), body.closed, body.neighbours});
  }
  return outline;
}

std::vector<ObservedNumber> listed(const SceneObserver& observer, const SceneOutline& outline,
                                   std::vector<ObservedNumber> (*list)(const void*,
                                                                       const SceneOutline&)) {
  if (list == nullptr) return {};
  std::vector<ObservedNumber> numbers = list(observer.description.get(), outline);
  std::set<std::string> names;
  for (const ObservedNumber& number : numbers) {
    if (!is_component_name(number.name) || !names.insert(number.name).second) {
      throw std::invalid_argument("\"" + number.name +
                                  "\" is not a valid name of a number, or is declared twice");
    }
  }
  if (numbers.empty()) throw std::invalid_argument("it gives no numbers");
  return numbers;
}

/// A table, and a sum, has no room for what is no number.
bool are_finite(RunContext& run, const SceneObserver& observer,
                const std::vector<ObservedNumber>& names, const double* numbers) {
  for (const ObservedNumber& number : names) {
    if (std::isfinite(*numbers++)) continue;
    RunFailure failure;
    failure.code = FaultCode::observable_undefined;
    failure.step = static_cast<std::uint64_t>(run.clock.steps());
    failure.time = run.clock.time();
    failure.what = "the observer " + observer.name + " gives " + number.name +
                   ", which is not a finite number";
    failure.cause = "what it looks at, or its code";
    if (!run.outcome.failure) run.outcome.failure = std::move(failure);
    return false;
  }
  return true;
}

}  // namespace tomlin::observers
