#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "framework/core/elements/element.hpp"
#include "framework/core/elements/kernel_tables.hpp"
#include "framework/core/elements/nearest_image.hpp"
#include "framework/core/elements/pairs.hpp"
#include "framework/core/elements/site_force.hpp"
#include "framework/core/numbers/number_types.hpp"
#include "framework/core/records/bound_force.hpp"
#include "framework/core/records/parameter.hpp"

/// Bound forces on pairs, made from an evaluator.
namespace tomlin {

/// The evaluator on pairs within one body or between two. All pairs of a body and neighbours run
/// along contiguous numbers; any other list gathers. In a periodic box separations are those to the
/// nearest image at every time, unless the pairs are bonds, which keep theirs.
template <class E, class Real, int D>
class PairForce : public BoundForce<Real>, public Curvature<Real>, public Diagnosis<Real> {
 public:
  using Parameters = typename E::template Parameters<Real, D>;

  PairForce(const typename E::Description& description, const Binding<Real>& binding,
            const KernelTables& tables, BoundPairs<Real> bound, int rank)
      : parameters_(E::template parameters<Real, D>(description)),
        tables_(tables.on<Real>(binding.set)),
        body_(*binding.bodies.front()),
        other_(*binding.bodies.back()),
        box_(binding.box),
        topology_(bound.topology),
        pairs_(std::move(bound.pairs)),
        rank_(rank) {
    if (pairs_.empty()) return;
    switch (topology_) {
      case PairTopology::ring:
        build_cyclic();
        break;
      case PairTopology::chain:
        build_chain();
        break;
      case PairTopology::list:
        by_nearest_image_ = bound.images == PairImages::nearest;
        list_.lay(body_, other_, D, pairs_, by_nearest_image_ ? box_ : std::array<double, 3>{});
        list_.arguments.parameters = &parameters_;
        break;
    }
  }

  std::vector<Pass<Real>> passes() override {
    if (pairs_.empty()) return {};
    std::vector<Region> writes = {{body_.index, false}};
    switch (topology_) {
      case PairTopology::ring:
        return {{tables_.cyclic.set[D - 1], tables_.cyclic.add[D - 1], &cyclic_, writes, rank_,
                 lane_form()}};
      case PairTopology::chain:
        return {{tables_.chain.set[D - 1], tables_.chain.add[D - 1], &chain_, writes, rank_,
                 lane_form()}};
      case PairTopology::list:
        break;
    }
    if (other_.index != body_.index) writes.push_back({other_.index, false});
    return {{nullptr, tables_.pair_list.add[D - 1], &list_.arguments, writes, rank_, lane_form()}};
  }

  Real energy(const Stage<Real>& stage) const override {
    PairEnergyArguments<Real> all{body_.slot, other_.slot, &parameters_, pairs_.data(),
                                  pairs_.size()};
    for (int d = 0; d < D && by_nearest_image_; ++d) all.box[d] = Real(box_[d]);
    const EnergyKernel<Real> kernel = tables_.pair_energy[D - 1];
    return kernel ? kernel(&all, stage) : Real(0.0);
  }

  void hessian(const Stage<Real>& stage, HessianSink& sink) const override {
    for (const BoundPair<Real>& bound : pairs_) {
      const Pair<Real, D> here = pair(stage, bound);
      const bool together = pulls_nothing_together(here);
      Pair<Real, D> beside = here;
      // Coinciding particles without tension have the same slope in all directions.
      if (together) beside.separation[0] = Real(kBeside);
      const auto force = slopes(beside);
      for (int a = 0; a < D; ++a) {
        for (int b = 0; b < D; ++b) {
          const Real slope = !together ? force[a].derivative[b]
                             : a == b  ? force[0].derivative[0]
                                       : Real(0.0);
          sink.pair(body_.index, bound.i, other_.index, bound.j, a, b, static_cast<double>(slope));
        }
      }
    }
  }

  double shortest_bond() const override {
    double shortest = 0.0;
    for (const BoundPair<Real>& bound : pairs_) {
      const auto length = static_cast<double>(bound.datum);
      if (shortest == 0.0 || (length > 0.0 && length < shortest)) shortest = length;
    }
    return shortest;
  }

