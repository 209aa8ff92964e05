#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "framework/core/numbers/double_double.hpp"
#include "framework/core/records/coordinates.hpp"
#include "framework/core/records/neighbours.hpp"
#include "framework/core/records/parameter.hpp"
#include "framework/core/records/variation.hpp"
#include "framework/core/system/aligned.hpp"
#include "framework/core/system/flow.hpp"
#include "framework/core/system/instruction_set.hpp"
#include "framework/core/system/kernel_arguments.hpp"
#include "framework/core/system/lanes.hpp"
#include "framework/core/system/stage.hpp"

/// A force is complete once a scene is bound, with every number resolved. Here are the contracts of
/// forces, of operators and of state that forces own.
namespace tomlin {

/// The scene's origin: whole cells per axis. All positions are kept relative to it.
struct Origin {
  std::array<std::int64_t, 3> cells{};
  std::array<double, 3> unit{};  ///< length of a cell: the longest period declared; 0: never moves
};

/// A position of the scene relative to its origin, to the last digit.
inline double relative_to(const Origin& origin, int axis, double position) {
  const DoubleDouble shift =
      DoubleDouble(static_cast<double>(origin.cells[axis])) * origin.unit[axis];
  return static_cast<double>(DoubleDouble(position) - shift);
}

/// A body as forces see it when they bind.
template <class Real>
struct BoundBody {
  std::string name;
  std::size_t index = 0;
  Coordinates coordinates = Coordinates::particles;
  bool closed = false;
  BodySlot<Real> slot;
  int open_along = -1;                       ///< a chain that the box closes: along this axis
  int freedom = 0;                           ///< how many of its coordinates move by forces
  std::vector<double> mass;                  ///< [count]
  std::vector<std::array<double, 3>> start;  ///< [count][axis], from the scene's origin; else 0
  std::vector<double> start_centre;          ///< [dimension], centre of mass
  NeighbourList neighbours;
  std::vector<std::int32_t> species;           ///< [count], indices of names; empty: it has none
  std::span<const std::string> species_names;  ///< of all species of the scene, each once
};

template <class Real>
struct Binding {
  int dimension = 0;
  InstructionSet set = InstructionSet::baseline;
  Origin origin;                               ///< at time 0; an axis whose unit is 0 never moves
  std::array<double, 3> box{};                 ///< length of each periodic axis, else 0
  std::vector<const BoundBody<Real>*> bodies;  ///< those the force acts on
  /// Parameters that differ between the particles of its one body; only where its record varies.
  std::span<const Variation> variations;
};

/// Forces on the particles of a body, or on the centre of a rigid one.
struct Region {
  std::size_t body = 0;
  bool centre = false;
};

/// Cheap passes come first and those with long latencies last, so that they overlap.
inline constexpr int kRankCheap = 0;
inline constexpr int kRankPairs = 1;
inline constexpr int kRankTranscendental = 2;

/// One kernel call of a force. The model orders the passes and lets the first on a region set.
template <class Real>
struct Pass {
  /// Null: this pass can only add. What stands in the region before is no number that means
  /// anything, so all of it is written: of particles every axis with its padding, up to a whole
  /// group, and of a centre its group of eight, the rotation included.
  Kernel<Real> set = nullptr;
  Kernel<Real> add = nullptr;
  const void* arguments = nullptr;
  std::vector<Region> writes;
  int rank = kRankCheap;
  LaneForm lanes = {};  ///< the same call over replicas, where there is one
};

/// Receives second derivatives of the energy, element by element, in particle coordinates.
class HessianSink {
 public:
  virtual ~HessianSink() = default;
  /// d2V / dx_a dx_b of one particle.
  virtual void site(std::size_t body, std::size_t particle, int a, int b, double value) = 0;
  /// d2V / ds_a ds_b, s the separation of two particles.
  virtual void pair(std::size_t body1, std::size_t particle1, std::size_t body2,
                    std::size_t particle2, int a, int b, double value) = 0;
  /// d2V / dx_a dy_b, x and y the positions of two different particles (y_b with x_a comes as a
  /// call of its own): what forces among three or more are made of, besides site().
  virtual void block(std::size_t body1, std::size_t particle1, int a, std::size_t body2,
                     std::size_t particle2, int b, double value) = 0;
  /// d2V / dc_a dc_b, c the weighted mean of a body's particles.
  virtual void centre(std::size_t body, const double* weight, int a, int b, double value) = 0;

 protected:
  HessianSink() = default;
};

/// Receives the friction coefficient (mass/time) of particles.
class FrictionSink {
 public:
  virtual ~FrictionSink() = default;
  virtual void site(std::size_t body, std::size_t particle, double coefficient) = 0;
  /// Receives the temperature of the bath of friction with noise, an energy, after the coefficient.
  virtual void bath(std::size_t body, std::size_t particle, double coefficient,
                    double temperature) {
    (void)body, (void)particle, (void)coefficient, (void)temperature;
  }

 protected:
  FrictionSink() = default;
};

/// Data of a driver for summaries and for the window in driver periods.
struct Drive {
  std::vector<double> velocity;   ///< of the pulled end, where it is steady
  bool steady = true;             ///< false: the velocity changes with time
  std::vector<double> stiffness;  ///< of all its springs together, per axis; empty: no spring
  std::vector<double> start;      ///< of the pulled end, relative to the first origin; the centre's
                                  ///< where each particle has its own
  std::vector<double> travel;     ///< since then, up to the start of the step, less the origin's

