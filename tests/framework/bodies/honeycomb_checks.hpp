#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "framework/core/records/neighbours.hpp"

/// Checks of every honeycomb, on a sheet or rolled up: distances computed from positions alone.
namespace tomlin::test {

using ParticlePositions = std::vector<std::vector<double>>;

/// From one particle to the nearest image of another, along axes with a length in the box.
inline std::vector<double> to_nearest_image(const std::vector<double>& from,
                                            const std::vector<double>& to,
                                            const std::vector<double>& box) {
  std::vector<double> apart(from.size());
  for (std::size_t d = 0; d < apart.size(); ++d) {
    apart[d] = to[d] - from[d];
    if (box[d] > 0.0) apart[d] -= box[d] * std::round(apart[d] / box[d]);
  }
  return apart;
}

inline double length_of(const std::vector<double>& x) {
  double square = 0.0;
  for (const double component : x) square += component * component;
  return std::sqrt(square);
}

/// All pairs within a distance, in ascending order. Every pair is looked at.
inline std::vector<IndexPair> pairs_within(const ParticlePositions& positions,
                                           const std::vector<double>& box, double distance) {
  std::vector<IndexPair> pairs;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    for (std::size_t j = i + 1; j < positions.size(); ++j) {
      double square = 0.0;
      for (std::size_t d = 0; d < box.size(); ++d) {
        double apart = positions[j][d] - positions[i][d];
        if (box[d] > 0.0) apart -= box[d] * std::round(apart / box[d]);
        square += apart * apart;
      }
      if (square < distance * distance) {
        pairs.push_back({static_cast<std::int64_t>(i), static_cast<std::int64_t>(j)});
      }
    }
  }
  return pairs;
}

inline std::vector<std::size_t> partners(const std::vector<IndexPair>& pairs, std::size_t count) {
  std::vector<std::size_t> number(count, 0);
  for (const auto& [i, j] : pairs) {
    ++number[static_cast<std::size_t>(i)];
    ++number[static_cast<std::size_t>(j)];
  }
  return number;
}

inline std::size_t count_with(const std::vector<std::size_t>& numbers, std::size_t wanted) {
  return static_cast<std::size_t>(std::count(numbers.begin(), numbers.end(), wanted));
}

/// The longest diagonal of the boxes around eight particles each, in the order of their numbers.
inline double largest_group_of_eight(const ParticlePositions& positions) {
  double largest = 0.0;
  for (std::size_t first = 0; first < positions.size(); first += 8) {
    const std::size_t end = std::min(first + 8, positions.size());
    std::vector<double> extent(positions.front().size(), 0.0);
    for (std::size_t d = 0; d < extent.size(); ++d) {
      double low = positions[first][d];
      double high = low;
      for (std::size_t i = first; i < end; ++i) {
        low = std::min(low, positions[i][d]);
        high = std::max(high, positions[i][d]);
      }
      extent[d] = high - low;
    }
    largest = std::max(largest, length_of(extent));
  }
  return largest;
}

}  // namespace tomlin::test
