#include "framework/run/run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "framework/core/kernel_tables.hpp"
#include "framework/core/scheme.hpp"
#include "framework/model/model.hpp"
#include "framework/run/determined.hpp"
#include "framework/run/engine.hpp"

namespace tomlin {

const char* to_string(RunStatus status) {
  switch (status) {
    case RunStatus::finished:
      return "finished";
    case RunStatus::interrupted:
      return "interrupted";
    case RunStatus::failed:
      return "failed";
  }
  return "";
}

const char* to_string(EventKind kind) {
  switch (kind) {
    case EventKind::slip:
      return "slip";
    case EventKind::hop:
      return "hop";
    case EventKind::turn:
      return "turn";
    case EventKind::reversal:
      return "reversal";
    case EventKind::driver_reversal:
      return "driver_reversal";
    case EventKind::tie:
      return "tie";
  }
  return "";
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
  if (scene->run.perturb) determine(scene, options, result);
  return result;
}

}  // namespace tomlin
