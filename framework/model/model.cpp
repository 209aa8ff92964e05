#include "framework/model/model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "framework/core/kernel_tables.hpp"
#include "framework/model/rigid_kernels.hpp"
#include "framework/model/storage.hpp"

TOMLIN_DECLARE_TABLES(RigidKernels, RigidTable)

namespace tomlin {
namespace {

constexpr double kTau = 6.283185307179586476925286766559;
/// No limit on a move, though still a finite one: infinity would let an infinite move pass.
constexpr double kUnbounded = std::numeric_limits<double>::max();

/// Distance from one axis of a body's particles to the next, kept off multiples of a page so that
/// the axes do not compete for the same cache lines.
std::size_t stride_for(std::size_t count) {
  const std::size_t length = padded(count);
  return length % 512 == 0 ? length + 3 * kGroup : length;
}

/// Places so far away that they cannot be counted in periods come out as no numbers.
bool placed_finitely(const std::vector<std::vector<double>>& start) {
  for (const auto& particle : start) {
    for (const double x : particle) {
      if (!std::isfinite(x)) return false;
    }
  }
  return true;
}

double per_particle(const PerParticle& given, std::size_t i) {
  return given.values.size() == 1 ? given.values.front() : given.values[i];
}

/// Writes zeros where no force acts.
struct ZeroArguments {
  bool mapped = false;
  std::size_t offset = 0;
  std::size_t length = 0;
};

void zero_kernel(const void* arguments, const Stage<double>& stage) {
  const auto& a = *static_cast<const ZeroArguments*>(arguments);
  double* f = (a.mapped ? stage.mapped_force : stage.force) + a.offset;
  for (std::size_t i = 0; i < a.length; ++i) f[i] = 0.0;
}

}  // namespace

Model::Model(std::shared_ptr<const Scene> scene, InstructionSet set)
    : scene_(std::move(scene)), set_(set), storage_(std::make_unique<Storage>()) {
  for (const SceneBody& body : scene_->bodies) {
    geometry_.push_back(body.record->build(body.description.get(), dimension()));
  }
  choose_origin();
  place_bodies();
  bind_forces();
  order_operations();
}

Model::~Model() = default;

/// The unit of each axis is the longest period that a force declares on it; the body with the
/// lowest start decides how many of them the scene is away, so that the order of bodies does not.
void Model::choose_origin() {
  for (int axis = 0; axis < dimension(); ++axis) {
    double unit = 0.0;
    for (const SceneForce& force : scene_->forces) {
      unit = std::max(unit, force.record->period(force.description.get(), axis));
    }
    origin_.unit[axis] = unit;
    if (!(unit > 0.0)) continue;
    double lowest = geometry_.front().anchor[axis];
    for (const BodyGeometry& geometry : geometry_) lowest = std::min(lowest, geometry.anchor[axis]);
    remainder_of(DoubleDouble(lowest), unit, first_cells_[axis]);
    origin_.cells[axis] = first_cells_[axis];
  }
}

void Model::place_bodies() {
  Storage& s = *storage_;
  std::vector<Fault> faults;
  // First the sizes, since views point into arrays that must not move afterwards.
  for (std::size_t b = 0; b < scene_->bodies.size(); ++b) {
    const SceneBody& from = scene_->bodies[b];
    const BodyDescription& common = from.record->common(from.description.get());
    const BodyGeometry& geometry = geometry_[b];
    const std::size_t count = geometry.relative.size();
    Body body;
    body.rolling_radius = geometry.rolling_radius;
    body.bound.name = from.name;
    body.bound.index = b;
    body.bound.coordinates = common.coordinates;
    body.bound.closed = geometry.closed;
    BodySlot<double>& slot = body.bound.slot;
    slot.count = count;
    slot.stride = stride_for(count);
    slot.mapped = common.coordinates != "particles";
    slot.rigid = common.coordinates == "rigid";
    const std::size_t block = slot.stride * dimension();
    if (slot.mapped) {
      slot.offset = s.mapped_size;
      s.mapped_size += block + 2 * kGroup;
    } else {
      slot.offset = s.dofs;
      s.dofs += padded(block);
    }
    if (slot.rigid) {
      if (dimension() != 2) {
        faults.push_back({from.place_of("coordinates"), "body." + from.name + ".coordinates",
                          "\"rigid\"",
                          "rigid bodies are planar; other dimensions are not in this version",
                          "\"particles\" or \"fixed\"", ""});
      }
      slot.centre = s.dofs;
      s.dofs += kGroup;
    }

    // Positions relative to the origin, to the last digit however far away the body is.
    body.bound.start.assign(count, std::vector<double>(dimension(), 0.0));
    for (int d = 0; d < dimension(); ++d) {
      const double anchor = relative_to(origin_, d, geometry.anchor[d]);
      for (std::size_t i = 0; i < count; ++i) {
        body.bound.start[i][d] = anchor + geometry.relative[i][d];
      }
    }
    for (std::size_t i = 0; i < count; ++i) {
      body.bound.mass.push_back(per_particle(common.particle_mass, i));
    }
    InterleavedSum<double> mass;
    for (std::size_t i = 0; i < count; ++i) mass.add(i, body.bound.mass[i]);
    body.total_mass = mass.total();
    if (!std::isfinite(body.total_mass)) {
      faults.push_back({from.place_of("particle_mass"), "body." + from.name + ".particle_mass", "",
                        "the body's total mass overflows", "smaller masses", ""});
    }
    if (!placed_finitely(body.bound.start)) {
      faults.push_back({from.place, "body." + from.name, "",
                        "further from the origin than can be counted in periods",
                        "a place nearer the origin", ""});
    }
    s.share.emplace_back(padded(count), 0.0);
    for (std::size_t i = 0; i < count; ++i)
      s.share.back()[i] = body.bound.mass[i] / body.total_mass;
    bodies_.push_back(std::move(body));
  }
  if (!faults.empty()) throw InputError(std::move(faults));

  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    Body& body = bodies_[b];
    body.bound.slot.share = s.share[b].data();
    const std::size_t count = body.bound.slot.count;
    std::vector<double> middle(dimension());
    for (int d = 0; d < dimension(); ++d) {
      InterleavedSum<double> mean;
      for (std::size_t i = 0; i < count; ++i)
        mean.add(i, s.share[b][i] * geometry_[b].relative[i][d]);
      middle[d] = mean.total();
      body.bound.start_centre.push_back(relative_to(origin_, d, geometry_[b].anchor[d]) +
                                        middle[d]);
    }
    InterleavedSum<double> inertia;
    body.arms.assign(count, std::vector<double>(dimension()));
    for (std::size_t i = 0; i < count; ++i) {
      double square = 0.0;
      for (int d = 0; d < dimension(); ++d) {
        body.arms[i][d] = geometry_[b].relative[i][d] - middle[d];
        square = std::fma(body.arms[i][d], body.arms[i][d], square);
      }
      inertia.add(i, body.bound.mass[i] * square);
    }
    body.inertia = inertia.total();
  }

