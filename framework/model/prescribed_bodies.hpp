#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "framework/core/records/bound_force.hpp"
#include "framework/model/assembled_bodies.hpp"
#include "framework/model/final_state.hpp"

namespace tomlin {

/// A driver does work on the scene: a force with a support, or a prescribed body.
struct AssembledDriver {
  std::string name;
  std::ptrdiff_t first_rate = kNoRate;
  const Drive* drive = nullptr;
};

/// Bodies whose motion the scene prescribes: where they are at each stage, and what accelerates
/// them. Kernels hold pointers into it.
template <class Real>
class PrescribedBodies {
 public:
  /// Own variables that hold the way of a body whose motion changes with time.
  struct Steered {
    std::size_t body = 0;
    std::ptrdiff_t own[4] = {-1, -1, -1, -1};  ///< x, y, z, turns
  };

  PrescribedBodies(const AssemblyPlan& plan, AssembledBodies<Real>& bodies);
  PrescribedBodies(const PrescribedBodies&) = delete;
  PrescribedBodies& operator=(const PrescribedBodies&) = delete;

  const std::deque<Steered>& steered() const { return steered_; }
  std::size_t own_count() const { return own_count_; }
  /// Takes rates for the force on each body and its power; each body becomes a driver.
  void assign_rates(const AssemblyPlan& plan, AssembledBodies<Real>& bodies, std::size_t& rates,
                    std::vector<AssembledDriver>& drivers);
  /// The kernels that say where the bodies are.
  void add_steering(std::vector<Operation<Real>>& operations) const;
  /// The kernel that adds what accelerates a body to the force on it, if anything does.
  void add_inertia(std::size_t body, std::vector<Operation<Real>>& operations) const;

  /// Position of a body, in the scene's own coordinates, with this origin and these internal
  /// variables; a planar one's rotation after it, in rad.
  std::vector<Quad> position_of(const AssembledBody<Real>& body, const DoubleDouble& time,
                                const Origin& origin, const std::vector<Quad>& own) const;
  /// It starts there, at time 0, and not where the scene says. Writes its internal variables.
  void begin_at(const AssembledBody<Real>& body, const std::vector<Quad>& position,
                const Origin& origin, Real* own);

  /// Stages count their time from here on, and positions from this origin.
  void begin_step(const DoubleDouble& time, const Origin& origin);

  /// How far a body has come since the start along an axis, at the anchor.
  double travel_of(const AssembledBody<Real>& body, int axis, const Real* integrals) const;
  /// Its rotation in turns at the last evaluation.
  double turns_of(const AssembledBody<Real>& body) const;
  /// Its velocity along an axis at the last evaluation.
  double speed_of(const AssembledBody<Real>& body, int axis) const;

 private:
  /// Motion of a body: its displacement, from the time alone or from its internal variables.
  struct Steering {
    const Motion* motion = nullptr;
    int axes = 0;
    bool planar = false;
    Real start[3] = {};     ///< of the centre, relative to the present origin
    Real speed[4] = {};     ///< x, y, z, turns: where they do not change
    Real travel[4] = {};    ///< since the start, at the anchor
    DoubleDouble began[4];  ///< how far it had travelled at time 0; of a rotation in rad
    std::ptrdiff_t own[4] = {-1, -1, -1, -1};
    DoubleDouble anchor;
    Real coordinates[3] = {};  ///< as a rigid body's: in the plane x, y, turns
    Real speeds[3] = {};

    bool has(int k) const { return k < 3 ? k < axes : planar; }
    const TimeFunction& function(int k) const {
      return k < 3 ? motion->velocity[k] : motion->angular_velocity;
    }
    /// Displacement where the velocity is constant.
    DoubleDouble travelled(int k, const DoubleDouble& time) const {
      const DoubleDouble since_start = time * function(k).constant;
      return began[k] == DoubleDouble() ? since_start : began[k] + since_start;
    }
  };
  /// Inertial force of a body, besides what the forces on it take: m dv/dt and the power of that
  /// and of I domega/dt. Added to the body's force and power, and kept apart behind them, since
  /// their integrals are known from the velocities at both ends, jumps of the velocity included.
  struct Inertia {
    std::size_t body = 0;
    const Motion* motion = nullptr;
    const DoubleDouble* anchor = nullptr;  ///< of the stages' time
    double mass = 0.0;
    double inertia = 0.0;
    std::ptrdiff_t rate = kNoRate;  ///< of the body's force
  };

  static void steer(const void* arguments, const Stage<Real>& stage);
  static void accelerate(const void* arguments, const Stage<Real>& stage);

  Origin first_origin_;  ///< which starts are relative to
  std::size_t own_count_ = 0;
  std::deque<Steering> steering_;
  std::deque<Steered> steered_;
  std::deque<Drive> drives_;
  std::deque<Inertia> inertia_;
};

}  // namespace tomlin
