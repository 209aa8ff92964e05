#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "framework/core/elements/bond_order_kernels.hpp"
#include "framework/core/elements/kernel_tables.hpp"
#include "framework/core/elements/neighbour_list.hpp"
#include "framework/core/elements/site_force.hpp"
#include "framework/core/numbers/sum.hpp"
#include "framework/core/records/facets.hpp"

/// Bound bond-order potentials, made from an evaluator.
namespace tomlin {

using BondOrderTables = TablesByType<BondOrderTable>;

/// The neighbours of each particle of a body, a row for each.
template <class Real>
class NeighbourRows {
 public:
  using Entry = typename DualList<Real>::Entry;

  NeighbourRows(const BoundBody<Real>& body, const PairCutoffs& cutoffs,
                const std::array<double, 3>& box)
      : list_(body, 3, cutoffs, box),
        periodic_(box[0] > 0.0 || box[1] > 0.0 || box[2] > 0.0),
        neighbours_(padded(body.slot.count), Real(0.0)),
        energy_(padded(body.slot.count)) {
    arguments.update = {&NeighbourRows::update, this};
    arguments.body = body.slot;
    arguments.reach = Real(cutoffs.longest());
    arguments.energy = energy_.data();
  }
  NeighbourRows(const NeighbourRows&) = delete;
  NeighbourRows& operator=(const NeighbourRows&) = delete;

  void bring_up_to_date(const Stage<Real>& stage) { update(this, stage); }
  std::span<const Entry> of(std::size_t particle) const { return list_.of(particle); }
  const std::array<double, 3>& shift_of(const Entry& near) const { return list_.shift_of(near); }
  NeighbourCount count() const {
    NeighbourCount all;
    all.bytes = list_.bytes() + bytes_of(row_start_) + bytes_of(neighbours_) + bytes_of(near_) +
                bytes_of(reverse_) + bytes_of(shift_) + bytes_of(gradient_) + bytes_of(work_) +
                bytes_of(energy_);
    std::size_t neighbours = 0;
    for (std::size_t i = 0; i < list_.count(); ++i) {
      neighbours += of(i).size();
      all.most = std::max(all.most, of(i).size());
    }
    all.pairs = neighbours / 2;
    all.mean = static_cast<double>(neighbours) / static_cast<double>(list_.count());
    return all;
  }

  BondOrderArguments<Real> arguments;

 private:
  static void update(void* list, const Stage<Real>& stage) {
    auto& self = *static_cast<NeighbourRows*>(list);
    // In a solid an updated list mostly has the same neighbours as before.
    if (self.list_.update(stage)) self.lay_all();
  }

  void lay_all() {
    const std::size_t count = list_.count();
    const std::size_t groups = padded(count) / kGroup;
    row_start_.assign(groups + 1, 0);
    most_rows_ = 0;
    for (std::size_t g = 0; g < groups; ++g) {
      std::size_t rows = 0;
      for (std::size_t i = g * kGroup; i < (g + 1) * kGroup && i < count; ++i) {
        neighbours_[i] = Real(static_cast<double>(of(i).size()));
        rows = std::max(rows, of(i).size());
      }
      most_rows_ = std::max(most_rows_, rows);
      row_start_[g + 1] = row_start_[g] + static_cast<std::uint32_t>(rows);
    }
    const std::size_t slots = row_start_.back();
    near_.assign(slots * kGroup, 0);
    reverse_.resize(slots * kGroup);
    if (periodic_) shift_.assign(3 * slots * kGroup, Real(0.0));
    // A slot without a neighbour is its own reverse; there is no gradient at it.
    for (std::size_t k = 0; k < reverse_.size(); ++k) reverse_[k] = static_cast<std::int64_t>(k);
    for (std::size_t i = 0; i < count; ++i) lay(i, slots);
    gradient_.resize(3 * slots * kGroup);
    arguments.work_apart = bond_order_work<Real>(most_rows_);
    work_.resize(arguments.work_apart * (arguments.team == nullptr ? 1 : arguments.team->members));
    arguments.row_start = row_start_.data();
    arguments.neighbours = neighbours_.data();
    arguments.near = near_.data();
    arguments.reverse = reverse_.data();
    arguments.shift = periodic_ ? shift_.data() : nullptr;
    arguments.slots = slots;
    arguments.gradient = gradient_.data();
    arguments.work = work_.data();
  }

