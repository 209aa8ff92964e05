#include "framework/model/evaluation.hpp"

#include <algorithm>
#include <limits>
#include <type_traits>
#include <utility>

#include "framework/core/elements/kernel_tables.hpp"
#include "framework/core/elements/site_force.hpp"

TOMLIN_DECLARE_TABLES(RigidKernels, RigidTable)

namespace tomlin {
namespace {

/// Calls that only check the others.
#ifdef NDEBUG
constexpr std::size_t kChecks = 0;
#else
constexpr std::size_t kChecks = 1;
#endif

/// Particles of bodies that move as one get velocities where something reads them.
template <class Real>
void ask_for_velocities(const Scene& scene, AssembledBodies<Real>& bodies,
                        const std::vector<AssembledForce<Real>>& forces) {
  for (std::size_t k = 0; k < bodies.rigid.size(); ++k) {
    if (!scene.observers.empty()) bodies.rigid[k].velocities = true;
    for (const AssembledForce<Real>& force : forces) {
      const auto& on = force.bodies;
      const bool acts = std::count(on.begin(), on.end(), bodies.rigid_body[k]) > 0;
      const bool reads =
          force.traits.depends_on_velocity || force.heat_rate != kNoRate || force.driver != nullptr;
      if (acts && reads && !force.is_operator) bodies.rigid[k].velocities = true;
    }
  }
}

template <class Real>
std::vector<Pass<Real>> passes_in_order(const AssemblyPlan& plan,
                                        const std::vector<AssembledForce<Real>>& forces) {
  std::vector<Pass<Real>> passes;
  for (const AssembledForce<Real>& force : forces) {
    if (force.is_operator) continue;
    for (Pass<Real>& pass : force.passes()) passes.push_back(std::move(pass));
  }
  std::stable_sort(passes.begin(), passes.end(),
                   [](const auto& a, const auto& b) { return a.rank < b.rank; });
  if (plan.backwards) std::reverse(passes.begin(), passes.end());
  return passes;
}

}  // namespace

template <class Real>
Evaluation<Real>::Evaluation(const AssemblyPlan& plan, AssembledBodies<Real>& bodies,
                             const PrescribedBodies<Real>& prescribed,
                             const std::vector<AssembledForce<Real>>& forces,
                             FrictionMatrix<Real>& friction, SystemView<Real>& view) {
  const int dimension = plan.dimension();
  const RigidTable<Real>& rigid = kernels::RigidKernels.on<Real>(plan.set);
  ask_for_velocities(*plan.scene, bodies, forces);
  const std::vector<Pass<Real>> passes = passes_in_order(plan, forces);
  Regions set{std::vector<bool>(bodies.all.size()), std::vector<bool>(bodies.all.size())};
  if constexpr (kChecks > 0) operations_.push_back({&Evaluation::spoil, &written_});
  prescribed.add_steering(operations_);
  for (std::size_t k = 0; k < bodies.rigid.size(); ++k) {
    const bool rotor = bodies.all[bodies.rigid_body[k]].rotor;
    add_rigid(rotor ? rigid.place_rotor : rigid.place[dimension - 1], bodies, k,
              rotor ? nullptr : rigid.place_lanes[dimension - 1], true);
  }
  for (const bool centre : {true, false}) {
    for (const Pass<Real>& pass : passes) {
      if (pass.writes.front().centre == centre) add_pass(pass, bodies, dimension, set);
    }
  }
  gather(plan, bodies, prescribed, set);
  add_heats(plan, bodies, forces, friction, view);
  if (dimension == 1 && bodies.all.size() == 1 && view.dofs == kGroup && view.own_count == 0 &&
      view.used_rates <= kGroup && !bodies.all.front().bound.slot.mapped && plan.inertial &&
      !plan.ledger) {
    add_point_forces(passes, view);
  }
  view.operations = operations_.data();
  view.operation_count = operations_.size();
  const bool all_in_lanes =
      lane_calls_.size() + kChecks == operations_.size() &&
      std::all_of(lane_calls_.begin(), lane_calls_.end(),
                  [](const LaneCall& call) { return call.form.kernel != nullptr; });
  if (!all_in_lanes) lane_calls_.clear();
}

template <class Real>
void Evaluation<Real>::add_zeros(const BodySlot<Real>& slot, int dimension, bool centre) {
  zeros_.push_back(centre ? Range{false, slot.centre, kGroup}
                          : Range{slot.mapped, slot.offset, slot.stride * dimension});
  LaneCall lanes;
  lanes.form.kernel = &write_zeros_in_lanes;
  const Range& range = zeros_.back();
  for (const std::size_t one : {range.offset, range.length, std::size_t{range.mapped ? 1U : 0U}}) {
    lanes.form.structure.push_back(static_cast<std::int64_t>(one));
  }
  lanes.single = &zeros_.back();
  add_call({&write_zeros, &zeros_.back()}, std::move(lanes));
}

template <class Real>
void Evaluation<Real>::add_pass(const Pass<Real>& pass, const AssembledBodies<Real>& bodies,
                                int dimension, Regions& set) {
  const bool fresh = std::none_of(pass.writes.begin(), pass.writes.end(),
                                  [&](const Region& region) { return set.of(region); });
  LaneCall lanes{pass.lanes, pass.arguments};
  if (fresh && pass.set && pass.writes.size() == 1) {
    lanes.set = true;
    add_call({pass.set, pass.arguments}, std::move(lanes));
  } else {
    for (const Region& region : pass.writes) {
      if (!set.of(region)) {
        add_zeros(bodies.all[region.body].bound.slot, dimension, region.centre);
      }
      set.of(region) = true;
    }
    add_call({pass.add, pass.arguments}, std::move(lanes));
  }
  for (const Region& region : pass.writes) set.of(region) = true;
}

/// Rigid bodies take their particles' forces, prescribed ones answer them; what no force acts on
/// gets zeros.
template <class Real>
void Evaluation<Real>::gather(const AssemblyPlan& plan, const AssembledBodies<Real>& bodies,
                              const PrescribedBodies<Real>& prescribed, Regions& set) {
  const int dimension = plan.dimension();
  const RigidTable<Real>& rigid = kernels::RigidKernels.on<Real>(plan.set);
  for (std::size_t k = 0; k < bodies.rigid.size(); ++k) {
    const std::size_t b = bodies.rigid_body[k];
    if (bodies.all[b].prescribed()) {
      if (!set.particles[b]) add_zeros(bodies.all[b].bound.slot, dimension, false);
      operations_.push_back({rigid.react[dimension - 1], &bodies.rigid[k]});
      prescribed.add_inertia(b, operations_);
    } else if (set.particles[b]) {
      if (bodies.all[b].rotor) {
        const bool add = set.centre[b];
        add_rigid(add ? rigid.gather_rotor_add : rigid.gather_rotor_set, bodies, k, nullptr, !add);
      } else {
        const int axis = dimension - 1;
        const Kernel<Real> into_centre =
            set.centre[b] ? rigid.gather_add[axis] : rigid.gather_set[axis];
        add_rigid(into_centre, bodies, k, rigid.gather_lanes[axis], !set.centre[b]);
      }
      set.centre[b] = true;
    }
  }
  for (std::size_t b = 0; b < bodies.all.size(); ++b) {
    const BodySlot<Real>& slot = bodies.all[b].bound.slot;
    if (slot.rigid && !set.centre[b]) add_zeros(slot, dimension, true);
    if (!slot.mapped && !set.particles[b]) add_zeros(slot, dimension, false);
    // Padding stays zero: a kernel that takes particles one by one never writes it.
    const std::size_t coordinates = bodies.all[b].rotor ? 6 : (dimension == 1 ? 1 : 3);
    if (slot.rigid) written_.push_back({false, slot.centre, coordinates});
    for (int d = 0; d < dimension && (!slot.mapped || set.particles[b]); ++d) {
      written_.push_back({slot.mapped, slot.offset + d * slot.stride, slot.count});
    }
  }
  for (std::size_t k = 0; k < bodies.rigid.size(); ++k) {
    if (!bodies.all[bodies.rigid_body[k]].rotor) continue;
    add_rigid(rigid.rotate, bodies, k, nullptr, false);
  }
}

/// Without inertia velocities are known when all forces are: only then, what these do.
template <class Real>
void Evaluation<Real>::add_heats(const AssemblyPlan& plan, const AssembledBodies<Real>& bodies,
                                 const std::vector<AssembledForce<Real>>& forces,
                                 FrictionMatrix<Real>& friction, const SystemView<Real>& view) {
  for (const AssembledForce<Real>& force : forces) {
    Operation<Real> heat;
    if (force.driver) heat = force.driver->power();
    if (force.driver || (force.heat_rate != kNoRate && force.heat(force.heat_rate, heat))) {
      plan.inertial ? add_call(heat, lane_call_of(heat)) : drifted_.heats.push_back(heat);
    }
  }
  if (plan.inertial) return;
  friction.add_mobility(plan, operations_);
  if (drifted_.heats.empty()) return;
  drifted_.velocity.assign(view.dofs + 2 * kGroup, Real(0.0));
  drifted_.mobility = view.inverse_mass;
  drifted_.dofs = view.dofs;
  const RigidTable<Real>& rigid = kernels::RigidKernels.on<Real>(plan.set);
  for (const auto& body : bodies.rigid) {
    drifted_.placements.push_back({rigid.place[plan.dimension() - 1], &body});
  }
  operations_.push_back({&Evaluation::heat_of_drift, &drifted_});
}

/// A single particle on a line has kernels that pass numbers in registers.
template <class Real>
void Evaluation<Real>::add_point_forces(const std::vector<Pass<Real>>& passes,
                                        SystemView<Real>& view) {
  for (const Pass<Real>& pass : passes) {
    if (pass.point.run == nullptr) {
      point_forces_.clear();
      return;
    }
    point_forces_.push_back(pass.point);
  }
  view.point_forces = point_forces_.data();
  view.point_force_count = point_forces_.size();
}

template <class Real>
void Evaluation<Real>::add_call(const Operation<Real>& operation, LaneCall lanes) {
  operations_.push_back(operation);
  if constexpr (std::is_same_v<Real, double>) lane_calls_.push_back(std::move(lanes));
}

template <class Real>
void Evaluation<Real>::add_rigid(Kernel<Real> kernel, const AssembledBodies<Real>& bodies,
                                 std::size_t k, Kernel<double> over_lanes, bool set) {
  const RigidArguments<Real>& body = bodies.rigid[k];
  LaneCall lanes;
  if constexpr (std::is_same_v<Real, double>) {
    // A prescribed body's coordinates are no part of the state.
    if (body.coordinates == nullptr) lanes.form.kernel = over_lanes;
    lanes.form.numbers = {bodies.reference[k]};
    lanes.form.structure = structure_of(body.body, body.velocities ? 1 : 0);
    lanes.form.scratch = bodies.reference[k].size();
    lanes.single = &body;
    lanes.set = set;
    lanes.arms = static_cast<std::ptrdiff_t>(k);
  }
  add_call({kernel, &body}, std::move(lanes));
}

template <class Real>
void Evaluation<Real>::write_zeros(const void* range, const Stage<Real>& stage) {
  const auto& a = *static_cast<const Range*>(range);
  Real* f = (a.mapped ? stage.mapped_force : stage.force) + a.offset;
  for (std::size_t i = 0; i < a.length; ++i) f[i] = Real(0.0);
}

template <class Real>
void Evaluation<Real>::write_zeros_in_lanes(const void* arguments, const Stage<double>& stage) {
  const auto& lanes = *static_cast<const LaneArguments*>(arguments);
  const auto& a = *static_cast<const Range*>(lanes.single);
  const std::size_t* const index = a.mapped ? lanes.mapped : lanes.coordinate;
  const std::size_t first = index[a.offset] * lanes.width;
  double* const f = a.mapped ? stage.mapped_force : stage.force;
  std::fill(f + first, f + index[a.offset + a.length] * lanes.width, 0.0);
}

template <class Real>
void Evaluation<Real>::spoil(const void* ranges, const Stage<Real>& stage) {
  for (const Range& part : *static_cast<const std::vector<Range>*>(ranges)) {
    Real* const from = (part.mapped ? stage.mapped_force : stage.force) + part.offset;
    std::fill_n(from, part.length, Real(std::numeric_limits<double>::quiet_NaN()));
  }
}

template <class Real>
void Evaluation<Real>::heat_of_drift(const void* drifted, const Stage<Real>& stage) {
  const auto& a = *static_cast<const Drifted*>(drifted);
  for (std::size_t i = 0; i < a.dofs; ++i) a.velocity[i] = stage.force[i] * a.mobility[i];
  Stage<Real> moving = stage;
  moving.velocity = a.velocity.data();
  for (const Operation<Real>& placement : a.placements) placement.run(placement.arguments, moving);
  for (const Operation<Real>& heat : a.heats) heat.run(heat.arguments, moving);
}

template class Evaluation<double>;
template class Evaluation<Quad>;

}  // namespace tomlin