  s.inverse_mass.assign(s.dofs, 0.0);
  s.largest_move.assign(s.dofs, kUnbounded);
  s.tolerance_scale.assign(s.dofs, 1.0);
  s.force.assign(s.dofs + 2 * kGroup, 0.0);
  s.mapped_position.assign(s.mapped_size + 2 * kGroup, 0.0);
  s.mapped_velocity.assign(s.mapped_size + 2 * kGroup, 0.0);
  s.mapped_force.assign(s.mapped_size + 2 * kGroup, 0.0);
  system_.view.coordinates = 0;
  for (Body& body : bodies_) {
    const BodySlot<double>& slot = body.bound.slot;
    if (slot.rigid) {
      for (int d = 0; d < 2; ++d) {
        s.inverse_mass[slot.centre + d] = 1.0 / body.total_mass;
        if (origin_.unit[d] > 0.0) s.largest_move[slot.centre + d] = origin_.unit[d];
      }
      // A body without extent (one particle) has no rotation to speak of: it stays put.
      s.inverse_mass[slot.centre + 2] =
          body.inertia > 0.0 ? 1.0 / (kTau * kTau * body.inertia) : 0.0;
      s.largest_move[slot.centre + 2] = 0.5;
      s.tolerance_scale[slot.centre + 2] = kTau;
      system_.view.coordinates += body.inertia > 0.0 ? 3 : 2;
      s.arms.emplace_back(2 * slot.stride, 0.0);
      s.reference.emplace_back(2 * slot.stride, 0.0);
      for (std::size_t i = 0; i < slot.count; ++i) {
        for (int d = 0; d < 2; ++d) s.reference.back()[d * slot.stride + i] = body.arms[i][d];
      }
    } else if (!slot.mapped) {
      for (std::size_t i = 0; i < slot.count; ++i) {
        for (int d = 0; d < dimension(); ++d) {
          const std::size_t at = slot.offset + d * slot.stride + i;
          s.inverse_mass[at] = 1.0 / body.bound.mass[i];
          if (origin_.unit[d] > 0.0) s.largest_move[at] = origin_.unit[d];
        }
      }
      system_.view.coordinates += slot.count * dimension();
    }
  }
  system_.view.dofs = s.dofs;
  system_.view.inverse_mass = s.inverse_mass.data();
  system_.view.largest_move = s.largest_move.data();
  system_.view.tolerance_scale = s.tolerance_scale.data();
  system_.view.force = s.force.data();
  system_.view.mapped_position = s.mapped_position.data();
  system_.view.mapped_velocity = s.mapped_velocity.data();
  system_.view.mapped_force = s.mapped_force.data();
  system_.set = set_;
  system_.begin_step = &Model::begin_step;
  system_.model = this;
}

