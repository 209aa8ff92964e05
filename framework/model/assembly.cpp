#include "framework/model/assembly.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "framework/core/numbers/normal_numbers.hpp"
#include "framework/core/numbers/random.hpp"
#include "framework/core/numbers/sum.hpp"
#include "framework/core/records/facets.hpp"

namespace tomlin {

namespace {

/// Writes where bodies start and how fast, one after the other.
template <class Real>
class BodyStart {
 public:
  BodyStart(const AssemblyPlan& plan, const Perturbation* noise, Real* position, Real* velocity,
            const FinalState* from, const Origin& origin)
      : plan_(plan), noise_(noise), position_(position), velocity_(velocity), from_(from) {
    for (int d = 0; from != nullptr && d < plan.dimension(); ++d) {
      shift_[d] = absolute_position(from->origin, d, 0.0) - absolute_position(origin, d, 0.0);
    }
  }

  /// Begins a body: all that is written from here on is part of it.
  void take(const AssembledBody<Real>& body) {
    body_ = &body;
    if (body.rotor) ++rotors_;
    const SceneBody& from = plan_.scene->bodies[body.bound.index];
    const BodyDescription& common = from.record->common(from.description.get());
    given_ = &common.velocity;
    draw_velocities(common.start_temperature, from.name);
    perturbed_ = noise_ != nullptr &&
                 std::count(noise_->bodies.begin(), noise_->bodies.end(), body.bound.index) > 0;
  }

  /// A rigid body's shape is disturbed too: noise on its coordinates alone dies out wherever it is
  /// stable for a while, and an unstable symmetry later on would see none of it.
  void write_shape(AlignedVector<Real>& reference) const {
    const BodySlot<Real>& slot = body_->bound.slot;
    for (std::size_t i = 0; i < slot.count; ++i) {
      const std::array<double, 3> start = body_->reference_arm(i);
      for (int d = 0; d < plan_.dimension(); ++d) {
        Real& arm = reference[d * slot.stride + i];
        arm = Real(start[d]);
        if (perturbed_ && slot.rigid) arm = arm + jitter(kShape, i * plan_.dimension() + d);
      }
    }
  }

  /// The velocity field's momentum and angular momentum, which is all that a rigid body keeps.
  void write_rigid(bool turns) const {
    const BodySlot<Real>& slot = body_->bound.slot;
    for (int d = 0; d < plan_.dimension(); ++d) {
      InterleavedSum<Real> mean;
      for (std::size_t i = 0; i < slot.count; ++i) mean.add(i, slot.share[i] * Real(speed(i, d)));
      const std::size_t at = slot.centre + d;
      const Real thermal =
          thermal_speed(static_cast<std::size_t>(d), body_->held[d] ? 0.0 : body_->total_mass);
      put(at, d, Real(body_->bound.start_centre[d]), mean.total() + thermal);
      if (perturbed_ && !body_->held[d]) position_[at] = position_[at] + jitter(kCoordinate, d);
    }
    if (body_->rotor) write_rotation_in_space();
    if (plan_.dimension() != 2) return;
    InterleavedSum<double> spin;
    for (std::size_t i = 0; i < slot.count; ++i) {
      const std::array<double, 3>& arm = body_->arms[i];
      spin.add(i, body_->bound.mass[i] * (arm[0] * speed(i, 1) - arm[1] * speed(i, 0)));
    }
    const std::size_t at = slot.centre + kRotation;
    const bool spins = body_->inertia > 0.0 && !body_->rotation_held;
    put(at, kRotation, Real(0.0),
        spins ? Real(spin.total()) / (tau<Real>() * Real(body_->inertia)) +
                    thermal_speed(kRotation, body_->inertia) / tau<Real>()
              : Real(0.0));
    if (perturbed_ && turns) {
      position_[at] = position_[at] + jitter(kCoordinate, kRotation) / tau<Real>();
    }
  }

