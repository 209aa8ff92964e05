#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

#include "framework/core/bound_force.hpp"
#include "framework/core/element.hpp"
#include "framework/core/kernel_tables.hpp"
#include "framework/core/number_types.hpp"
#include "framework/core/parameter.hpp"
#include "framework/core/site_force.hpp"
#include "framework/core/sum.hpp"

/// Bound forces on pairs, made from an evaluator.
namespace tomlin {

/// One pair, with the number of its own that the evaluator reads (a rest length, say).
template <class Real>
struct BoundPair {
  std::size_t i = 0;              ///< of the first body
  std::size_t j = 0;              ///< of the second, or of the same
  std::array<double, 3> image{};  ///< through a periodic box: added to the way from i to j
  Real datum{};
};

/// What the pairs of a force look like to the loops.
enum class PairTopology {
  ring,   ///< all pairs of a body
  chain,  ///< neighbours, open or closed
  list,   ///< anything else
};

template <class Real>
struct BoundPairs {
  PairTopology topology = PairTopology::list;
  std::vector<BoundPair<Real>> pairs;  ///< "all" row by row, "neighbours" in order
};

/// The pairs that a selection means on the bodies of a binding, each once. In a periodic box a pair
/// is that of the nearest images at the start, and stays with them; the pair that closes a chain
/// goes forwards.
template <class Real>
BoundPairs<Real> pairs_of(const PairSelection& selection, const Binding<Real>& binding) {
  const BoundBody<Real>& one = *binding.bodies.front();
  const BoundBody<Real>& other = *binding.bodies.back();
  const std::size_t count = one.slot.count;
  BoundPairs<Real> found;
  const auto add = [&](std::size_t i, std::size_t j) {
    BoundPair<Real> pair;
    pair.i = i;
    pair.j = j;
    for (int d = 0; d < binding.dimension; ++d) {
      const double length = binding.box[d];
      if (!(length > 0.0)) continue;
      const double apart = other.start[j][d] - one.start[i][d];
      pair.image[d] = -length * __builtin_ceil(apart / length - 0.5);
    }
    found.pairs.push_back(pair);
  };
  switch (selection.kind) {
    case PairSelection::Kind::all:
      if (binding.bodies.size() > 1) {
        for (std::size_t i = 0; i < count; ++i) {
          for (std::size_t j = 0; j < other.slot.count; ++j) add(i, j);
        }
        break;
      }
      found.topology = PairTopology::ring;
      for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = i + 1; j < count; ++j) add(i, j);
      }
      break;
    case PairSelection::Kind::neighbours: {
      found.topology = PairTopology::chain;
      for (std::size_t i = 0; i + 1 < count; ++i) add(i, i + 1);
      const bool through_box = one.open_along >= 0 && binding.box[one.open_along] > 0.0;
      if ((one.closed && count > 2) || (through_box && count > 1)) add(count - 1, 0);
      // Neighbours are bonded as they stand; only a chain's last bond passes through the box's
      // side.
      for (BoundPair<Real>& pair : found.pairs) pair.image = {};
      if (through_box && count > 1) {
        BoundPair<Real>& closing = found.pairs.back();
        const double way = one.start[count - 1][one.open_along] - one.start[0][one.open_along];
        closing.image[one.open_along] =
            way < 0.0 ? -binding.box[one.open_along] : binding.box[one.open_along];
      }
      break;
    }
    case PairSelection::Kind::list:
      for (const auto& [i, j] : selection.list) {
        add(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
      }
      break;
  }
  const auto is_imaged = [](const BoundPair<Real>& pair) {
    return pair.image != std::array<double, 3>{};
  };
  if (found.topology == PairTopology::ring &&
      std::any_of(found.pairs.begin(), found.pairs.end(), is_imaged)) {
    found.topology = PairTopology::list;
  }
  return found;
}

/// The way from a pair's first particle to its second's image at the start.
template <class Real, int D>
Vec<Real, D> separation_at_start(const Binding<Real>& binding, const BoundPair<Real>& pair) {
  Vec<Real, D> separation;
  for (int d = 0; d < D; ++d) {
    separation[d] = Real(binding.bodies.back()->start[pair.j][d]) -
                    Real(binding.bodies.front()->start[pair.i][d]) + Real(pair.image[d]);
  }
  return separation;
}

/// The evaluator on pairs within one body or between two. All pairs of a body and neighbours run
/// along contiguous numbers; any other list gathers.
template <class E, class Real, int D>
class PairForce : public BoundForce<Real> {
 public:
  using Parameters = typename E::template Parameters<Real, D>;

  PairForce(const typename E::Description& description, const Binding<Real>& binding,
            const KernelTables& tables, BoundPairs<Real> bound, int rank)
      : parameters_(E::template parameters<Real, D>(description)),
        tables_(tables.on<Real>(binding.set)),
        body_(*binding.bodies.front()),
        other_(*binding.bodies.back()),
        topology_(bound.topology),
        pairs_(std::move(bound.pairs)),
        rank_(rank) {
    if (pairs_.empty()) return;
    switch (topology_) {
      case PairTopology::ring:
        lay_cyclic();
        break;
      case PairTopology::chain:
        lay_chain();
        break;
      case PairTopology::list:
        lay_list();
        break;
    }
  }