void Model::bind_forces() {
  for (const SceneForce& from : scene_->forces) {
    const auto all_of = [&](const char* coordinates) {
      return std::all_of(from.bodies.begin(), from.bodies.end(), [&](std::size_t b) {
        return bodies_[b].bound.coordinates == coordinates;
      });
    };
    if (from.record->traits.internal && from.bodies.size() == 1 && all_of("rigid")) {
      left_out_.push_back({from.name, "internal to a rigid body, where it does nothing"});
      continue;
    }
    if (all_of("fixed") && !from.record->traits.does_work) {
      left_out_.push_back({from.name, "acts only on what is fixed"});
      continue;
    }
    Binding<double> binding;
    binding.dimension = dimension();
    binding.set = set_;
    binding.origin = origin_;
    for (const std::size_t b : from.bodies) binding.bodies.push_back(&bodies_[b].bound);
    Force force;
    force.name = from.name;
    force.record = from.record;
    force.bodies = from.bodies;
    force.bound = from.record->bind(from.description.get(), binding);
    if (force.bound->depends_on_time()) timed_.push_back(force.bound.get());
    forces_.push_back(std::move(force));
  }

  // Own variables come first among the integrals: stages read them back.
  Storage& s = *storage_;
  std::size_t own = 0;
  for (Force& force : forces_) {
    if (force.bound->own_count() == 0) continue;
    force.bound->place_own(own);
    own += force.bound->own_count();
  }
  s.own_count = own;
  std::size_t rates = padded(own);
  for (Force& force : forces_) {
    if (force.bound->rate_count() == 0) continue;
    force.first_rate = static_cast<std::ptrdiff_t>(rates);
    force.bound->place_rates(force.first_rate);
    rates += force.bound->rate_count();
  }
  system_.view.own = padded(own);
  system_.view.own_count = own;
  system_.view.rates = padded(rates);
  system_.view.used_rates = rates;
  s.rates.assign(system_.view.rates + 2 * kGroup, 0.0);

  // A bond may not turn over in one step: half the shortest bond of a body bounds its particles.
  for (const Force& force : forces_) {
    const double shortest = force.bound->shortest_bond();
    if (!(shortest > 0.0)) continue;
    for (const std::size_t b : force.bodies) {
      const BodySlot<double>& slot = bodies_[b].bound.slot;
      if (slot.mapped) continue;
      for (std::size_t i = 0; i < slot.stride * dimension(); ++i) {
        double& limit = s.largest_move[slot.offset + i];
        limit = std::min(limit, 0.5 * shortest);
      }
    }
  }
}