  /// Along a principal axis of the body that starts where a run has ended.
  double spin_of(std::size_t k) const {
    const FinalState::Rotor& from = from_->rotors[rotors_ - 1];
    const Matrix3 axes = matrix_of(product(from.rotation, body_->orientation));
    if (!(body_->moments[k] > 0.0)) return 0.0;
    return axes[k] * from.spin[0] + axes[3 + k] * from.spin[1] + axes[6 + k] * from.spin[2];
  }

  /// At p = 0, where dp/dt is the angular velocity.
  void write_rotation_in_space() const {
    const BodySlot<Real>& slot = body_->bound.slot;
    std::array<InterleavedSum<double>, 3> spin;
    for (std::size_t i = 0; i < slot.count; ++i) {
      const std::array<double, 3>& arm = body_->arms[i];
      for (int d = 0; d < 3; ++d) {
        const int next = (d + 1) % 3;
        const int last = (d + 2) % 3;
        spin[d].add(
            i, body_->bound.mass[i] * (arm[next] * speed(i, last) - arm[last] * speed(i, next)));
      }
    }
    const Matrix3 axes = matrix_of(body_->orientation);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t d = 3 + k;
      const double moment = body_->moments[k];
      const double momentum =
          axes[k] * spin[0].total() + axes[3 + k] * spin[1].total() + axes[6 + k] * spin[2].total();
      const Real speed =
          moment > 0.0 ? Real(momentum / moment) + thermal_speed(d, moment) : Real(0.0);
      position_[slot.centre + d] = Real(0.0);
      velocity_[slot.centre + d] = from_ == nullptr ? speed : Real(spin_of(k));
      if (perturbed_ && moment > 0.0)
        position_[slot.centre + d] = position_[slot.centre + d] + jitter(kCoordinate, d);
    }
  }

  void write_particles() const {
    const BodySlot<Real>& slot = body_->bound.slot;
    for (std::size_t i = 0; i < slot.count; ++i) {
      for (int d = 0; d < plan_.dimension(); ++d) {
        const std::size_t at = slot.offset + d * slot.stride + i;
        const Real thermal =
            thermal_speed(d * slot.stride + i, body_->held[d] ? 0.0 : body_->bound.mass[i]);
        put(at, d, Real(body_->bound.start[i][d]), Real(speed(i, d)) + thermal);
        if (perturbed_ && !body_->held[d]) {
          position_[at] = position_[at] + jitter(kCoordinate, i * plan_.dimension() + d);
        }
      }
    }
  }

 private:
  enum Kind : std::uint64_t { kCoordinate, kShape };

  /// The scene's numbers, unless there are others. A rotation is not relative to an origin.
  void put(std::size_t at, int d, Real position, Real velocity) const {
    position_[at] = position;
    velocity_[at] = velocity;
    if (from_ == nullptr) return;
    const bool turns = body_->bound.slot.rigid && d == kRotation && plan_.dimension() == 2;
    position_[at] =
        static_cast<Real>(turns ? from_->position[at] : from_->position[at] + shift_[d]);
    velocity_[at] = static_cast<Real>(from_->velocity[at]);
  }

  /// Normal numbers of the body's coordinates, where it starts with a temperature.
  void draw_velocities(double temperature, const std::string& name) {
    temperature_ = temperature;
    if (!(temperature > 0.0)) return;
    const RunSettings& run = plan_.scene->run;
    const BodySlot<Real>& slot = body_->bound.slot;
    normals_.assign(slot.rigid ? kGroup : slot.stride * plan_.dimension(), 0.0);
    fill_normals<double>(
        {static_cast<std::uint64_t>(run.seed),
         stream_of("start_temperature/" + name, static_cast<std::uint64_t>(run.stream))},
        {}, normals_.size(), body_->rotor ? 6 : (slot.rigid ? 3 : slot.count), normals_.data());
  }

  Real thermal_speed(std::size_t coordinate, double mass) const {
    if (!(temperature_ > 0.0 && mass > 0.0)) return Real(0.0);
    return Real(std::sqrt(temperature_ / mass) * normals_[coordinate]);
  }

  Real jitter(Kind kind, std::uint64_t k) const {
    return Real(noise_->size * uniform_symmetric({noise_->seed, noise_->stream},
                                                 {body_->bound.index, kind, k, 0}));
  }

