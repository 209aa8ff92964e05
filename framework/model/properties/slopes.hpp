#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "framework/model/properties/force_under_test.hpp"

/// Slopes by differences, and work along directions.
namespace tomlin::properties {

/// The longest difference in parts of the shortest length. Errors fall as (2 pi/50)^2 = 0.016 from
/// one order to the next.
inline constexpr double kLongestDifference = 0.02;
/// Parts of the largest force that its fourth difference may be: (2 pi/100)^4 = 1.6e-5 of a sine.
inline constexpr double kMostFourthDifference = 1e-3;
/// Parts of it that are tried where that is not smooth.
inline constexpr double kShorter[] = {1.0, 0.05, 0.0025, 0.000125};
/// Central differences at h, h/2, h/4, h/8 leave an error of order h^8.
inline constexpr int kDifferences = 4;
/// Another sequence begins at this part of the longest one, and has none of its differences.
inline constexpr double kOtherLongest = 0.618033988749894848;
/// The last two orders of an extrapolation differ by more than a tenth of the last one's error.
inline constexpr double kErrorPerDifference = 10.0;
/// An energy whose slope has not settled to this is not smooth enough to have one.
inline constexpr double kSettled = 1e-3;
struct Slope {
  double best = 0.0;
  double unsettled = 0.0;
  double shortest = 0.0;  ///< difference
  double kink = 0.0;      ///< by how much the slopes to both sides differ
};

/// Slope at 0 by central differences, extrapolated to h = 0: row by row, each column an order of
/// h^2 better (Romberg).
template <class Function>
Slope slope_by(Function&& f, double longest) {
  std::array<std::array<double, kDifferences>, kDifferences> slope{};
  std::array<double, kDifferences> kink{};
  const double here = f(0.0);
  double h = longest;
  for (int row = 0; row < kDifferences; ++row, h *= 0.5) {
    const double after = f(h);
    const double before = f(-h);
    slope[row][0] = (after - before) / (2.0 * h);
    kink[static_cast<std::size_t>(row)] = (after - here + (before - here)) / h;
    double gain = 4.0;
    for (int column = 1; column <= row; ++column, gain *= 4.0) {
      slope[row][column] =
          (gain * slope[row][column - 1] - slope[row - 1][column - 1]) / (gain - 1.0);
    }
  }
  // The slope to the right less that to the left: of a smooth function h, h^3, h^5 times
  // derivatives.
  double gain = 2.0;
  for (std::size_t last = kDifferences - 1; last > 0; --last, gain *= 4.0) {
    for (std::size_t row = 0; row < last; ++row) {
      kink[row] = (gain * kink[row + 1] - kink[row]) / (gain - 1.0);
    }
  }
  const double best = slope[kDifferences - 1][kDifferences - 1];
  // Both are worse than the best; one may come close to it by chance.
  const double unsettled = std::max(std::abs(best - slope[kDifferences - 1][kDifferences - 2]),
                                    std::abs(best - slope[kDifferences - 2][kDifferences - 2]));
  return {best, unsettled, 2.0 * h, std::abs(kink[0])};
}

/// By two sequences of differences. Beyond a knot of a spline, where a high derivative jumps, one
/// may settle by chance, but not both at the same slope.
template <class Function>
Slope slope_of(Function&& f, double longest) {
  Slope slope = slope_by(f, longest);
  const Slope other = slope_by(f, kOtherLongest * longest);
  slope.unsettled = std::max(slope.unsettled, std::abs(slope.best - other.best));
  slope.kink = std::max(slope.kink, other.kink);
  return slope;
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

/// The fourth difference of the force along a way, and the largest effort within it.
struct Roughness {
  double fourth = 0.0;
  double most = 0.0;
};

inline Roughness roughness_of(ForceUnderTest& e, const State& state, const Direction& along,
                              const Direction& seen, double step) {
  constexpr double kWeight[] = {1.0, -4.0, 6.0, -4.0, 1.0};
  Roughness rough;
  for (int k = 0; k < 5; ++k) {
    State moved = state;
    const double h = (k - 2) * step;
    for (std::size_t i = 0; i < e.count(); ++i) moved.x[i] += h * along[i];
    const std::vector<double> forces = e.forces(moved);
    rough.fourth += kWeight[k] * work(forces, seen);
    rough.most = std::max(rough.most, effort(forces, seen));
  }
  return rough;
}

/// Whether the force along a way has neither kinks nor jumps within `longest` of a state, nor
/// waves: its fourth difference is what is left of a smooth one. Where it has, differences say
/// nothing. By steps of two lengths, of which no wave is a part of both.
inline bool is_regular(ForceUnderTest& e, const State& state, const Direction& along,
                       const Direction& seen, double longest) {
  for (const double step : {0.5 * longest, 0.309016994374947424 * longest}) {
    const Roughness rough = roughness_of(e, state, along, seen, step);
    if (std::abs(rough.fourth) > kMostFourthDifference * rough.most) return false;
  }
  return true;
}

/// Lengths of a direction along single coordinates, as a body's edge goes.
inline double length_of(const ForceUnderTest& e, const Direction& direction) {
  double length = 0.0;
  for (std::size_t i = 0; i < e.count(); ++i) {
    length += std::abs(direction[i]) / e.variable(i).unit;
  }
  return length;
}

/// In quadruple precision, in parts of the shortest length: what two orders leave is below 1e-20 of
/// the slope even a millionth of a length apart, and so is what rounding to 1e-34 leaves.
inline constexpr double kTinyDifference = 1e-12;

/// A kink's two slopes differ by as much twice as far away, those about a smooth point by twice as
/// much; and by more than the rounding of quadruple precision.
inline constexpr double kLeastKinkRatio = 0.75;
inline constexpr double kLeastKink = 1e-6;

/// A slope in quadruple precision, to all digits of a double and some more; unsettled where there
/// is a kink.
struct ExactSlope {
  Quad best;
  double unsettled = 0.0;
  double step = 0.0;
};

template <class Function>
ExactSlope exact_slope(Function&& f, double length) {
  const Quad h = Quad(kTinyDifference) * Quad(length);
  const Quad here = f(Quad(0.0));
  const auto one_sided = [&](const Quad& by) { return (f(by) - here) / by; };
  const Quad right = one_sided(h);
  const Quad left = one_sided(-h);
  const Quad far_right = one_sided(h + h);
  const Quad far_left = one_sided(-(h + h));
  const Quad near = (right + left) / Quad(2.0);
  const Quad far = (far_right + far_left) / Quad(2.0);
  const double apart = std::abs(static_cast<double>(right - left));
  const bool kinked =
      apart > kLeastKinkRatio * std::abs(static_cast<double>(far_right - far_left)) &&
      apart > kLeastKink * std::abs(static_cast<double>(abs(right) + abs(left)));
  return {(Quad(4.0) * near - far) / Quad(3.0),
          std::abs(static_cast<double>(near - far)) + (kinked ? apart : 0.0),
          static_cast<double>(h)};
}

/// The energy in quadruple precision, differentiated.
inline ExactSlope exact_slope(ForceUnderTest& e, const State& state, const Direction& direction) {
  ForceTwin<Quad>& twin = *e.exact();
  e.put(state, twin);
  return exact_slope(
      [&](const Quad& h) {
        for (std::size_t i = 0; i < e.count(); ++i) {
          twin.position(e.variable(i).at) = Quad(state.x[i]) + h * Quad(direction[i]);
        }
        twin.evaluate(state.time);
        return twin.energy();
      },
      e.length());
}

}  // namespace tomlin::properties
