#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "framework/core/bound_force.hpp"
#include "framework/core/element.hpp"
#include "framework/core/kernel_tables.hpp"
#include "framework/core/parameter.hpp"
#include "framework/core/site_force.hpp"
#include "framework/core/sum.hpp"

/// Bound forces on pairs, made from an evaluator.
namespace tomlin {

/// One pair, with the number of its own that the evaluator reads (a rest length, say).
struct BoundPair {
  std::size_t i = 0;
  std::size_t j = 0;
  double datum = 0.0;
};

/// The pairs that a selection means, each once: "all" row by row, "neighbours" in order.
inline std::vector<BoundPair> pairs_of(const PairSelection& selection, std::size_t count,
                                       bool closed) {
  std::vector<BoundPair> pairs;
  switch (selection.kind) {
    case PairSelection::Kind::all:
      for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = i + 1; j < count; ++j) pairs.push_back({i, j});
      }
      break;
    case PairSelection::Kind::neighbours:
      for (std::size_t i = 0; i + 1 < count; ++i) pairs.push_back({i, i + 1});
      if (closed && count > 2) pairs.push_back({count - 1, 0});
      break;
    case PairSelection::Kind::list:
      for (const auto& [i, j] : selection.list) {
        pairs.push_back({static_cast<std::size_t>(i), static_cast<std::size_t>(j)});
      }
      break;
  }
  return pairs;
}

/// The evaluator on pairs within one body. "all" and "neighbours" run along contiguous numbers; any
/// other list gathers.
template <class E, int D>
class PairForce : public BoundForce<double> {
 public:
  using Parameters = typename E::template Parameters<double, D>;

  PairForce(const typename E::Description& description, const Binding<double>& binding,
            const KernelTables& tables, const PairSelection& selection,
            std::vector<BoundPair> pairs, int rank)
      : parameters_(E::template parameters<double, D>(description)),
        tables_(tables.on(binding.set)),
        body_(*binding.bodies.front()),
        pairs_(std::move(pairs)),
        rank_(rank) {
    const bool all = selection.kind == PairSelection::Kind::all;
    if (selection.kind == PairSelection::Kind::list) {
      topology_ = Topology::list;
    } else if (all || (body_.closed && body_.slot.count > 2)) {
      topology_ = Topology::cyclic;
    } else {
      topology_ = Topology::chain;
    }
    if (pairs_.empty()) return;
    switch (topology_) {
      case Topology::cyclic:
        lay_cyclic(all);
        break;
      case Topology::chain:
        lay_chain();
        break;
      case Topology::list:
        lay_list();
        break;
    }
  }

  std::vector<Pass<double>> passes() override {
    if (pairs_.empty()) return {};
    const std::vector<Region> writes = {{body_.index, false}};
    switch (topology_) {
      case Topology::cyclic:
        return {{tables_.cyclic.set[D - 1], tables_.cyclic.add[D - 1], &cyclic_, writes, rank_}};
      case Topology::chain:
        return {{tables_.chain.set[D - 1], tables_.chain.add[D - 1], &chain_, writes, rank_}};
      case Topology::list:
        break;
    }
    return {{nullptr, tables_.pair_list.add[D - 1], &list_, writes, rank_}};
  }