/// One evaluation, in order: rigid bodies place their particles; forces on rigid centres; forces on
/// particles, cheap ones first; rigid bodies gather. The first on each region sets, the rest add.
void Model::order_operations() {
  Storage& s = *storage_;
  const RigidTable& rigid = kernels::RigidKernels.on(set_);
  const bool planar_bodies = !s.reference.empty();
  if (planar_bodies) {
    std::size_t k = 0;
    for (Body& body : bodies_) {
      if (!body.bound.slot.rigid) continue;
      auto arguments = std::make_unique<RigidArguments>();
      arguments->body = body.bound.slot;
      arguments->reference = s.reference[k].data();
      arguments->arm = s.arms[k].data();
      for (const Force& force : forces_) {
        const bool acts =
            std::count(force.bodies.begin(), force.bodies.end(), body.bound.index) > 0;
        if (acts && force.record->traits.depends_on_velocity) arguments->velocities = true;
      }
      s.rigid.push_back(std::move(arguments));
      ++k;
    }
  }

  std::vector<Pass<double>> passes;
  for (Force& force : forces_) {
    for (Pass<double>& pass : force.bound->passes()) passes.push_back(std::move(pass));
  }
  std::stable_sort(passes.begin(), passes.end(),
                   [](const auto& a, const auto& b) { return a.rank < b.rank; });

  std::vector<bool> particles_set(bodies_.size(), false);
  std::vector<bool> centre_set(bodies_.size(), false);
  const auto mark = [&](const Region& region) -> std::vector<bool>::reference {
    return region.centre ? centre_set[region.body] : particles_set[region.body];
  };
  const auto zero = [&](std::size_t b, bool centre) {
    const BodySlot<double>& slot = bodies_[b].bound.slot;
    auto arguments = std::make_unique<ZeroArguments>();
    if (centre) {
      *arguments = {false, slot.centre, kGroup};
    } else {
      *arguments = {slot.mapped, slot.offset, slot.stride * dimension()};
    }
    operations_.push_back({&zero_kernel, arguments.get()});
    s.zeros.push_back(std::shared_ptr<void>(std::move(arguments)));
  };
  const auto emit = [&](const Pass<double>& pass) {
    const bool fresh = std::none_of(pass.writes.begin(), pass.writes.end(),
                                    [&](const Region& region) { return mark(region); });
    if (fresh && pass.set && pass.writes.size() == 1) {
      operations_.push_back({pass.set, pass.arguments});
    } else {
      for (const Region& region : pass.writes) {
        if (!mark(region)) zero(region.body, region.centre);
        mark(region) = true;
      }
      operations_.push_back({pass.add, pass.arguments});
    }
    for (const Region& region : pass.writes) mark(region) = true;
  };

  for (const auto& arguments : s.rigid) operations_.push_back({rigid.place, arguments.get()});
  for (const auto& pass : passes) {
    if (pass.writes.front().centre) emit(pass);
  }
  for (const auto& pass : passes) {
    if (!pass.writes.front().centre) emit(pass);
  }
  for (const auto& arguments : s.rigid) {
    std::size_t b = 0;
    while (bodies_[b].bound.slot.centre != arguments->body.centre || !bodies_[b].bound.slot.rigid)
      ++b;
    if (!particles_set[b]) continue;
    operations_.push_back({centre_set[b] ? rigid.gather_add : rigid.gather_set, arguments.get()});
    centre_set[b] = true;
  }
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const BodySlot<double>& slot = bodies_[b].bound.slot;
    if (slot.rigid && !centre_set[b]) zero(b, true);
    if (!slot.mapped && !particles_set[b]) zero(b, false);
  }
  // A single particle on a line has kernels that pass numbers in registers.
  if (dimension() == 1 && bodies_.size() == 1 && s.dofs == kGroup && s.own_count == 0 &&
      system_.view.used_rates <= kGroup && !bodies_.front().bound.slot.mapped) {
    std::vector<const BoundForce<double>*> in_order;
    for (const Pass<double>& pass : passes) {
      for (const Force& force : forces_) {
        for (const Pass<double>& own : force.bound->passes()) {
          if (own.arguments == pass.arguments) in_order.push_back(force.bound.get());
        }
      }
    }
    for (const BoundForce<double>* force : in_order) {
      PointForce<double> point;
      if (!force->point(point)) {
        s.point_forces.clear();
        break;
      }
      s.point_forces.push_back(point);
    }
    system_.view.point_forces = s.point_forces.data();
    system_.view.point_force_count = s.point_forces.size();
  }
  system_.view.operations = operations_.data();
  system_.view.operation_count = operations_.size();
}

