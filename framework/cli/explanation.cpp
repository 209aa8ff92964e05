#include "framework/cli/explanation.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "framework/core/records/force.hpp"
#include "framework/core/system/instruction_set.hpp"
#include "framework/core/text/axis_names.hpp"
#include "framework/model/model.hpp"
#include "framework/run/guard/trial.hpp"
#include "framework/run/steps/lane_batch.hpp"
#include "framework/scene/engine_units.hpp"

namespace tomlin {
namespace {

/// A rest shorter than this part of a step is no step.
constexpr double kNoStep = 1e-9;

/// Coordinates of a body, and those of them that may move.
void count_coordinates(Model& model, std::size_t b, Explanation::Body& body) {
  const auto& slot = model.bodies()[b].bound.slot;
  const double* inverse_mass = model.system().view.inverse_mass;
  const auto count = [&](std::size_t at) {
    ++body.coordinate_count;
    if (inverse_mass[at] > 0.0) ++body.degrees_of_freedom;
  };
  const auto axes = static_cast<std::size_t>(model.dimension());
  if (slot.rigid) {
    const std::size_t rotations = model.bodies()[b].rotor ? 3 : 1;
    for (std::size_t k = 0; k < axes + rotations; ++k) count(slot.centre + k);
    // A rod does not turn about itself.
    if (model.bodies()[b].rotor) {
      body.degrees_of_freedom = static_cast<std::size_t>(model.bodies()[b].bound.freedom);
    }
  } else if (!slot.mapped) {
    for (std::size_t d = 0; d < axes; ++d) {
      for (std::size_t i = 0; i < slot.count; ++i) count(slot.offset + d * slot.stride + i);
    }
  }
}

void add_built(Explanation& explanation, Model& model) {
  const Scene& scene = *explanation.scene;
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const Model::Body& from = model.bodies()[b];
    Explanation::Body body;
    body.name = from.bound.name;
    body.type = scene.bodies[b].record->name;
    body.coordinates = from.bound.coordinates;
    body.particles = from.bound.slot.count;
    body.mass = scene_number(from.total_mass, scene_unit(scene.units, dimension::mass));
    body.rolling_radius = from.rolling_radius;
    body.note = scene.bodies[b].record->note(scene.bodies[b].description.get());
    count_coordinates(model, b, body);
    explanation.bodies.push_back(std::move(body));
  }
  for (const Model::Force& from : model.forces()) {
    Explanation::Force force{from.name, from.record->name, {}, {}, {}, {}};
    for (const SceneForce& force_of_scene : scene.forces) {
      if (force_of_scene.name != from.name) continue;
      force.element = element_of(*from.record, force_of_scene.description.get());
      force.note = from.record->note(force_of_scene.description.get());
    }
    const auto add_note = [&force](const std::string& more) {
      if (!more.empty()) force.note += (force.note.empty() ? "" : "; ") + more;
    };
    add_note(from.diagnosis->note());
    if (from.given->active) {
      const double time = scene_unit(scene.units, dimension::time);
      const auto& until = from.given->active->until;
      add_note(fmt::format("active from {:g} {}", scene_number(from.given->active->from, time),
                           until ? fmt::format("until {:g}", scene_number(*until, time))
                                 : std::string("to the end")));
    }
    for (const std::size_t b : from.bodies) force.bodies.push_back(scene.bodies[b].name);
    explanation.forces.push_back(std::move(force));
  }
  for (const Model::LeftOut& left : model.left_out()) {
    explanation.left_out.emplace_back(left.force, left.why);
  }
}

/// Reports whether there are drivers, and which other forces change with time and do work.
Explanation::Part driver_part(const Model& model) {
  const bool driven = !model.drivers().empty();
  std::string timed;
  for (const Model::Force& force : model.forces()) {
    if (!force.traits.depends_on_time || force.drive() != nullptr) continue;
    timed += (timed.empty() ? "" : ", ") + force.name;
  }
  std::string note = driven ? "the force and the power of every driver" : "no driver";
  if (timed.empty()) {
    if (!driven) note = "nothing does work";
  } else {
    note += fmt::format("; {} changes with time and does work, which the energy ledger has", timed);
  }
  return {"driver integrals", driven, std::move(note)};
}

void add_parts(Explanation& explanation, const Model& model) {
  const Scene& scene = *explanation.scene;
  auto& parts = explanation.parts;
  bool random = false;
  for (const Model::Force& force : model.forces()) {
    random = random || force.traits.stochastic;
  }
  parts.push_back(driver_part(model));
  std::string cells;
  for (int axis = 0; axis < model.dimension(); ++axis) {
    const double unit = model.origin().unit[axis];
    if (!(unit > 0.0)) continue;
    cells += fmt::format("{}{:g} along {}", cells.empty() ? "" : ", ", unit, kAxisNames[axis]);
  }
  parts.push_back({"moving origin", !cells.empty(),
                   cells.empty() ? "no force declares a period" : "cells of " + cells});
  parts.push_back({"energy ledger", scene.run.ledger,
                   scene.run.ledger ? "work, heat, stored energy, and what does not balance"
                                    : "run.ledger = true keeps it"});
  parts.push_back({"random numbers", random,
                   random ? fmt::format("seed {}", scene.run.seed) : "no force is stochastic"});
  const bool samples = scene.output.every.has_value();
  parts.push_back(
      {"samples", samples,
       samples ? fmt::format("every {:g}: {:.6g} rows", *scene.output.every,
                             std::floor(scene.run.duration / *scene.output.every + kNoStep) + 1)
               : "output.every = INTERVAL takes them"});
  const std::string alone = why_not_in_lanes(model);
  // Schemes that take steps of single particles on a line in registers show all of them.
  const bool shows_steps = scene.run.integrator.record->lane_block != nullptr &&
                           model.system().view.point_force_count > 0;
  parts.push_back(
      {"lanes", alone.empty(),
       !alone.empty() ? alone
       : shows_steps
           ? "in a sweep and of repeats"
           : "in a sweep and of repeats, for observables that are no extremes or events"});
  parts.push_back({"trajectory", scene.output.trajectory, "output.trajectory = true writes it"});
}

/// Counts neighbours at the start: an evaluation makes the lists. Forces are in the model's order.
void count_neighbours(Explanation& explanation, Model& model) {
  std::vector<const CountsNeighbours*> lists;
  for (const Model::Force& force : model.forces()) {
    lists.push_back(dynamic_cast<const CountsNeighbours*>(force.bound.get()));
  }
  if (std::all_of(lists.begin(), lists.end(), [](const auto* list) { return list == nullptr; }))
    return;
  StateLayout layout;
  model.declare(layout);
  RunState state(layout);
  model.attach(state);
  model.start();
  const SystemView<double>& view = model.system().view;
  AlignedVector<double> rates(view.rates + 2 * kGroup, 0.0);
  model.evaluate_at(DoubleDouble(0.0), view.position, view.velocity, view.integrals, rates.data());
  for (std::size_t k = 0; k < lists.size(); ++k) {
    if (lists[k] != nullptr) explanation.forces[k].neighbours = lists[k]->count_neighbours();
  }
}

Explanation::Step step_of(const Scene& scene, const Trial& trial) {
  const SceneIntegrator& integrator = scene.run.integrator;
  Explanation::Step step;
  step.type = integrator.record->name;
  step.adaptive = integrator.record->adaptive;
  step.accuracy = scene.run.accuracy;
  step.dt = integrator.record->step(integrator.description.get());
  step.stable_step = trial.stable_step;
  step.stable = trial.step_is_stable;
  return step;
}

/// The trial, stretched to the whole run.
std::optional<Explanation::Cost> cost_of(const Scene& scene, const Explanation::Step& step,
                                         const Trial& trial) {
  if (trial.steps == 0 || trial.failure) return std::nullopt;
  const double tried = static_cast<double>(trial.steps);
  Explanation::Cost cost;
  cost.exact = trial.finished;
  cost.part = trial.time / scene.run.duration;
  cost.steps = trial.finished  ? tried
               : step.adaptive ? tried / cost.part
                               : std::ceil(scene.run.duration / step.dt - kNoStep);
  cost.evaluations = cost.steps * static_cast<double>(trial.evaluations) / tried;
  cost.seconds = cost.steps * trial.seconds / tried;
  cost.instruction_set = to_string(chosen_instruction_set());
  return cost;
}

/// Adds a warning where `tomlin run` would refuse the size of the output.
void add_warning_of_room(Explanation& explanation) {
  try {
    require_room(*explanation.scene, explanation.output.size, explanation.output.room);
  } catch (const InputError& error) {
    for (const Fault& fault : error.faults()) {
      explanation.warnings.push_back(
          {fault.code,
           fmt::format("the run is refused: {}; expected: {}", fault.why, fault.admissible),
           "output.every"});
    }
  }
}

}  // namespace

