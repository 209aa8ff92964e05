#pragma once

#include "framework/core/elements/own_state.hpp"

/// Drag that remembers: generalised Langevin friction, with the noise of its bath or without.
///
///   F(t) = - integral_0^t K(t - s) v(s) ds,  K(t) = (c/tau) exp(-t/tau), per particle
///
/// which is a Maxwell element, a spring k = c/tau and a dashpot c in series, dragged along:
///
///   F = -k q,  dq/dt = v - q/tau,  q(0) = 0;  stored k q^2/2, heat k q^2/tau >= 0
///
///   c    coefficient  mass/time, per particle: the drag c v on what is much slower than tau
///   tau  memory_time
///   q    the spring's stretch. The force's own variable is w q, one for each axis, with w = 1/tau:
///        a velocity, whose errors are held against the same tolerance as those of particles
///
/// With a temperature T, an energy, the dashpot has its noise, which makes the coloured noise that
/// belongs to the kernel, <R(t) R(t')> = T K(t - t'):
///
///   dq/dt = v - q/tau + sqrt(2 T/(k tau)) xi(t)
///
/// from q(0) = 0 on, so that the noise is stationary after some tau. Velocity and q together are an
/// Ornstein-Uhlenbeck process, whose exact flow M over h it hands out as an operator, with noise of
/// covariance S - M S M^T, S = diag(T/m, T/k) that of equilibrium: bodies of free particles, with
/// inertia. At temperature 0, as without the key, it hands out the same flow without noise, and any
/// scheme that takes forces with variables of their own, or operators, takes it.
///
/// For tau -> 0 it is viscous damping. Several of them make a Prony series. The power -F.v changes
/// its sign: the spring gives back some of what it took.
/// Source: R. Zwanzig, J. Stat. Phys. 9, 215 (1973), doi:10.1007/BF01008729; H. Mori, Prog. Theor.
/// Phys. 33, 423 (1965), doi:10.1143/PTP.33.423.
namespace tomlin {

struct ForceRecord;  // framework/core/records/force.hpp

struct MemoryDampingDescription {
  double coefficient = 0.0;
  double memory_time = 0.0;
  double temperature = 0.0;  ///< an energy; 0: no noise
};

ForceRecord memory_damping_record();

inline namespace TOMLIN_TARGET {

struct MemoryDamping {
  using Description = MemoryDampingDescription;

  template <class T, int D>
  struct Parameters {
    T rate;       // 1/tau
    T pull;       // k/w
    T stiffness;  // k/w^2
  };

  template <class T, int D>
  static Parameters<T, D> parameters(const Description& d) {
    return {T(1.0) / T(d.memory_time), T(d.coefficient), T(d.coefficient) * T(d.memory_time)};
  }

  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const OwnSite<T, D>& site) {
    return -p.pull * site.own;
  }

  template <class T, int D>
  static Vec<T, D> rate(const Parameters<T, D>& p, const OwnSite<T, D>& site) {
    Vec<T, D> rate;
    for (int d = 0; d < D; ++d) rate[d] = p.rate * (site.velocity[d] - site.own[d]);
    return rate;
  }

  template <class T, int D>
  static T energy(const Parameters<T, D>& p, const OwnSite<T, D>& site) {
    return T(0.5) * p.stiffness * norm_squared(site.own);
  }

  template <class T, int D>
  static T heat(const Parameters<T, D>& p, const OwnSite<T, D>& site) {
    return p.stiffness * p.rate * norm_squared(site.own);
  }

  template <class Real>
  static constexpr auto kernels() {
    return own_state_table<MemoryDamping, Real>();
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