  double stiffness_on(int axis) const {
    return stiffness.empty() ? 0.0 : stiffness[static_cast<std::size_t>(axis)];
  }
  /// Along the velocity, n.K.n; of a driver at rest the largest of all axes.
  double stiffness_along() const {
    double along = 0.0;
    double squares = 0.0;
    double most = 0.0;
    bool equal = true;  // without rounding
    for (std::size_t d = 0; d < stiffness.size(); ++d) {
      const double v = velocity.empty() ? 0.0 : velocity[d];
      along += stiffness[d] * v * v;
      squares += v * v;
      most = stiffness[d] > most ? stiffness[d] : most;
      equal = equal && stiffness[d] == stiffness.front();
    }
    return equal || !(squares > 0.0) ? most : along / squares;
  }
};

template <class Real>
class BoundForce {
 public:
  virtual ~BoundForce() = default;

  // The force contract.

  /// Kernel calls of one evaluation. Their arguments live as long as this object.
  virtual std::vector<Pass<Real>> passes() = 0;
  /// On a single particle on a line: the same force for one point, in registers. False when there
  /// is no such kernel.
  virtual bool point(PointForce<Real>& force) const {
    (void)force;
    return false;
  }
  /// Running integrals that its kernels give the rates of: a driver's force on each axis, then its
  /// power. `place_rates` says where among all rates. (Variables of its own stand apart, see
  /// below.)
  virtual std::size_t rate_count() const { return 0; }
  virtual void place_rates(std::ptrdiff_t first) { (void)first; }
  /// For forces that depend on time: stages count their `elapsed` from this time on. Called every
  /// few steps, not at each.
  virtual bool depends_on_time() const { return false; }
  virtual void begin_step(const DoubleDouble& time) { (void)time; }
  /// The scene's origin has moved; positions are relative to the new one from now on.
  virtual void rebase(const Origin& origin) { (void)origin; }
  /// Potential energy; 0 for a force without one.
  virtual Real energy(const Stage<Real>& stage) const {
    (void)stage;
    return Real(0.0);
  }
  /// Second derivatives of the energy at a stage.
  virtual void hessian(const Stage<Real>& stage, HessianSink& sink) const {
    (void)stage;
    (void)sink;
  }
  /// Bound on the curvature of a site force's energy, over all positions; negative when the
  /// Hessian at the start is the better estimate (springs).
  virtual double curvature_bound() const { return -1.0; }
  /// Bound on the curvature along one axis; the bound over all directions unless a force knows
  /// better.
  virtual double curvature_bound_along(int axis) const {
    (void)axis;
    return curvature_bound();
  }
  virtual const Drive* drive() const { return nullptr; }
  /// Shortest distance that a pair of it keeps; 0 when there are none.
  virtual double shortest_bond() const { return 0.0; }
  /// Bonds that keep the images with which they start, in a periodic box: what has become so long
  /// that another image of the same particle is nearer, for a warning; empty where none has.
  virtual std::string bond_beyond_half_box(const Stage<Real>& stage) const {
    (void)stage;
    return {};
  }
  /// Reports where and why it has no finite value at a stage: "in 'log(y)', column 1, of
  /// particle 3: ...". For messages; empty when it cannot.
  virtual std::string why_not_finite(const Stage<Real>& stage) const {
    (void)stage;
    return {};
  }

  /// For the energy ledger: a kernel that writes the power which this force takes out of the
  /// particles to stage.rates[rate]. False for a force that only stores energy.
  virtual bool heat(std::ptrdiff_t rate, Operation<Real>& operation) {
    (void)rate;
    (void)operation;
    return false;
  }

  /// Text of `explain` on the force besides that of its record: what it found out about its
  /// bodies when it was bound, and how exact it is.
  virtual std::string note() const { return {}; }

  // The operator contract: the exact flow of this force alone over a time, see flow.hpp.

  /// The flow, the same whenever it is asked for, for schemes that take operators; then none of its
  /// kernels is called, nor is a rate integrated. Its arguments live as long as this object. False:
  /// there is none, as on rigid bodies, whose velocities are not their particles'.
  virtual bool flow(Flow<Real>& flow) {
    (void)flow;
    return false;
  }
  /// True when this force is linear friction and nothing else, with the coefficients that
  /// friction() gives: dynamics without inertia take it as a matrix, and schemes that take
  /// operators by the flow of all such friction on a body, unless it hands out one of its own.
  virtual bool is_friction() const { return false; }
  virtual void friction(FrictionSink& sink) const { (void)sink; }
  /// Bound on what a change of velocity does to the force of nonlinear friction on particles
  /// (mass/time), over all velocities. 0 where there is none or where friction() reports it.
  virtual double friction_bound() const { return 0.0; }

  // The state contract: variables of its own, laid out, integrated and saved by the engine. Kernels
  // read variable k at stage.own[first + k] and write its time derivative to stage.rates[first +
  // k], with the `first` that place_own() gave; start_own() fills own[first + k].

  virtual std::size_t own_count() const { return 0; }
  virtual void place_own(std::size_t first) { (void)first; }
  virtual void start_own(Real* own) const { (void)own; }

  // The control contract: something that happens to this force when an observable passes a value.
  // What events change stands in the run's state, as doubles whatever the number type; the force
  // reads it in begin_step().

  /// The event that it waits for; null for a force that nothing happens to.
  virtual const Passing* waits_for() const { return nullptr; }
  virtual std::size_t control_count() const { return 0; }
  virtual void attach_control(double* control) { (void)control; }
  virtual void start_control() {}
  /// True as long as it may happen again.
  virtual bool waits() const { return false; }
  /// It has happened.
  virtual void passed(const DoubleDouble& time) { (void)time; }
};

}  // namespace tomlin
