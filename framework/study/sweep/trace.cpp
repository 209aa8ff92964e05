#include "framework/study/sweep/trace.hpp"

#include <memory>
#include <utility>

#include "framework/core/text/fault.hpp"
#include "framework/output/resumption.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/study/recorded_run.hpp"
#include "framework/study/tradeoff/trial_run.hpp"

namespace tomlin {

bool trace_point(const SweepPlan& plan, std::size_t point, const std::filesystem::path& path,
                 const std::atomic<bool>* stop) {
  std::shared_ptr<const Scene> scene;
  try {
    scene = plan.scene_at(point);
    result_at_start(scene);
  } catch (const InputError&) {
    return true;  // as the row of the point says
  }
  RunFolder folder(path, Occupied::go_on);
  Resumption found = find_resumption(folder, *scene, plan.program_version());
  using Kind = Resumption::Kind;
  if (found.kind == Kind::finished || found.kind == Kind::failed) return true;
  folder.own(found.journal);
  RecordedRunOptions options;
  options.program_version = plan.program_version();
  options.before = StoreFile::Before::read;
  options.stop = stop;
  const RecordedRun run = record_run(folder, scene, *scene->registry, std::move(found), options);
  if (run.trouble) throw OutputError(*run.trouble);
  return !run.stopped_before && run.result.status != RunStatus::interrupted;
}

}  // namespace tomlin
