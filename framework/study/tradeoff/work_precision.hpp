#pragma once

#include <cstddef>
#include <vector>

#include "framework/study/tradeoff/measurer.hpp"
#include "framework/study/tradeoff/tradeoff.hpp"

namespace tomlin {

/// Reference and errors that the diagram is to show.
struct Aim {
  double reference = 0.0;
  double tolerance = 0.0;    ///< absolute
  double fine_enough = 0.0;  ///< an error that no method need go below
  /// Absolute, of the reference: what a point's error may be wrong by.
  double doubt = 0.0;

  /// It has a margin for the error of the reference itself, and for other machines.
  bool is_met(double error) const;
};

/// The resolution's values that are tried first: steps from just below the stability limit
/// downwards by halves, tolerances from 1 by half decades, in two digits.
double first_resolution(const Method& method, double duration);
double next_resolution(const Method& method, double resolution);

/// Takes one method from coarse to fine and adds its points and what they leave out.
void walk(std::size_t index, const std::vector<Method>& methods, double duration, const Aim& aim,
          double seconds, Measurer& measurer, Tradeoff& tradeoff);

/// More points between those that keep the tolerance and those that do not, where they may turn
/// out cheapest.
void refine(const Aim& aim, Measurer& measurer, Tradeoff& tradeoff);

/// The cheapest point from which on all finer ones of its method keep the tolerance; its index, or
/// the number of points.
std::size_t cheapest_point(const Aim& aim, const std::vector<TradeoffPoint>& points);

/// Marks the fastest and the cheapest at each power of ten.
void mark_best(Tradeoff& tradeoff);

}  // namespace tomlin