  std::vector<Pass<Real>> passes() override {
    if (pairs_.empty()) return {};
    std::vector<Region> writes = {{body_.index, false}};
    switch (topology_) {
      case PairTopology::ring:
        return {{tables_.cyclic.set[D - 1], tables_.cyclic.add[D - 1], &cyclic_, writes, rank_}};
      case PairTopology::chain:
        return {{tables_.chain.set[D - 1], tables_.chain.add[D - 1], &chain_, writes, rank_}};
      case PairTopology::list:
        break;
    }
    if (other_.index != body_.index) writes.push_back({other_.index, false});
    return {{nullptr, tables_.pair_list.add[D - 1], &list_, writes, rank_}};
  }

  Real energy(const Stage<Real>& stage) const override {
    InterleavedSum<Real> total;
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      total.add(k, E::energy(parameters_, pair(stage, pairs_[k])));
    }
    return total.total();
  }

  void hessian(const Stage<Real>& stage, HessianSink& sink) const override {
    using T = Dual<Real, D>;
    for (const BoundPair<Real>& bound : pairs_) {
      const auto force = force_on<E, T, D>(in_type<E, T, Real, D>(parameters_),
                                           differentiable(pair(stage, bound)));
      for (int a = 0; a < D; ++a) {
        for (int b = 0; b < D; ++b) {
          sink.pair(body_.index, bound.i, other_.index, bound.j, a, b,
                    static_cast<double>(force[a].derivative[b]));
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

 private:
  Pair<Real, D> pair(const Stage<Real>& stage, const BoundPair<Real>& bound) const {
    const auto from =
        vector_at<D, Real>(body_.slot, stage.position, stage.mapped_position, bound.i);
    const auto to = vector_at<D, Real>(other_.slot, stage.position, stage.mapped_position, bound.j);
    Pair<Real, D> pair;
    for (int d = 0; d < D; ++d) pair.separation[d] = to[d] - from[d] + Real(bound.image[d]);
    pair.datum = bound.datum;
    return pair;
  }

  void lay_cyclic() {
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

  void lay_chain() {
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

  void lay_list() {
    const std::size_t length = padded(pairs_.size());
    const bool same = other_.index == body_.index;
    list_.first = body_.slot;
    list_.second = other_.slot;
    list_.same_body = same;
    list_.parameters = &parameters_;
    list_.pairs = pairs_.size();
    image_.assign(D * length, Real(0.0));
    bool imaged = false;
    for (std::size_t k = 0; k < length; ++k) {
      const BoundPair<Real>& bound = pairs_[std::min(k, pairs_.size() - 1)];
      index_i_.push_back(bound.i);
      index_j_.push_back(bound.j);
      datum_.push_back(bound.datum);
      for (int d = 0; d < D; ++d) {
        image_[d * length + k] = Real(bound.image[d]);
        imaged = imaged || bound.image[d] != 0.0;
      }
    }
    // Row order: each particle meets the others in ascending order.
    std::vector<std::vector<std::pair<std::size_t, std::ptrdiff_t>>> rows(body_.slot.count);
    std::vector<std::vector<std::pair<std::size_t, std::ptrdiff_t>>> others(
        same ? 0 : other_.slot.count);
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      const auto mark = static_cast<std::ptrdiff_t>(k + 1);
      rows[pairs_[k].i].emplace_back(pairs_[k].j, mark);
      (same ? rows : others)[pairs_[k].j].emplace_back(pairs_[k].i, -mark);
    }
    row_start_.push_back(0);
    for (auto* side : {&rows, &others}) {
      for (auto& row : *side) {
        std::sort(row.begin(), row.end());
        for (const auto& [other, mark] : row) row_.push_back(mark);
        row_start_.push_back(row_.size());
      }
    }
    result_.assign(D * length, Real(0.0));
    list_.i = index_i_.data();
    list_.j = index_j_.data();
    list_.datum = datum_.data();
    if (imaged) list_.image = image_.data();
    list_.result = result_.data();
    list_.particles_first = rows.size();
    list_.particles_second = others.size();
    list_.row_start = row_start_.data();
    list_.row = row_.data();
  }

  Parameters parameters_;
  const KernelTable<Real>& tables_;
  BoundBody<Real> body_;
  BoundBody<Real> other_;
  PairTopology topology_;
  std::vector<BoundPair<Real>> pairs_;
  int rank_;

  CyclicArguments<Real> cyclic_;
  ChainArguments<Real> chain_;
  PairListArguments<Real> list_;
  AlignedVector<Real> datum_;
  AlignedVector<Real> image_;
  AlignedVector<std::int64_t> forward_;
  AlignedVector<std::int64_t> backward_;
  AlignedVector<Real> extended_;
  AlignedVector<Real> result_;
  std::vector<std::size_t> index_i_;
  std::vector<std::size_t> index_j_;
  std::vector<std::size_t> row_start_;
  std::vector<std::ptrdiff_t> row_;
};

}  // namespace tomlin
