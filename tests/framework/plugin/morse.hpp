#pragma once

#include "framework/core/elements/element.hpp"
#include "framework/core/records/parameter.hpp"
#include "framework/core/records/registry.hpp"

/// Morse bonds, as a plugin has them.
///
///   V = D (1 - exp(-a (r - r0)))^2, each pair once;  dV/dr = 2 D a (1 - e) e, e = exp(-a (r - r0))
///
///   D   depth        energy
///   a   steepness    1/length
///   r0  rest_length  length
///
/// Source: P. M. Morse, Phys. Rev. 34 (1929) 57, eq. (4), doi:10.1103/PhysRev.34.57
namespace tomlin {

struct MorseDescription {
  PairSelection pairs;
  double depth = 0.0;
  double steepness = 0.0;
  double rest_length = 0.0;
};

ForceRecord morse_record();

inline namespace TOMLIN_TARGET {

struct Morse {
  using Description = MorseDescription;

  template <class T, int D>
  struct Parameters {
    T depth;
    T steepness;
  };

  template <class T, int D>
  static Parameters<T, D> parameters(const Description& d) {
    return {T(d.depth), T(d.steepness)};
  }

  template <class T, int D>
  static T energy(const Parameters<T, D>& p, const Pair<T, D>& pair) {
    const T away = T(1.0) - exp(-p.steepness * (distance(pair.separation) - pair.datum));
    return p.depth * away * away;
  }

  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Pair<T, D>& pair) {
    const T r = distance(pair.separation);
    const T e = exp(-p.steepness * (r - pair.datum));
    return pull(pair.separation, r, T(T(2.0) * p.depth * p.steepness * (T(1.0) - e) * e));
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
