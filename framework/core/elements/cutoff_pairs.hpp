#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "framework/core/elements/bonds.hpp"
#include "framework/core/elements/cutoff_arguments.hpp"
#include "framework/core/elements/kernel_tables.hpp"
#include "framework/core/elements/neighbour_list.hpp"
#include "framework/core/elements/site_force.hpp"
#include "framework/core/numbers/sum.hpp"
#include "framework/core/records/facets.hpp"

/// Bound forces between all pairs within a cutoff, made from an evaluator of pairs: within a body,
/// or between two.
namespace tomlin {

using CutoffPairTables = TablesByType<CutoffPairTable>;

/// For each particle of one body the groups of eight particles of another, or of the same, that
/// hold its neighbours.
template <class Real>
class GroupList {
 public:
  GroupList(const BoundBody<Real>& one, const BoundBody<Real>& other, int dimension, double cutoff,
            const std::array<double, 3>& box)
      : finder_(one, other, dimension, single_list(cutoff), box), energy_(padded(one.slot.count)) {
    arguments.update = {&GroupList::update, this};
    arguments.one = one.slot;
    arguments.other = other.slot;
    arguments.same_body = one.index == other.index;
    arguments.cutoff_squared = Real(cutoff) * Real(cutoff);
    arguments.energy = energy_.data();
  }
  GroupList(const GroupList&) = delete;
  GroupList& operator=(const GroupList&) = delete;

  void bring_up_to_date(const Stage<Real>& stage) { update(this, stage); }

  /// Neighbours within the reach of the list; pairs within a body are there twice.
  NeighbourCount count() const {
    return {static_cast<double>(neighbours_) / static_cast<double>(finder_.count()), most_,
            arguments.same_body ? neighbours_ / 2 : neighbours_,
            finder_.bytes() + bytes_of(row_start_) + bytes_of(first_) + bytes_of(shift_) +
                known_.bytes() + bytes_of(shifts_) + bytes_of(energy_)};
  }

  /// Parameters that differ between species: which each particle of `one` is, and the numbers as
  /// the arguments have them.
  void set_species(std::vector<std::uint32_t> kind, AlignedVector<Real> numbers) {
    kind_ = std::move(kind);
    numbers_ = std::move(numbers);
    arguments.kind = kind_.data();
    arguments.numbers = numbers_.data();
    arguments.numbers_apart = padded(arguments.other.count);
  }

  CutoffPairArguments<Real> arguments;

 private:
  static void update(void* list, const Stage<Real>& stage) {
    auto& self = *static_cast<GroupList*>(list);
    if (self.finder_.begin(stage)) self.make();
  }

  void make() {
    row_start_.assign(1, 0);
    first_.clear();
    shift_.clear();
    known_.clear();
    shifts_.clear();
    neighbours_ = 0;
    most_ = 0;
    for (std::size_t i = 0; i < finder_.count(); ++i) {
      const std::size_t begin = first_.size();
      const std::vector<Neighbour>& found = finder_.of(i);
      neighbours_ += found.size();
      most_ = std::max(most_, found.size());
      for (const Neighbour& near : found) {
        const auto group = static_cast<std::uint32_t>(near.particle / kGroup * kGroup);
        const std::uint32_t shift = known_.number_of(near.shift);
        // A group at the side of the box is there with several images, each for other particles.
        bool listed = false;
        for (std::size_t k = first_.size(); k > begin && first_[k - 1] == group; --k) {
          listed = listed || shift_[k - 1] == shift;
        }
        if (listed) continue;
        first_.push_back(group);
        shift_.push_back(shift);
      }
      row_start_.push_back(static_cast<std::uint32_t>(first_.size()));
    }
    for (std::size_t k = 0; k < known_.size(); ++k) {
      for (const double x : known_[k]) shifts_.push_back(Real(x));
    }
    arguments.row_start = row_start_.data();
    arguments.first = first_.data();
    arguments.shift = shift_.data();
    arguments.shifts = shifts_.data();
  }

