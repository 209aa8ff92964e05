#pragma once

#include <array>
#include <cstddef>
#include <memory>

#include "forcefields/lennard_jones.hpp"
#include "forcefields/sheet_field_table.hpp"
#include "framework/core/elements/element.hpp"
#include "framework/core/numbers/inverse_trigonometry.hpp"
#include "framework/core/numbers/table_index.hpp"
#include "framework/core/records/bound_force.hpp"

/// Lennard-Jones interaction with a fixed, flat, periodic sheet of equal atoms, as a function of
/// position alone.
///
///   V(R, z) = V_0(z) + sum_s f_s(z) W_s(R),  0 for z >= r_c; z the distance from the sheet
///   V_0(z)  = 2 pi rho int_z^r_c V_c(r) r dr,  V_0'(z) = -2 pi rho z V_c(z)
///   W_s(R)  = sum over the reciprocal lattice vectors G of a star of weights times cos(2 pi G.R)
///
///   V_c  energy    of a pair, as of lennard_jones with "smooth", r_c its cutoff
///   rho  1/area    atoms of the sheet per area
///   f_s  energy    Fourier coefficients of the sums over atoms, as splines (sheet_field_table.hpp)
///
/// Source: W. A. Steele, Surf. Sci. 36 (1973) 317, doi:10.1016/0039-6028(73)90264-1; here with a
/// cutoff, for which there is no closed form but of V_0.
/// Valid for z >= 0.6 sigma: nearer the force is NaN, and a run fails. Energy and force differ from
/// the sums over atoms by the tolerance; force and Hessian are exact derivatives of the energy.
namespace tomlin {

struct SheetFieldDescription : LennardJonesDescription {
  double tolerance = 0.0;
  // Found where the sheet is known.
  std::shared_ptr<const SheetTable> sheet;
  Origin first_origin;
  double box_height = 0.0;  ///< of a box that is periodic along z; else 0
};

ForceRecord sheet_field_record();

inline namespace TOMLIN_TARGET {

struct SheetField {
  using Description = SheetFieldDescription;
  static constexpr Reads reads{.table = true};

  template <class T, int D>
  struct Parameters {
    T turns[2][2];   ///< b1, b2
    T slopes[2][2];  ///< 2 pi b1, 2 pi b2
    T phase[2];      ///< of the scene's origin, in turns
    T height;        ///< of the sheet above the scene's origin
    T box_height;
    T inverse_box_height;  ///< 0 where the box is open along z
    T four_epsilon;
    T sigma_squared;
    T at_cutoff;
    T slope;
    T cutoff;
    T sheet;  ///< 2 pi rho
    T end;    ///< V_0 = sheet (pairs(sigma^2/z^2) + end + end_squared z^2 + end_cubed z^3)
    T end_squared;
    T end_cubed;
    T nearest;
    T per_length;  ///< intervals of the splines
    T last;        ///< interval
  };

  template <class T, int D>
  static Parameters<T, D> parameters(const Description& d) {
    const SheetTable& table = *d.sheet;
    Parameters<T, D> p{};
    for (std::size_t j = 0; j < 2; ++j) {
      for (std::size_t axis = 0; axis < 2; ++axis) {
        p.turns[j][axis] = T(table.lattice.turns[j][axis]) / T(table.lattice.box[axis]);
        p.slopes[j][axis] = tau<T>() * p.turns[j][axis];
      }
    }
    p.box_height = T(d.box_height);
    if (d.box_height > 0.0) p.inverse_box_height = T(1.0) / T(d.box_height);
    p.four_epsilon = T(table.law.four_epsilon);
    p.sigma_squared = T(table.law.sigma_squared);
    p.at_cutoff = T(table.law.at_cutoff);
    p.slope = T(table.law.slope);
    p.cutoff = T(table.law.cutoff);
    p.sheet = tau<T>() * T(table.density);
    const T squared = p.cutoff * p.cutoff;
    const T linear = p.cutoff * p.slope - p.at_cutoff;
    p.end_squared = T(-0.5) * linear;
    p.end_cubed = p.slope / T(3.0);
    p.end = T(0.5) * linear * squared - p.end_cubed * squared * p.cutoff -
            pairs(p, p.sigma_squared / squared);
    p.nearest = T(table.nearest);
    p.per_length = T(static_cast<double>(table.intervals)) / (p.cutoff - p.nearest);
    p.last = T(static_cast<double>(table.intervals - 1));
    return p;
  }

  static const double* table(const Description& d) { return d.sheet->numbers.data(); }

  template <class T, int D>
  static void rebase(Parameters<T, D>& p, const Description& d, const Origin& origin) {
    const SheetTable& table = *d.sheet;
    const auto moved = [&](std::size_t axis) {
      const auto cells = static_cast<double>(origin.cells[axis] - d.first_origin.cells[axis]);
      return two_prod(cells, origin.unit[axis]) - DoubleDouble(table.centre[axis]);
    };
    T boxes[2];
    for (std::size_t axis = 0; axis < 2; ++axis) {
      std::int64_t whole = 0;
      const double length = table.lattice.box[axis];
      boxes[axis] = T(remainder_of(moved(axis), length, whole)) / T(length);
    }
    for (std::size_t j = 0; j < 2; ++j) {
      p.phase[j] =
          T(table.lattice.turns[j][0]) * boxes[0] + T(table.lattice.turns[j][1]) * boxes[1];
    }
    p.height = -from_double_double<T>(moved(2));
  }

  template <class T, int D>
  static T energy(const Parameters<T, D>& p, const Site<T, D>& site) requires(D == 3) {
    const T z = abs(above(p, site));
    const T q = p.sigma_squared / (z * z);
    const T mean = fma(z * z, fma(z, p.end_cubed, p.end_squared), pairs(p, q) + p.end);
    return within(p, z, fma(p.sheet, mean, harmonics(p, site, z).energy));
  }

  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) requires(D == 3) {
    const T way = above(p, site);
    const T z = abs(way);
    const T q = p.sigma_squared / (z * z);
    const T cube = q * (q * q);
    const T pair =
        fnma(z - p.cutoff, p.slope, fma(p.four_epsilon * cube, cube - T(1.0), -p.at_cutoff));
    const Harmonics<T> sum = harmonics(p, site, z);
    Vec<T, D> force;
    for (int axis = 0; axis < 2; ++axis) {
      force[axis] =
          within(p, z, fma(p.slopes[1][axis], sum.pull[1], p.slopes[0][axis] * sum.pull[0]));
    }
    const T away = within(p, z, fma(p.sheet * z, pair, -sum.slope));
    force[2] = away * copysign(T(1.0), way);
    return force;
  }

 private:
  /// Hermite's interpolation of fifth order at t = 0..1 between two knots: contributions of a
  /// function, its slope and half its curvature (by t) at either of them, and their derivatives by
  /// t. Both intervals at a knot have the same numbers of it, so that function, slope and
  /// curvature are continuous in every precision.
  template <class T>
  struct SplineWeights {
    T from[SheetTable::kKnot], to[SheetTable::kKnot];
    T from_slope[SheetTable::kKnot], to_slope[SheetTable::kKnot];

    TOMLIN_INLINE explicit SplineWeights(const T& t) {
      const T u = T(1.0) - t;
      half(u, t, from, from_slope);
      half(t, u, to, to_slope);
      // The way from the other knot back to this one.
      to[1] = -to[1];
      to_slope[0] = -to_slope[0];
      to_slope[2] = -to_slope[2];
    }

   private:
    /// Weights of the knot at a distance of t, and their derivatives by t; u is 1 - t.
    TOMLIN_INLINE static void half(const T& u, const T& t, T* value, T* slope) {
      const T squared = u * u;
      const T cube = squared * u;
      const T along = t * cube;
      value[0] = cube * fma(t, fma(t, T(6.0), T(3.0)), T(1.0));
      value[1] = along * fma(t, T(3.0), T(1.0));
      value[2] = t * along;
      slope[0] = T(-30.0) * (squared * (t * t));
      slope[1] = squared * fma(t, fma(t, T(-15.0), T(2.0)), T(1.0));
      slope[2] = (t * squared) * fma(t, T(-5.0), T(2.0));
    }
  };

  template <class T>
  struct Harmonics {
    T energy;
    T pull[2];  ///< -d/d(2 pi p_j), p_j = b_j.R
    T slope;    ///< d/dz
  };

  /// int V r dr/sheet of the pair energy without a cutoff.
  template <class T, int D>
  TOMLIN_INLINE static T pairs(const Parameters<T, D>& p, const T& q) {
    const T square = q * q;
    return p.four_epsilon * p.sigma_squared * square * (fma(square, q, T(-2.5)) / T(10.0));
  }

  template <class T, int D>
  TOMLIN_INLINE static T above(const Parameters<T, D>& p, const Site<T, D>& site) {
    const T z = site.position[2] - p.height;
    return fnma(p.box_height, floor(fma(z, p.inverse_box_height, T(0.5))), z);
  }

  /// Zero beyond the cutoff, no number too near.
  template <class T, int D>
  TOMLIN_INLINE static T within(const Parameters<T, D>& p, const T& z, const T& value) {
    const T near = select(z < p.nearest, T(math_detail::kNan), value);
    return select(z >= p.cutoff, T(0.0), near);
  }

  template <class T, int D>
  TOMLIN_INLINE static T turn(const Parameters<T, D>& p, const Site<T, D>& site, int j) {
    return fma(site.position[0], p.turns[j][0], fma(site.position[1], p.turns[j][1], p.phase[j]));
  }

  /// Sine and cosine of the next multiple of an angle, behind those of this one.
  template <class T>
  TOMLIN_INLINE static void raise(T* sine, T* cosine, const T& sine1, const T& cosine1) {
    sine[1] = fma(sine[0], cosine1, cosine[0] * sine1);
    cosine[1] = fma(cosine[0], cosine1, -(sine[0] * sine1));
  }

  template <class T, int D>
  TOMLIN_INLINE static Harmonics<T> harmonics(const Parameters<T, D>& p, const Site<T, D>& site,
                                              const T& z) {
    Harmonics<T> sum{T(0.0), {T(0.0), T(0.0)}, T(0.0)};
    const double* const table = site.table;
    const double* star = table + SheetTable::kHead;
    const auto stars = static_cast<std::size_t>(table[0]);
    // Nothing is added beyond the reach of a star, so that it may be left out.
    if (stars == 0 || !any(z < T(static_cast<Scalar<T>>(star[0])))) return sum;
    const T position = (z - p.nearest) * p.per_length;
    const T interval = min(floor(position), p.last);
    const T t = position - interval;
    const SplineWeights<T> weights(t);
    const double row_length = table[0] * double{SheetTable::kKnot};
    const TableIndex<T> row(interval * T(static_cast<Scalar<T>>(row_length)));
    const double* here = table + static_cast<std::ptrdiff_t>(table[1]);
    const double* next = here + static_cast<std::ptrdiff_t>(row_length);
    // Entry m is for the phase m p1, and entry kMiddle + n for n p2.
    constexpr std::size_t kMiddle = SheetTable::kMostOrder;
    T sine1[kMiddle + 1], cosine1[kMiddle + 1];
    T sine2[2 * kMiddle + 1], cosine2[2 * kMiddle + 1];
    sine1[0] = sine2[kMiddle] = T(0.0);
    cosine1[0] = cosine2[kMiddle] = T(1.0);
    sincos_turns(turn(p, site, 0), sine1[1], cosine1[1]);
    sincos_turns(turn(p, site, 1), sine2[kMiddle + 1], cosine2[kMiddle + 1]);
    sine2[kMiddle - 1] = -sine2[kMiddle + 1];
    cosine2[kMiddle - 1] = cosine2[kMiddle + 1];
    std::size_t order = 1;
    for (std::size_t s = 0; s < stars; ++s) {
      if (!any(z < T(static_cast<Scalar<T>>(star[0])))) break;
      for (const auto needed = static_cast<std::size_t>(star[1]); order < needed; ++order) {
        const std::size_t n = kMiddle + order;
        raise(sine1 + order, cosine1 + order, sine1[1], cosine1[1]);
        raise(sine2 + n, cosine2 + n, sine2[kMiddle + 1], cosine2[kMiddle + 1]);
        sine2[kMiddle - order - 1] = -sine2[n + 1];
        cosine2[kMiddle - order - 1] = cosine2[n + 1];
      }
      const auto terms = static_cast<std::size_t>(star[2]);
      star += SheetTable::kStarHead;
      T wave(0.0);
      T pull[2] = {T(0.0), T(0.0)};
      for (std::size_t k = 0; k < terms; ++k, star += SheetTable::kTerm) {
        const auto m = static_cast<std::ptrdiff_t>(star[0]);
        const auto n = static_cast<std::ptrdiff_t>(kMiddle) + static_cast<std::ptrdiff_t>(star[1]);
        wave = fma(cosine1[m], cosine2[n], fnma(sine1[m], sine2[n], wave));
        const T sine = fma(sine1[m], cosine2[n], cosine1[m] * sine2[n]);
        pull[0] = fma(T(static_cast<Scalar<T>>(star[0])), sine, pull[0]);
        pull[1] = fma(T(static_cast<Scalar<T>>(star[1])), sine, pull[1]);
      }
      T value(0.0);
      T by_t(0.0);
      for (std::size_t k = 0; k < SheetTable::kKnot; ++k) {
        const T from = row.of(here + k);
        const T to = row.of(next + k);
        value = fma(weights.from[k], from, fma(weights.to[k], to, value));
        by_t = fma(weights.from_slope[k], from, fma(weights.to_slope[k], to, by_t));
      }
      here += SheetTable::kKnot;
      next += SheetTable::kKnot;
      sum.energy = fma(value, wave, sum.energy);
      sum.slope = fma(by_t * p.per_length, wave, sum.slope);
      for (int j = 0; j < 2; ++j) sum.pull[j] = fma(value, pull[j], sum.pull[j]);
    }
    return sum;
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
