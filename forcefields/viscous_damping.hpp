#pragma once

#include "framework/core/elements/element.hpp"

/// Linear drag on each particle.
///
///   F = -c v
///
///   c  coefficient  mass/time, per particle (not the rate c/m)
///
/// Offers a force, and its friction matrix, c on the diagonal, of which schemes that take operators
/// make the exact flow v -> v exp(-c h/m) (framework/model/friction_kernels.hpp).
/// Source: Sircar and Patra, eq. (7) with the sign of eq. (10), which dissipates.
namespace tomlin {

struct ForceRecord;  // framework/core/records/force.hpp

struct ViscousDampingDescription {
  double coefficient = 0.0;
  double temperature = 0.0;  ///< of langevin; an energy
};

ForceRecord viscous_damping_record();

inline namespace TOMLIN_TARGET {

struct ViscousDamping {
  using Description = ViscousDampingDescription;
  static constexpr Reads reads{.velocity = true};

  template <class T, int D>
  struct Parameters {
    T coefficient;
  };

  template <class T, int D>
  static Parameters<T, D> parameters(const Description& d) {
    return {T(d.coefficient)};
  }

  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    return -p.coefficient * site.velocity;
  }

  static double temperature(const Description& d) { return d.temperature; }

  template <class T, int D>
  static T friction(const Parameters<T, D>& p) {
    return p.coefficient;
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
