#pragma once

#include "framework/core/elements/element.hpp"
#include "framework/core/records/parameter.hpp"

/// Harmonic bonds between particles of a body.
///
///   V = (K/2) (r_ij - r0_ij)^2, each pair once;  F_i = K (r_ij - r0_ij) (x_j - x_i) / r_ij
///
///   K     stiffness     of each bond, mass/time^2
///   r0    rest_lengths  length; "initial": the distances at the start
///   r_ij  a distance, in one dimension too: |x_j - x_i|
///
/// Source: Sircar and Patra, eq. (3); Frenkel and Kontorova (1938) for neighbours on a line.
/// A bond without rest length is -K (x_i - x_j), also where its ends coincide. Any other is valid
/// for r_ij > 0: coincident particles have no direction to push, and a run stops there.
namespace tomlin {

struct ForceRecord;  // framework/core/records/force.hpp

struct HarmonicBondsDescription {
  PairSelection pairs;
  double stiffness = 0.0;
  WordOrNumbers rest_lengths;
};

ForceRecord harmonic_bonds_record();

inline namespace TOMLIN_TARGET {

struct HarmonicBonds {
  using Description = HarmonicBondsDescription;
  static constexpr bool central = true;

  template <class T, int D>
  struct Parameters {
    T stiffness;
  };

  template <class T, int D>
  static Parameters<T, D> parameters(const Description& d) {
    return {T(d.stiffness)};
  }

  template <class T, int D>
  static T energy(const Parameters<T, D>& p, const Pair<T, D>& pair) {
    const T stretch = distance(pair.separation) - pair.datum;
    const T stretched = T(0.5) * p.stiffness * stretch * stretch;
    if constexpr (D == 1) return stretched;
    const T without_length = T(0.5) * p.stiffness * norm_squared(pair.separation);
    return select(pair.datum == T(0.0), without_length, stretched);
  }

  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Pair<T, D>& pair) {
    const T r = distance(pair.separation);
    const T tension = p.stiffness * (r - pair.datum);
    if constexpr (D == 1) return pull(pair.separation, r, tension);
    return select(pair.datum == T(0.0), p.stiffness, tension / r) * pair.separation;
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