  std::string bond_beyond_half_box(const Stage<Real>& stage) const override {
    if (topology_ != PairTopology::list || by_nearest_image_) return {};
    static constexpr char kAxes[] = {'x', 'y', 'z'};
    for (const BoundPair<Real>& bound : pairs_) {
      const Pair<Real, D> here = pair(stage, bound);
      for (int d = 0; d < D; ++d) {
        const double apart = std::abs(static_cast<double>(here.separation[d]));
        if (!(box_[d] > 0.0 && apart >= 0.5 * box_[d])) continue;
        return fmt::format("{} are {:.4g} apart along {}, half the box or more", name_of(bound),
                           apart, kAxes[d]);
      }
    }
    return {};
  }

  std::string why_not_finite(const Stage<Real>& stage) const override {
    for (const BoundPair<Real>& bound : pairs_) {
      const Pair<Real, D> here = pair(stage, bound);
      if (is_finite(force_on<E, Real, D>(parameters_, here)) || !are_together(here)) continue;
      return name_of(bound) + " coincide, and the force between them has no direction";
    }
    return {};
  }

 private:
  /// So short a way that nothing changes along it, and no number but its square.
  static constexpr double kBeside = sizeof(Real) < sizeof(double) ? 1e-18 : 1e-150;

  /// Hash of the pairs in the list and of their order (FNV-1a of 64 bits): the list itself may be
  /// as large as all else.
  std::int64_t hash_of_pairs() const {
    std::uint64_t hash = 0xcbf29ce484222325;
    for (const BoundPair<Real>& pair : pairs_) {
      for (const std::size_t index : {pair.i, pair.j}) hash = (hash ^ index) * 0x100000001b3;
    }
    return static_cast<std::int64_t>(hash);
  }

  LaneForm lane_form() const {
    LaneForm form;
    if constexpr (std::is_same_v<Real, double>) {
      const std::span<const double> parameters = numbers_in(parameters_);
      form.structure = structure_of(body_.slot, static_cast<std::ptrdiff_t>(pairs_.size()));
      const std::vector<std::int64_t> second = structure_of(other_.slot, by_nearest_image_ ? 1 : 0);
      form.structure.insert(form.structure.end(), second.begin(), second.end());
      form.structure.push_back(static_cast<std::int64_t>(topology_));
      switch (topology_) {
        case PairTopology::ring:
          form.kernel = tables_.lanes.cyclic[D - 1];
          form.numbers = {parameters, datum_};
          form.scratch = (cyclic_.rows + 1) * D * body_.slot.count;
          break;
        case PairTopology::chain:
          form.kernel = tables_.lanes.chain[D - 1];
          form.numbers = {parameters, chain_.wrap, datum_};
          break;
        case PairTopology::list:
          form.kernel = tables_.lanes.pair_list[D - 1];
          form.numbers = {parameters, list_.arguments.box, list_.data()};
          if (list_.arguments.image) form.numbers.push_back(list_.images());
          for (const double length : list_.arguments.box) form.structure.push_back(length > 0.0);
          form.structure.push_back(list_.arguments.image != nullptr);
          form.structure.push_back(hash_of_pairs());
          form.scratch = D * pairs_.size();
          break;
      }
    }
    return form;
  }

  static bool are_together(const Pair<Real, D>& pair) {
    for (int d = 0; d < D; ++d) {
      if (pair.separation[d] != Real(0.0)) return false;
    }
    return true;
  }

  /// On a line particles pass through each other: a pair has a direction on either side.
  bool pulls_nothing_together(const Pair<Real, D>& pair) const {
    if (D == 1 || !are_together(pair)) return false;
    const Vec<Real, D> force = force_on<E, Real, D>(parameters_, pair);
    for (int d = 0; d < D; ++d) {
      if (force[d] != Real(0.0)) return false;  // no number is not equal to any
    }
    return true;
  }

  Vec<Dual<Real, D>, D> slopes(const Pair<Real, D>& pair) const {
    using T = Dual<Real, D>;
    return force_on<E, T, D>(in_type<E, T, Real, D>(parameters_), differentiable(pair));
  }

