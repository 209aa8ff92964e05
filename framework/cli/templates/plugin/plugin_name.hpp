#pragma once

#include "framework/core/elements/element.hpp"
#include "framework/core/records/registry.hpp"

/// This force is a harmonic trap about the scene's zero. Replace it by your own force.
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
  };

  template <class T, int D>
  static Parameters<T, D> parameters(const Description& d) {
    return {T(d.stiffness)};
  }

  /// site.coordinates() is the position in the scene. A periodic force has instead a function
  /// `period`, and reads site.phase(axis), which keeps its digits however far a particle goes.
  template <class T, int D>
  static T energy(const Parameters<T, D>& p, const Site<T, D>& site) {
    return T(0.5) * p.stiffness * norm_squared(site.coordinates());
  }

  /// May be left out: then the energy is differentiated.
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    return -p.stiffness * site.coordinates();
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
