#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "framework/core/elements/bond_order_kernels.hpp"

/// Tersoff's bond-order potential between all particles of a body, in three dimensions.
///
///   V = 1/2 sum_i sum_j f_C(r_ij) (f_R(r_ij) + b_ij f_A(r_ij))
///   f_R(r) = A exp(-lambda1 r),  f_A(r) = -B exp(-lambda2 r)
///   f_C(r) = 1 below R - D, 1/2 - 1/2 sin(pi (r - R)/(2 D)) up to R + D, 0 beyond
///   b_ij = (1 + (beta zeta_ij)^n)^(-1/(2 n))
///   zeta_ij = sum_k f_C(r_ik) g(theta_ijk) exp((lambda3 (r_ij - r_ik))^m),  m = 1 or 3
///   g(theta) = gamma (1 + c^2/d^2 - c^2/(d^2 + (h - cos theta)^2)),  h = cos theta_0
///
///   A, B              energy
///   lambda1, 2, 3     1/length
///   R, D              length
///   beta, n, gamma, c, d, h    pure numbers
///
/// Sources: J. Tersoff, Phys. Rev. B 39, 5566 (1989), doi:10.1103/PhysRevB.39.5566, eqs. (1) and
/// (2); Phys. Rev. B 37, 6991 (1988), doi:10.1103/PhysRevB.37.6991, for lambda3. Values for
/// graphene: L. Lindsay and D. A. Broido, Phys. Rev. B 81, 205441 (2010),
/// doi:10.1103/PhysRevB.81.205441. Valid for r > 0; the force is continuous, its derivative jumps
/// at R - D and R + D.
namespace tomlin {

struct ForceRecord;  // framework/core/records/force.hpp

/// The numbers of one triple of species, in eV and Angstrom, in the order in which LAMMPS has them
/// in a file.
struct TersoffNumbers {
  double m = 3.0;
  double gamma = 1.0;
  double lambda3 = 0.0;
  double c = 0.0;
  double d = 1.0;
  double cos_theta0 = 0.0;
  double n = 1.0;
  double beta = 0.0;
  double lambda2 = 0.0;
  double b = 0.0;
  double r = 0.0;
  double half_width = 0.0;  ///< D
  double lambda1 = 0.0;
  double a = 0.0;
};

/// Numbers of the bond between the first and the second species, with the third present. What
/// belongs to the bond alone, n, beta, lambda1, lambda2, A and B, is that of the entry whose second
/// and third are the same; published files often have zeros for it in the other entries.
struct TersoffEntry {
  std::array<std::string, 3> species;
  TersoffNumbers numbers;

