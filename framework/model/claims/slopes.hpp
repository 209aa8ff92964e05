#pragma once

#include <array>
#include <cmath>
#include <iterator>
#include <vector>

#include "framework/model/claims/examination.hpp"

/// Slopes by differences, and work along directions.
namespace tomlin::claims {

/// The longest difference in parts of the shortest length. Errors fall as (2 pi/50)^2 = 0.016 from
/// one order to the next.
inline constexpr double kLongestDifference = 0.02;
/// Parts of it that are tried where that is not smooth.
inline constexpr double kShorter[] = {1.0, 0.05, 0.0025};
/// Central differences at h, h/2, h/4, h/8 leave an error of order h^8.
inline constexpr int kDifferences = 4;
/// The last two orders of the extrapolation differ by more than the last one is off.
inline constexpr double kTrust = 10.0;
/// An energy whose slope has not settled to this is not smooth enough to have one.
inline constexpr double kSettled = 1e-3;
struct Slope {
  double best = 0.0;
  double unsettled = 0.0;
  double shortest = 0.0;  ///< difference
};

/// Slope at 0 by central differences, extrapolated to h = 0: row by row, each column an order of
/// h^2 better (Romberg).
template <class Function>
Slope slope_of(Function&& f, double longest) {
  std::array<std::array<double, kDifferences>, kDifferences> slope{};
  double h = longest;
  for (int row = 0; row < kDifferences; ++row, h *= 0.5) {
    slope[row][0] = (f(h) - f(-h)) / (2.0 * h);
    double gain = 4.0;
    for (int column = 1; column <= row; ++column, gain *= 4.0) {
      slope[row][column] =
          (gain * slope[row][column - 1] - slope[row - 1][column - 1]) / (gain - 1.0);
    }
  }
  const double best = slope[kDifferences - 1][kDifferences - 1];
  return {best, std::abs(best - slope[kDifferences - 1][kDifferences - 2]), 2.0 * h};
}

inline double work(const std::vector<double>& forces, const Direction& direction) {
  double sum = 0.0;
  for (std::size_t i = 0; i < forces.size(); ++i) sum += forces[i] * direction[i];
  return sum;
}

inline double effort(const std::vector<double>& forces, const Direction& direction) {
  double sum = 0.0;
  for (std::size_t i = 0; i < forces.size(); ++i) sum += std::abs(forces[i] * direction[i]);
  return sum;
}

}  // namespace tomlin::claims
