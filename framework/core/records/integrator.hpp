#pragma once

#include <complex>
#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "framework/core/records/body.hpp"
#include "framework/core/records/registry.hpp"
#include "framework/core/system/lane_block.hpp"

/// Integrators as the registry knows them; what they see of a bound scene stands in
/// framework/core/system/system.hpp.
namespace tomlin {

template <class Real>
class Integrator;
template <class Real>
struct System;
class AdaptiveLanes;
struct LaneLayout;

struct Quad;

template <class Real>
using IntegratorFactory = std::unique_ptr<Integrator<Real>> (*)(const void* description,
                                                                System<Real>& system);

/// Factories by number type; the first is required.
struct IntegratorFactories {
  IntegratorFactory<double> in_double = nullptr;
  IntegratorFactory<Quad> in_quadruple = nullptr;

  IntegratorFactories() = default;
  IntegratorFactories(IntegratorFactory<double> d,  // NOLINT: one will do
                      IntegratorFactory<Quad> q = nullptr)
      : in_double(d), in_quadruple(q) {}

  template <class Real>
  IntegratorFactory<Real> in() const {
    if constexpr (std::is_same_v<Real, double>) {
      return in_double;
    } else {
      return in_quadruple;
    }
  }
};

struct IntegratorRecord : ComponentRecord {
  int order = 0;          ///< global order in the positions, velocity-dependent forces included
  bool adaptive = false;  ///< chooses its own steps
  int evaluations_per_step = 0;  ///< of all forces, per accepted step
  bool without_inertia = true;   ///< takes overdamped scenes too
  /// Takes operators (flow.hpp): friction, and whatever forces hand out, in place of the forces.
  /// Other forces that depend on velocity or have variables of their own are then refused.
  bool splits_friction = false;
  /// Draws random numbers for forces with noise, at the steps of its grid.
  bool takes_noise = false;
  /// Its kinetic energies are those of velocities within steps (KineticIntegral).
  bool half_step_velocities = false;
  bool with_inertia = true;  ///< false: for overdamped scenes alone
  /// Takes bonds within bodies as an operator too, whose stiffness then limits no step.
  bool splits_bonds = false;
  bool needs_tangent = false;      ///< solves equations with the forces' derivatives
  bool conservative_only = false;  ///< for scenes without friction and other loss
  /// A fixed step does to every coordinate what it does to every other, and keeps nothing between
  /// steps: arrays may hold the coordinates of several runs (framework/core/system/lanes.hpp).
  bool in_lanes = false;
  /// Form of an adaptive scheme for lanes: over the system of replicas that the layout describes.
  std::unique_ptr<AdaptiveLanes> (*adaptive_lanes)(const LaneLayout& layout,
                                                   System<double>& system) = nullptr;
  /// Follows equilibria as the driver moves: for quasistatic dynamics, and for no other.
  bool follows_equilibria = false;

  /// Growth factor |R(z)| on y' = lambda y, z = h lambda; stable where it does not exceed 1.
  double (*growth)(std::complex<double> z) = nullptr;
  /// Instead of it, for a scheme that is no function of h lambda: the largest step for an
  /// oscillator of this angular frequency and damping rate.
  double (*stable_step)(double frequency, double damping_rate) = nullptr;
  /// The finest tolerance that an adaptive scheme is asked to keep; null for a fixed one.
  double (*tolerance)(const void* description) = nullptr;
  /// How many steps an adaptive scheme may take; null for a fixed one.
  std::int64_t (*most_steps)(const void* description) = nullptr;
  /// Relative error of the speed at which a steady force drags a coordinate, `damped` = step *
  /// damping rate; null: none, whatever the step.
  double (*drag_error)(double damped) = nullptr;
  /// Relative error of the variance of positions in a harmonic well without inertia, `relaxed` =
  /// step * relaxation rate of the well; null: none, whatever the step.
  double (*variance_error)(double relaxed) = nullptr;
  /// The fixed step; 0 for an adaptive scheme.
  double (*step)(const void* description) = nullptr;
  /// Faults across keys; empty when valid.
  std::vector<Complaint> (*complaints)(const void* description) = nullptr;

  IntegratorFactories bind;
  /// The kernel that takes steps of single particles on a line in lanes in registers. Given where
  /// forces are known too.
  LaneBlockFinder lane_block = nullptr;

  /// True when no scene of particles is refused for what its forces are, with inertia or without.
  bool takes_any_scene() const {
    return without_inertia && with_inertia && !splits_friction && !needs_tangent &&
           !conservative_only && !follows_equilibria;
  }
};

}  // namespace tomlin
