#pragma once

#include <array>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "framework/core/elements/element.hpp"
#include "framework/core/numbers/double_double.hpp"
#include "framework/core/numbers/number_types.hpp"
#include "framework/core/numbers/periodic_spline.hpp"
#include "framework/core/records/bound_force.hpp"
#include "framework/core/records/parameter.hpp"
#include "framework/core/text/words.hpp"

/// Crystalline surface, felt by each particle on its own: a Fourier sum over the reciprocal
/// lattice, or a map M of the energy on a grid.
///
///   V(R, z) = W exp(-w z) + sum_s A_s exp(-d_s z) sum_G cos(2 pi G.R)
///   F_R = 2 pi sum_s A_s exp(-d_s z) sum_G G sin(2 pi G.R)
///   F_z = w W exp(-w z) + sum_s d_s A_s exp(-d_s z) sum_G cos(2 pi G.R)
///
///   V(R, z) = W exp(-w z) + exp(-d z) e M(b1.R, b2.R)
///   F_R = -exp(-d z) e sum_j b_j dM/d(b_j.R)
///
///   R    lateral position: x and y; x alone on a line and in a side view
///   z    height above the surface: z in three dimensions, y in a side view; else there is none
///   s    star: all reciprocal-lattice vectors of one length, in order of length
///   G    vectors m b1 + n b2 of the star, one of each pair G and -G; a_i.b_j = 1 if i = j, else 0
///   a_i  lattice, period, misfit; or lattice_vectors, misfit; length
///   A_s  amplitude, amplitudes  energy per particle
///   d_s  decay                  1/length, 0: no dependence on height
///   W    repulsion              energy per particle
///   w    repulsion_decay        1/length
///   M    energies, energy_map   energy per particle; spline of periodic_spline.hpp
///   e    energy_scale           dimensionless
///
/// Lattices with their first vector along x, turned counter-clockwise by the misfit:
///   square     a1 = (a, 0), a2 = (0, a); R = 0 is an atom
///   hexagonal  a1 = (a, 0), a2 = (a/2, sqrt(3) a/2); R = 0 is an atom
///   honeycomb  the same lattice with atoms at (a1 + a2)/3 and 2 (a1 + a2)/3; R = 0 is the centre
///              of a hexagon. Stars with m + n not divisible by 3 have the sign -1.
///   line       a1 = (a, 0); R = 0 is an atom
/// Atoms are maxima where amplitudes are positive.
///
/// Sources: G. S. Verhoeven, M. Dienwiebel, J. W. M. Frenken, Phys. Rev. B 70, 165418 (2004),
/// doi:10.1103/PhysRevB.70.165418: the first star of "honeycomb"; W. A. Steele,
/// Surf. Sci. 36, 317 (1973), doi:10.1016/0039-6028(73)90264-1: the form of the dependence on
/// height, here with the exponentials that its Bessel functions tend to.
/// Valid for any R; far below the surface (-d z > 709) energies exceed the range of numbers.
/// Lattice vectors are rounded to double precision once; the lattice is exactly theirs from there
/// on, however far away.
namespace tomlin {

struct ForceRecord;  // framework/core/records/force.hpp

enum class SurfaceLattice { square, hexagonal, honeycomb, line, given };

constexpr auto word_table(SurfaceLattice) {
  using enum SurfaceLattice;
  return std::to_array<Word<SurfaceLattice>>({{square, "square"},
                                              {hexagonal, "hexagonal"},
                                              {honeycomb, "honeycomb"},
                                              {line, "line"},
                                              {given, nullptr}});
}

enum class HeightAxis { z, y };

constexpr auto word_table(HeightAxis) {
  using enum HeightAxis;
  return std::to_array<Word<HeightAxis>>({{z, "z"}, {y, "y"}});
}

struct LatticeSubstrateDescription {
  static constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();

