#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "framework/run/run.hpp"
#include "framework/run/steps/run_plan.hpp"

/// Scenes that run to their end and still give no number to trust are refused, or warned of, before
/// the first step.
namespace tomlin {

struct StartFindings {
  std::vector<Warning> warnings;
  std::optional<RunFailure> failure;  ///< the first reason to take no step
  double stable_step = 0.0;  ///< of a fixed step: the stability limit, or less but beyond it
  /// The longest step of an adaptive scheme whose error it does not estimate itself.
  double longest_step = std::numeric_limits<double>::infinity();
};

/// The distance of 1 to the next number, by which numbers of a type round.
double epsilon_of(NumberType number_type);

/// Whether a fixed step is shorter than the limit: at the limit itself nothing decays, and an
/// oscillation may grow with the number of steps.
bool is_stable(double step, double stable_step);

/// At the scene's start, with the model anchored at time 0. Moves the model's clock: anchor it
/// anew. `checks_step`: see RunOptions.
StartFindings check_start(Model& model, const RunPlan& plan, bool checks_step = true);

}  // namespace tomlin
