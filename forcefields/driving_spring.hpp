#pragma once

#include "framework/core/elements/element.hpp"
#include "framework/core/records/parameter.hpp"

/// A spring whose support moves at constant velocity.
///
///   X(t) = X0 + V t;   F_d = k_d (X_d - x_d);   V_spring = sum over axes (k_d/2) (X_d - x_d)^2;
///   power in = F.V
///
///   k   stiffness  mass/time^2, one for all axes or one per axis, where 0 leaves that axis free;
///                  with attach = "each_particle" that of each particle's spring
///       axes       along which the spring acts; all by default
///   V   velocity   of the support, per axis
///   X0  start      the attached point at t = 0 by default (for each particle its own); where the
///                  spring is active from a time t0 on, the attached point then, and X0 + V (t -
///                  t0)
///   x   attach     "centre_of_mass", "each_particle" or { particle = i }
///   reverse        V changes its sign when an observable passes a value; X(t) is continuous; with
///                  two limits and no `times` as long as the run lasts
///
/// F is the lateral force that a friction force microscope reads: positive along x when the driver
/// leads. A force on the centre of mass is shared among the particles by mass, which is virtual
/// work; with equal masses each gets F/N.
/// Source: Sircar and Patra, eqs. (4) to (6); Prandtl (1928).
namespace tomlin {

struct ForceRecord;  // framework/core/records/force.hpp

struct DrivingSpringDescription {
  WordOrNumbers stiffness;
  WordList axes;
  SpaceVector velocity;
  Attachment attach;
  SpaceVector start;
  Passing reverse;
};

/// Stiffness of the spring along an axis; 0 along those that it leaves free.
double stiffness_on(const DrivingSpringDescription& description, int axis);

ForceRecord driving_spring_record();

inline namespace TOMLIN_TARGET {

struct DrivingSpring {
  using Description = DrivingSpringDescription;
  static constexpr Reads reads{.start = true, .time = true};

  template <class T, int D>
  struct Parameters {
    Vec<T, D> stiffness;
    Vec<T, D> velocity;
    Vec<T, D> travel;  ///< of the support up to the start of this step, less the origin's
  };

  template <class T, int D>
  static Parameters<T, D> parameters(const Description& d) {
    Parameters<T, D> p;
    for (int k = 0; k < D; ++k) {
      p.stiffness[k] = T(stiffness_on(d, k));
      p.velocity[k] = T(d.velocity.components[k]);
      p.travel[k] = T(0.0);
    }
    return p;
  }

  template <class T, int D>
  static Vec<T, D> extension(const Parameters<T, D>& p, const Site<T, D>& site) {
    Vec<T, D> extension;
    for (int k = 0; k < D; ++k) {
      extension[k] =
          (site.start[k] + fma(p.velocity[k], site.elapsed, p.travel[k])) - site.position[k];
    }
    return extension;
  }

  template <class T, int D>
  static T energy(const Parameters<T, D>& p, const Site<T, D>& site) {
    const Vec<T, D> stretch = extension(p, site);
    T twice = p.stiffness[0] * (stretch[0] * stretch[0]);
    for (int k = 1; k < D; ++k) twice = fma(p.stiffness[k], stretch[k] * stretch[k], twice);
    return T(0.5) * twice;
  }

  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    Vec<T, D> force = extension(p, site);
    for (int k = 0; k < D; ++k) force[k] = p.stiffness[k] * force[k];
    return force;
  }

  /// Returns the power that the support puts in.
  template <class T, int D>
  static T power(const Parameters<T, D>& p, const Site<T, D>&, const Vec<T, D>& force) {
    return dot(force, p.velocity);
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