  double speed(std::size_t i, int d) const {
    const auto& values = given_->values;
    if (values.empty() || body_->held[d]) return 0.0;
    return values[values.size() == 1 ? 0 : i].components[d];
  }

  const AssemblyPlan& plan_;
  const Perturbation* noise_;
  Real* position_;
  Real* velocity_;
  const FinalState* from_;
  std::array<Quad, 3> shift_{};  ///< between the origins
  const AssembledBody<Real>* body_ = nullptr;
  const PerParticleVector* given_ = nullptr;
  double temperature_ = 0.0;
  std::vector<double> normals_;  ///< of the coordinates, in the order of their arrays
  bool perturbed_ = false;
  std::size_t rotors_ = 0;  ///< so far
};

}  // namespace

template <class Real>
Assembly<Real>::Assembly(const AssemblyPlan& plan)
    : plan_(plan),
      origin_(plan.origin),
      bodies_(plan_),
      coordinates_(plan_, bodies_, system_.view),
      forces_(plan_, bodies_),
      prescribed_(plan_, bodies_) {
  system_.set = plan_.set;
  assign_rates();
  coordinates_.scale_tolerances(scene(), bodies_.all, prescribed_, system_.view);
  coordinates_.bound_moves(forces_.all, bodies_.all, dimension());
  if (!plan_.inertial || plan_.splits_friction) {
    friction_.lay(plan_, bodies_.all, forces_.all, coordinates_.inverse_mass, system_.view);
  }
  evaluation_.emplace(plan_, bodies_, prescribed_, forces_.all, friction_, system_.view);
}

/// Own variables come first among the integrals: stages read them back.
template <class Real>
void Assembly<Real>::assign_rates() {
  std::size_t own = prescribed_.own_count();
  for (Force& force : forces_.all) {
    const std::size_t count = force.variables->own_count();
    if (count == 0) continue;
    force.variables->place_own(own);
    if (force.switched) force.switched->place_own(own, count);
    own += count;
  }
  std::size_t rates = padded(own);
  for (Force& force : forces_.all) {
    const std::size_t count = force.driving->rate_count();
    if (count == 0 && !force.driver) continue;
    force.first_rate = static_cast<std::ptrdiff_t>(rates);
    if (force.driver) {
      force.driver->place_rates(force.first_rate);
      rates += static_cast<std::size_t>(dimension()) + 1;
    } else {
      force.driving->place_rates(force.first_rate);
      if (force.switched) force.switched->place_rates(rates, count);
      rates += count;
    }
    if (force.driver || force.traits.does_work) {
      drivers_.push_back({force.name, force.first_rate, force.drive()});
    }
  }
  prescribed_.assign_rates(plan_, bodies_, rates, drivers_);
  if (plan_.ledger) {
    for (Force& force : forces_.all) {
      Operation<Real> unused;
      if (force.is_operator || force.driver || !force.heat(0, unused)) continue;
      force.heat_rate = static_cast<std::ptrdiff_t>(rates++);
    }
    if (!plan_.inertial || plan_.splits_friction) {
      friction_.rate = static_cast<std::ptrdiff_t>(rates++);
    }
  }
  assign_kinetic(rates);
  SystemView<Real>& view = system_.view;
  view.own = padded(own);
  view.own_count = own;
  view.rates = padded(rates + 1);  // one at least is left for a ledger that is kept for some steps
  view.used_rates = rates;
}

/// Assigns kinetic rates to all bodies that move, where there is a thermostat.
template <class Real>
void Assembly<Real>::assign_kinetic(std::size_t& rates) {
  if (!plan_.half_step_velocities) return;
  if (!has_thermostat(scene())) return;
  for (Body& body : bodies_.all) {
    const BodySlot<Real>& slot = body.bound.slot;
    if (slot.mapped && !slot.rigid) continue;
    body.kinetic_rate = static_cast<std::ptrdiff_t>(rates++);
    kinetic_.push_back({slot.rigid ? slot.centre : slot.offset,
                        slot.rigid ? kGroup : slot.stride * static_cast<std::size_t>(dimension()),
                        body.kinetic_rate});
  }
  system_.view.kinetic = kinetic_.data();
  system_.view.kinetic_count = kinetic_.size();
}