void Model::begin_step(void* model, double time_high, double time_low) {
  auto* const self = static_cast<Model*>(model);
  self->anchor_ = DoubleDouble(time_high, time_low);
  for (BoundForce<double>* force : self->timed_) force->begin_step(self->anchor_);
}

void Model::declare(StateLayout& layout) const {
  layout.add_reals("position", system_.view.dofs);
  layout.add_reals("velocity", system_.view.dofs);
  layout.add_reals("integrals", system_.view.rates);
  layout.add_integers("origin_cells", 3);
  layout.add_integers("whole_turns", bodies_.size());
}

void Model::attach(RunState& state) {
  system_.view.position = state.reals("position");
  system_.view.velocity = state.reals("velocity");
  system_.view.integrals = state.reals("integrals");
  cells_ = state.integers("origin_cells");
  whole_turns_ = state.integers("whole_turns");
  for (int d = 0; d < 3; ++d) origin_.cells[d] = cells_[d];
  for (Force& force : forces_) force.bound->rebase(origin_);
  place_fixed();
}

void Model::start() {
  SystemView<double>& view = system_.view;
  for (const Body& body : bodies_) {
    const BodySlot<double>& slot = body.bound.slot;
    const SceneBody& from = scene_->bodies[body.bound.index];
    const PerParticleVector& given = from.record->common(from.description.get()).velocity;
    const auto velocity = [&](std::size_t i, int d) {
      if (given.values.empty()) return 0.0;
      return given.values[given.values.size() == 1 ? 0 : i].components[d];
    };
    if (slot.rigid) {
      // The velocity field's momentum and angular momentum, which is all that a rigid body keeps.
      InterleavedSum<double> spin;
      for (std::size_t i = 0; i < slot.count; ++i) {
        spin.add(i, body.bound.mass[i] *
                        (body.arms[i][0] * velocity(i, 1) - body.arms[i][1] * velocity(i, 0)));
      }
      for (int d = 0; d < 2; ++d) {
        InterleavedSum<double> mean;
        for (std::size_t i = 0; i < slot.count; ++i) mean.add(i, slot.share[i] * velocity(i, d));
        view.position[slot.centre + d] = body.bound.start_centre[d];
        view.velocity[slot.centre + d] = mean.total();
      }
      view.velocity[slot.centre + 2] =
          body.inertia > 0.0 ? spin.total() / (kTau * body.inertia) : 0.0;
    } else if (!slot.mapped) {
      for (std::size_t i = 0; i < slot.count; ++i) {
        for (int d = 0; d < dimension(); ++d) {
          const std::size_t at = slot.offset + d * slot.stride + i;
          view.position[at] = body.bound.start[i][d];
          view.velocity[at] = velocity(i, d);
        }
      }
    }
  }
  for (Force& force : forces_) {
    if (force.bound->own_count() > 0) force.bound->start_own(view.integrals);
  }
  for (int d = 0; d < dimension(); ++d) cells_[d] = origin_.cells[d] = first_cells_[d];
  for (Force& force : forces_) force.bound->rebase(origin_);
  place_fixed();
}

