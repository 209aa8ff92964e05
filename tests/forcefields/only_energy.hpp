#pragma once

#include "framework/core/elements/element.hpp"
#include "framework/core/records/bound_force.hpp"

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
  template <class T, int D>
  static void rebase(typename E::template Parameters<T, D>& p, const Description& d,
                     const Origin& origin) requires requires {
    E::template rebase<T, D>(p, d, origin);
  }
  { E::template rebase<T, D>(p, d, origin); }
  template <class T, int D>
  static auto energy(const typename E::template Parameters<T, D>& p, const Site<T, D>& site) {
    return E::energy(p, site);
  }
};

}  // namespace tomlin::test
