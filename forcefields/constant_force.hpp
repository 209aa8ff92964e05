#pragma once

#include "framework/core/elements/element.hpp"
#include "framework/core/records/bound_force.hpp"
#include "framework/core/records/registry.hpp"

/// The same force on every particle, for ever.
///
///   V = -F.x
///
///   F  force  per particle, one component per axis
///
/// Source: elementary. Its energy is no periodic one: x is the scene's own, whole cells included.
namespace tomlin {

struct ConstantForceDescription {
  SpaceVector force;
};

ForceRecord constant_force_record();

inline namespace TOMLIN_TARGET {

struct ConstantForce {
  using Description = ConstantForceDescription;
  static constexpr Reads reads{};

  template <class T, int D>
  struct Parameters {
    Vec<T, D> force;
    Vec<T, D> base;  ///< where the scene's origin is
  };

  template <class T, int D>
  static Parameters<T, D> parameters(const Description& d) {
    Parameters<T, D> p;
    for (int k = 0; k < D; ++k) {
      p.force[k] = T(d.force.components[k]);
      p.base[k] = T(0.0);
    }
    return p;
  }

  template <class T, int D>
  static void rebase(Parameters<T, D>& p, const Description&, const Origin& origin) {
    for (int k = 0; k < D; ++k) {
      p.base[k] = T(static_cast<double>(origin.cells[k])) * T(origin.unit[k]);
    }
  }

  template <class T, int D>
  static T energy(const Parameters<T, D>& p, const Site<T, D>& site) {
    return -dot(p.force, site.position + p.base);
  }

  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>&) {
    return p.force;
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
