#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "framework/core/elements/pair_force.hpp"
#include "framework/core/records/force.hpp"
#include "framework/core/text/fault_code.hpp"

/// Bonds and potentials between pairs share this: chosen pairs, each with a rest length, kept as
/// the pair's datum. A description has a member `pairs`; without `rest_lengths` the datum is 0.
namespace tomlin {

template <class Description>
concept HasRestLengths = requires(const Description& d) {
  d.rest_lengths;
};

/// How many pairs a selection means on the bodies of a scene.
inline std::uint64_t count_of(const PairSelection& selection, const SceneOutline& scene) {
  const auto n = static_cast<std::uint64_t>(scene.bodies.front().count);
  switch (selection.kind) {
    case PairSelection::Kind::all:
      return scene.bodies.size() == 2 ? n * static_cast<std::uint64_t>(scene.bodies.back().count)
                                      : n * (n - 1) / 2;
    case PairSelection::Kind::neighbours:
      if (scene.bodies.front().neighbours) return scene.bodies.front().neighbours().size();
      return n - 1 + (scene.bodies.front().closed && n > 2 ? 1 : 0);
    case PairSelection::Kind::list:
      return selection.list.size();
  }
  return 0;
}

/// For ForceRecord::pairs.
template <class Description>
std::uint64_t bond_count(const void* description, const SceneOutline& scene) {
  return count_of(static_cast<const Description*>(description)->pairs, scene);
}

/// For ForceRecord::complaints.
template <class Description>
std::vector<Complaint> bond_complaints(const void* description, const SceneOutline& scene) {
  const auto& d = *static_cast<const Description*>(description);
  std::vector<Complaint> found;
  const std::size_t given = d.rest_lengths.numbers.size();
  const std::uint64_t expected = count_of(d.pairs, scene);
  if (given > 1 && given != expected) {
    found.push_back({.key = "rest_lengths",
                     .why = fmt::format("{} lengths for {} pairs", given, expected),
                     .admissible = "\"initial\", one length for all pairs, or one each",
                     .code = FaultCode::scene_wrong_count});
  }
  for (const double length : d.rest_lengths.numbers) {
    if (length < 0.0) {
      found.push_back({.key = "rest_lengths",
                       .why = "a length is negative",
                       .admissible = ">= 0",
                       .code = FaultCode::scene_out_of_range});
      break;
    }
  }
  return found;
}

/// The rows of `pairs`, and of `rest_lengths`.
template <class Description>
Parameter bonded_pairs() {
  return parameter(
      "pairs", &Description::pairs, dimension::none,
      "which pairs are bonded: \"all\", \"neighbours\" (each particle with the next; the last with "
      "the first in a closed body such as a ring, and in a chain along a periodic axis; in a "
      "flake, "
      "in graphene and in a nanotube the nearest neighbours of the lattice) or a list of index "
      "pairs; "
      "between two bodies \"all\" is each particle of the first with each of the "
      "second, and the first index of a pair is in the first body; in a periodic box a "
      "bond keeps the images with which it starts, and is warned of where it becomes as long as "
      "half "
      "the box");
}
/// The row of `pairs` for a potential, see pair_potential().
template <class Description>
Parameter interacting_pairs() {
  return parameter(
      "pairs", &Description::pairs, dimension::none,
      "which pairs interact: \"all\", \"neighbours\" or a list of index pairs; between two bodies "
      "\"all\" is each particle of the first with each of the second, and the first index of a "
      "pair "
      "is in the first body; in a periodic box by the nearest images at every time");
}
template <class Description>
Parameter bond_rest_lengths() {
  return parameter("rest_lengths", &Description::rest_lengths, dimension::length,
                   "\"initial\", one length for all pairs, or one each")
      .one_of({"initial"})
      .by_default(WordOrNumbers{.word = "initial", .numbers = {}});
}

/// Rest lengths in the pairs' order. The distances at the start are taken as the kernels take
/// them, so that no bond starts with a force of rounding.
template <class Real, int D>
void set_rest_lengths(const WordOrNumbers& rest, const Binding<Real>& binding,
                      std::vector<BoundPair<Real>>& pairs) {
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (rest.numbers.empty()) {
      pairs[k].datum = distance(separation_at_start<Real, D>(binding, pairs[k]));
    } else {
      pairs[k].datum = Real(rest.numbers[rest.numbers.size() == 1 ? 0 : k]);
      // On a line the kernels take either side for granted. Where the two coincide there is none:
      // no number, so that the first step fails.
      const bool coincide =
          D == 1 && separation_at_start<Real, D>(binding, pairs[k])[0] == Real(0.0);
      if (coincide && pairs[k].datum != Real(0.0)) pairs[k].datum = Real(__builtin_nan(""));
    }
  }
}

template <class E, const KernelTables& tables, int rank, PairImages images, class Real>
std::unique_ptr<BoundForce<Real>> bind_on_pairs(const typename E::Description& d,
                                                const Binding<Real>& binding) {
  BoundPairs<Real> bound = pairs_of(d.pairs, binding, images);
  return for_dimension<Real>(binding.dimension, [&]<int D>() -> std::unique_ptr<BoundForce<Real>> {
    if constexpr (HasRestLengths<typename E::Description>) {
      set_rest_lengths<Real, D>(d.rest_lengths, binding, bound.pairs);
    }
    return std::make_unique<PairForce<E, Real, D>>(d, binding, tables, std::move(bound), rank);
  });
}

/// The whole binding of bonds or of a potential, in every number type.
template <class E, const KernelTables& tables, int rank = kRankPairs,
          PairImages images = PairImages::kept>
ForceFactories on_bonds() {
  return {of_description<&bind_on_pairs<E, tables, rank, images, double>>,
          of_description<&bind_on_pairs<E, tables, rank, images, Quad>>};
}

/// The record of bonds within a body or between two, but for its name, its texts and parameters.
/// Bonds act along the line between two particles, so that forces and torques sum to zero.
template <class E, const KernelTables& tables, int rank = kRankPairs,
          PairImages images = PairImages::kept>
ForceRecord bond_force() {
  using Description = typename E::Description;
  ForceRecord record = record_of<Description>();
  record.element = Element::pair;
  record.traits = {.conservative = HasEnergy<E, 2, Pair>, .internal = true};
  record.most_bodies = 2;
  if constexpr (HasRestLengths<Description>) record.complaints = &bond_complaints<Description>;
  record.pairs = &bond_count<Description>;
  record.bind = on_bonds<E, tables, rank, images>();
  return record;
}

/// The record of a potential between all chosen particles: in a periodic box each pair acts by its
/// nearest images at every time, so that the potential has to end within half the box.
template <class E, const KernelTables& tables, int rank = kRankPairs>
ForceRecord pair_potential() {
  return bond_force<E, tables, rank, PairImages::nearest>();
}

}  // namespace tomlin