  double energy(const Stage<double>& stage) const override {
    InterleavedSum<double> total;
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      total.add(k, E::energy(parameters_, pair(stage, pairs_[k])));
    }
    return total.total();
  }

  void hessian(const Stage<double>& stage, HessianSink& sink) const override {
    using T = Dual<double, D>;
    for (const BoundPair& bound : pairs_) {
      const auto force = force_on<E, T, D>(in_type<E, T, double, D>(parameters_),
                                           differentiable(pair(stage, bound)));
      for (int a = 0; a < D; ++a) {
        for (int b = 0; b < D; ++b) {
          sink.pair(body_.index, bound.i, body_.index, bound.j, a, b, force[a].derivative[b]);
        }
      }
    }
  }

  double shortest_bond() const override {
    double shortest = 0.0;
    for (const BoundPair& bound : pairs_) {
      if (shortest == 0.0 || (bound.datum > 0.0 && bound.datum < shortest)) shortest = bound.datum;
    }
    return shortest;
  }

 private:
  Pair<double, D> pair(const Stage<double>& stage, const BoundPair& bound) const {
    const auto from = vector_at<D>(body_.slot, stage.position, stage.mapped_position, bound.i);
    const auto to = vector_at<D>(body_.slot, stage.position, stage.mapped_position, bound.j);
    Pair<double, D> pair;
    for (int d = 0; d < D; ++d) pair.separation[d] = to[d] - from[d];
    pair.datum = bound.datum;
    return pair;
  }

  void lay_cyclic(bool all) {
    const std::size_t count = body_.slot.count;
    cyclic_.body = body_.slot;
    cyclic_.parameters = &parameters_;
    cyclic_.rows = all ? count / 2 : 1;
    cyclic_.half_row_last = all && count % 2 == 0;
    cyclic_.row_stride = padded(count);
    datum_.assign(cyclic_.rows * cyclic_.row_stride, 0.0);
    for (const BoundPair& bound : pairs_) {
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
    extended_.assign(D * cyclic_.extended_stride, 0.0);
    cyclic_.extended = extended_.data();
    cyclic_.result_stride = padded(2 * count) + 5 * kGroup;
    result_.assign(cyclic_.rows * D * cyclic_.result_stride, 0.0);
    cyclic_.result = result_.data();
  }

  void lay_chain() {
    chain_.body = body_.slot;
    chain_.parameters = &parameters_;
    datum_.assign(padded(body_.slot.count), 0.0);
    for (const BoundPair& bound : pairs_) datum_[bound.i] = bound.datum;
    chain_.datum = datum_.data();
  }

  void lay_list() {
    const std::size_t count = body_.slot.count;
    const std::size_t length = padded(pairs_.size());
    list_.first = list_.second = body_.slot;
    list_.parameters = &parameters_;
    list_.pairs = pairs_.size();
    for (std::size_t k = 0; k < length; ++k) {
      const BoundPair& bound = pairs_[std::min(k, pairs_.size() - 1)];
      index_i_.push_back(bound.i);
      index_j_.push_back(bound.j);
      datum_.push_back(bound.datum);
    }
    // Row order: each particle meets the others in ascending order.
    std::vector<std::vector<std::pair<std::size_t, std::ptrdiff_t>>> rows(count);
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      const auto mark = static_cast<std::ptrdiff_t>(k + 1);
      rows[pairs_[k].i].emplace_back(pairs_[k].j, mark);
      rows[pairs_[k].j].emplace_back(pairs_[k].i, -mark);
    }
    row_start_.push_back(0);
    for (auto& row : rows) {
      std::sort(row.begin(), row.end());
      for (const auto& [other, mark] : row) row_.push_back(mark);
      row_start_.push_back(row_.size());
    }
    result_.assign(D * length, 0.0);
    list_.i = index_i_.data();
    list_.j = index_j_.data();
    list_.datum = datum_.data();
    list_.result = result_.data();
    list_.particles_first = count;
    list_.row_start = row_start_.data();
    list_.row = row_.data();
  }

  Parameters parameters_;
  const KernelTable<double>& tables_;
  BoundBody<double> body_;
  std::vector<BoundPair> pairs_;
  int rank_;
  enum class Topology { cyclic, chain, list } topology_ = Topology::cyclic;

  CyclicArguments<double> cyclic_;
  ChainArguments<double> chain_;
  PairListArguments<double> list_;
  AlignedVector<double> datum_;
  AlignedVector<std::int64_t> forward_;
  AlignedVector<std::int64_t> backward_;
  AlignedVector<double> extended_;
  AlignedVector<double> result_;
  std::vector<std::size_t> index_i_;
  std::vector<std::size_t> index_j_;
  std::vector<std::size_t> row_start_;
  std::vector<std::ptrdiff_t> row_;
};

}  // namespace tomlin
