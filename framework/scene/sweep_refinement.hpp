#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "framework/scene/sweep_settings.hpp"

namespace tomlin {

/// Points that a sweep adds between those of its axes, by bisection along one of them: where an
/// observable crosses a level, or else where it jumps.
struct SweepRefinement {
  std::optional<double> level;  ///< none: where it jumps
  std::size_t axis = 0;         ///< of numbers that rise or fall
  bool logarithmic = false;     ///< the middle of an interval, and its width
  double width = 0.0;           ///< an interval that is not wider is not bisected
  std::size_t rounds = 0;       ///< bisections of the widest interval

  double middle(double from, double to) const;
  /// How often an interval is halved.
  std::size_t rounds_between(double from, double to) const;
};

/// Observable by which to refine, from "OBSERVABLE=LEVEL"; empty where there is none.
std::string refined_observable(const RefineSettings& refine);

/// Refinement by `refine` and the keys beside it; nothing where there is none or they are wrong,
/// for which faults are added.
std::optional<SweepRefinement> sweep_refinement(const SweepSettings& settings,
                                                const std::vector<SweepDimension>& dimensions,
                                                std::vector<Fault>& faults);

}  // namespace tomlin
