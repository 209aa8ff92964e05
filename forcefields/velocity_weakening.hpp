#pragma once

#include "framework/core/elements/element.hpp"

/// Dry friction on each particle that becomes weaker the faster it slides.
///
///   F = -f (v/u) / (1 + u/v_w),  u = sqrt(|v|^2 + w^2)
///
///   f    force               force, >= 0: the friction of the slowest sliding, at w << |v| << v_w
///   v_w  weakening_velocity  velocity, > 0: at this speed friction has halved
///   w    width               velocity, > 0: what regularises the law at rest
///
/// For w -> 0 this is F = -f phi(|v|/v_w) v/|v| with phi(y) = 1/(1 + y), the law of Carlson and
/// Langer: f is their F_0, v_w their characteristic velocity, so that 2 alpha = f / (v_w sqrt(k m))
/// in units of their pulling spring k. Theirs holds a block that does not slide, with any force up
/// to F_0, and lets none slide backwards. Here a block at rest creeps instead, since below w the
/// friction is viscous with the coefficient f/w (1 + w/v_w)^-1; and it may slide either way. The
/// largest magnitude is below f, by about 3/2 f (w/v_w)^(2/3) where w << v_w.
///
/// Beyond the speed of that largest magnitude dF/dv falls with v: the friction of steady sliding
/// feeds an oscillation rather than damping it, and sliding on a spring at v >> w without other
/// damping is unstable. F.v <= 0 still holds at every velocity.
///
/// Source: J. M. Carlson and J. S. Langer, Phys. Rev. A 40 (1989) 6470,
/// doi:10.1103/PhysRevA.40.6470.
namespace tomlin {

struct ForceRecord;  // framework/core/records/force.hpp

struct VelocityWeakeningDescription {
  double force = 0.0;
  double weakening_velocity = 0.0;
  double width = 0.0;
};

ForceRecord velocity_weakening_record();

inline namespace TOMLIN_TARGET {

struct VelocityWeakening {
  using Description = VelocityWeakeningDescription;
  static constexpr Reads reads{.velocity = true};
  static constexpr bool dissipative = true;

  template <class T, int D>
  struct Parameters {
    T force;
    T width;
    T inverse_weakening;  // 1 / v_w
  };

  template <class T, int D>
  static Parameters<T, D> parameters(const Description& d) {
    return {T(d.force), T(d.width), T(1.0) / T(d.weakening_velocity)};
  }

  /// The slope of the force is never larger in either direction: it falls from this at rest, and is
  /// at most f / (4 w) the other way.
  static double friction_bound(const Description& d) { return d.force / d.width; }

  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    // In units of the larger of speed and width, whose squares are in range.
    T unit = p.width;
    for (int d = 0; d < D; ++d) unit = max(abs(site.velocity[d]), unit);
    const T inverse = T(1.0) / unit;
    const Vec<T, D> v = inverse * site.velocity;
    const T w = inverse * p.width;
    const T root = sqrt(fma(w, w, norm_squared(v)));
    return -(p.force / (root * fma(unit * root, p.inverse_weakening, T(1.0)))) * v;
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
