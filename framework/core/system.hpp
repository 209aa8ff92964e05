#pragma once

#include <cstddef>
#include <cstdint>

#include "framework/core/instruction_set.hpp"
#include "framework/core/kernel_arguments.hpp"
#include "framework/core/stage.hpp"

/// A bound scene as integrators and kernels see it: plain arrays and a list of kernel calls.
namespace tomlin {

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

  const Real* inverse_mass = nullptr;     ///< zero where nothing moves and in the padding
  const Real* largest_move = nullptr;     ///< in one step, per coordinate; infinite where unbounded
  const Real* tolerance_scale = nullptr;  ///< coordinate times this is a length or an angle in rad
  std::size_t coordinates = 0;            ///< without padding

  const Operation<Real>* operations = nullptr;  ///< one evaluation of all forces
  std::size_t operation_count = 0;

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

/// What integrators ask of the model between kernel calls.
template <class Real>
struct System {
  SystemView<Real> view;
  InstructionSet set = InstructionSet::baseline;
  std::uint64_t evaluations = 0;  ///< of all forces, so far

  /// Tell forces that depend on time from where stages count their `elapsed`.
  void (*begin_step)(void* model, double time_high, double time_low) = nullptr;
  void* model = nullptr;
};

}  // namespace tomlin
