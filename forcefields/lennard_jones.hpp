#pragma once

#include "framework/core/elements/cutoff_kernels.hpp"
#include "framework/core/records/parameter.hpp"
#include "framework/core/records/registry.hpp"

/// Lennard-Jones interaction of all pairs within a cutoff.
///
///   V(r) = 4 epsilon ((sigma/r)^12 - (sigma/r)^6)
///   V_c  = V(r)                                "cut": energy and force jump at r = r_c
///        = V(r) - V(r_c)                       "shift": the force jumps
///        = V(r) - V(r_c) - (r - r_c) V'(r_c)   "smooth": both go to zero
///   F_i  = V_c'(r) (x_j - x_i)/r,  0 for r >= r_c
///
///   epsilon  energy  depth of the well of V, at r = 2^(1/6) sigma
///   sigma    length  where V = 0
///   r_c      length  cutoff
///
/// Source: J. E. Jones, Proc. R. Soc. Lond. A 106, 463 (1924), doi:10.1098/rspa.1924.0082; the
/// shifted force: S. Toxvaerd and J. C. Dyre, J. Chem. Phys. 134, 081102 (2011),
/// doi:10.1063/1.3558787.
/// Valid for r > 0. Without "smooth" the energy is not conserved where pairs pass the cutoff. With
/// it the second derivative jumps there.
namespace tomlin {

/// What becomes of energy and force at the cutoff.
enum class AtCutoff { cut, shift, smooth };

constexpr auto word_table(AtCutoff) {
  using enum AtCutoff;
  return std::to_array<Word<AtCutoff>>({{cut, "cut"}, {shift, "shift"}, {smooth, "smooth"}});
}

struct LennardJonesDescription {
  double epsilon = 0.0;
  double sigma = 0.0;
  double cutoff = 0.0;
  AtCutoff at_cutoff = AtCutoff::smooth;
};

ForceRecord lennard_jones_record();

inline namespace TOMLIN_TARGET {

/// V and what its force is made of, r being the distance.
template <bool smooth>
struct LennardJonesPotential {
  using Description = LennardJonesDescription;

  template <class T, int D>
  struct Parameters {
    T four_epsilon;
    T sigma_squared;
    T at_cutoff;  // V(r_c); with "cut" 0
    T slope;      // V'(r_c)
    T cutoff;
  };

  static double cutoff(const Description& d) { return d.cutoff; }
  /// Of a particle: those that are nearer than half of this at the start are refused.
  static double size(const Description& d) { return d.epsilon > 0.0 ? d.sigma : 0.0; }
  static constexpr const char* what_size = "half of sigma";

  template <class T, int D>
  static Parameters<T, D> parameters(const Description& d) {
    Parameters<T, D> p{T(4.0) * T(d.epsilon), T(d.sigma) * T(d.sigma), T(0.0), T(0.0), T(d.cutoff)};
    const T inverse_squared = T(1.0) / (p.cutoff * p.cutoff);
    if (d.at_cutoff != AtCutoff::cut) p.at_cutoff = value(p, inverse_squared);
    if (smooth) p.slope = slope_over_distance(p, inverse_squared) * p.cutoff;
    return p;
  }

  template <class T, int D>
  static T energy(const Parameters<T, D>& p, const Pair<T, D>& pair) {
    const T squared = norm_squared(pair.separation);
    const T shifted = value(p, T(1.0) / squared) - p.at_cutoff;
    if constexpr (!smooth) return shifted;
    return shifted - (sqrt(squared) - p.cutoff) * p.slope;
  }

  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Pair<T, D>& pair) {
    const T squared = norm_squared(pair.separation);
    T scale = slope_over_distance(p, T(1.0) / squared);
    if constexpr (smooth) scale = scale - p.slope / sqrt(squared);
    return scale * pair.separation;
  }

  template <class Real>
  static constexpr auto kernels() {
    return cutoff_pair_table<LennardJonesPotential, Real>();
  }

 private:
  template <class T, int D>
  static T value(const Parameters<T, D>& p, const T& inverse_squared) {
    const T part = p.sigma_squared * inverse_squared;
    const T attraction = part * part * part;
    return p.four_epsilon * attraction * (attraction - T(1.0));
  }

  /// V'(r)/r.
  template <class T, int D>
  static T slope_over_distance(const Parameters<T, D>& p, const T& inverse_squared) {
    const T part = p.sigma_squared * inverse_squared;
    const T attraction = part * part * part;
    return p.four_epsilon * inverse_squared * attraction * (T(6.0) - T(12.0) * attraction);
  }
};

struct LennardJones : LennardJonesPotential<false> {};
struct LennardJonesSmooth : LennardJonesPotential<true> {};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