void Model::place_fixed() {
  for (const Body& body : bodies_) {
    const BodySlot<double>& slot = body.bound.slot;
    if (!slot.mapped || slot.rigid) continue;
    for (int d = 0; d < dimension(); ++d) {
      const double anchor = relative_to(origin_, d, geometry_[body.bound.index].anchor[d]);
      for (std::size_t i = 0; i < slot.count; ++i) {
        storage_->mapped_position[slot.offset + d * slot.stride + i] =
            anchor + geometry_[body.bound.index].relative[i][d];
      }
    }
  }
}

bool Model::rebase_if_due() {
  bool rebased = false;
  SystemView<double>& view = system_.view;
  for (const Body& body : bodies_) {
    // Rotation has cells of its own: whole turns.
    const BodySlot<double>& slot = body.bound.slot;
    if (!slot.rigid) continue;
    double& turns = view.position[slot.centre + 2];
    if (turns >= 1.0 || turns <= -1.0) {
      const double whole = std::trunc(turns);
      turns -= whole;
      whole_turns_[body.bound.index] += static_cast<std::int64_t>(whole);
      rebased = true;
    }
  }
  for (int d = 0; d < dimension(); ++d) {
    const double unit = origin_.unit[d];
    if (unit == 0.0) continue;
    double least = kUnbounded;  // whole cells by which everything has moved forward
    double most = -kUnbounded;
    const auto moved = [&](double now, double start) {
      least = std::min(least, now - start);
      most = std::max(most, now - start);
      return least >= unit || most <= -unit;
    };
    bool all = true;
    for (const Force& force : forces_) {
      if (const Drive* drive = force.bound->drive()) {
        if (drive->travel.empty()) continue;
        all = all && moved(drive->travel[d], 0.0);
      }
    }
    for (const Body& body : bodies_) {
      if (!all) break;
      const BodySlot<double>& slot = body.bound.slot;
      if (slot.rigid) {
        all = moved(view.position[slot.centre + d], body.bound.start_centre[d]);
      } else {
        const double* x = (slot.mapped ? storage_->mapped_position.data() : view.position) +
                          slot.offset + d * slot.stride;
        for (std::size_t i = 0; all && i < slot.count; ++i)
          all = moved(x[i], body.bound.start[i][d]);
      }
    }
    if (!all || !(least >= unit || most <= -unit)) continue;
    const double cells = std::trunc((least >= unit ? least : most) / unit);
    const double shift = cells * unit;
    for (const Body& body : bodies_) {
      const BodySlot<double>& slot = body.bound.slot;
      if (slot.rigid) {
        view.position[slot.centre + d] -= shift;
      } else if (!slot.mapped) {
        double* x = view.position + slot.offset + d * slot.stride;
        for (std::size_t i = 0; i < slot.count; ++i) x[i] -= shift;
      }
    }
    cells_[d] += static_cast<std::int64_t>(cells);
    origin_.cells[d] = cells_[d];
    for (Force& force : forces_) force.bound->rebase(origin_);
    place_fixed();
    rebased = true;
  }
  if (rebased) begin_step(this, anchor_.hi, anchor_.lo);
  return rebased;
}

}  // namespace tomlin
