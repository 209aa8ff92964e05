#pragma once

#include "framework/core/elements/element.hpp"
#include "framework/core/numbers/double_double.hpp"
#include "framework/core/numbers/number_types.hpp"
#include "framework/core/records/bound_force.hpp"
#include "framework/core/records/registry.hpp"

/// Corrugated substrate, felt by each particle on its own.
///
///   V(x, y) = A exp(-b y^2) cos(2 pi x / a)
///   F_x = (2 pi A / a) exp(-b y^2) sin(2 pi x / a)
///   F_y = 2 b y A exp(-b y^2) cos(2 pi x / a)
///
///   A  amplitude  corrugation amplitude per particle, energy; negative: x = 0 is a minimum
///   a  period     lattice period, length
///   b  decay      1/length^2; 0: no dependence on y. In one dimension it must be 0.
///
/// Source: Sircar and Patra, eqs. (8) and (9), where b = lambda/R and A = V0/N; with b = 0 the
/// potential of Prandtl (1928) and Tomlinson (1929). x = 0 is a maximum for A > 0.
/// Valid for any x, y; far above (b y^2 > 745) force and energy are exactly zero.
namespace tomlin {

struct SinusoidalSubstrateDescription {
  double amplitude = 0.0;
  double period = 0.0;
  double decay = 0.0;
};

ForceRecord sinusoidal_substrate_record();

inline namespace TOMLIN_TARGET {

struct SinusoidalSubstrate {
  using Description = SinusoidalSubstrateDescription;
  static constexpr Reads reads{};

  template <class T, int D>
  struct Parameters {
    T amplitude;
    T slope;        ///< 2 pi A / a
    T wave_number;  ///< 1/a, in turns per length
    T phase;        ///< of the scene's origin, in turns
    T decay;
    T vertical_slope;  ///< 2 b A
    T base;            ///< y of the scene's origin
  };

  template <class T, int D>
  static Parameters<T, D> parameters(const Description& d) {
    return {T(d.amplitude),
            tau<T>() * T(d.amplitude) / T(d.period),
            T(1.0) / T(d.period),
            T(0.0),
            T(d.decay),
            T(2.0) * T(d.decay) * T(d.amplitude),
            T(0.0)};
  }

  template <class T, int D>
  static void rebase(Parameters<T, D>& p, const Description& d, const Origin& origin) {
    // The part of a period by which the origin is off a maximum: exact however far away it is.
    const DoubleDouble place =
        DoubleDouble(static_cast<double>(origin.cells[0])) * DoubleDouble(origin.unit[0]);
    std::int64_t periods = 0;
    p.phase = T(remainder_of(place, d.period, periods)) / T(d.period);
    // Another force may declare a period along y; heights are the scene's own, whatever the origin.
    p.base = T(static_cast<double>(origin.cells[1]) * origin.unit[1]);
  }

  template <class T, int D>
  static T energy(const Parameters<T, D>& p, const Site<T, D>& site) {
    const T wave = cos_turns(fma(site.position[0], p.wave_number, p.phase));
    if constexpr (D == 1) {
      return p.amplitude * wave;
    } else {
      const T y = site.position[1] + p.base;
      return p.amplitude * exp(-(p.decay * y) * y) * wave;
    }
  }

  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    const T turns = fma(site.position[0], p.wave_number, p.phase);
    Vec<T, D> force;
    if constexpr (D == 1) {
      force[0] = p.slope * sin_turns(turns);
    } else {
      T sine;
      T cosine;
      sincos_turns(turns, sine, cosine);
      const T y = site.position[1] + p.base;
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
