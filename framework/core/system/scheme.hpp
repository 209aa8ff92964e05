#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "framework/core/numbers/double_double.hpp"
#include "framework/core/system/lanes.hpp"
#include "framework/core/system/state_layout.hpp"
#include "framework/core/system/system.hpp"

/// The contract of integrators.
namespace tomlin {

/// How a step ended. Failures are values: the run loop adds position and cause.
enum class StepFault {
  none,
  not_finite_or_too_far,  ///< a coordinate left the finite numbers or moved too far in one step
  step_too_small,         ///< an adaptive scheme would need less than its smallest step
  too_many_steps,         ///< an adaptive scheme has used up its steps
  no_equilibrium,         ///< no stable equilibrium was found: nothing holds the scene
};

struct StepReport {
  double taken = 0.0;  ///< length of the step; 0 when it failed
  StepFault fault = StepFault::none;
};

/// The equilibrium that a scene is in. Second derivatives of the potential energy are with respect
/// to the free coordinates, angles in rad.
struct EquilibriumState {
  std::size_t neutral = 0;       ///< directions that nothing holds
  double softest = 0.0;          ///< smallest along a direction of unit length that is not neutral
  double log_determinant = 0.0;  ///< ln |det|; not a number where a direction is neutral
  std::vector<std::size_t> neutral_at;  ///< the coordinate that moves most, of each direction
};

/// Schemes that follow equilibria offer this. A step ends at the latest where the equilibrium loses
/// its stability; the scene then slips to the next one, in no time.
class EquilibriumPath {
 public:
  virtual ~EquilibriumPath() = default;

  /// From the scene's start to an equilibrium, at the start of a run that is `ahead`.
  virtual StepFault settle(double ahead) = 0;
  /// The last step has ended where the equilibrium does.
  virtual bool ends() const = 0;
  /// To the next equilibrium, at the end of the last step, which is `since` after the anchor, with
  /// `ahead` to go.
  virtual StepFault slip(double since, double ahead) = 0;
  /// It was a jump. Else the scene has only branched off: the next equilibrium begins where the
  /// last one has ended.
  virtual bool jumped() const = 0;
  /// If the last settle() or slip() was a tie, no force but rounding preferring the equilibrium
  /// that it took, returns the coordinate in which that differs most from the other one.
  virtual std::optional<std::size_t> tied() const = 0;
  /// Before settle(): steady random forces, which displace the first equilibrium by about `size`,
  /// decide from then on where nothing stronger does. Those of streams 1 and 2, 3 and 4, ... are
  /// opposite, so that an unstable equilibrium is left to opposite sides wherever they decide.
  virtual void disturb(double size, std::uint64_t seed, std::uint64_t stream) = 0;

  /// Moments of the last step, close enough that cubics through each four show all that it does;
  /// the first is its start and the last its end.
  static constexpr std::size_t kMoments = 49;
  /// The state there; returns the part of the step's time that has passed.
  virtual double moment(std::size_t k, double* position, double* velocity, double* rates) const = 0;

  /// Describes the present state.
  virtual EquilibriumState state(double since) = 0;

 protected:
  EquilibriumPath() = default;
};

/// A running integral that results are made of, and what its rate must be multiplied by to be a
/// power: 1, or for a force the speed of what it pulls.
struct WatchedIntegral {
  std::size_t rate = 0;  ///< where it stands among the rates
  double speed = 1.0;
  double stiffness = 0.0;  ///< by how much the rate changes where a coordinate does
};

/// Schemes that choose their steps by an estimate of the error offer this.
class ErrorControl {
 public:
  virtual ~ErrorControl() = default;

  /// Attempts that the estimate has refused.
  virtual std::uint64_t refused_steps() const = 0;
  /// Before the first step: integrals whose error a scheme may hold against what is dissipated,
  /// which is no less on average than at the velocities `along`, [dofs]: all move with the drivers.
  virtual void watch(const std::vector<WatchedIntegral>& integrals,
                     const std::vector<double>& along) {
    (void)integrals, (void)along;
  }
  /// Error of the works among them that rounding has made so far, where that is more than the
  /// tolerance allows; an energy.
  virtual double rounding_of_works() const { return 0.0; }

 protected:
  ErrorControl() = default;
};

/// Schemes whose dense output has velocities and rates of its own, without an evaluation, offer
/// this.
class DenseRates {
 public:
  virtual ~DenseRates() = default;

  /// Velocities and rates at a fraction theta of the last step, to the order of the dense output.
  virtual void between(double theta, double* velocity, double* rates) const = 0;

 protected:
  DenseRates() = default;
};

/// Fixed steps of a single particle without leaving registers.
template <class Real>
class PointBlocks {
 public:
  virtual ~PointBlocks() = default;