  SurfaceLattice lattice = SurfaceLattice::given;
  double period = kAbsent;    // a
  PointList lattice_vectors;  // a1, a2
  double misfit = 0.0;
  double amplitude = kAbsent;  // of the first star
  WordOrNumbers amplitudes;    // of the stars, or of the harmonics
  PointList harmonics;         // [m, n]
  std::string energy_map;      // empty once its energies are fetched: see read_from
  std::shared_ptr<const PeriodicSpline> map;
  double energy_scale = 1.0;
  std::filesystem::path read_from;
  HeightAxis height = HeightAxis::z;
  WordOrNumbers decay;
  double repulsion = 0.0;
  double repulsion_decay = 0.0;
};

/// A = amplitude exp(-decay z) of cos(2 pi (m b1 + n b2).R).
struct LatticeHarmonic {
  int m = 0;
  int n = 0;  ///< m > 0, or m = 0 and n > 0
  double amplitude = 0.0;
  double decay = 0.0;
};

/// How amplitudes depend on the height: not, all by one exponential, each by its own.
enum class LatticeHeight { none, common, each };

/// All harmonics of a description that its complaints accept.
std::vector<LatticeHarmonic> lattice_harmonics(const LatticeSubstrateDescription& description);
/// The decay of amplitude k.
double lattice_decay(const LatticeSubstrateDescription& description, std::size_t k);
/// The shortest lattice vector along an axis: a combination of a1 and a2, at most four of each,
/// that lies on it exactly; 0 where there is none.
double lattice_period(const LatticeSubstrateDescription& description, int axis);
/// Bounds on the curvatures without dependence on height: along x, along y, along any direction.
std::array<double, 3> lattice_curvatures(const LatticeSubstrateDescription& description);

ForceRecord lattice_substrate_record();

inline namespace TOMLIN_TARGET {

/// b1 and b2.
std::array<std::array<DoubleDouble, 2>, 2> reciprocal_lattice(const LatticeSubstrateDescription&);
/// b1.R and b2.R of the origin less whole lattice vectors: moving the origin by a lattice vector
/// changes no bit.
std::array<DoubleDouble, 2> lattice_phases(const LatticeSubstrateDescription&, const Origin&);

/// sum over m = 0..order, n = -order..order, one of each pair (m, n) and (-m, -n), of
/// A_mn cos(m p1 + n p2), from the sines and cosines of p1 and p2. Of one phase n is 0.
///
/// Rows: sum_n A_0n cos(n p2) + sum_m Re(exp(i m p1) sum_n A_mn exp(i n p2)), where A_mn and A_m-n
/// are taken together: even_mn = A_mn + A_m-n (n > 0; even_m0 = A_m0), odd_mn = A_mn - A_m-n.
template <class T, int phases, int order>
struct LatticeSum {
  static constexpr int kRow = phases == 1 ? 1 : 2 * order + 1;
  static constexpr int kFirst = phases == 1 ? 0 : order;  ///< terms with m = 0
  static constexpr int kTerms = kFirst + order * kRow;

  T term[kTerms];

  /// Returns the index of A_mn in an array of all terms.
  static constexpr int index(int m, int n) {
    if (phases == 1) return m - 1;
    return m == 0 ? n - 1 : kFirst + (m - 1) * kRow + order + n;
  }

  /// From the terms A_mn.
  TOMLIN_INLINE static LatticeSum of(const T (&a)[kTerms]) {
    LatticeSum sum;
    if constexpr (phases == 1) {
      for (int m = 1; m <= order; ++m) sum.term[m - 1] = a[m - 1];
    } else {
      for (int n = 1; n <= order; ++n) sum.term[index(0, n)] = a[index(0, n)];
      for (int m = 1; m <= order; ++m) {
        sum.term[index(m, 0)] = a[index(m, 0)];
        for (int n = 1; n <= order; ++n) {
          sum.term[index(m, n)] = a[index(m, n)] + a[index(m, -n)];
          sum.term[index(m, -n)] = a[index(m, n)] - a[index(m, -n)];
        }
      }
    }
    return sum;
  }

  /// Sines and cosines of m p1 and n p2, by complex products.
  struct Waves {
    T sine[phases][order + 1];
    T cosine[phases][order + 1];

    TOMLIN_INLINE explicit Waves(const Vec<T, phases>& turns) {
      for (int j = 0; j < phases; ++j) {
        T* s = sine[j];
        T* c = cosine[j];
        sincos_turns(turns[j], s[1], c[1]);
        for (int m = 2; m <= order; ++m) {
          s[m] = fma(s[m - 1], c[1], c[m - 1] * s[1]);
          c[m] = fma(c[m - 1], c[1], -(s[m - 1] * s[1]));
        }
      }
    }
  };

  TOMLIN_INLINE T energy(const Waves& w) const {
    T total = row_energy(w, 1);
    for (int m = 2; m <= order; ++m) total = total + row_energy(w, m);
    if constexpr (phases == 2) {
      for (int n = 1; n <= order; ++n) total = fma(term[index(0, n)], w.cosine[1][n], total);
    }
    return total;
  }

  /// -d/dp1 and -d/dp2.
  TOMLIN_INLINE Vec<T, phases> pull(const Waves& w) const {
    Vec<T, phases> pull = row_pull(w, 1);
    for (int m = 2; m <= order; ++m) {
      const Vec<T, phases> row = row_pull(w, m);
      pull[0] = fma(T(m), row[0], pull[0]);
      if constexpr (phases == 2) pull[1] = pull[1] + row[1];
    }
    if constexpr (phases == 2) {
      for (int n = 1; n <= order; ++n) {
        pull[1] = fma(times(n, term[index(0, n)]), w.sine[1][n], pull[1]);
      }
    }
    return pull;
  }

 private:
  TOMLIN_INLINE static T times(int n, const T& x) { return n == 1 ? x : T(n) * x; }

  TOMLIN_INLINE T row_energy(const Waves& w, int m) const {
    if constexpr (phases == 1) {
      return term[m - 1] * w.cosine[0][m];
    } else {
      T even = fma(term[index(m, 1)], w.cosine[1][1], term[index(m, 0)]);
      T odd = term[index(m, -1)] * w.sine[1][1];
      for (int n = 2; n <= order; ++n) {
        even = fma(term[index(m, n)], w.cosine[1][n], even);
        odd = fma(term[index(m, -n)], w.sine[1][n], odd);
      }
      return fma(w.cosine[0][m], even, -(w.sine[0][m] * odd));
    }
  }

  /// The first without its factor m.
  TOMLIN_INLINE Vec<T, phases> row_pull(const Waves& w, int m) const {
    Vec<T, phases> pull;
    if constexpr (phases == 1) {
      pull[0] = term[m - 1] * w.sine[0][m];
    } else {
      T even = fma(term[index(m, 1)], w.cosine[1][1], term[index(m, 0)]);
      T odd = term[index(m, -1)] * w.sine[1][1];
      T even_slope = term[index(m, 1)] * w.sine[1][1];
      T odd_slope = term[index(m, -1)] * w.cosine[1][1];
      for (int n = 2; n <= order; ++n) {
        const T along = term[index(m, n)];
        const T across = term[index(m, -n)];
        even = fma(along, w.cosine[1][n], even);
        odd = fma(across, w.sine[1][n], odd);
        even_slope = fma(times(n, along), w.sine[1][n], even_slope);
        odd_slope = fma(times(n, across), w.cosine[1][n], odd_slope);
      }
      pull[0] = fma(w.sine[0][m], even, w.cosine[0][m] * odd);
      pull[1] = fma(w.cosine[0][m], even_slope, w.sine[0][m] * odd_slope);
    }
    return pull;
  }
};

/// In place of the sum: a map of the energy over the cell.
template <class T, int phases>
struct LatticeMap {
  static constexpr int kTerms = 1;  ///< that depend on the height each by its own
  using Waves = SplinePoint<T, phases>;

  T scale;

  TOMLIN_INLINE T energy(const Waves& point) const { return scale * point.value(); }
  /// By turns.
  TOMLIN_INLINE Vec<T, phases> pull(const Waves& point) const {
    return (-scale) * point.gradient();
  }
};

/// The numbers of the dependence on height.
template <class T, LatticeHeight law, int terms>
struct LatticeDecays {};
template <class T, int terms>
struct LatticeDecays<T, LatticeHeight::common, terms> {
  T repulsion;
  T repulsion_decay;
  T decay;
};
template <class T, int terms>
struct LatticeDecays<T, LatticeHeight::each, terms> {
  T repulsion;
  T repulsion_decay;
  T decay[terms];
};

/// In place of an order: the energy map.
inline constexpr int kOfMap = 0;

/// The evaluator for harmonics up to an order, or for the map. There is one phase in one dimension
/// and in a side view, the only scene in two dimensions with a height.
template <int order, LatticeHeight law>
struct LatticeSubstrate {
  using Description = LatticeSubstrateDescription;
  static constexpr Reads reads{.table = order == kOfMap};
  static constexpr bool kHasHeight = law != LatticeHeight::none;

  template <int D>
  static constexpr int kPhases = D == 1 || (D == 2 && kHasHeight) ? 1 : 2;
  template <class T, int D>
  using Sum = std::conditional_t<order == kOfMap, LatticeMap<T, kPhases<D>>,
                                 LatticeSum<T, kPhases<D>, order>>;

  template <class T, int D>
  struct Parameters : LatticeDecays<T, law, Sum<T, D>::kTerms> {
    Vec<T, kPhases<D>> turns[kPhases<D>];   ///< b_j
    Vec<T, kPhases<D>> slopes[kPhases<D>];  ///< of what the sum is over: 2 pi b_j, of a map b_j
    Vec<T, kPhases<D>> phase;               ///< of the origin, in turns
    Sum<T, D> amplitude;                    ///< the terms themselves where each has its own decay
  };

  template <class T, int D>
  static Parameters<T, D> parameters(const Description& d) {
    Parameters<T, D> p{};
    const auto reciprocal = reciprocal_lattice(d);
    for (int j = 0; j < kPhases<D>; ++j) {
      for (int axis = 0; axis < kPhases<D>; ++axis) {
        p.turns[j][axis] = from_double_double<T>(reciprocal[j][axis]);
        p.slopes[j][axis] = order == kOfMap ? p.turns[j][axis] : tau<T>() * p.turns[j][axis];
      }
    }
    put_amplitudes(p, d);
    if constexpr (kHasHeight) {
      p.repulsion = T(d.repulsion);
      // Without repulsion there is no exponential of it that could overflow.
      p.repulsion_decay = T(d.repulsion == 0.0 ? 0.0 : d.repulsion_decay);
    }
    if constexpr (law == LatticeHeight::common) p.decay = T(lattice_decay(d, 0));
    return p;
  }

  static const double* table(const Description& d) { return d.map->table(); }

  template <class T, int D>
  static void rebase(Parameters<T, D>& p, const Description& d, const Origin& origin) {
    const auto phases = lattice_phases(d, origin);
    for (int j = 0; j < kPhases<D>; ++j) p.phase[j] = from_double_double<T>(phases[j]);
  }

  static double period(const Description& d, int axis) { return lattice_period(d, axis); }

  template <class T, int D>
  static T energy(const Parameters<T, D>& p,
                  const Site<T, D>& site) requires(D > 1 || !kHasHeight) {
    const auto waves = waves_at(p, site);
    if constexpr (!kHasHeight) {
      return p.amplitude.energy(waves);
    } else {
      const T z = site.coordinate(D - 1);
      const T wall = p.repulsion * exp(-(p.repulsion_decay * z));
      if constexpr (law == LatticeHeight::common) {
        return fma(exp(-(p.decay * z)), p.amplitude.energy(waves), wall);
      } else {
        T faded[Sum<T, D>::kTerms];
        for (int k = 0; k < Sum<T, D>::kTerms; ++k) {
          faded[k] = p.amplitude.term[k] * exp(-(p.decay[k] * z));
        }
        return Sum<T, D>::of(faded).energy(waves) + wall;
      }
    }
  }

  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p,
                         const Site<T, D>& site) requires(D > 1 || !kHasHeight) {
    const auto waves = waves_at(p, site);
    Vec<T, D> force;
    if constexpr (!kHasHeight) {
      put_lateral(p, p.amplitude.pull(waves), force);
      if constexpr (D == 3) force[2] = T(0.0);
    } else {
      const T z = site.coordinate(D - 1);
      const T wall = p.repulsion_decay * p.repulsion * exp(-(p.repulsion_decay * z));
      if constexpr (law == LatticeHeight::common) {
        const T height = exp(-(p.decay * z));
        put_lateral(p, height * p.amplitude.pull(waves), force);
        force[D - 1] = fma(p.decay * height, p.amplitude.energy(waves), wall);
      } else {
        T faded[Sum<T, D>::kTerms];
        T slope[Sum<T, D>::kTerms];
        for (int k = 0; k < Sum<T, D>::kTerms; ++k) {
          faded[k] = p.amplitude.term[k] * exp(-(p.decay[k] * z));
          slope[k] = p.decay[k] * faded[k];
        }
        put_lateral(p, Sum<T, D>::of(faded).pull(waves), force);
        force[D - 1] = Sum<T, D>::of(slope).energy(waves) + wall;
      }
    }
    return force;
  }

  /// Each harmonic adds at most 4 pi^2 |A| (G.u)^2 to the curvature along a unit vector u.
  template <int D>
  static double curvature_bound(const Description& d) requires(!kHasHeight) {
    return lattice_curvatures(d)[D == 1 ? 0 : 2];
  }
  template <int D>
  static double curvature_bound_along(const Description& d, int axis) requires(!kHasHeight) {
    return axis == 2 ? 0.0 : lattice_curvatures(d)[axis];
  }

 private:
  template <class T, int D>
  static void put_amplitudes(Parameters<T, D>& p, const Description& d) {
    if constexpr (order == kOfMap) {
      p.amplitude.scale = T(d.energy_scale);
    } else {
      T term[Sum<T, D>::kTerms] = {};
      for (const LatticeHarmonic& harmonic : lattice_harmonics(d)) {
        const int at = Sum<T, D>::index(harmonic.m, harmonic.n);
        term[at] = T(harmonic.amplitude);
        if constexpr (law == LatticeHeight::each) p.decay[at] = T(harmonic.decay);
      }
      if constexpr (law == LatticeHeight::each) {
        for (int k = 0; k < Sum<T, D>::kTerms; ++k) p.amplitude.term[k] = term[k];
      } else {
        p.amplitude = Sum<T, D>::of(term);
      }
    }
  }

  template <class T, int D>
  TOMLIN_INLINE static auto waves_at(const Parameters<T, D>& p, const Site<T, D>& site) {
    Vec<T, kPhases<D>> turns = p.phase;
    for (int j = 0; j < kPhases<D>; ++j) {
      for (int axis = 0; axis < kPhases<D>; ++axis) {
        turns[j] = fma(site.position[axis], p.turns[j][axis], turns[j]);
      }
    }
    if constexpr (order == kOfMap) {
      return typename Sum<T, D>::Waves(turns, site.table);
    } else {
      return typename Sum<T, D>::Waves(turns);
    }
  }

  /// The lateral force, from those along the phases.
  template <class T, int D>
  TOMLIN_INLINE static void put_lateral(const Parameters<T, D>& p, const Vec<T, kPhases<D>>& pull,
                                        Vec<T, D>& force) {
    for (int axis = 0; axis < kPhases<D>; ++axis) {
      force[axis] = p.slopes[0][axis] * pull[0];
      for (int j = 1; j < kPhases<D>; ++j) {
        force[axis] = fma(p.slopes[j][axis], pull[j], force[axis]);
      }
    }
  }
};

// The evaluators that there are kernels of.
using LatticeFirst = LatticeSubstrate<1, LatticeHeight::none>;
using LatticeHigher = LatticeSubstrate<3, LatticeHeight::none>;
using LatticeFirstAtHeight = LatticeSubstrate<1, LatticeHeight::common>;
using LatticeHigherAtHeight = LatticeSubstrate<3, LatticeHeight::common>;
using LatticeStarsAtHeight = LatticeSubstrate<3, LatticeHeight::each>;
using LatticeOfMap = LatticeSubstrate<kOfMap, LatticeHeight::none>;
using LatticeOfMapAtHeight = LatticeSubstrate<kOfMap, LatticeHeight::common>;

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
