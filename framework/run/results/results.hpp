#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "framework/run/results/result_group.hpp"
#include "framework/run/run.hpp"

namespace tomlin {

/// The rows of every family that a run may report, but for those of observers, which plugins
/// declare: for the reference page of results and the summary's schema.
std::span<const ResultFamily> result_families();

/// The row of a dotted path: "drivers.driver.mean_force.x", "driver.mean_force.x"; null for those
/// of observers.
const ResultQuantity* quantity_at(std::string_view path);

/// "time", "window" and "performance": the course and cost of a run, in the terms of the other
/// groups.
std::vector<ResultGroup> groups_of_run(const RunResult& result);

}  // namespace tomlin
