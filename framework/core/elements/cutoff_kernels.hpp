#pragma once

#include <bit>
#include <cstddef>

#include "framework/core/elements/cutoff_arguments.hpp"
#include "framework/core/elements/element.hpp"
#include "framework/core/numbers/number_types.hpp"

/// The loop over pairs within a cutoff.
namespace tomlin {
inline namespace TOMLIN_TARGET {

/// True but in lane n.
template <class Group>
TOMLIN_INLINE Mask<Group> all_but_lane(std::size_t n) {
  return first_lanes_of<Group>(static_cast<int>(n)) |
         !first_lanes_of<Group>(static_cast<int>(n) + 1);
}

/// The parameters of the particle of a kind with eight others from j on, where they differ.
template <class E, class Real, int D>
TOMLIN_INLINE auto parameters_of_each(const CutoffPairArguments<Real>& a, std::size_t i,
                                      std::size_t j) {
  using Parameters = typename E::template Parameters<Packed<Real>, D>;
  constexpr std::size_t n = sizeof(typename E::template Parameters<Real, D>) / sizeof(Real);
  struct Numbers {
    Packed<Real> value[n];
  } numbers;
  const Real* from = a.numbers + a.kind[i] * n * a.numbers_apart + j;
  for (std::size_t k = 0; k < n; ++k) {
    numbers.value[k] = Packed<Real>::load(from + k * a.numbers_apart);
  }
  return std::bit_cast<Parameters>(numbers);
}

/// use(near, pair, i, j): all groups of pairs of each particle i from `begin` to `end` with eight
/// from j on, `near` those within the cutoff; then done(i).
template <class E, class Real, int D, class Use, class Done>
TOMLIN_INLINE void for_groups_of_pairs(const CutoffPairArguments<Real>& a, const Stage<Real>& stage,
                                       std::size_t begin, std::size_t end, Use&& use, Done&& done) {
  using Group = Packed<Real>;
  const Real* x = (a.one.mapped ? stage.mapped_position : stage.position) + a.one.offset;
  const Real* others = (a.other.mapped ? stage.mapped_position : stage.position) + a.other.offset;
  const Group cutoff_squared(a.cutoff_squared);
  const std::size_t whole = a.other.count / kGroup * kGroup;
  for (std::size_t i = begin; i < end; ++i) {
    Vec<Group, D> here;
    for (int d = 0; d < D; ++d) here[d] = Group(x[d * a.one.stride + i]);
    for (std::uint32_t k = a.row_start[i]; k < a.row_start[i + 1]; ++k) {
      const std::size_t j = a.first[k];
      const Real* shift = a.shifts + 3 * a.shift[k];
      Pair<Group, D> pair;
      for (int d = 0; d < D; ++d) {
        pair.separation[d] =
            (Group::load(others + d * a.other.stride + j) - here[d]) + Group(shift[d]);
      }
      pair.datum = Group(Real(0.0));
      Mask<Group> near = norm_squared(pair.separation) < cutoff_squared;
      if (j == whole) near = near & first_lanes_of<Group>(static_cast<int>(a.other.count - j));
      if (a.same_body && j == i / kGroup * kGroup) near = near & all_but_lane<Group>(i - j);
      if (any(near)) use(near, pair, i, j);  // what it would add otherwise is zero
    }
    done(i);
  }
}

/// The forces on the particles from `begin` to `end`.
template <class E, class Real, int D, bool set>
TOMLIN_INLINE void add_cutoff_forces(const CutoffPairArguments<Real>& a, const Stage<Real>& stage,
                                     std::size_t begin, std::size_t end) {
  using Group = Packed<Real>;
  const auto p = in_type<E, Group, Real, D>(
      *static_cast<const typename E::template Parameters<Real, D>*>(a.parameters));
  Real* f = (a.one.mapped ? stage.mapped_force : stage.force) + a.one.offset;
  const Group none(Real(0.0));
  Vec<Group, D> total;
  for (int d = 0; d < D; ++d) total[d] = none;
  const auto add = [&](const Mask<Group>& near, const Vec<Group, D>& force) {
    for (int d = 0; d < D; ++d) total[d] = total[d] + select(near, force[d], none);
  };
  const auto done = [&](std::size_t i) {
    for (int d = 0; d < D; ++d) {
      Real& to = f[d * a.one.stride + i];
      const Real sum_of_all = sum(total[d]);
      to = set ? sum_of_all : to + sum_of_all;
      total[d] = none;
    }
  };
  if (a.numbers == nullptr) {
    for_groups_of_pairs<E, Real, D>(
        a, stage, begin, end,
        [&](const Mask<Group>& near, const Pair<Group, D>& pair, std::size_t, std::size_t) {
          add(near, force_on<E, Group, D>(p, pair));
        },
        done);
  } else {
    for_groups_of_pairs<E, Real, D>(
        a, stage, begin, end,
        [&](const Mask<Group>& near, const Pair<Group, D>& pair, std::size_t i, std::size_t j) {
          add(near, force_on<E, Group, D>(parameters_of_each<E, Real, D>(a, i, j), pair));
        },
        done);
  }
  if constexpr (set) {
    for (std::size_t i = end; i % kGroup != 0; ++i) {
      for (int d = 0; d < D; ++d) f[d * a.one.stride + i] = Real(0.0);
    }
  }
}

template <class E, class Real, int D, bool set>
void cutoff_pair_kernel(const void* arguments, const Stage<Real>& stage_of_all) {
  const auto* const given = static_cast<const CutoffPairArguments<Real>*>(arguments);
  given->update.run(given->update.list, stage_of_all);
  in_parts(given->team, given->one.count,
           [a = *given, stage = stage_of_all](std::size_t begin, std::size_t end, std::size_t) {
             const std::size_t last = end < a.one.count ? end : a.one.count;
             add_cutoff_forces<E, Real, D, set>(a, stage, begin, last);
           });
}

template <class E, class Real, int D>
TOMLIN_INLINE void find_cutoff_energies(const CutoffPairArguments<Real>& a,
                                        const Stage<Real>& stage, std::size_t begin,
                                        std::size_t end) {
  using Group = Packed<Real>;
  const auto p = in_type<E, Group, Real, D>(
      *static_cast<const typename E::template Parameters<Real, D>*>(a.parameters));
  const Group none(Real(0.0));
  Group total = none;
  const bool differ = a.numbers != nullptr;
  for_groups_of_pairs<E, Real, D>(
      a, stage, begin, end,
      [&](const Mask<Group>& near, const Pair<Group, D>& pair, std::size_t i, std::size_t j) {
        const Group energy = E::energy(differ ? parameters_of_each<E, Real, D>(a, i, j) : p, pair);
        total = total + select(near, energy, none);
      },
      [&](std::size_t i) {
        a.energy[i] = sum(total);
        total = none;
      });
}

template <class E, class Real, int D>
void cutoff_energy_kernel(const void* arguments, const Stage<Real>& stage_of_all) {
  const auto* const given = static_cast<const CutoffPairArguments<Real>*>(arguments);
  in_parts(given->team, given->one.count,
           [a = *given, stage = stage_of_all](std::size_t begin, std::size_t end, std::size_t) {
             const std::size_t last = end < a.one.count ? end : a.one.count;
             find_cutoff_energies<E, Real, D>(a, stage, begin, last);
           });
}

/// The kernels of an evaluator of pairs that ends at a cutoff.
template <class E, class Real>
constexpr CutoffPairTable<Real> cutoff_pair_table() {
  CutoffPairTable<Real> table;
  const auto fill = [&]<int D>() {
    table.set[D - 1] = &cutoff_pair_kernel<E, Real, D, true>;
    table.add[D - 1] = &cutoff_pair_kernel<E, Real, D, false>;
    table.energy[D - 1] = &cutoff_energy_kernel<E, Real, D>;
  };
  fill.template operator()<1>();
  fill.template operator()<2>();
  fill.template operator()<3>();
  return table;
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
