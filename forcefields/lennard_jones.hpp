#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/core/elements/cutoff_kernels.hpp"
#include "framework/core/records/parameter.hpp"

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
/// Entries give epsilon and sigma for pairs of species. Mixing by H. A. Lorentz, Ann. Phys. 248
/// (1881) 127, doi:10.1002/andp.18812480110, and D. Berthelot, C. R. Acad. Sci. (Paris) 126 (1898)
/// 1703: sigma is the arithmetic mean of those of like pairs, epsilon the geometric one.
///
/// Source: J. E. Jones, Proc. R. Soc. Lond. A 106, 463 (1924), doi:10.1098/rspa.1924.0082; the
/// shifted force: S. Toxvaerd and J. C. Dyre, J. Chem. Phys. 134, 081102 (2011),
/// doi:10.1063/1.3558787.
/// Valid for r > 0. Without "smooth" the energy is not conserved where pairs pass the cutoff. With
/// it the second derivative jumps there.
namespace tomlin {

struct ForceRecord;  // framework/core/records/force.hpp

/// Treatment of energy and force at the cutoff.
enum class AtCutoff { cut, shift, smooth };

constexpr auto word_table(AtCutoff) {
  using enum AtCutoff;
  return std::to_array<Word<AtCutoff>>({{cut, "cut"}, {shift, "shift"}, {smooth, "smooth"}});
}

/// Treatment of pairs of species that have no entry.
enum class Mixing { none, lorentz_berthelot };

constexpr auto word_table(Mixing) {
  using enum Mixing;
  return std::to_array<Word<Mixing>>({{none, "none"}, {lorentz_berthelot, "lorentz_berthelot"}});
}

/// The numbers of two species.
struct LennardJonesEntry {
  std::array<std::string, 2> species;
  double epsilon = 0.0;
  double sigma = 0.0;
};

struct LennardJonesDescription {
  double epsilon = std::numeric_limits<double>::quiet_NaN();  // absent with entries
  double sigma = std::numeric_limits<double>::quiet_NaN();
  std::string entries;
  Mixing mixing = Mixing::none;
  double cutoff = 0.0;
  AtCutoff at_cutoff = AtCutoff::smooth;
};

/// The entries of a text, four words each: two species, epsilon and sigma. Adds to `faults`, each
/// with its line.
std::vector<LennardJonesEntry> parse_lennard_jones(std::string_view text,
                                                   std::vector<std::string>& faults);

/// The numbers of a pair of species: those of its entry, or mixed; nothing where there are none.
std::optional<LennardJonesEntry> lennard_jones_of(const std::vector<LennardJonesEntry>& known,
                                                  Mixing mixing, const std::string& one,
                                                  const std::string& other);

/// Entries of every pair of species; empty where the description has no entries.
std::vector<LennardJonesEntry> lennard_jones_of_all(const LennardJonesDescription& description,
                                                    const std::vector<std::string>& one,
                                                    const std::vector<std::string>& other);

/// The shortest sigma of those that repel.
double shortest_sigma(const LennardJonesDescription& description);

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
  /// Size of a particle: pairs that are nearer than half of this at the start are refused.
  static double size(const Description& d) { return shortest_sigma(d); }
  static constexpr const char* what_size = "half of sigma";

  template <class T, int D>
  static Parameters<T, D> parameters(const Description& d) {
    Parameters<T, D> p{T(4.0) * T(d.epsilon), T(d.sigma) * T(d.sigma), T(0.0), T(0.0), T(d.cutoff)};
    const T inverse_squared = T(1.0) / (p.cutoff * p.cutoff);
    if (d.at_cutoff != AtCutoff::cut) p.at_cutoff = value(p, inverse_squared);
    if (smooth) p.slope = slope_over_distance(p, inverse_squared) * p.cutoff;
    return p;
  }

  /// [species of one][species of other]; empty where all pairs are alike.
  template <class T, int D>
  static std::vector<Parameters<T, D>> by_species(const Description& d,
                                                  const std::vector<std::string>& one,
                                                  const std::vector<std::string>& other) {
    std::vector<Parameters<T, D>> all;
    for (const LennardJonesEntry& pair : lennard_jones_of_all(d, one, other)) {
      Description alike = d;
      alike.epsilon = pair.epsilon;
      alike.sigma = pair.sigma;
      all.push_back(parameters<T, D>(alike));
    }
    return all;
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
    const T inverse_squared = T(1.0) / squared;
    T scale = slope_over_distance(p, inverse_squared);
    if constexpr (smooth) scale = scale - p.slope * sqrt(inverse_squared);
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
