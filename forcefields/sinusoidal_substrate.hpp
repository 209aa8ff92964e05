#pragma once

#include "framework/core/elements/element.hpp"
#include "framework/core/numbers/number_types.hpp"

/// Corrugated substrate, felt by each particle on its own.
///
///   V(x, y) = A exp(-b y^2) cos(2 pi (x - x0) / a)
///   F_x = (2 pi A / a) exp(-b y^2) sin(2 pi (x - x0) / a)
///   F_y = 2 b y A exp(-b y^2) cos(2 pi (x - x0) / a)
///
///   A  amplitude  corrugation amplitude per particle, energy; negative: x = 0 is a minimum
///   a  period     lattice period, length
///   b  decay      1/length^2; 0: no dependence on y. In one dimension it must be 0.
///   x0 offset     of the lattice along x, length; 0 by default
///
/// Source: Sircar and Patra, eqs. (8) and (9), where b = lambda/R and A = V0/N; with b = 0 the
/// potential of Prandtl (1928) and Tomlinson (1929). x = x0 is a maximum for A > 0.
/// Valid for any x, y; far above (b y^2 > 745) force and energy are exactly zero.
namespace tomlin {

struct ForceRecord;  // framework/core/records/force.hpp

struct SinusoidalSubstrateDescription {
  double amplitude = 0.0;
  double period = 0.0;
  double decay = 0.0;
  double offset = 0.0;
};

ForceRecord sinusoidal_substrate_record();

inline namespace TOMLIN_TARGET {

struct SinusoidalSubstrate {
  using Description = SinusoidalSubstrateDescription;
  static constexpr Reads reads{};

  template <class T, int D>
  struct Parameters {
    T amplitude;
    T slope;  ///< 2 pi A / a
    T decay;
    T vertical_slope;  ///< 2 b A
  };

  template <class T, int D>
  static Parameters<T, D> parameters(const Description& d) {
    return {T(d.amplitude), tau<T>() * T(d.amplitude) / T(d.period), T(d.decay),
            T(2.0) * T(d.decay) * T(d.amplitude)};
  }

  static double period(const Description& d, int axis) { return axis == 0 ? d.period : 0.0; }
  static double offset(const Description& d, int axis) { return axis == 0 ? d.offset : 0.0; }

  template <class T, int D>
  static T energy(const Parameters<T, D>& p, const Site<T, D>& site) {
    const T wave = cos_turns(site.phase(0));
    if constexpr (D == 1) {
      return p.amplitude * wave;
    } else {
      const T y = site.coordinate(1);
      return p.amplitude * exp(-(p.decay * y) * y) * wave;
    }
  }

  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    const T turns = site.phase(0);
    Vec<T, D> force;
    if constexpr (D == 1) {
      force[0] = p.slope * sin_turns(turns);
    } else {
      T sine;
      T cosine;
      sincos_turns(turns, sine, cosine);
      const T y = site.coordinate(1);
      const T height = exp(-(p.decay * y) * y);
      force[0] = height * (p.slope * sine);
      force[1] = (height * y) * (p.vertical_slope * cosine);
      if constexpr (D == 3) force[2] = T(0.0);
    }
    return force;
  }

  /// Spectral norm of the Hessian, at most: with D the largest diagonal and C the largest mixed
  /// entry it is cos * D + sin * C <= sqrt(D^2 + C^2).
  template <int D>
  static double curvature_bound(const Description& d) {
    const double wave = 6.283185307179586 / d.period;
    const double amplitude = d.amplitude < 0.0 ? -d.amplitude : d.amplitude;
    if (D == 1 || d.decay == 0.0) return amplitude * wave * wave;
    const double along = wave * wave;
    const double across = 2.0 * d.decay;
    const double diagonal = along > across ? along : across;
    const double mixed = wave * sqrt(2.0 * d.decay / 2.718281828459045);
    return amplitude * sqrt(diagonal * diagonal + mixed * mixed);
  }

  /// Largest diagonal entry of the Hessian.
  template <int D>
  static double curvature_bound_along(const Description& d, int axis) {
    const double wave = 6.283185307179586 / d.period;
    const double amplitude = d.amplitude < 0.0 ? -d.amplitude : d.amplitude;
    if (axis == 0) return amplitude * wave * wave;
    return axis == 1 ? amplitude * 2.0 * d.decay : 0.0;
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
