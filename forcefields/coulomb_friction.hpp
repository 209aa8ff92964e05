#pragma once

#include "framework/core/elements/element.hpp"

/// Dry friction on each particle: of constant magnitude against the velocity, whatever the speed.
///
///   F = -f v / sqrt(|v|^2 + w^2)
///
///   f  force  force, >= 0: the kinetic friction force of a particle
///   w  width  velocity, > 0: what regularises the law at rest
///
/// Coulomb's law, F = -f v/|v|, is the limit w -> 0: at speed v the magnitude falls short of f by
/// the part w^2 / (2 v^2). Below w the friction is viscous with the coefficient f/w, so that
/// nothing sticks: under a force P < f a particle creeps at the velocity w P / sqrt(f^2 - P^2).
/// Choose w far below the velocities of interest, and steps below w m/f: see the table in
/// README.md.
///
/// Sources: C. A. Coulomb, Theorie des machines simples (1785), for the law; E. Pennestri et al.,
/// Nonlinear Dyn. 83 (2016) 1785, doi:10.1007/s11071-015-2485-3, reviews regularised laws. The root
/// is chosen among them because it is smooth, monotonic, and the same in every dimension.
namespace tomlin {

struct ForceRecord;  // framework/core/records/force.hpp

struct CoulombFrictionDescription {
  double force = 0.0;
  double width = 0.0;
};

ForceRecord coulomb_friction_record();

inline namespace TOMLIN_TARGET {

struct CoulombFriction {
  using Description = CoulombFrictionDescription;
  static constexpr Reads reads{.velocity = true};
  static constexpr bool dissipative = true;

  template <class T, int D>
  struct Parameters {
    T force;
    T width;
  };

  template <class T, int D>
  static Parameters<T, D> parameters(const Description& d) {
    return {T(d.force), T(d.width)};
  }

  /// The largest slope of the force, at rest.
  static double friction_bound(const Description& d) { return d.force / d.width; }

  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    // In units of the larger of speed and width, whose squares are in range.
    T unit = p.width;
    for (int d = 0; d < D; ++d) unit = max(abs(site.velocity[d]), unit);
    const T inverse = T(1.0) / unit;
    const Vec<T, D> v = inverse * site.velocity;
    const T w = inverse * p.width;
    return -(p.force / sqrt(fma(w, w, norm_squared(v)))) * v;
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
