#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "framework/core/elements/energy_kernels.hpp"
#include "framework/core/numbers/vec.hpp"
#include "framework/core/records/bound_force.hpp"
#include "framework/core/records/neighbours.hpp"
#include "framework/core/records/parameter.hpp"
#include "framework/core/system/aligned.hpp"

/// The pairs of particles that a force acts on, and how a list of them is laid out for its kernel.
namespace tomlin {

/// Structure of a force's pairs, as the loops see it.
enum class PairTopology {
  ring,   ///< all pairs of a body
  chain,  ///< neighbours, open or closed
  list,   ///< anything else
};

/// Through the sides of a periodic box a pair is of one particle and an image of the other.
enum class PairImages {
  nearest,  ///< the nearest at every time: a potential. Neighbours along a chain keep theirs
  kept,     ///< the nearest at the start, for ever: a bond
};

template <class Real>
struct BoundPairs {
  PairTopology topology = PairTopology::list;
  PairImages images = PairImages::nearest;
  std::vector<BoundPair<Real>> pairs;  ///< "all" row by row, "neighbours" in order
};

/// The pairs that a selection means on the bodies of a binding, each once, and the images that they
/// have at the start: the nearest. Neighbours are as they stand: consecutive particles, where the
/// pair that closes a chain goes forwards through the box's side, or those that the body lists.
template <class Real>
BoundPairs<Real> pairs_of(const PairSelection& selection, const Binding<Real>& binding,
                          PairImages images = PairImages::nearest) {
  const BoundBody<Real>& one = *binding.bodies.front();
  const BoundBody<Real>& other = *binding.bodies.back();
  const std::size_t count = one.slot.count;
  BoundPairs<Real> found;
  found.images = images;
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
      if (one.neighbours) {
        for (const auto& [i, j] : one.neighbours()) {
          add(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
        }
        break;
      }
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
  const bool boxed = binding.box != std::array<double, 3>{};
  const bool by_image = images == PairImages::nearest
                            ? boxed
                            : std::any_of(found.pairs.begin(), found.pairs.end(), is_imaged);
  if (found.topology == PairTopology::ring && by_image) found.topology = PairTopology::list;
  return found;
}

/// Three particles, the vertex of their angle in the middle.
using IndexTriple = std::array<std::size_t, 3>;

/// The angles between any two bonds of a particle, which those of `count` particles are.
inline std::vector<IndexTriple> angles_between(const std::vector<IndexPair>& bonds,
                                               std::size_t count) {
  std::vector<std::vector<std::size_t>> bonded(count);
  for (const auto& [i, j] : bonds) {
    bonded[static_cast<std::size_t>(i)].push_back(static_cast<std::size_t>(j));
    bonded[static_cast<std::size_t>(j)].push_back(static_cast<std::size_t>(i));
  }
  std::vector<IndexTriple> angles;
  for (std::size_t vertex = 0; vertex < count; ++vertex) {
    const std::vector<std::size_t>& ends = bonded[vertex];
    for (std::size_t first = 0; first < ends.size(); ++first) {
      for (std::size_t last = first + 1; last < ends.size(); ++last) {
        angles.push_back({ends[first], vertex, ends[last]});
      }
    }
  }
  return angles;
}

/// For messages: `particles 0 and 1 of "chain"`.
template <class Real>
std::string name_of_pair(const BoundBody<Real>& one, std::size_t i, const BoundBody<Real>& other,
                         std::size_t j) {
  if (one.index == other.index) {
    return fmt::format("particles {} and {} of \"{}\"", i, j, one.name);
  }
  return fmt::format("particle {} of \"{}\" and particle {} of \"{}\"", i, one.name, j, other.name);
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

/// Any list of pairs, within one body or between two, as its kernel wants it.
template <class Real>
struct PairList {
  PairListArguments<Real> arguments;

  std::span<const Real> data() const { return datum_; }
  std::span<const Real> images() const { return image_; }

  /// `box`: along its axes separations are to the nearest image, in place of the pairs' own.
  void lay(const BoundBody<Real>& one, const BoundBody<Real>& other, int dimension,
           const std::vector<BoundPair<Real>>& pairs, const std::array<double, 3>& box) {
    const std::size_t length = padded(pairs.size());
    const bool same = other.index == one.index;
    image_.assign(static_cast<std::size_t>(dimension) * length, Real(0.0));
    bool imaged = false;
    for (std::size_t k = 0; k < length; ++k) {
      const BoundPair<Real>& bound = pairs[std::min(k, pairs.size() - 1)];
      index_i_.push_back(bound.i);
      index_j_.push_back(bound.j);
      datum_.push_back(bound.datum);
      for (int d = 0; d < dimension; ++d) {
        if (box[d] > 0.0) continue;
        image_[static_cast<std::size_t>(d) * length + k] = Real(bound.image[d]);
        imaged = imaged || bound.image[d] != 0.0;
      }
    }
    assign_rows(one.slot.count, same ? 0 : other.slot.count, pairs);
    result_.assign(static_cast<std::size_t>(dimension) * length, Real(0.0));
    arguments.first = one.slot;
    arguments.second = other.slot;
    arguments.same_body = same;
    arguments.pairs = pairs.size();
    arguments.i = index_i_.data();
    arguments.j = index_j_.data();
    arguments.datum = datum_.data();
    if (imaged) arguments.image = image_.data();
    for (std::size_t d = 0; d < 3; ++d) arguments.box[d] = Real(box[d]);
    arguments.result = result_.data();
  }

 private:
  /// Row order: each particle meets the others in ascending order.
  void assign_rows(std::size_t first, std::size_t second,
                   const std::vector<BoundPair<Real>>& pairs) {
    using Row = std::vector<std::pair<std::size_t, std::ptrdiff_t>>;
    std::vector<Row> rows(first);
    std::vector<Row> others(second);
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const auto mark = static_cast<std::ptrdiff_t>(k + 1);
      rows[pairs[k].i].emplace_back(pairs[k].j, mark);
      (second == 0 ? rows : others)[pairs[k].j].emplace_back(pairs[k].i, -mark);
    }
    row_start_.push_back(0);
    for (auto* side : {&rows, &others}) {
      for (Row& row : *side) {
        std::sort(row.begin(), row.end());
        for (const auto& [other, mark] : row) row_.push_back(mark);
        row_start_.push_back(row_.size());
      }
    }
    arguments.particles_first = first;
    arguments.particles_second = second;
    arguments.row_start = row_start_.data();
    arguments.row = row_.data();
  }

  AlignedVector<Real> datum_;
  AlignedVector<Real> image_;
  AlignedVector<Real> result_;
  std::vector<std::size_t> index_i_;
  std::vector<std::size_t> index_j_;
  std::vector<std::size_t> row_start_;
  std::vector<std::ptrdiff_t> row_;
};

}  // namespace tomlin
