#pragma once

#include <bit>
#include <cstddef>

#include "framework/core/numbers/dual.hpp"
#include "framework/core/numbers/math.hpp"
#include "framework/core/numbers/vec.hpp"

/// Evaluators see one element, whatever the number type. The loops over elements stand in
/// framework/core/elements/kernels.hpp.
namespace tomlin {
inline namespace TOMLIN_TARGET {

/// Inputs of a site that an evaluator reads. Others are not loaded. The traits of a force follow
/// from this.
struct Reads {
  bool velocity = false;
  bool start = false;
  bool time = false;
  bool table = false;
};

/// The scene's origin, to which positions are relative, as forces need it: in the scene's
/// coordinates, and as a phase along each axis on which the evaluator has a period.
template <class T, int D>
struct Frame {
  Vec<T, D> origin;
  Vec<T, D> wave_number;  ///< 1/period; 0 along an axis without one
  Vec<T, D> phase;        ///< of the origin, in periods, between -1/2 and 1/2
};

/// One particle, or the centre of mass of a body, in a field.
template <class T, int D>
struct Site {
  Vec<T, D> position;  ///< relative to the scene's origin
  Vec<T, D> velocity;
  Vec<T, D> start;  ///< where a driver's end for this site started, relative to the first origin
  T elapsed;        ///< time since the start of the step
  Frame<T, D> frame;
  /// The evaluator's own numbers, the same for all sites; see table_index.hpp.
  const double* table = nullptr;

  /// The position in the scene's coordinates.
  TOMLIN_INLINE Vec<T, D> coordinates() const { return position + frame.origin; }
  TOMLIN_INLINE T coordinate(int axis) const { return position[axis] + frame.origin[axis]; }
  /// coordinate / period, in periods less a whole number of them: as exact far from the scene's
  /// zero as near it. For an axis along which the evaluator has a period.
  TOMLIN_INLINE T phase(int axis) const {
    return fma(position[axis], frame.wave_number[axis], frame.phase[axis]);
  }
};

/// Parameters of kernels of sites: those of the evaluator, and the frame of the sites.
template <class E, class T, int D>
struct SiteParameters {
  typename E::template Parameters<T, D> own;
  Frame<T, D> frame;
};

/// Two particles.
template <class T, int D>
struct Pair {
  Vec<T, D> separation;  ///< from the first to the second
  T datum;               ///< a number of this pair's own, e.g. its rest length
};

template <class T, int D>
TOMLIN_INLINE T distance(const Vec<T, D>& separation) {
  if constexpr (D == 1) {
    return abs(separation[0]);
  } else {
    return sqrt(norm_squared(separation));
  }
}

/// The force on the first particle of a pair that is pulled towards the second by `tension`
/// (dV/dr; negative: pushed away). `r` is the distance between them. A coincident pair without
/// tension does not pull, and one with tension has no direction: that is no number.
template <class T, int D>
TOMLIN_INLINE Vec<T, D> pull(const Vec<T, D>& separation, const T& r, const T& tension) {
  Vec<T, D> force;
  if constexpr (D == 1) {
    (void)r;
    force[0] = tension * copysign(T(1.0), separation[0]);
  } else {
    const T none(0.0);
    const T scale = select((r == none) & (tension == none), none, tension / r);
    for (int d = 0; d < D; ++d) force[d] = scale * separation[d];
  }
  return force;
}

// ---- the same parameters and elements in another number type

/// A structure that holds nothing but numbers From becomes one of as many numbers To.
template <class Target, class To, class From, class Source>
TOMLIN_INLINE Target number_by_number(const Source& p) {
  constexpr std::size_t n = sizeof(Source) / sizeof(From);
  static_assert(sizeof(Source) == n * sizeof(From) && sizeof(Target) == n * sizeof(To),
                "Parameters<T, D> may hold nothing but T");
  struct Sources {
    From value[n];
  };
  struct Targets {
    To value[n];
  } targets;
  const auto sources = std::bit_cast<Sources>(p);
  for (std::size_t k = 0; k < n; ++k) targets.value[k] = To(sources.value[k]);
  return std::bit_cast<Target>(targets);
}

template <class E, class To, class From, int D>
TOMLIN_INLINE typename E::template Parameters<To, D> in_type(
    const typename E::template Parameters<From, D>& p) {
  return number_by_number<typename E::template Parameters<To, D>, To, From>(p);
}

/// A site whose position carries derivatives along each axis.
template <class T, int D>
TOMLIN_INLINE Site<Dual<T, D>, D> differentiable(const Site<T, D>& site) {
  Site<Dual<T, D>, D> wide;
  for (int d = 0; d < D; ++d) {
    wide.position[d] = Dual<T, D>(site.position[d]);
    wide.position[d].derivative[d] = T(1.0);
    wide.velocity[d] = Dual<T, D>(site.velocity[d]);
    wide.start[d] = Dual<T, D>(site.start[d]);
    wide.frame.origin[d] = Dual<T, D>(site.frame.origin[d]);
    wide.frame.wave_number[d] = Dual<T, D>(site.frame.wave_number[d]);
    wide.frame.phase[d] = Dual<T, D>(site.frame.phase[d]);
  }
  wide.elapsed = Dual<T, D>(site.elapsed);
  wide.table = site.table;
  return wide;
}

/// A pair whose separation carries derivatives along each axis.
template <class T, int D>
TOMLIN_INLINE Pair<Dual<T, D>, D> differentiable(const Pair<T, D>& pair) {
  Pair<Dual<T, D>, D> wide;
  for (int d = 0; d < D; ++d) {
    wide.separation[d] = Dual<T, D>(pair.separation[d]);
    wide.separation[d].derivative[d] = T(1.0);
  }
  wide.datum = Dual<T, D>(pair.datum);
  return wide;
}

template <class E, int D, template <class, int> class ElementOf>
concept HasForce = requires(const typename E::template Parameters<double, D>& p,
                            const ElementOf<double, D>& element) {
  E::force(p, element);
};

template <class E, int D, template <class, int> class ElementOf>
concept HasEnergy = requires(const typename E::template Parameters<double, D>& p,
                             const ElementOf<double, D>& element) {
  E::energy(p, element);
};

/// A driver, whose power follows from its force.
template <class E, int D>
concept DoesWork = requires(const typename E::template Parameters<double, D>& p,
                            const Site<double, D>& site, const Vec<double, D>& force) {
  E::power(p, site, force);
};

/// The evaluator's force on a site, or its energy differentiated where it gives no force.
template <class E, class T, int D>
TOMLIN_INLINE Vec<T, D> force_on(const typename E::template Parameters<T, D>& p,
                                 const Site<T, D>& site) {
  if constexpr (HasForce<E, D, Site>) {
    return E::force(p, site);
  } else {
    const auto energy = E::energy(in_type<E, Dual<T, D>, T, D>(p), differentiable(site));
    Vec<T, D> force;
    for (int d = 0; d < D; ++d) force[d] = -energy.derivative[d];
    return force;
  }
}

/// The evaluator's force on the first particle of a pair: its energy grows with the separation.
template <class E, class T, int D>
TOMLIN_INLINE Vec<T, D> force_on(const typename E::template Parameters<T, D>& p,
                                 const Pair<T, D>& pair) {
  if constexpr (HasForce<E, D, Pair>) {
    return E::force(p, pair);
  } else {
    const auto energy = E::energy(in_type<E, Dual<T, D>, T, D>(p), differentiable(pair));
    Vec<T, D> force;
    for (int d = 0; d < D; ++d) force[d] = energy.derivative[d];
    return force;
  }
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
