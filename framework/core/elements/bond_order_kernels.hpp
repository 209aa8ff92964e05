#pragma once

#include <type_traits>
#include <utility>

#include "framework/core/elements/bond_order_arguments.hpp"
#include "framework/core/elements/element.hpp"
#include "framework/core/numbers/number_types.hpp"

/// Bond-order potentials: the energy of a particle i, and its gradient, from its neighbours.
///
///   V_i = 1/2 sum_j f_C(r_ij) (f_R(r_ij) + b(zeta_ij) f_A(r_ij))
///   zeta_ij = sum_k f_C(r_ik) g(cos theta_ijk) w(r_ij - r_ik),  k other than i and j
///
/// An evaluator E gives f_C, f_R, f_A, b, g and w, each with its slope, for a number type T; the
/// sums, and the derivatives with respect to positions, are those below. All sums go over
/// neighbours in ascending order. Those at which f_C is zero add zeros: what is listed beyond
/// changes no bit.
namespace tomlin {
inline namespace TOMLIN_TARGET {

/// A function's value and derivative.
template <class T>
struct Sloped {
  T value;
  T slope;
};

/// A neighbour j of the particle.
template <class T>
struct BondRow {
  Vec<T, 3> direction;  ///< (x_j - x_i)/r_ij
  T distance;
  T inverse_distance;
  Sloped<T> cutoff;  ///< f_C
  T zeta;
  T by_zeta;           ///< dV_i/dzeta_ij
  T radial;            ///< dV_i/dr_ij at zeta_ij
  Vec<T, 3> gradient;  ///< dV_i/dx_j, what is found
};

/// Two neighbours j and k of it, where zeta_ij is found.
template <class T>
struct AngleRow {
  T cosine;
  Sloped<T> angle;   ///< g
  Sloped<T> weight;  ///< w
  Sloped<T> cutoff;  ///< f_C(r_ik)
};

/// Parameters that are those of all pairs and triples. `by_pairs`: g and w are the same for all
/// triples of a particle, and f_C of a triple is that of its bond, whatever the third particle.
template <class P>
struct OneSpecies {
  static constexpr bool by_pairs = true;
  P all;
  bool is_weighted = false;  ///< w is not 1

  TOMLIN_INLINE const P& pair(std::size_t) const { return all; }
  TOMLIN_INLINE const P& triple(std::size_t, std::size_t) const { return all; }
  TOMLIN_INLINE bool weighted() const { return is_weighted; }
};

/// Parameters of several species where they go by pairs: `at(j)` are the numbers of a bond,
/// `own` those of the particle.
template <class P, class At>
struct PairsOfSpecies {
  static constexpr bool by_pairs = true;
  At at;
  P own;
  bool is_weighted = false;

  TOMLIN_INLINE P pair(std::size_t j) const { return at(j); }
  TOMLIN_INLINE const P& triple(std::size_t, std::size_t) const { return own; }
  TOMLIN_INLINE bool weighted() const { return is_weighted; }
};

/// Parameters of several species: `at(j, k)` are the numbers of a triple.
template <class P, class At>
struct ManySpecies {
  static constexpr bool by_pairs = false;
  At at;
  bool is_weighted = false;

  TOMLIN_INLINE P pair(std::size_t j) const { return at(j, j); }
  TOMLIN_INLINE P triple(std::size_t j, std::size_t k) const { return at(j, k); }
  TOMLIN_INLINE bool weighted() const { return is_weighted; }
};

/// V_i, and its gradients in the rows, whose directions and distances are given. `angles` has room
/// for rows * rows. A row that is no neighbour has a distance beyond the cutoff.
template <class E, class T, class Rows, class Parameters>
TOMLIN_INLINE T bond_order_energy(Rows rows, BondRow<T>* bonds, AngleRow<T>* angles,
                                  const Parameters& p) {
  for (std::size_t j = 0; j < rows; ++j) {
    bonds[j].cutoff = E::cutoff(p.pair(j), bonds[j].distance);
    for (int d = 0; d < 3; ++d) bonds[j].gradient[d] = T(0.0);
  }
  // Three passes over the bonds: of the second, whose functions take long, several are under way at
  // a time.
  for (std::size_t j = 0; j < rows; ++j) {
    BondRow<T>& bond = bonds[j];
    bond.zeta = T(0.0);
    for (std::size_t k = 0; k < rows; ++k) {
      if (k == j) continue;
      const auto& q = p.triple(j, k);
      AngleRow<T>& row = angles[j * rows + k];
      if (Parameters::by_pairs && k < j) {
        row.cosine = angles[k * rows + j].cosine;
        row.angle = angles[k * rows + j].angle;
      } else {
        row.cosine = dot(bond.direction, bonds[k].direction);
        row.angle = E::angle(q, row.cosine);
      }
      row.cutoff = Parameters::by_pairs ? bonds[k].cutoff : E::cutoff(q, bonds[k].distance);
      T term = row.cutoff.value * row.angle.value;
      if (p.weighted()) {
        row.weight = E::weight(q, T(bond.distance - bonds[k].distance));
        term = term * row.weight.value;
      }
      bond.zeta = bond.zeta + term;
    }
  }
  T energy(0.0);
  const T half(Scalar<T>(0.5));
  for (std::size_t j = 0; j < rows; ++j) {
    BondRow<T>& bond = bonds[j];
    const auto& q = p.pair(j);
    const Sloped<T> order = E::order(q, bond.zeta);
    const Sloped<T> repulsion = E::repulsion(q, bond.distance);
    const Sloped<T> attraction = E::attraction(q, bond.distance);
    const T potential = fma(order.value, attraction.value, repulsion.value);
    energy = fma(half * bond.cutoff.value, potential, energy);
    const T slope = fma(order.value, attraction.slope, repulsion.slope);
    bond.radial = half * fma(bond.cutoff.slope, potential, bond.cutoff.value * slope);
    bond.by_zeta = half * bond.cutoff.value * attraction.value * order.slope;
  }
  for (std::size_t j = 0; j < rows; ++j) {
    BondRow<T>& bond = bonds[j];
    const T by_zeta = bond.by_zeta;
    bond.gradient = fma(bond.radial, bond.direction, bond.gradient);
    for (std::size_t k = 0; k < rows; ++k) {
      if (k == j) continue;
      const AngleRow<T>& row = angles[j * rows + k];
      BondRow<T>& other = bonds[k];
      T share = by_zeta * row.cutoff.value;
      T by_distance = by_zeta * row.cutoff.slope * row.angle.value;
      if (p.weighted()) {
        const T by_difference = share * row.angle.value * row.weight.slope;
        share = share * row.weight.value;
        by_distance = by_distance * row.weight.value - by_difference;
        bond.gradient = fma(by_difference, bond.direction, bond.gradient);
      }
      const T by_cosine = share * row.angle.slope;
      const T across_j = by_cosine * bond.inverse_distance;
      const T across_k = by_cosine * other.inverse_distance;
      for (int d = 0; d < 3; ++d) {
        const T rest_j = fnma(row.cosine, bond.direction[d], other.direction[d]);
        const T rest_k = fnma(row.cosine, other.direction[d], bond.direction[d]);
        bond.gradient[d] = fma(across_j, rest_j, bond.gradient[d]);
        other.gradient[d] =
            fma(by_distance, other.direction[d], fma(across_k, rest_k, other.gradient[d]));
      }
    }
  }
  return energy;
}

/// Lane k of the result is from[index[k]].
template <class Real>
TOMLIN_INLINE Packed<Real> gathered(const Real* from, const std::int64_t* index) {
#if TOMLIN_TARGET_IS_AVX512
  if constexpr (std::is_same_v<Real, double>) {
    const hn::RebindToSigned<pack_detail::PartTag> indices;
    return Pack(hn::GatherIndex(pack_detail::part_tag, from, hn::Load(indices, index)));
  }
#elif TOMLIN_TARGET_IS_AVX2
  if constexpr (std::is_same_v<Real, double>) {
    const hn::RebindToSigned<pack_detail::PartTag> indices;
    return Pack(
        hn::GatherIndex(pack_detail::part_tag, from, hn::Load(indices, index)),
        hn::GatherIndex(pack_detail::part_tag, from, hn::Load(indices, index + kGroup / 2)));
  }
#endif
  alignas(64) Real lane[kGroup];
  for (std::size_t k = 0; k < kGroup; ++k) lane[k] = from[index[k]];
  return Packed<Real>::load(lane);
}

/// The parameters of the triples that particles from the i-th on make with those of two slots.
/// `near_j` and `near_k` are the particles in them.
template <class E, class Real>
TOMLIN_INLINE auto gathered_parameters(const BondOrderArguments<Real>& a,
                                       const typename E::template Parameters<Real>* table,
                                       std::size_t i, const std::int64_t* near_j,
                                       const std::int64_t* near_k) {
  using P = typename E::template Parameters<Packed<Real>>;
  constexpr std::size_t n = sizeof(*table) / sizeof(Real);
  const auto species = static_cast<std::int64_t>(a.species);
  alignas(64) std::int64_t at[kGroup];
  for (std::size_t l = 0; l < kGroup; ++l) {
    const std::int64_t j = a.kind[near_j[l]];
    const std::int64_t k = a.kind[near_k[l]];
    at[l] = ((a.kind[i + l] * species + j) * species + k) * static_cast<std::int64_t>(n);
  }
  const Real* const numbers = reinterpret_cast<const Real*>(table);
  // One by one, not in a loop, so that those that are not used are not gathered.
  return [&]<std::size_t... k>(std::index_sequence<k...>) {
    return P{gathered(numbers + k, at)...};
  }
  (std::make_index_sequence<n>());
}

/// Scratch of one group with so many rows, in numbers.
template <class Real>
constexpr std::size_t bond_order_work(std::size_t rows) {
  return (rows * sizeof(BondRow<Real>) + rows * rows * sizeof(AngleRow<Real>)) / sizeof(Real) *
         kGroup;
}

/// Neighbours of an atom in a sheet or tube. For so many of one species the loops have a length
/// that the compiler knows.
constexpr std::size_t kSheetRows = 3;

/// The rows of each group of the particles from `begin` on, from their positions, and their
/// energies: use(first particle, first slot, rows, bonds, energy).
template <class E, class Real, class Use>
TOMLIN_INLINE void for_groups_of_bonds(const BondOrderArguments<Real>& a, const Stage<Real>& stage,
                                       std::size_t begin, std::size_t end, std::size_t member,
                                       Use&& use) {
  using Group = Packed<Real>;
  using P = typename E::template Parameters<Group>;
  const auto* const numbers =
      static_cast<const typename E::template Parameters<Real>*>(a.parameters);
  const P all = number_by_number<P, Group, Real>(numbers[0]);
  const bool uniform = a.species == 1;
  const Real* x = (a.body.mapped ? stage.mapped_position : stage.position) + a.body.offset;
  const std::size_t stride = a.body.stride;
  const std::size_t axis_length = a.slots * kGroup;
  const Group beyond(Real(2.0) * a.reach);
  const auto set_bonds = [&](std::size_t i, std::size_t first, auto rows, BondRow<Group>* bonds) {
    const Group count = Group::load(a.neighbours + i);
    Vec<Group, 3> here;
    for (int d = 0; d < 3; ++d) here[d] = Group::load(x + d * stride + i);
    for (std::size_t k = 0; k < rows; ++k) {
      const std::size_t slot = (first + k) * kGroup;
      Vec<Group, 3> way;
      for (int d = 0; d < 3; ++d) {
        way[d] = gathered(x + d * stride, a.near + slot) - here[d];
        if (a.shift != nullptr) way[d] = way[d] + Group::load(a.shift + d * axis_length + slot);
      }
      const Mask<Group> listed = Group(Real(static_cast<double>(k))) < count;
      BondRow<Group>& bond = bonds[k];
      bond.distance = select(listed, sqrt(norm_squared(way)), beyond);
      bond.inverse_distance = Group(Real(1.0)) / bond.distance;
      bond.direction = bond.inverse_distance * way;
    }
  };
  for (std::size_t i = begin; i < end; i += kGroup) {
    const std::size_t first = a.row_start[i / kGroup];
    const std::size_t rows = a.row_start[i / kGroup + 1] - first;
    if (rows == kSheetRows && uniform && !a.weighted) {
      const std::integral_constant<std::size_t, kSheetRows> three;
      BondRow<Group> bonds[kSheetRows];
      AngleRow<Group> angles[kSheetRows * kSheetRows];
      set_bonds(i, first, three, bonds);
      use(i, first, three, bonds,
          bond_order_energy<E, Group>(three, bonds, angles, OneSpecies<P>{all, false}));
      continue;
    }
    auto* const bonds = reinterpret_cast<BondRow<Group>*>(a.work + member * a.work_apart);
    auto* const angles = reinterpret_cast<AngleRow<Group>*>(bonds + rows);
    set_bonds(i, first, rows, bonds);
    if (uniform) {
      use(i, first, rows, bonds,
          bond_order_energy<E, Group>(rows, bonds, angles, OneSpecies<P>{all, a.weighted}));
      continue;
    }
    const std::int64_t* const near = a.near + first * kGroup;
    if (a.by_pairs) {
      const auto parameters_of = [&](std::size_t j) {
        return gathered_parameters<E, Real>(a, numbers, i, near + j * kGroup, near + j * kGroup);
      };
      std::int64_t itself[kGroup];
      for (std::size_t l = 0; l < kGroup; ++l) itself[l] = static_cast<std::int64_t>(i + l);
      const PairsOfSpecies<P, decltype(parameters_of)> pairs{
          parameters_of, gathered_parameters<E, Real>(a, numbers, i, itself, itself), a.weighted};
      use(i, first, rows, bonds, bond_order_energy<E, Group>(rows, bonds, angles, pairs));
      continue;
    }
    const auto parameters_at = [&](std::size_t j, std::size_t k) {
      return gathered_parameters<E, Real>(a, numbers, i, near + j * kGroup, near + k * kGroup);
    };
    const ManySpecies<P, decltype(parameters_at)> many{parameters_at, a.weighted};
    use(i, first, rows, bonds, bond_order_energy<E, Group>(rows, bonds, angles, many));
  }
}

template <class E, class Real, bool set>
void bond_order_kernel(const void* arguments, const Stage<Real>& stage_of_all) {
  using Group = Packed<Real>;
  const auto* const given = static_cast<const BondOrderArguments<Real>*>(arguments);
  given->update.run(given->update.list, stage_of_all);
  in_parts(
      given->team, given->body.count,
      [a = *given, stage = stage_of_all](std::size_t begin, std::size_t end, std::size_t member) {
        const std::size_t axis_length = a.slots * kGroup;
        for_groups_of_bonds<E, Real>(
            a, stage, begin, end, member,
            [&](std::size_t, std::size_t first, auto rows, const BondRow<Group>* bonds,
                const Group&) {
              for (std::size_t k = 0; k < rows; ++k) {
                for (int d = 0; d < 3; ++d) {
                  bonds[k].gradient[d].store(a.gradient + d * axis_length + (first + k) * kGroup);
                }
              }
            });
      });

  Real* const forces =
      (given->body.mapped ? stage_of_all.mapped_force : stage_of_all.force) + given->body.offset;
  in_parts(given->team, given->body.count,
           [a = *given, forces](std::size_t begin, std::size_t end, std::size_t) {
             const std::size_t axis_length = a.slots * kGroup;
             for (std::size_t i = begin; i < end; i += kGroup) {
               const std::size_t last = a.row_start[i / kGroup + 1];
               for (int d = 0; d < 3; ++d) {
                 const Real* gradient = a.gradient + d * axis_length;
                 Group total(Real(0.0));
                 for (std::size_t slot = a.row_start[i / kGroup]; slot < last; ++slot) {
                   total = total + (Group::load(gradient + slot * kGroup) -
                                    gathered(gradient, a.reverse + slot * kGroup));
                 }
                 Real* to = forces + d * a.body.stride + i;
                 (set ? total : Group::load(to) + total).store(to);
               }
             }
           });
}

template <class E, class Real>
void bond_order_energy_kernel(const void* arguments, const Stage<Real>& stage_of_all) {
  using Group = Packed<Real>;
  const auto* const given = static_cast<const BondOrderArguments<Real>*>(arguments);
  in_parts(
      given->team, given->body.count,
      [a = *given, stage = stage_of_all](std::size_t begin, std::size_t end, std::size_t member) {
        for_groups_of_bonds<E, Real>(a, stage, begin, end, member,
                                     [&](std::size_t i, std::size_t, auto, const BondRow<Group>*,
                                         const Group& energy) { energy.store(a.energy + i); });
      });
}

/// The kernels of an evaluator of bond orders.
template <class E, class Real>
constexpr BondOrderTable<Real> bond_order_table() {
  return {&bond_order_kernel<E, Real, true>, &bond_order_kernel<E, Real, false>,
          &bond_order_energy_kernel<E, Real>};
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
