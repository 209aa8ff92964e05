#include "framework/study/sweep/line_run.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "framework/core/text/fault.hpp"
#include "framework/study/sweep/line_end.hpp"
#include "framework/study/sweep/point_run.hpp"

namespace tomlin {
namespace {

void require_end(const FinalState* before, std::size_t point) {
  if (before == nullptr || before->known()) return;
  throw InputError(
      {Fault(FaultCode::resume_impossible, {}, "", "",
             fmt::format("point {}, which it continues from, has not finished", point - 1))});
}

}  // namespace

bool run_line(const SweepPlan& plan, const std::vector<std::size_t>& points, PointSource& source,
              const WorkerOptions& options) {
  const std::size_t first = points.front() / plan.line() * plan.line();
  LineEnd end(plan, first, points.front(), options.checkpoints);
  for (;;) {
    const std::size_t point = end.next();
    std::unique_ptr<PointRun> run;
    std::optional<SweepRow> row;
    FinalState state;
    try {
      require_end(end.before(), point);
      run = std::make_unique<PointRun>(plan, point, options.stop, options.checkpoints);
      run->connect(end.before(), &state);
      row = run->run();
    } catch (const InputError& error) {
      row = row_of_refused(plan, error);
    }
    if (!row) {
      end.write();
      return false;
    }
    const bool is_last = point == points.back();
    if (is_last) end.remove();  // nothing that a kill would leave after the last row
    if (std::binary_search(points.begin(), points.end(), point)) source.keep(point, *row);
    if (run) run->remove_checkpoint();
    if (is_last) return true;
    end.pass(std::move(state));
  }
}

}  // namespace tomlin
