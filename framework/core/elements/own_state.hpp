#pragma once

#include <cstddef>

#include "framework/core/elements/kernels.hpp"
#include "framework/core/numbers/number_types.hpp"
#include "framework/core/numbers/target.hpp"
#include "framework/core/system/kernel_arguments.hpp"

/// Particles whose force has a memory: a vector of its own for each, which the engine integrates.
///
/// An evaluator E has
///   template <class T, int D> struct Parameters;
///   static Vec<T,D> force(const Parameters<T,D>&, const OwnSite<T,D>&);
///   static Vec<T,D> rate(const Parameters<T,D>&, const OwnSite<T,D>&);     d own / dt
///   static T energy(const Parameters<T,D>&, const OwnSite<T,D>&);          stored
///   static T heat(const Parameters<T,D>&, const OwnSite<T,D>&);            power that is lost
///   template <class Real> static constexpr auto kernels() { return own_state_table<E, Real>(); }
namespace tomlin {

/// Arguments of the kernels below.
template <class Real>
struct OwnStateArguments {
  BodySlot<Real> body;
  const void* parameters = nullptr;  ///< the evaluator's Parameters<Real, D>
  std::size_t own = 0;               ///< [axis][count], of its own variables and of their rates
  std::ptrdiff_t heat_rate = kNoRate;
};

inline namespace TOMLIN_TARGET {

/// One particle and what the force keeps for it.
template <class T, int D>
struct OwnSite {
  Vec<T, D> position;  ///< relative to the scene's origin
  Vec<T, D> velocity;
  Vec<T, D> own;
};

/// The first n of a group; own variables stand close together, without padding.
template <class Real>
TOMLIN_INLINE Packed<Real> load_first(const Real* from, std::size_t n) {
  if (n >= kGroup) return Packed<Real>::load_unaligned(from);
  alignas(64) Real lane[kGroup];
  for (std::size_t k = 0; k < kGroup; ++k) lane[k] = k < n ? from[k] : Real(0.0);
  return Packed<Real>::load(lane);
}

template <class Real>
TOMLIN_INLINE void store_first(const Packed<Real>& group, Real* to, std::size_t n) {
  if (n >= kGroup) return group.store_unaligned(to);
  alignas(64) Real lane[kGroup];
  group.store(lane);
  for (std::size_t k = 0; k < n; ++k) to[k] = lane[k];
}

/// Eight particles from the i-th on.
template <class Real, int D>
TOMLIN_INLINE OwnSite<Packed<Real>, D> own_site_at(const OwnStateArguments<Real>& a,
                                                   const Stage<Real>& stage, std::size_t i) {
  using Group = Packed<Real>;
  const Real* x = (a.body.mapped ? stage.mapped_position : stage.position) + a.body.offset;
  const Real* v = (a.body.mapped ? stage.mapped_velocity : stage.velocity) + a.body.offset;
  const std::size_t count = a.body.count;
  OwnSite<Group, D> site;
  for (int d = 0; d < D; ++d) {
    site.position[d] = Group::load(x + d * a.body.stride + i);
    site.velocity[d] = Group::load(v + d * a.body.stride + i);
    site.own[d] = load_first(stage.own + a.own + d * count + i, count - i);
  }
  return site;
}

template <class E, class Real, int D, bool set>
TOMLIN_FLATTEN void own_state_kernel(const void* arguments, const Stage<Real>& stage) {
  using Group = Packed<Real>;
  const auto a = *static_cast<const OwnStateArguments<Real>*>(arguments);
  const auto p = in_all_lanes<E, Real, D>(a.parameters);
  Real* f = (a.body.mapped ? stage.mapped_force : stage.force) + a.body.offset;
  const std::size_t count = a.body.count;
  for (std::size_t i = 0; i < count; i += kGroup) {
    const OwnSite<Group, D> site = own_site_at<Real, D>(a, stage, i);
    const Vec<Group, D> force = E::force(p, site);
    const Vec<Group, D> rate = E::rate(p, site);
    for (int d = 0; d < D; ++d) {
      put<set>(f + d * a.body.stride + i, without_padding<Real>(force[d], i, count));
      store_first(rate[d], stage.rates + a.own + d * count + i, count - i);
    }
  }
}

template <class E, class Real, int D>
TOMLIN_FLATTEN void own_heat_kernel(const void* arguments, const Stage<Real>& stage) {
  using Group = Packed<Real>;
  const auto a = *static_cast<const OwnStateArguments<Real>*>(arguments);
  const auto p = in_all_lanes<E, Real, D>(a.parameters);
  Group total(Real(0.0));
  for (std::size_t i = 0; i < a.body.count; i += kGroup) {
    const Group heat = E::heat(p, own_site_at<Real, D>(a, stage, i));
    total += without_padding<Real>(heat, i, a.body.count);
  }
  stage.rates[a.heat_rate] = sum(total);
}

template <class E, class Real, int D>
TOMLIN_FLATTEN Real own_state_energy(const void* arguments, const Stage<Real>& stage) {
  using Group = Packed<Real>;
  const auto a = *static_cast<const OwnStateArguments<Real>*>(arguments);
  const auto p = in_all_lanes<E, Real, D>(a.parameters);
  Group total(Real(0.0));
  for (std::size_t i = 0; i < a.body.count; i += kGroup) {
    const Group energy = E::energy(p, own_site_at<Real, D>(a, stage, i));
    total += without_padding<Real>(energy, i, a.body.count);
  }
  return sum(total);
}

template <class E, class Real>
constexpr ElementTable<Real> own_state_table() {
  ElementTable<Real> table;
  table.site = {{&own_state_kernel<E, Real, 1, true>, &own_state_kernel<E, Real, 2, true>,
                 &own_state_kernel<E, Real, 3, true>},
                {&own_state_kernel<E, Real, 1, false>, &own_state_kernel<E, Real, 2, false>,
                 &own_state_kernel<E, Real, 3, false>}};
  table.heat[0] = &own_heat_kernel<E, Real, 1>;
  table.heat[1] = &own_heat_kernel<E, Real, 2>;
  table.heat[2] = &own_heat_kernel<E, Real, 3>;
  table.site_energy[0] = &own_state_energy<E, Real, 1>;
  table.site_energy[1] = &own_state_energy<E, Real, 2>;
  table.site_energy[2] = &own_state_energy<E, Real, 3>;
  return table;
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
