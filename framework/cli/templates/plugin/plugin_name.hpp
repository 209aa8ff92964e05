#pragma once

#include "framework/core/elements/element.hpp"
#include "framework/core/records/bound_force.hpp"
#include "framework/core/records/registry.hpp"

/// What the force is: a harmonic trap about the scene's zero. Put your own in its place.
///
///   V = (stiffness/2) |x|^2,  F = -stiffness x,  on each particle
///
///   stiffness  mass/time^2
///
/// Source: the paper that the equation is from, with its number.
namespace tomlin {

/// The parameters as a scene gives them.
struct PluginNameDescription {
  double stiffness = 0.0;
};

ForceRecord plugin_name_record();

inline namespace TOMLIN_TARGET {

/// The evaluator: one particle in D dimensions, whatever the number type T. No loop over particles,
/// no branch on a number, no std:: mathematics (framework/core/numbers/math.hpp has exp, sin_turns,
/// ...).
struct PluginName {
  using Description = PluginNameDescription;
  static constexpr Reads reads{};  // positions only; {.velocity = true} for more

  /// Nothing but numbers of type T.
  template <class T, int D>
  struct Parameters {
    T stiffness;
    Vec<T, D> origin;
  };

  template <class T, int D>
  static Parameters<T, D> parameters(const Description& d) {
    return {T(d.stiffness), {}};
  }

  /// Positions are relative to an origin that follows what moves far; the trap stays where it is. A
  /// force that does not depend on the place has no need of this.
  template <class T, int D>
  static void rebase(Parameters<T, D>& p, const Description&, const Origin& origin) {
    for (int axis = 0; axis < D; ++axis) {
      p.origin[axis] = T(static_cast<double>(origin.cells[axis])) * T(origin.unit[axis]);
    }
  }

  template <class T, int D>
  static T energy(const Parameters<T, D>& p, const Site<T, D>& site) {
    return T(0.5) * p.stiffness * norm_squared(site.position + p.origin);
  }

  /// May be left out: then the energy is differentiated.
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    return -p.stiffness * (site.position + p.origin);
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