  bool of_bond() const { return species[1] == species[2]; }
};

struct TersoffDescription {
  std::string parameters;  ///< name of a set; empty: there are entries
  std::string file;
  std::string entries;              ///< text of a file
  std::vector<TersoffEntry> known;  ///< of the set or of the entries
  std::filesystem::path read_from;
};

/// The entries of a text in the format of LAMMPS' files: three species and fourteen numbers, over
/// one line or more, # comments. `faults`: "NAME:LINE: why".
std::vector<TersoffEntry> parse_tersoff(std::string_view text, const std::string& name,
                                        std::vector<std::string>& faults);

/// The numbers of all triples of these species, [(first * count + second) * count + third]; without
/// names those of the one entry. Empty where one is missing.
std::vector<TersoffNumbers> numbers_of(const TersoffDescription& description,
                                       const std::vector<std::string>& species);

ForceRecord tersoff_record();

inline namespace TOMLIN_TARGET {

struct Tersoff {
  using Description = TersoffDescription;

  template <class T>
  struct Parameters {
    T cubic;  // 1 for m = 3, 0 for m = 1
    T lambda3;
    T gamma;
    T c_squared;
    T d_squared;
    T ratio;  // gamma c^2/d^2
    T cos_theta0;
    T n;
    T exponent;  // -1/(2 n)
    T beta;
    T lambda2;
    T b;
    T middle;  // R
    T inner;   // R - D
    T outer;   // R + D
    T turns;   // 1/(4 D)
    T lambda1;
    T a;
  };

  template <class T>
  static Parameters<T> parameters(const TersoffNumbers& p) {
    const T c_squared = T(p.c) * T(p.c);
    const T d_squared = T(p.d) * T(p.d);
    return {T(p.m == 3.0 ? 1.0 : 0.0),
            T(p.lambda3),
            T(p.gamma),
            c_squared,
            d_squared,
            T(p.gamma) * (c_squared / d_squared),
            T(p.cos_theta0),
            T(p.n),
            p.n > 0.0 ? T(-0.5) / T(p.n) : T(0.0),  // 0: not of a bond, and not used
            T(p.beta),
            T(p.lambda2),
            T(p.b),
            T(p.r),
            T(p.r) - T(p.half_width),
            T(p.r) + T(p.half_width),
            T(0.25) / T(p.half_width),
            T(p.lambda1),
            T(p.a)};
  }

  /// The parameters of all triples of these species.
  template <class T>
  static std::vector<Parameters<T>> table(const Description& description,
                                          const std::vector<std::string>& species) {
    std::vector<Parameters<T>> all;
    for (const TersoffNumbers& p : numbers_of(description, species)) {
      all.push_back(parameters<T>(p));
    }
    return all;
  }

  template <class T>
  static T reach(const Parameters<T>& p) {
    return p.outer;
  }

  /// Compares the numbers of f_C.
  template <class T>
  static bool same_cutoff(const Parameters<T>& p, const Parameters<T>& q) {
    return p.middle == q.middle && p.inner == q.inner && p.outer == q.outer && p.turns == q.turns;
  }
  /// Compares the numbers of g and of the weight.
  template <class T>
  static bool same_surroundings(const Parameters<T>& p, const Parameters<T>& q) {
    return p.cubic == q.cubic && p.lambda3 == q.lambda3 && p.gamma == q.gamma &&
           p.c_squared == q.c_squared && p.d_squared == q.d_squared && p.ratio == q.ratio &&
           p.cos_theta0 == q.cos_theta0;
  }

  template <class T>
  static bool weighted(const Parameters<T>& p) {
    return p.lambda3 != T(0.0);
  }

  /// f_C
  template <class N, class T>
  static Sloped<T> cutoff(const Parameters<N>& p, const T& r) {
    const auto inside = r <= p.inner;
    const auto outside = r >= p.outer;
    const T one(Scalar<T>(1.0));
    const T none(Scalar<T>(0.0));
    // Mostly nothing is between: then the sine, a good part of the time, is not needed.
    if (!any(!(inside | outside))) return {select(inside, one, none), none};
    T sine;
    T cosine;
    sincos_turns(T((r - p.middle) * p.turns), sine, cosine);
    const T half(Scalar<T>(0.5));
    const T slope = cosine * (p.turns * (-half_tau<N>()));
    return {select(inside, one, select(outside, none, T(half - half * sine))),
            select(inside | outside, none, slope)};
  }

  /// f_R
  template <class N, class T>
  static Sloped<T> repulsion(const Parameters<N>& p, const T& r) {
    const T value = exp(T(r * (-p.lambda1))) * p.a;
    return {value, value * (-p.lambda1)};
  }

  /// f_A
  template <class N, class T>
  static Sloped<T> attraction(const Parameters<N>& p, const T& r) {
    const T value = exp(T(r * (-p.lambda2))) * (-p.b);
    return {value, value * (-p.lambda2)};
  }

  /// b. Its slope is infinite at zeta = 0 if n < 1, where a bond meets no other: there 0 stands for
  /// it, as the slope of zeta is 0.
  template <class N, class T>
  static Sloped<T> order(const Parameters<N>& p, const T& zeta) {
    // A smaller number adds nothing to 1, whatever n.
    constexpr double kLeast = sizeof(Scalar<T>) < sizeof(double) ? 1e-36 : 1e-280;
    const T least(static_cast<Scalar<T>>(kLeast));
    const T scaled = zeta * p.beta;
    const auto alone = !(scaled > least);
    const T x = select(alone, least, scaled);
    // A power beyond this is not formed: 1 adds nothing to it, and its logarithm is known. It is a
    // number of its type that may still be multiplied by x.
    const T most(static_cast<Scalar<T>>(sizeof(Scalar<T>) < sizeof(double) ? 40.0 : 300.0));
    const T exponent = log(x) * p.n;
    const T power = exp(T(min(exponent, most)));
    const T one_more = power + T(Scalar<T>(1.0));
    const T logarithm = select(exponent > most, exponent, log(one_more));
    const T value = exp(T(logarithm * p.exponent));
    const T slope = value * power * (p.beta * N(Scalar<N>(-0.5))) / (one_more * x);
    const T none(Scalar<T>(0.0));
    return {select(alone, T(Scalar<T>(1.0)), value), select(alone, none, slope)};
  }

  /// g, of the cosine: 1 + c^2 x^2/(d^2 (d^2 + x^2)), x = h - cosine, in which nothing cancels
  template <class N, class T>
  static Sloped<T> angle(const Parameters<N>& p, const T& cosine) {
    const T apart = p.cos_theta0 - cosine;
    const T squared = apart * apart;
    const T inverse = T(Scalar<T>(1.0)) / (squared + p.d_squared);
    const T part = inverse * (p.gamma * p.c_squared);
    return {squared * inverse * p.ratio + p.gamma, part * inverse * apart * N(Scalar<N>(-2.0))};
  }

  /// The factor of a difference of two distances in zeta. Exponents end where LAMMPS ends them.
  template <class N, class T>
  static Sloped<T> weight(const Parameters<N>& p, const T& difference) {
    const T x = difference * p.lambda3;
    const T squared = x * x;
    const auto cubic = p.cubic > N(Scalar<N>(0.5));
    const T one(Scalar<T>(1.0));
    const T most(static_cast<Scalar<T>>(kMostExponent));
    const T exponent = min(max(select(mask_of<T>(cubic), T(squared * x), x), T(-most)), most);
    const T value = exp(exponent);
    const T inner = select(mask_of<T>(cubic), T(squared * N(Scalar<N>(3.0))), one);
    return {value, value * inner * p.lambda3};
  }

  template <class Real>
  static constexpr auto kernels() {
    return bond_order_table<Tersoff, Real>();
  }

 private:
  static constexpr double kMostExponent = 69.0776;

  template <class N>
  static N half_tau() {
    return tau<N>() * N(Scalar<N>(0.5));
  }
  template <class T, class M>
  static Mask<T> mask_of(const M& mask) {
    return mask;
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
