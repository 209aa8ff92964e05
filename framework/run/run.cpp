#include "framework/run/run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "framework/core/elements/kernel_tables.hpp"
#include "framework/core/system/scheme.hpp"
#include "framework/model/model.hpp"
#include "framework/run/engine.hpp"
#include "framework/run/guard/determined.hpp"
#include "framework/run/repeats.hpp"

namespace tomlin {

std::span<const ResultGroup> RunResult::family(std::string_view name) const {
  const auto is_in = [name](const ResultGroup& group) { return group.family == name; };
  const auto first = std::find_if(groups.begin(), groups.end(), is_in);
  return {first, std::find_if_not(first, groups.end(), is_in)};
}

const ResultGroup& RunResult::member(std::string_view family_name, std::size_t k) const {
  const std::span<const ResultGroup> all = family(family_name);
  if (k >= all.size()) {
    throw std::out_of_range(fmt::format("there are {} {}", all.size(), family_name));
  }
  return all[k];
}

const ResultGroup* RunResult::find(std::string_view family_name, std::string_view name) const {
  for (const ResultGroup& group : family(family_name)) {
    if (group.name == name) return &group;
  }
  return nullptr;
}

const ResultGroup& RunResult::group(std::string_view family_name, std::string_view name) const {
  const ResultGroup* found = find(family_name, name);
  if (found == nullptr) {
    throw std::out_of_range(fmt::format("there are no results {} {}", family_name, name));
  }
  return *found;
}

std::size_t RunLayout::particles() const {
  std::size_t total = 0;
  for (const TrajectoryBody& body : bodies) total += body.mass.size();
  return total;
}

std::size_t RunLayout::row() const {
  return columns.size() + particles() * static_cast<std::size_t>(dimension);
}

std::string to_string(const RunFailure& failure) {
  std::string where = failure.body;
  if (failure.particle >= 0) where += fmt::format(", particle {}", failure.particle);
  if (!failure.axis.empty()) where += ", " + failure.axis;
  if (!where.empty()) where = "; where: " + where;
  const std::string force = failure.force.empty() ? "" : "; force: " + failure.force;
  return fmt::format("step {}, time {:.17g}: {}{}{}; likely cause: {}", failure.step, failure.time,
                     failure.what, where, force, failure.cause);
}

RunResult run_as_bound(const std::shared_ptr<const Scene>& scene, const RunOptions& options) {
  Engine engine(scene, options);
  RunResult result = engine.run();
  if (options.final_state != nullptr && result.status == RunStatus::finished) {
    *options.final_state = engine.model().final_state(engine.context().clock.now());
  }
  if (scene->run.perturb) determine(scene, options, result);
  if (scene->run.repeats > 1) average_over_repeats(scene, options, result);
  return result;
}

}  // namespace tomlin