Explanation explain(const std::shared_ptr<const Scene>& scene, double trial_seconds) {
  Explanation explanation;
  explanation.scene = scene;
  Model model(scene);
  add_built(explanation, model);
  add_parts(explanation, model);
  count_neighbours(explanation, model);
  explanation.scales = scales_of(scene);
  const Trial trial = try_out(scene, trial_seconds);
  explanation.step = step_of(*scene, trial);
  explanation.cost = cost_of(*scene, explanation.step, trial);
  explanation.output = {output_size(*scene, trial.layout), trial.layout.events, room_in(".")};
  add_warning_of_room(explanation);
  if (!explanation.step.stable) {
    const bool allowed = scene->run.allow_unstable;
    explanation.warnings.push_back(
        {allowed ? FaultCode::integrator_beyond_stability : FaultCode::run_step_unstable,
         fmt::format(
             "dt = {:g} is beyond the stable step {:.4g}: {}", explanation.step.dt,
             explanation.step.stable_step,
             allowed ? "the run will probably fail" : "the run is refused; take a smaller dt"),
         "run.integrator.dt"});
  }
  if (trial.failure) {
    explanation.warnings.push_back(
        {*trial.failure, "a step of the trial failed: run says why", "run.integrator"});
  }
  return explanation;
}

}  // namespace tomlin
