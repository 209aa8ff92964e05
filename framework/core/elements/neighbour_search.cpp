#include "framework/core/elements/neighbour_search.hpp"

#include <algorithm>
#include <cmath>

namespace tomlin {
namespace {

/// Bits of a cell's number along one axis; three of them make a key.
constexpr int kBits = 21;
/// The middle cell of an axis without a period; cells further out than so many share the last one.
constexpr std::int64_t kMiddle = std::int64_t{1} << (kBits - 1);

}  // namespace

NeighbourSearch::NeighbourSearch(int dimension, double reach, const std::array<double, 3>& box)
    : dimension_(dimension), reach_(reach), box_(box) {
  for (int d = 0; d < dimension; ++d) {
    length_[d] = reach;
    if (!(box[d] > 0.0)) continue;
    const double cells = std::clamp(box[d] / reach, 1.0, static_cast<double>(kMiddle));
    cells_[d] = static_cast<std::int64_t>(cells);
    length_[d] = box[d] / static_cast<double>(cells_[d]);
  }
}

std::int64_t NeighbourSearch::cell_along(int axis, double x) const {
  if (cells_[axis] == 0) {
    const double cell = std::floor(x / length_[axis]);
    constexpr auto kMost = static_cast<double>(kMiddle - 2);
    return kMiddle + static_cast<std::int64_t>(std::clamp(cell, -kMost, kMost));
  }
  const double within = x - box_[axis] * std::floor(x / box_[axis]);
  const auto cell = static_cast<std::int64_t>(within / length_[axis]);
  return std::clamp<std::int64_t>(cell, 0, cells_[axis] - 1);
}

int NeighbourSearch::ranges_around(int axis, double x, std::array<Range, 2>& ranges) const {
  const std::int64_t cell = cell_along(axis, x);
  const std::int64_t cells = cells_[axis];
  if (cells == 0) {
    ranges[0] = {cell - 1, cell + 1};
    return 1;
  }
  if (cells <= 3) {
    ranges[0] = {0, cells - 1};
    return 1;
  }
  if (cell == 0 || cell == cells - 1) {
    ranges[0] = {0, cell == 0 ? 1 : 0};
    ranges[1] = {cell == 0 ? cells - 1 : cells - 2, cells - 1};
    return 2;
  }
  ranges[0] = {cell - 1, cell + 1};
  return 1;
}

void NeighbourSearch::sort(const std::vector<double>& positions, std::size_t count) {
  entries_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    Entry entry;
    entry.particle = static_cast<std::uint32_t>(i);
    bool finite = true;
    for (int d = dimension_ - 1; d >= 0; --d) {
      const double x = positions[static_cast<std::size_t>(d) * count + i];
      finite = finite && std::isfinite(x);
      if (!finite) break;
      entry.cell = (entry.cell << kBits) | static_cast<std::uint64_t>(cell_along(d, x));
    }
    if (finite) entries_.push_back(entry);
  }
  std::sort(entries_.begin(), entries_.end());
  positions_.resize(entries_.size());
  for (std::size_t k = 0; k < entries_.size(); ++k) {
    for (int d = 0; d < dimension_; ++d) {
      positions_[k][d] = positions[static_cast<std::size_t>(d) * count + entries_[k].particle];
    }
  }
}

void NeighbourSearch::find(const std::array<double, 3>& position,
                           std::vector<Neighbour>& found) const {
  found.clear();
  std::array<std::array<Range, 2>, 3> ranges{};
  std::array<int, 3> count = {1, 1, 1};
  for (int d = 0; d < dimension_; ++d) {
    if (!std::isfinite(position[d])) return;
    count[d] = ranges_around(d, position[d], ranges[d]);
  }
  const double reach_squared = reach_ * reach_;
  const auto look_through = [&](std::uint64_t first, std::uint64_t last) {
    auto k = static_cast<std::size_t>(
        std::lower_bound(entries_.begin(), entries_.end(), first,
                         [](const Entry& e, std::uint64_t cell) { return e.cell < cell; }) -
        entries_.begin());
    for (; k < entries_.size() && entries_[k].cell <= last; ++k) {
      Neighbour near;
      double squared = 0.0;
      for (int d = 0; d < dimension_; ++d) {
        double apart = positions_[k][d] - position[d];
        // Within the reach, at most half of a box, it is the nearest image already.
        if (cells_[d] > 0 && !(std::abs(apart) < reach_)) {
          near.shift[d] = -box_[d] * std::floor(apart / box_[d] + 0.5);
          apart += near.shift[d];
        }
        squared += apart * apart;
      }
      if (!(squared <= reach_squared)) continue;
      near.particle = entries_[k].particle;
      found.push_back(near);
    }
  };
  const auto for_cells = [&](int axis, auto&& use) {
    for (int r = 0; r < count[axis]; ++r) {
      for (std::int64_t c = ranges[axis][r].first; c <= ranges[axis][r].last; ++c) {
        use(static_cast<std::uint64_t>(c));
      }
    }
  };
  for_cells(2, [&](std::uint64_t z) {
    for_cells(1, [&](std::uint64_t y) {
      const std::uint64_t row = ((z << kBits) | y) << kBits;
      for (int r = 0; r < count[0]; ++r) {
        look_through(row | static_cast<std::uint64_t>(ranges[0][r].first),
                     row | static_cast<std::uint64_t>(ranges[0][r].last));
      }
    });
  });
  std::sort(found.begin(), found.end(),
            [](const Neighbour& a, const Neighbour& b) { return a.particle < b.particle; });
}

}  // namespace tomlin