  /// Up to `most` plain steps, the first `first` steps of `h` after the anchor: returns how many
  /// were taken before one failed (all, when none did).
  virtual std::size_t point_block(std::size_t first, double h, std::size_t most,
                                  const PointStarts<Real>& starts) = 0;

 protected:
  PointBlocks() = default;
};

/// A fixed scheme over a system of replicas in lanes (lanes.hpp) offers this where a run has
/// numbers of its own between steps.
class FixedLanes {
 public:
  virtual ~FixedLanes() = default;

  /// From the state of the run in a lane, and back.
  virtual void put_lane(const LaneLayout& layout, std::size_t lane, RunState& run) = 0;
  virtual void get_lane(const LaneLayout& layout, std::size_t lane, RunState& run) const = 0;

 protected:
  FixedLanes() = default;
};

/// An adaptive scheme over a system of replicas in lanes, each with its own tolerances, control and
/// steps: they have the bits of Integrator::step_from() of a single run.
class AdaptiveLanes {
 public:
  virtual ~AdaptiveLanes() = default;

  /// Outcome of an attempt: a step, a rejection (nothing taken, no fault), or the fault with
  /// which the step fails. The state of a failed step is the one before it.
  struct Attempt {
    double taken = 0.0;
    StepFault fault = StepFault::none;
    unsigned evaluations = 0;
  };

  /// The scheme's own numbers of a run, from its state and its description; and back, between
  /// steps. One without a run repeats another's.
  virtual void put(std::size_t lane, const System<double>& run, const void* description,
                   RunState& state) = 0;
  virtual void get(std::size_t lane, RunState& state) const = 0;
  /// The length of a lane's next attempt, where the step may take at most `most`.
  virtual double next_attempt(std::size_t lane, double most) const = 0;
  /// One attempt in each lane.
  virtual void attempt(const std::vector<double>& most, std::vector<Attempt>& attempts) = 0;

 protected:
  AdaptiveLanes() = default;
};

/// The interfaces beyond steps that a scheme has for its system at present; null: not that one.
template <class Real>
struct Capabilities {
  EquilibriumPath* path = nullptr;
  ErrorControl* error_control = nullptr;
  DenseRates* dense_rates = nullptr;
  FixedLanes* lanes = nullptr;
  PointBlocks<Real>* point_blocks = nullptr;
};

/// Advances position, velocity and integrals of a system. All three are known at the same time at
/// the end of every step.
template <class Real>
class Integrator {
 public:
  virtual ~Integrator() = default;

  /// Numbers of its own that a resumed run needs.
  virtual void declare(StateLayout& layout) { (void)layout; }
  /// The state it works on from now on; outlives the integrator's use of it.
  virtual void attach(RunState& state) { (void)state; }

  /// One step from `since` after the time that forces are anchored at. A fixed scheme takes exactly
  /// `h`; an adaptive one takes at most `h`. With `dense`, interpolate() will be asked for. A
  /// failed step leaves the state as it was.
  virtual StepReport step_from(double since, double h, bool dense) = 0;

  /// Makes one step from a time of its own.
  StepReport step(const DoubleDouble& time, double h, bool dense) {
    anchor(time);
    return step_from(0.0, h, dense);
  }

  /// Rates at the start of the last step.
  virtual const Real* first_rates() const = 0;

  /// Complete the last step (made with `dense`) for interpolation. Where that takes an evaluation
  /// at its end, `since` after the anchor, it is the next step's first: steps do not depend on
  /// samples.
  virtual void finish_dense_from(double since) = 0;
  /// The state at a fraction theta in [0, 1] of the last step, as doubles: whoever looks on needs
  /// no more.
  virtual void interpolate(double theta, double* position, double* velocity,
                           double* integrals) const = 0;

  /// The origin has moved: drop what was computed ahead, so that it is computed as it would have
  /// been without samples.
  virtual void rebased() {}

  /// Forces have changed at this moment, at an event: what is known of the next step's start is
  /// computed anew.
  virtual void forces_changed() { rebased(); }

  /// Evaluations that are counted already and belong to the next step. They are lost with the
  /// state's bytes, and made again.
  virtual std::uint64_t evaluations_ahead() const { return 0; }

  /// Whether the numbers that a run has between steps are known. Before its first step they are
  /// not.
  virtual bool is_started() const { return true; }

  virtual Capabilities<Real> capabilities() { return {}; }

 protected:
  explicit Integrator(System<Real>& system) : system_(system) {}
  void anchor(const DoubleDouble& time) { system_.begin_step(system_.model, time.hi, time.lo); }

  System<Real>& system_;
};

}  // namespace tomlin
