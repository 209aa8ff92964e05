#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "framework/core/system/flow.hpp"
#include "framework/core/system/instruction_set.hpp"
#include "framework/core/system/kernel_arguments.hpp"
#include "framework/core/system/stage.hpp"
#include "framework/core/system/tangent.hpp"

/// A bound scene as integrators and kernels see it: plain arrays and a list of kernel calls.
namespace tomlin {

/// A running integral of a body's kinetic energy over the steps of a scheme that knows velocities
/// within them (IntegratorRecord::half_step_velocities).
struct KineticIntegral {
  std::size_t first = 0;   ///< coordinates of the body
  std::size_t length = 0;  ///< a multiple of a group
  std::ptrdiff_t rate = kNoRate;
};

template <class Real>
struct SystemView {
  std::size_t dofs = 0;  ///< length of position, velocity and force, padding included
  std::size_t own = 0;   ///< state variables owned by forces, padded; the first of the integrals
  std::size_t own_count = 0;   ///< the same without padding
  std::size_t rates = 0;       ///< own variables and running integrals, padded
  std::size_t used_rates = 0;  ///< without the padding at the end

  // The current state, relative to the scene's origin.
  Real* position = nullptr;
  Real* velocity = nullptr;
  Real* integrals = nullptr;

  bool inertial = true;  ///< false: force times inverse_mass is the velocity, not its change
  const Real* inverse_mass = nullptr;     ///< zero where nothing moves and in the padding; without
                                          ///< inertia the inverse friction coefficient
  const Real* largest_move = nullptr;     ///< in one step, per coordinate; infinite where unbounded
  const Real* tolerance_scale = nullptr;  ///< coordinate times this is a length or an angle in rad
  std::size_t coordinates = 0;            ///< without padding

  const Operation<Real>* operations = nullptr;  ///< one evaluation of all forces
  std::size_t operation_count = 0;

  /// Operators: of all linear friction on a body together, and what forces hand out. None unless
  /// the scheme takes them.
  const Flow<Real>* flows = nullptr;
  std::size_t flow_count = 0;
  bool flows_overlap = false;              ///< several act on the same velocities, or may
  std::ptrdiff_t friction_rate = kNoRate;  ///< where their heat stands among the integrals, if kept

  const KineticIntegral* kinetic = nullptr;  ///< none unless the scene has a thermostat
  std::size_t kinetic_count = 0;

  // Noise without inertia; none unless a force of the scene is stochastic.
  const Noise<Real>* noises = nullptr;
  std::size_t noise_count = 0;
  const Real* noise_scale = nullptr;  ///< sqrt(2 kT/c) of each coordinate; zero where there is none
  const Real* friction = nullptr;     ///< c: generalised friction coefficient of each coordinate

  /// The forces of a scene that is a single particle on a line; none otherwise.
  const PointForce<Real>* point_forces = nullptr;
  std::size_t point_force_count = 0;

  Real* force = nullptr;  ///< scratch for one evaluation
  Real* mapped_position = nullptr;
  Real* mapped_velocity = nullptr;
  Real* mapped_force = nullptr;
};

template <class Real>
inline Stage<Real> stage_of(const SystemView<Real>& system, const Real* position,
                            const Real* velocity, const Real* own, Real* rates, Real elapsed) {
  return {position,
          velocity,
          system.force,
          system.mapped_position,
          system.mapped_velocity,
          system.mapped_force,
          own,
          rates,
          elapsed};
}

struct ElasticBody;  // framework/core/system/elastic.hpp

/// The model as integrators use it between kernel calls.
template <class Real>
struct System {
  SystemView<Real> view;
  InstructionSet set = InstructionSet::baseline;
  std::uint64_t evaluations = 0;  ///< of all forces, so far
  std::uint64_t columns = 0;      ///< of Jacobians, so far: see Tangent::columns()
  Tangent* tangent = nullptr;     ///< for schemes whose record asks for it; null otherwise
  /// All moving bodies, for schemes that split bonds off; null otherwise.
  const std::vector<ElasticBody>* elastic = nullptr;

  /// Tell forces that depend on time from where stages count their `elapsed`.
  void (*begin_step)(void* model, double time_high, double time_low) = nullptr;
  void* model = nullptr;
};

}  // namespace tomlin