  std::string name_of(const BoundPair<Real>& bound) const {
    return name_of_pair(body_, bound.i, other_, bound.j);
  }

  Pair<Real, D> pair(const Stage<Real>& stage, const BoundPair<Real>& bound) const {
    const auto from =
        vector_at<D, Real>(body_.slot, stage.position, stage.mapped_position, bound.i);
    const auto to = vector_at<D, Real>(other_.slot, stage.position, stage.mapped_position, bound.j);
    Pair<Real, D> pair;
    for (int d = 0; d < D; ++d) {
      const Real apart = to[d] - from[d];
      const bool nearest = by_nearest_image_ && box_[d] > 0.0;
      pair.separation[d] =
          nearest ? nearest_image(apart, Real(box_[d])) : apart + Real(bound.image[d]);
    }
    pair.datum = bound.datum;
    return pair;
  }

  void build_cyclic() {
    const std::size_t count = body_.slot.count;
    cyclic_.body = body_.slot;
    cyclic_.parameters = &parameters_;
    cyclic_.rows = count / 2;
    cyclic_.half_row_last = count % 2 == 0;
    cyclic_.row_stride = padded(count);
    datum_.assign(cyclic_.rows * cyclic_.row_stride, Real(0.0));
    for (const BoundPair<Real>& bound : pairs_) {
      // Row `shift - 1` holds the pair (i, i + shift); with half a turn it stands there twice.
      const std::size_t ahead = (bound.j + count - bound.i) % count;
      const std::size_t behind = count - ahead;
      if (ahead <= cyclic_.rows) {
        datum_[(ahead - 1) * cyclic_.row_stride + bound.i] = bound.datum;
      }
      if (behind <= cyclic_.rows) {
        datum_[(behind - 1) * cyclic_.row_stride + bound.j] = bound.datum;
      }
    }
    cyclic_.datum = datum_.data();
    if (count <= kGroup) {
      for (std::size_t row = 0; row < cyclic_.rows; ++row) {
        for (std::size_t i = 0; i < kGroup; ++i) {
          const std::size_t here = std::min(i, count - 1);
          forward_.push_back(static_cast<std::int64_t>((here + row + 1) % count));
          backward_.push_back(static_cast<std::int64_t>((here + count - row - 1) % count));
        }
      }
      cyclic_.forward = forward_.data();
      cyclic_.backward = backward_.data();
      return;
    }
    // Kernels read and write up to a group past each copy; strides keep off powers of two.
    cyclic_.extended_stride = padded(2 * count) + 3 * kGroup;
    extended_.assign(D * cyclic_.extended_stride, Real(0.0));
    cyclic_.extended = extended_.data();
    cyclic_.result_stride = padded(2 * count) + 5 * kGroup;
    result_.assign(cyclic_.rows * D * cyclic_.result_stride, Real(0.0));
    cyclic_.result = result_.data();
  }

  void build_chain() {
    chain_.body = body_.slot;
    chain_.parameters = &parameters_;
    chain_.closed = pairs_.size() == body_.slot.count;
    if (chain_.closed) {
      for (int d = 0; d < D; ++d) chain_.wrap[d] = Real(pairs_.back().image[d]);
    }
    datum_.assign(padded(body_.slot.count), Real(0.0));
    for (const BoundPair<Real>& bound : pairs_) datum_[bound.i] = bound.datum;
    chain_.datum = datum_.data();
  }

  Parameters parameters_;
  const ElementTable<Real>& tables_;
  BoundBody<Real> body_;
  BoundBody<Real> other_;
  std::array<double, 3> box_;
  PairTopology topology_;
  bool by_nearest_image_ = false;
  std::vector<BoundPair<Real>> pairs_;
  int rank_;

  CyclicArguments<Real> cyclic_;
  ChainArguments<Real> chain_;
  PairList<Real> list_;
  AlignedVector<Real> datum_;
  AlignedVector<std::int64_t> forward_;
  AlignedVector<std::int64_t> backward_;
  AlignedVector<Real> extended_;
  AlignedVector<Real> result_;
};

}  // namespace tomlin