  std::size_t index_of(std::size_t particle, std::size_t row) const {
    return (row_start_[particle / kGroup] + row) * kGroup + particle % kGroup;
  }

  void lay(std::size_t i, std::size_t slots) {
    const std::span<const Entry> near = of(i);
    for (std::size_t k = 0; k < near.size(); ++k) {
      const Entry& neighbour = near[k];
      const std::size_t index = index_of(i, k);
      near_[index] = neighbour.particle;
      if (periodic_) {
        for (std::size_t d = 0; d < 3; ++d) {
          shift_[d * slots * kGroup + index] = Real(list_.shift_of(neighbour)[d]);
        }
      }
      const std::span<const Entry> back = of(neighbour.particle);
      const auto me = std::lower_bound(
          back.begin(), back.end(), i,
          [](const Entry& one, std::size_t particle) { return one.particle < particle; });
      if (me == back.end() || me->particle != i) continue;  // at the very edge of the list's reach
      reverse_[index] = static_cast<std::int64_t>(
          index_of(neighbour.particle, static_cast<std::size_t>(me - back.begin())));
    }
  }

  DualList<Real> list_;
  bool periodic_;
  std::size_t most_rows_ = 0;
  std::vector<std::uint32_t> row_start_;
  AlignedVector<Real> neighbours_;
  AlignedVector<std::int64_t> near_;
  AlignedVector<std::int64_t> reverse_;
  AlignedVector<Real> shift_;
  AlignedVector<Real> gradient_;
  AlignedVector<Real> work_;
  AlignedVector<Real> energy_;
};

/// The potential among all particles of a body, in three dimensions.
template <class E, class Real>
class BondOrderForce : public BoundForce<Real>,
                       public Curvature<Real>,
                       public Diagnosis<Real>,
                       public CountsNeighbours,
                       public SharesWork {
 public:
  using Entry = typename NeighbourRows<Real>::Entry;

  BondOrderForce(const typename E::Description& description, const Binding<Real>& binding,
                 const BondOrderTables& tables)
      : table_(tables.on<Real>(binding.set)),
        body_(*binding.bodies.front()),
        species_(body_),
        kind_(padded(body_.slot.count), 0),
        parameters_(E::template table<Real>(description, species_.names)),
        rows_(body_, cutoffs(), binding.box) {
    std::copy(species_.kind.begin(), species_.kind.end(), kind_.begin());
    check_distances(starting(body_), starting(body_), 3, binding.box, 0.25 * shortest_reach(),
                    "a quarter of the shortest cutoff");
    rows_.arguments.parameters = parameters_.data();
    rows_.arguments.species = kinds();
    rows_.arguments.kind = kind_.data();
    rows_.arguments.weighted = weighted();
    rows_.arguments.by_pairs = by_pairs();
  }

  std::vector<Pass<Real>> passes() override {
    return {
        {table_.set, table_.add, &rows_.arguments, {{body_.index, false}}, kRankTranscendental}};
  }

  void share_with(const Team& team) override { rows_.arguments.team = &team; }

  NeighbourCount count_neighbours() const override { return rows_.count(); }

  Real energy(const Stage<Real>& stage) const override {
    rows_.bring_up_to_date(stage);
    table_.energy(&rows_.arguments, stage);
    InterleavedSum<Real> total;
    for (std::size_t i = 0; i < body_.slot.count; ++i) total.add(i, rows_.arguments.energy[i]);
    return total.total();
  }

  /// By the derivative of the gradient along each coordinate of each neighbour.
  void hessian(const Stage<Real>& stage, HessianSink& sink) const override {
    if (all_coincide(stage)) return name_all(sink);
    rows_.bring_up_to_date(stage);
    Rows rows;
    for (std::size_t i = 0; i < body_.slot.count; ++i) {
      const std::span<const Entry> near = rows_.of(i);
      for (std::size_t j = 0; j < near.size(); ++j) {
        for (int b = 0; b < 3; ++b) {
          rows.fill(*this, stage, i, j, b);
          for (std::size_t k = 0; k < near.size(); ++k) {
            for (int a = 0; a < 3; ++a) {
              const auto value = static_cast<double>(rows.bonds[k].gradient[a].derivative[0]);
              if (value == 0.0) continue;
              add_block(sink, near[k].particle, a, near[j].particle, b, value);
              add_block(sink, i, a, near[j].particle, b, -value);
              add_block(sink, near[k].particle, a, i, b, -value);
              add_block(sink, i, a, i, b, value);
            }
          }
        }
      }
    }
  }

  /// In a step no particle moves by more than half of this.
  double shortest_bond() const override { return shortest_reach(); }

  std::string why_not_finite(const Stage<Real>& stage) const override {
    rows_.bring_up_to_date(stage);
    const StartingParticles body = starting(body_);
    for (std::size_t i = 0; i < body_.slot.count; ++i) {
      for (const Entry& near : rows_.of(i)) {
        const auto apart = static_cast<double>(distance(way_to(stage, i, near)));
        if (apart > 0.0) continue;
        return fmt::format("{} and {} coincide", name_of(body, i), name_of(body, near.particle));
      }
    }
    table_.energy(&rows_.arguments, stage);
    for (std::size_t i = 0; i < body_.slot.count; ++i) {
      const Real energy = rows_.arguments.energy[i];
      if (energy - energy == Real(0.0)) continue;
      return fmt::format("{} has no finite energy with its {} neighbours", name_of(body, i),
                         rows_.of(i).size());
    }
    return {};
  }

 private:
  std::size_t kinds() const { return std::max<std::size_t>(1, species_.names.size()); }
  /// Parameters of a particle of kind i, in the bond to one of kind j, with one of kind k present.
  const auto& parameters_of(std::size_t i, std::size_t j, std::size_t k) const {
    return parameters_[(i * kinds() + j) * kinds() + k];
  }

  /// Within them two particles are in a bond, or one is present at a bond of the other.
  PairCutoffs cutoffs() const {
    PairCutoffs cutoffs{kind_, kinds(), std::vector<double>(kinds() * kinds(), 0.0)};
    for (std::size_t i = 0; i < kinds(); ++i) {
      for (std::size_t j = 0; j < kinds(); ++j) {
        for (std::size_t k = 0; k < kinds(); ++k) {
          const auto reach = static_cast<double>(E::reach(parameters_of(i, j, k)));
          for (const std::size_t pair : {i * kinds() + k, k * kinds() + i}) {
            cutoffs.all[pair] = std::max(cutoffs.all[pair], reach);
          }
        }
      }
    }
    return cutoffs;
  }
  double shortest_reach() const {
    double shortest = std::numeric_limits<double>::infinity();
    for (const auto& p : parameters_) {
      shortest = std::min(shortest, static_cast<double>(E::reach(p)));
    }
    return shortest;
  }
  /// True where g and w are those of the particle, and f_C is that of the bond, whatever the third.
  bool by_pairs() const {
    for (std::size_t i = 0; i < kinds(); ++i) {
      for (std::size_t j = 0; j < kinds(); ++j) {
        for (std::size_t k = 0; k < kinds(); ++k) {
          const auto& p = parameters_of(i, j, k);
          if (!E::same_cutoff(p, parameters_of(i, k, k))) return false;
          if (!E::same_surroundings(p, parameters_of(i, i, i))) return false;
        }
      }
    }
    return true;
  }
  bool weighted() const {
    return std::any_of(parameters_.begin(), parameters_.end(),
                       [](const auto& p) { return E::weighted(p); });
  }

  /// True for the stage by which a caller asks which elements there are.
  bool all_coincide(const Stage<Real>& stage) const {
    const auto position = [&](std::size_t i) {
      return vector_at<3, Real>(body_.slot, stage.position, stage.mapped_position, i);
    };
    const Vec<Real, 3> first = position(0);
    for (std::size_t i = 1; i < body_.slot.count; ++i) {
      const Vec<Real, 3> other = position(i);
      for (int d = 0; d < 3; ++d) {
        if (!(other[d] == first[d])) return false;
      }
    }
    return body_.slot.count > 1;
  }
  /// Any two particles may become neighbours, or neighbours of a third one. There are no numbers:
  /// where all coincide, no bond has a direction.
  void name_all(HessianSink& sink) const {
    for (std::size_t i = 0; i < body_.slot.count; ++i) {
      for (std::size_t j = 0; j < body_.slot.count; ++j) {
        for (int a = 0; a < 3; ++a) {
          for (int b = 0; b < 3; ++b) {
            add_block(sink, i, a, j, b, std::numeric_limits<double>::quiet_NaN());
          }
        }
      }
    }
  }

  /// The rows of one particle with their derivatives along a coordinate of one of its neighbours.
  struct Rows {
    using T = Dual<Real, 1>;
    std::vector<BondRow<T>> bonds;
    std::vector<AngleRow<T>> angles;

    void fill(const BondOrderForce& force, const Stage<Real>& stage, std::size_t i,
              std::size_t moved, int axis) {
      const std::span<const Entry> near = force.rows_.of(i);
      bonds.resize(near.size());
      angles.resize(near.size() * near.size());
      for (std::size_t k = 0; k < near.size(); ++k) {
        const Vec<Real, 3> way = force.way_to(stage, i, near[k]);
        Vec<T, 3> wide;
        for (int d = 0; d < 3; ++d) wide[d] = T(way[d]);
        if (k == moved) wide[axis].derivative[0] = Real(1.0);
        bonds[k].distance = sqrt(norm_squared(wide));
        bonds[k].inverse_distance = T(Real(1.0)) / bonds[k].distance;
        bonds[k].direction = bonds[k].inverse_distance * wide;
      }
      const auto& kind = force.kind_;
      const auto species = static_cast<std::int64_t>(force.rows_.arguments.species);
      const auto parameters_at = [&](std::size_t j, std::size_t k) {
        const std::int64_t pair = kind[i] * species + kind[near[j].particle];
        return force.parameters_[static_cast<std::size_t>(pair * species + kind[near[k].particle])];
      };
      const ManySpecies<typename E::template Parameters<Real>, decltype(parameters_at)> p{
          parameters_at, force.rows_.arguments.weighted};
      bond_order_energy<E, T>(near.size(), bonds.data(), angles.data(), p);
    }
  };

  Vec<Real, 3> way_to(const Stage<Real>& stage, std::size_t i, const Entry& near) const {
    const auto here = vector_at<3, Real>(body_.slot, stage.position, stage.mapped_position, i);
    const auto there =
        vector_at<3, Real>(body_.slot, stage.position, stage.mapped_position, near.particle);
    Vec<Real, 3> way;
    const std::array<double, 3>& shift = rows_.shift_of(near);
    for (int d = 0; d < 3; ++d) way[d] = (there[d] - here[d]) + Real(shift[d]);
    return way;
  }

  void add_block(HessianSink& sink, std::size_t i, int a, std::size_t j, int b,
                 double value) const {
    if (i == j) {
      sink.site(body_.index, i, a, b, value);
    } else {
      sink.block(body_.index, i, a, body_.index, j, b, value);
    }
  }

  const BondOrderTable<Real>& table_;
  BoundBody<Real> body_;
  ListedSpecies species_;
  AlignedVector<std::int64_t> kind_;  ///< of each particle, and zeros in the padding
  std::vector<typename E::template Parameters<Real>> parameters_;
  mutable NeighbourRows<Real> rows_;
};

template <class E, const BondOrderTables& tables, class Real>
std::unique_ptr<BoundForce<Real>> bind_bond_order(const typename E::Description& d,
                                                  const Binding<Real>& binding) {
  return std::make_unique<BondOrderForce<E, Real>>(d, binding, tables);
}

/// The binding of a bond-order potential, in every number type.
template <class E, const BondOrderTables& tables>
ForceFactories on_bond_orders() {
  return {of_description<&bind_bond_order<E, tables, double>>,
          of_description<&bind_bond_order<E, tables, Quad>>};
}

}  // namespace tomlin
