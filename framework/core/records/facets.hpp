#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "framework/core/numbers/double_double.hpp"
#include "framework/core/records/parameter.hpp"
#include "framework/core/system/flow.hpp"
#include "framework/core/system/stage.hpp"
#include "framework/core/system/team.hpp"

/// The facets of a bound force: what only some forces can do. A force offers one by inheriting it
/// besides BoundForce and overriding those functions that say more than the default, which is that
/// of a force without the facet.
namespace tomlin {

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

/// Second derivatives of the energy.
template <class Real>
class Curvature {
 public:
  virtual ~Curvature() = default;
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
};

/// Coefficients of friction, linear or not.
class FrictionCoefficients {
 public:
  virtual ~FrictionCoefficients() = default;
  /// True when the force is linear friction and nothing else, with the coefficients that
  /// friction() gives: dynamics without inertia take it as a matrix, and schemes that take
  /// operators by the flow of all such friction on a body, unless it hands out one of its own.
  virtual bool is_friction() const { return false; }
  virtual void friction(FrictionSink& sink) const { (void)sink; }
  /// Bound on what a change of velocity does to the force of nonlinear friction on particles
  /// (mass/time), over all velocities. 0 where there is none or where friction() reports it.
  virtual double friction_bound() const { return 0.0; }
};

/// The operator of a force: its exact flow alone over a time, see flow.hpp.
template <class Real>
class ExactFlow {
 public:
  virtual ~ExactFlow() = default;
  /// The flow, the same whenever it is asked for, for schemes that take operators; then none of the
  /// force's kernels is called, nor is a rate integrated. Its arguments live as long as the force.
  /// False: there is none, as on rigid bodies, whose velocities are not their particles'.
  virtual bool flow(Flow<Real>& flow) {
    (void)flow;
    return false;
  }
};

/// Variables of a force's own, laid out, integrated and saved by the engine. Kernels read variable
/// k at stage.own[first + k] and write its time derivative to stage.rates[first + k], with the
/// `first` that place_own() gave; start_own() fills own[first + k].
template <class Real>
class InternalVariables {
 public:
  virtual ~InternalVariables() = default;
  virtual std::size_t own_count() const { return 0; }
  virtual void place_own(std::size_t first) { (void)first; }
  virtual void start_own(Real* own) const { (void)own; }
};

/// A driver: running integrals that its kernels give the rates of, its force on each axis, then its
/// power; and the motion of the pulled end.
class Driving {
 public:
  virtual ~Driving() = default;
  virtual std::size_t rate_count() const { return 0; }
  /// Sets the index of its first rate among all rates.
  virtual void place_rates(std::ptrdiff_t first) { (void)first; }
  virtual const Drive* drive() const { return nullptr; }
};

/// Something that happens to a force when an observable passes a value. What events change stands
/// in the run's state, as doubles whatever the number type; the force reads it in begin_step().
class Control {
 public:
  virtual ~Control() = default;
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

/// A force describes itself for messages, warnings and limits of steps.
template <class Real>
class Diagnosis {
 public:
  virtual ~Diagnosis() = default;
  /// Shortest distance that a pair of it keeps; 0 when there are none.
  virtual double shortest_bond() const { return 0.0; }
  /// Bonds that keep the images with which they start, in a periodic box: what has become so long
  /// that another image of the same particle is nearer; empty where none has.
  virtual std::string bond_beyond_half_box(const Stage<Real>& stage) const {
    (void)stage;
    return {};
  }
  /// Reports where and why it has no finite value at a stage: "in 'log(y)', column 1, of
  /// particle 3: ..."; empty when it cannot.
  virtual std::string why_not_finite(const Stage<Real>& stage) const {
    (void)stage;
    return {};
  }
  /// Text of `explain` on the force besides that of its record: what it found out about its
  /// bodies when it was bound, and how exact it is.
  virtual std::string note() const { return {}; }
};

/// A force whose evaluations several threads can share.
class SharesWork {
 public:
  virtual ~SharesWork() = default;
  /// Before its passes are asked for; the team outlives the force.
  virtual void share_with(const Team& team) { (void)team; }
};

/// A support that can start elsewhere than the description says: where the support of another run's
/// driver has come to.
class PulledEnd {
 public:
  virtual ~PulledEnd() = default;
  /// From where the description starts it, along each axis, at a time that is no earlier than its
  /// last change of velocity.
  virtual std::vector<DoubleDouble> travelled(const DoubleDouble& time) const = 0;
  /// At time 0 it has travelled so far already. Before start_control().
  virtual void begin_at(const std::vector<DoubleDouble>& travel) = 0;
  /// It rests where it starts until set_out(). Before its control is laid out.
  virtual void rests_at_first() = 0;
  /// It moves from this time on, having travelled so far.
  virtual void set_out(const DoubleDouble& time, const std::vector<DoubleDouble>& travel) = 0;
  /// The description does not say where it starts: with the attached point.
  virtual bool starts_at_point() const = 0;
  /// There is one for each particle.
  virtual bool is_of_each_particle() const = 0;
};

/// Contents of a force's neighbour lists, as they were last made.
struct NeighbourCount {
  double mean = 0.0;        ///< neighbours of a particle, within the cutoff and the skin
  std::size_t most = 0;     ///< of any particle
  std::uint64_t pairs = 0;  ///< each once
  std::uint64_t bytes = 0;  ///< of all lists and what belongs to them
};

/// A force with a cutoff, which keeps lists of neighbours.
class CountsNeighbours {
 public:
  virtual ~CountsNeighbours() = default;
  /// All zero before the first evaluation.
  virtual NeighbourCount count_neighbours() const = 0;
};

/// The facet that a force offers, or one that answers for a force without it; PulledEnd and
/// CountsNeighbours have no such answer, and are found by dynamic_cast.
template <class Facet, class Force>
Facet* facet_of(Force& force) {
  static Facet none;  // without state: all forces share it
  auto* const offered = dynamic_cast<Facet*>(&force);
  return offered != nullptr ? offered : &none;
}

}  // namespace tomlin
