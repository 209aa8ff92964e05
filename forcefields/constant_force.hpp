#pragma once

#include "framework/core/elements/element.hpp"
#include "framework/core/records/parameter.hpp"

/// A constant force, the same for every particle at all times.
///
///   V = -F.x
///
///   F  force  per particle, one component per axis
///
/// Source: elementary. Its energy is no periodic one: x is the scene's own, whole cells included.
namespace tomlin {

struct ForceRecord;  // framework/core/records/force.hpp

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
  };

  template <class T, int D>
  static Parameters<T, D> parameters(const Description& d) {
    Parameters<T, D> p;
    for (int k = 0; k < D; ++k) p.force[k] = T(d.force.components[k]);
    return p;
  }

  template <class T, int D>
  static T energy(const Parameters<T, D>& p, const Site<T, D>& site) {
    return -dot(p.force, site.coordinates());
  }

  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>&) {
    return p.force;
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
