#include "framework/model/assembly.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "framework/core/random.hpp"
#include "framework/core/sum.hpp"

namespace tomlin {

template <class Real>
Assembly<Real>::Assembly(const AssemblyPlan& plan)
    : plan_(plan),
      origin_(plan.origin),
      bodies_(plan_),
      coordinates_(plan_, bodies_, system_.view),
      forces_(plan_, bodies_.all),
      prescribed_(plan_, bodies_) {
  system_.set = plan_.set;
  lay_rates();
  coordinates_.scale_tolerances(scene(), bodies_.all, prescribed_, system_.view);
  coordinates_.bound_moves(forces_.all, bodies_.all, dimension());
  if (!plan_.inertial || plan_.splits_friction) {
    friction_.lay(plan_, bodies_.all, forces_.all, coordinates_.inverse_mass, system_.view);
  }
  evaluation_.emplace(plan_, bodies_, prescribed_, forces_.all, friction_, system_.view);
}

/// Own variables come first among the integrals: stages read them back.
template <class Real>
void Assembly<Real>::lay_rates() {
  std::size_t own = prescribed_.own_count();
  for (Force& force : forces_.all) {
    if (force.bound->own_count() == 0) continue;
    force.bound->place_own(own);
    own += force.bound->own_count();
  }
  std::size_t rates = padded(own);
  for (Force& force : forces_.all) {
    if (force.bound->rate_count() == 0) continue;
    force.first_rate = static_cast<std::ptrdiff_t>(rates);
    force.bound->place_rates(force.first_rate);
    rates += force.bound->rate_count();
    if (force.traits.does_work) {
      drivers_.push_back({force.name, force.first_rate, force.bound->drive()});
    }
  }
  prescribed_.lay_rates(plan_, bodies_, rates, drivers_);
  if (plan_.ledger) {
    for (Force& force : forces_.all) {
      Operation<Real> unused;
      if (force.is_operator || !force.bound->heat(0, unused)) continue;
      force.heat_rate = static_cast<std::ptrdiff_t>(rates++);
    }
    if (!plan_.inertial || plan_.splits_friction) {
      friction_.rate = static_cast<std::ptrdiff_t>(rates++);
    }
  }
  SystemView<Real>& view = system_.view;
  view.own = padded(own);
  view.own_count = own;
  view.rates = padded(rates);
  view.used_rates = rates;
}

template <class Real>
void Assembly<Real>::start(Real* position, Real* velocity, Real* integrals,
                           const Perturbation* noise) {
  const auto is_perturbed = [&](std::size_t b) {
    return noise != nullptr &&
           std::find(noise->bodies.begin(), noise->bodies.end(), b) != noise->bodies.end();
  };
  const auto jitter = [&](std::size_t b, std::uint64_t kind, std::uint64_t k) {
    return Real(noise->size * uniform_symmetric({noise->seed, noise->stream}, {b, kind, k, 0}));
  };
  enum : std::uint64_t { kCoordinate, kShape };
  std::size_t next_rigid = 0;
  for (const Body& body : bodies()) {
    const BodySlot<Real>& slot = body.bound.slot;
    const std::size_t b = body.bound.index;
    const bool perturbed = is_perturbed(b);
    const SceneBody& from = scene().bodies[b];
    const PerParticleVector& given = from.record->common(from.description.get()).velocity;
    const auto speed = [&](std::size_t i, int d) {
      if (given.values.empty() || body.held[d]) return 0.0;
      return given.values[given.values.size() == 1 ? 0 : i].components[d];
    };
    if (slot.rigid || body.prescribed()) {
      // A rigid body's shape is disturbed too: noise on its coordinates alone dies out wherever it
      // is stable for a while, and an unstable symmetry later on would see none of it.
      AlignedVector<Real>& reference = bodies_.reference[next_rigid++];
      for (std::size_t i = 0; i < slot.count; ++i) {
        for (int d = 0; d < dimension(); ++d) {
          Real& arm = reference[d * slot.stride + i];
          arm = Real(body.arms[i][d]);
          if (perturbed && slot.rigid) arm = arm + jitter(b, kShape, i * dimension() + d);
        }
      }
    }
    if (slot.rigid) {
      // The velocity field's momentum and angular momentum, which is all that a rigid body keeps.
      for (int d = 0; d < dimension(); ++d) {
        InterleavedSum<Real> mean;
        for (std::size_t i = 0; i < slot.count; ++i) {
          mean.add(i, slot.share[i] * Real(speed(i, d)));
        }
        position[slot.centre + d] = Real(body.bound.start_centre[d]);
        velocity[slot.centre + d] = mean.total();
        if (perturbed && !body.held[d]) {
          position[slot.centre + d] = position[slot.centre + d] + jitter(b, kCoordinate, d);
        }
      }
      if (dimension() != 2) continue;
      const bool turns = coordinates_.inverse_mass[slot.centre + kRotation] != Real(0.0);
      InterleavedSum<double> spin;
      for (std::size_t i = 0; i < slot.count; ++i) {
        spin.add(i, body.bound.mass[i] *
                        (body.arms[i][0] * speed(i, 1) - body.arms[i][1] * speed(i, 0)));
      }
      position[slot.centre + kRotation] = Real(0.0);
      velocity[slot.centre + kRotation] =
          body.inertia > 0.0 && !body.rotation_held
              ? Real(spin.total()) / (tau<Real>() * Real(body.inertia))
              : Real(0.0);
      if (perturbed && turns) {
        position[slot.centre + kRotation] = jitter(b, kCoordinate, kRotation) / tau<Real>();
      }
    } else if (!slot.mapped) {
      for (std::size_t i = 0; i < slot.count; ++i) {
        for (int d = 0; d < dimension(); ++d) {
          const std::size_t at = slot.offset + d * slot.stride + i;
          position[at] = Real(body.bound.start[i][d]);
          velocity[at] = Real(speed(i, d));
          if (perturbed && !body.held[d]) {
            position[at] = position[at] + jitter(b, kCoordinate, i * dimension() + d);
          }
        }
      }
    }
  }
  for (std::size_t k = 0; k < system_.view.rates; ++k) integrals[k] = Real(0.0);
  for (const Force& force : forces()) {
    if (force.bound->own_count() > 0) force.bound->start_own(integrals);
  }
}

template <class Real>
void Assembly<Real>::begin_step(const DoubleDouble& time) {
  forces_.begin_step(time);
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
template class Assembly<float>;
template class Assembly<Quad>;

}  // namespace tomlin
