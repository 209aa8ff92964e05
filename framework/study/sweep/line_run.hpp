#pragma once

#include <cstddef>
#include <vector>

#include "framework/study/sweep/sweep_plan.hpp"
#include "framework/study/sweep/worker.hpp"

namespace tomlin {

/// Runs points of one line, each from where the one before it has ended; first those before them
/// whose end is not known any more, whose rows are there already. A point whose neighbour has not
/// finished is refused. False where it was stopped.
bool run_line(const SweepPlan& plan, const std::vector<std::size_t>& points, PointSource& source,
              const WorkerOptions& options);

}  // namespace tomlin