  NeighbourFinder<Real> finder_;
  std::size_t neighbours_ = 0;
  std::size_t most_ = 0;
  std::vector<std::uint32_t> row_start_;
  std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> shift_;
  ImageShifts known_;
  AlignedVector<Real> shifts_;
  AlignedVector<Real> energy_;
  std::vector<std::uint32_t> kind_;
  AlignedVector<Real> numbers_;
};

/// The evaluator between all pairs within the cutoff that its description states. Besides energy
/// and force the evaluator has cutoff(description); size(description), half of which is how near
/// particles may start and how far they move in a step, and what_size, which says so in messages;
/// by_species(description, species of one, species of other), the parameters of each pair of
/// species, empty where all pairs are alike. Between two
/// bodies each gets its force by a list of its own, but for one that is fixed.
template <class E, class Real, int D>
class CutoffPairForce : public BoundForce<Real>,
                        public Curvature<Real>,
                        public Diagnosis<Real>,
                        public CountsNeighbours,
                        public SharesWork {
 public:
  using Parameters = typename E::template Parameters<Real, D>;

  CutoffPairForce(const typename E::Description& description, const Binding<Real>& binding,
                  const CutoffPairTables& tables, int rank)
      : parameters_(E::template parameters<Real, D>(description)),
        table_(tables.on<Real>(binding.set)),
        one_(*binding.bodies.front()),
        other_(*binding.bodies.back()),
        one_species_(one_),
        other_species_(other_),
        rank_(rank) {
    by_species_ =
        E::template by_species<Real, D>(description, one_species_.names, other_species_.names);
    const double cutoff = E::cutoff(description);
    size_ = E::size(description);
    check_distances(starting(one_), starting(other_), D, binding.box, std::min(0.5 * size_, cutoff),
                    E::what_size);
    add_list(one_, other_, cutoff, binding.box);
    if (one_.index != other_.index) add_list(other_, one_, cutoff, binding.box);
  }

  std::vector<Pass<Real>> passes() override {
    std::vector<Pass<Real>> all;
    for (const auto& list : lists_) {
      const BoundBody<Real>& body = &list == &lists_.front() ? first_listed() : other_;
      all.push_back(
          {table_.set[D - 1], table_.add[D - 1], &list->arguments, {{body.index, false}}, rank_});
    }
    return all;
  }

  void share_with(const Team& team) override {
    for (const auto& list : lists_) list->arguments.team = &team;
  }

  /// Counts the neighbours in the first list, and the memory of both.
  NeighbourCount count_neighbours() const override {
    NeighbourCount count = lists_.front()->count();
    for (std::size_t k = 1; k < lists_.size(); ++k) count.bytes += lists_[k]->count().bytes;
    return count;
  }

  Real energy(const Stage<Real>& stage) const override {
    GroupList<Real>& list = *lists_.front();
    list.bring_up_to_date(stage);
    table_.energy[D - 1](&list.arguments, stage);
    InterleavedSum<Real> total;
    for (std::size_t i = 0; i < list.arguments.one.count; ++i) {
      total.add(i, list.arguments.energy[i]);
    }
    return list.arguments.same_body ? Real(0.5) * total.total() : total.total();
  }

  void hessian(const Stage<Real>& stage, HessianSink& sink) const override {
    const BoundBody<Real>& body = first_listed();
    const BoundBody<Real>& other = other_listed();
    const bool same = body.index == other.index;
    for_pairs(stage, [&](std::size_t i, std::size_t j, const Pair<Real, D>& pair) {
      if (same && j < i) return;
      using T = Dual<Real, D>;
      const auto force =
          force_on<E, T, D>(in_type<E, T, Real, D>(parameters_of(i, j)), differentiable(pair));
      for (int a = 0; a < D; ++a) {
        for (int b = 0; b < D; ++b) {
          sink.pair(body.index, i, other.index, j, a, b,
                    static_cast<double>(force[a].derivative[b]));
        }
      }
    });
  }

  /// In a step no particle moves by more than half of this.
  double shortest_bond() const override { return size_; }

  std::string why_not_finite(const Stage<Real>& stage) const override {
    std::string why;
    const BoundBody<Real>& body = first_listed();
    const BoundBody<Real>& other = other_listed();
    for_pairs(stage, [&](std::size_t i, std::size_t j, const Pair<Real, D>& pair) {
      const Vec<Real, D> force = force_on<E, Real, D>(parameters_of(i, j), pair);
      if (is_finite(force) || !why.empty()) return;
      why =
          fmt::format("{} and {} are {:.3g} apart", name_of(starting(body), i),
                      name_of(starting(other), j), static_cast<double>(distance(pair.separation)));
    });
    return why;
  }

 private:
  void add_list(const BoundBody<Real>& one, const BoundBody<Real>& other, double cutoff,
                const std::array<double, 3>& box) {
    if (one.coordinates == Coordinates::fixed) return;
    lists_.push_back(std::make_unique<GroupList<Real>>(one, other, D, cutoff, box));
    lists_.back()->arguments.parameters = &parameters_;
    if (!by_species_.empty()) add_species(*lists_.back(), one.index == one_.index);
  }

  /// The parameters of each species with each particle of the other body.
  void add_species(GroupList<Real>& list, bool forward) {
    const ListedSpecies& one = forward ? one_species_ : other_species_;
    const ListedSpecies& other = forward ? other_species_ : one_species_;
    constexpr std::size_t n = sizeof(Parameters) / sizeof(Real);
    const std::size_t apart = padded(other.kind.size());
    AlignedVector<Real> numbers(one.names.size() * n * apart, Real(0.0));
    struct Numbers {
      Real value[n];
    };
    for (std::uint32_t kind = 0; kind < one.names.size(); ++kind) {
      for (std::size_t j = 0; j < other.kind.size(); ++j) {
        const auto from = std::bit_cast<Numbers>(forward ? of_kinds(kind, other.kind[j])
                                                         : of_kinds(other.kind[j], kind));
        for (std::size_t k = 0; k < n; ++k) {
          numbers[(kind * n + k) * apart + j] = from.value[k];
        }
      }
    }
    list.set_species(one.kind, std::move(numbers));
  }

  const Parameters& of_kinds(std::uint32_t one, std::uint32_t other) const {
    return by_species_[one * other_species_.names.size() + other];
  }

  /// Parameters of a particle of the first list and its partner.
  const Parameters& parameters_of(std::size_t i, std::size_t j) const {
    if (by_species_.empty()) return parameters_;
    if (first_listed().index != one_.index) std::swap(i, j);
    return of_kinds(one_species_.kind[i], other_species_.kind[j]);
  }

  /// That whose neighbours the first list holds.
  const BoundBody<Real>& first_listed() const {
    return one_.coordinates == Coordinates::fixed ? other_ : one_;
  }
  /// The body that they are particles of.
  const BoundBody<Real>& other_listed() const {
    return first_listed().index == one_.index ? other_ : one_;
  }

  /// All pairs within the cutoff, particle by particle of the first list; within a body twice.
  template <class Use>
  void for_pairs(const Stage<Real>& stage, Use&& use) const {
    lists_.front()->bring_up_to_date(stage);
    const CutoffPairArguments<Real>& a = lists_.front()->arguments;
    for (std::size_t i = 0; i < a.one.count; ++i) {
      const auto here = vector_at<D, Real>(a.one, stage.position, stage.mapped_position, i);
      for (std::uint32_t k = a.row_start[i]; k < a.row_start[i + 1]; ++k) {
        for (std::size_t j = a.first[k]; j < a.first[k] + kGroup && j < a.other.count; ++j) {
          if (a.same_body && j == i) continue;
          const auto there = vector_at<D, Real>(a.other, stage.position, stage.mapped_position, j);
          Pair<Real, D> pair{};
          for (int d = 0; d < D; ++d) {
            pair.separation[d] = (there[d] - here[d]) + a.shifts[3 * a.shift[k] + d];
          }
          if (norm_squared(pair.separation) < a.cutoff_squared) use(i, j, pair);
        }
      }
    }
  }

  Parameters parameters_;
  const CutoffPairTable<Real>& table_;
  BoundBody<Real> one_;
  BoundBody<Real> other_;
  ListedSpecies one_species_;
  ListedSpecies other_species_;
  /// [species of one][species of other]; empty where all pairs are alike.
  std::vector<Parameters> by_species_;
  int rank_;
  double size_ = 0.0;
  std::vector<std::unique_ptr<GroupList<Real>>> lists_;
};

template <class E, const CutoffPairTables& tables, int rank, class Real>
std::unique_ptr<BoundForce<Real>> bind_within_cutoff(const typename E::Description& d,
                                                     const Binding<Real>& binding) {
  return for_dimension<Real>(binding.dimension, [&]<int D>() -> std::unique_ptr<BoundForce<Real>> {
    return std::make_unique<CutoffPairForce<E, Real, D>>(d, binding, tables, rank);
  });
}

}  // namespace tomlin
