#pragma once

#include "framework/core/elements/element.hpp"
#include "framework/core/records/parameter.hpp"

/// Bonds that break: stiff at their rest length, without force far beyond it.
///
///   V = D (1 - exp(-a (r_ij - r0_ij)))^2, each pair once
///   F_i = 2 D a exp(-a (r_ij - r0_ij)) (1 - exp(-a (r_ij - r0_ij))) (x_j - x_i) / r_ij
///
///   D     depth          energy to break a bond
///   a     inverse_width  1/length; the stiffness at rest is 2 D a^2
///   r0    rest_lengths   length; "initial": the distances at the start
///   r_ij  a distance, in one dimension too: |x_j - x_i|
///
/// Source: P. M. Morse, Phys. Rev. 34, 57 (1929), doi:10.1103/PhysRev.34.57, eq. (4).
/// Valid for r_ij > 0: the repulsion stays finite at contact, where there is no direction to push.
/// With r0 = 0 there is none, and contact is a point like any other.
namespace tomlin {

struct ForceRecord;  // framework/core/records/force.hpp

struct MorseBondsDescription {
  PairSelection pairs;
  double depth = 0.0;
  double inverse_width = 0.0;
  WordOrNumbers rest_lengths;
};

ForceRecord morse_bonds_record();

inline namespace TOMLIN_TARGET {

struct MorseBonds {
  using Description = MorseBondsDescription;
  static constexpr bool central = true;

  template <class T, int D>
  struct Parameters {
    T depth;
    T inverse_width;
  };

  template <class T, int D>
  static Parameters<T, D> parameters(const Description& d) {
    return {T(d.depth), T(d.inverse_width)};
  }

  template <class T, int D>
  static T energy(const Parameters<T, D>& p, const Pair<T, D>& pair) {
    const T broken = T(1.0) - decayed(p, distance(pair.separation) - pair.datum);
    return p.depth * broken * broken;
  }

  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Pair<T, D>& pair) {
    const T r = distance(pair.separation);
    const T left = decayed(p, r - pair.datum);
    return pull(pair.separation, r, T(T(2.0) * p.depth * p.inverse_width * left * (T(1.0) - left)));
  }

 private:
  /// 1 at rest, 0 far away.
  template <class T, int D>
  static T decayed(const Parameters<T, D>& p, const T& stretch) {
    return exp(-p.inverse_width * stretch);
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