template <class Real>
void Assembly<Real>::start(Real* position, Real* velocity, Real* integrals,
                           const Perturbation* noise, const FinalState* from) {
  BodyStart<Real> start(plan_, noise, position, velocity, from, origin_);
  auto reference = bodies_.reference.begin();
  for (const Body& body : bodies()) {
    const BodySlot<Real>& slot = body.bound.slot;
    start.take(body);
    if (slot.rigid || body.prescribed()) start.write_shape(*reference++);
    if (slot.rigid) {
      start.write_rigid(coordinates_.inverse_mass[slot.centre + kRotation] != Real(0.0));
    } else if (!slot.mapped) {
      start.write_particles();
    }
  }
  for (std::size_t k = 0; k < system_.view.rates; ++k) integrals[k] = Real(0.0);
  for (const Force& force : forces()) {
    if (force.variables->own_count() > 0) force.variables->start_own(integrals);
  }
  if (from != nullptr) start_supports(*from, integrals);
}

template <class Real>
void Assembly<Real>::start_supports(const FinalState& from, Real* own) {
  for (std::size_t k = 0; k < from.own.size(); ++k) own[k] = static_cast<Real>(from.own[k]);
  for (const Force& force : forces()) {
    PulledEnd* const end = force.pulled_end;
    const FinalState::Support* const support = from.support(force.name);
    if (end == nullptr || support == nullptr) continue;
    std::vector<DoubleDouble> travel;
    for (int d = 0; d < dimension(); ++d) {
      const Quad start = absolute_position(plan_.origin, d, force.drive()->start[d]);
      travel.push_back(to_double_double(support->position[d] - start));
    }
    end->begin_at(travel);
  }
  for (const Body& body : bodies()) {
    const FinalState::Support* const support = from.support(body.bound.name);
    if (body.prescribed() && support) prescribed_.begin_at(body, support->position, origin_, own);
  }
}

template <class Real>
void Assembly<Real>::write_numbers(FinalState& state) const {
  const SystemView<Real>& view = system_.view;
  const auto write = [](const Real* x, std::size_t count, std::vector<Quad>& to) {
    to.resize(count);
    for (std::size_t i = 0; i < count; ++i) to[i] = Quad(x[i]);
  };
  write(view.position, view.dofs, state.position);
  write(view.velocity, view.dofs, state.velocity);
  write(view.integrals, view.own_count, state.own);
}

template <class Real>
void Assembly<Real>::write_supports(const DoubleDouble& time, FinalState& state) const {
  for (const Force& force : forces()) {
    const PulledEnd* const end = force.pulled_end;
    if (end == nullptr) continue;
    FinalState::Support& support = state.supports.emplace_back();
    support.name = force.name;
    const std::vector<DoubleDouble> travel = end->travelled(time);
    for (int d = 0; d < dimension(); ++d) {
      support.position.push_back(absolute_position(plan_.origin, d, force.drive()->start[d]) +
                                 to_quad(travel[d]));
    }
  }
  for (const Body& body : bodies()) {
    if (!body.prescribed()) continue;
    state.supports.push_back(
        {body.bound.name, prescribed_.position_of(body, time, origin_, state.own)});
  }
}

template <class Real>
void Assembly<Real>::begin_step(const DoubleDouble& time) {
  forces_.begin_step(time, origin_);
  prescribed_.begin_step(time, origin_);
}

template <class Real>
void Assembly<Real>::rebase(const Origin& origin) {
  origin_ = origin;
  forces_.rebase(origin_);
  coordinates_.place_fixed(plan_, bodies_.all, origin_);
}

template <class Real>
void Assembly<Real>::spoil_forces() {
  Stage<Real> stage;
  stage.force = system_.view.force;
  stage.mapped_force = system_.view.mapped_force;
  evaluation_->spoil(stage);
}

template class Assembly<double>;
template class Assembly<Quad>;

}  // namespace tomlin
