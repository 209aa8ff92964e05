#pragma once

#include "framework/core/elements/element.hpp"
#include "framework/core/records/parameter.hpp"
#include "framework/core/records/registry.hpp"

/// This force is a soft repulsion between particles that ends at a cutoff. Replace it by your own
/// force.
///
///   V = height (1 - r^2/cutoff^2)^3  for r < cutoff, 0 beyond, each pair once
///
///   height  energy    of a coincident pair
///   cutoff  length    energy, force and its slope are continuous there
///
/// Source: the paper that the equation is from, with its number.
namespace tomlin {

/// The parameters as a scene gives them.
struct PairPluginNameDescription {
  PairSelection pairs{.kind = PairSelection::Kind::all, .list = {}};
  double height = 0.0;
  double cutoff = 0.0;
};

ForceRecord plugin_name_record();

inline namespace TOMLIN_TARGET {

/// The evaluator: one pair in D dimensions, whatever the number type T. No loop over pairs, no
/// branch on a number (select), no std:: mathematics (framework/core/numbers/math.hpp has exp, pow,
/// ...).
struct PairPluginName {
  using Description = PairPluginNameDescription;

  /// Nothing but numbers of type T.
  template <class T, int D>
  struct Parameters {
    T height;
    T inverse_square;  // 1 / cutoff^2
  };

  template <class T, int D>
  static Parameters<T, D> parameters(const Description& d) {
    return {T(d.height), T(1.0) / (T(d.cutoff) * T(d.cutoff))};
  }

  template <class T, int D>
  static T energy(const Parameters<T, D>& p, const Pair<T, D>& pair) {
    const T left = within(p, pair);
    return p.height * left * left * left;
  }

  /// On the first particle; the second gets the opposite. May be left out: then the energy is
  /// differentiated. dV/dr is -6 height r/cutoff^2 left^2, and pair.separation points to the second
  /// particle. Where dV/dr itself is at hand, pull(pair.separation, r, dV/dr) makes the force of
  /// it.
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Pair<T, D>& pair) {
    const T left = within(p, pair);
    return (T(-6.0) * p.height * p.inverse_square * left * left) * pair.separation;
  }

 private:
  /// 1 - r^2/cutoff^2, and 0 beyond the cutoff; a NaN stays one.
  template <class T, int D>
  static T within(const Parameters<T, D>& p, const Pair<T, D>& pair) {
    const T part = norm_squared(pair.separation) * p.inverse_square;
    return select(part >= T(1.0), T(0.0), T(1.0) - part);
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
