#pragma once

#include "framework/core/elements/element.hpp"

namespace tomlin::test {

/// The evaluator without its force: the framework differentiates the energy.
template <class E>
struct OnlyEnergyOnSites {
  using Description = typename E::Description;
  static constexpr Reads reads = E::reads;
  template <class T, int D>
  using Parameters = typename E::template Parameters<T, D>;
  template <class T, int D>
  static auto parameters(const Description& d) {
    return E::template parameters<T, D>(d);
  }
  static double period(const Description& d, int axis) requires requires { E::period(d, axis); }
  { return E::period(d, axis); }
  template <class T, int D>
  static auto energy(const typename E::template Parameters<T, D>& p, const Site<T, D>& site) {
    return E::energy(p, site);
  }
};

}  // namespace tomlin::test
