#include "framework/run/guard/brief_ledger.hpp"

#include <algorithm>

#include "framework/run/context.hpp"

namespace tomlin {
namespace {

/// The velocities of particles that follow a rigid body are computed where a force reads them.
bool has_velocities(const Model& model, const Model::Force& force) {
  return force.traits.depends_on_velocity ||
         std::none_of(force.bodies.begin(), force.bodies.end(),
                      [&](std::size_t body) { return model.bodies()[body].bound.slot.mapped; });
}

/// Schemes of a fixed step that integrate all rates that an evaluation gives.
bool integrates_rates(const RunContext& run) {
  const IntegratorRecord& scheme = run.scheme;
  return scheme.in_lanes && !scheme.adaptive && scheme.library.empty() &&
         run.model.system().view.inertial &&
         run.scene->run.number_type == NumberType::double_precision;
}

}  // namespace

BriefLedger::BriefLedger(RunContext& run) : run_(run) {
  const SystemView<double>& view = run.model.system().view;
  if (!integrates_rates(run)) return;
  splits_friction_ = !run.scheme.takes_any_scene();
  operations_.assign(view.operations, view.operations + view.operation_count);
  points_.assign(view.point_forces, view.point_forces + view.point_force_count);
  dampers_.reserve(points_.size());
  lane_calls_ = run.model.assembly().lane_calls();
  const std::size_t before = points_.empty() ? 0 : 1;  // a point's force stands before its power
  std::size_t rate = view.used_rates + before;
  for (const Model::Force& force : run.model.forces()) {
    Operation<double> heat;
    if (force.is_operator || force.driver) continue;
    if (!force.heat(static_cast<std::ptrdiff_t>(rate), heat)) continue;
    if (!has_velocities(run.model, force)) return;
    // A kick's forces are the rates, at a velocity of half a step before.
    if (splits_friction_ && !force.traits.conservative) return;
    heats_.push_back({rate, force.traits.conservative});
    lane_calls_.push_back(lane_call_of(heat));
    if (before > 0 && add_point(force, rate)) {
      heat = {&write_heat, &dampers_.back()};
    } else {
      points_.clear();
    }
    operations_.push_back(heat);
    rate += 1 + before;
  }
  if (view.flow_count > 0) {
    friction_rate_ = static_cast<std::ptrdiff_t>(rate);
    heats_.push_back({rate, false});
    rate += 1 + before;
  }
  used_rates_ = rate - before;
  const auto is_absent = [](const LaneCall& call) { return call.form.kernel == nullptr; };
  const auto first_heat = run.model.assembly().lane_calls().size();
  const bool is_alone = first_heat == 0 || splits_friction_ ||
                        std::any_of(lane_calls_.begin(), lane_calls_.end(), is_absent);
  if (is_alone) lane_calls_.clear();
  for (std::size_t k = first_heat; k < lane_calls_.size(); ++k) {
    lane_calls_[k].set = !points_.empty();  // the force stands before its power
  }
  can_be_kept_ = used_rates_ <= view.rates;
}

/// A force that depends on velocity takes out the power -F v.
bool BriefLedger::add_point(const Model::Force& force, std::size_t rate) {
  if (!force.traits.depends_on_velocity) return false;
  const std::vector<Pass<double>> passes = force.passes();
  if (passes.empty() || passes.front().point.run == nullptr) return false;
  const auto found = std::find_if(points_.begin(), points_.end(), [&](const auto& point) {
    return point.parameters == passes.front().point.parameters && point.rate == kNoRate;
  });
  if (found == points_.end()) return false;
  dampers_.push_back({found->run, found->parameters, found->start, rate});
  found->run = &with_heat;
  found->parameters = &dampers_.back();
  found->rate = static_cast<std::ptrdiff_t>(rate) - 1;
  return true;
}

PointResult<double> BriefLedger::with_heat(const void* damper, double position, double velocity,
                                           double start, double elapsed) {
  const auto& own = *static_cast<const Damper*>(damper);
  const PointResult<double> of = own.run(own.parameters, position, velocity, start, elapsed);
  return {of.force, -of.force * velocity};
}

/// A step that is taken by operations leaves the same rates as one in registers.
void BriefLedger::write_heat(const void* damper, const Stage<double>& stage) {
  const Damper& own = *static_cast<const Damper*>(damper);
  const PointResult<double> of =
      with_heat(damper, stage.position[0], stage.velocity[0], own.start, stage.elapsed);
  stage.rates[own.rate - 1] = of.force;
  stage.rates[own.rate] = of.power;
}

bool BriefLedger::lacks_first_step() const {
  return splits_friction_ && run_.integrator->is_started();
}

void BriefLedger::keep(bool on) {
  if (on == kept_) return;
  kept_ = on;
  lane_calls_.swap(run_.model.assembly().lane_calls());
  System<double>& system = run_.model.system();
  SystemView<double>& view = system.view;
  if (on) {
    without_ = view;
    view.operations = operations_.data();
    view.operation_count = operations_.size();
    view.point_forces = points_.data();
    view.point_force_count = points_.size();
    view.used_rates = used_rates_;
    view.friction_rate = friction_rate_;
  } else {
    view.operations = without_.operations;
    view.operation_count = without_.operation_count;
    view.point_forces = without_.point_forces;
    view.point_force_count = without_.point_force_count;
    view.used_rates = without_.used_rates;
    view.friction_rate = kNoRate;
    std::fill(view.integrals + view.used_rates, view.integrals + view.rates, 0.0);
  }
  if (splits_friction_) return;
  // The start of the next step is evaluated with other operations.
  system.evaluations -= run_.integrator->evaluations_ahead();
  run_.integrator->forces_changed();
}

EnergyTerms BriefLedger::terms(const double* from_integrals, double from) const {
  const double* const now = run_.model.system().view.integrals;
  EnergyTerms terms = energy_terms(run_.model, from_integrals, now, from, run_.clock.time());
  for (const Heat& heat : heats_) {
    const double out = now[heat.rate] - from_integrals[heat.rate];
    terms.add_out(heat.of_energy, out);
  }
  return terms;
}

}  // namespace tomlin
