#include "framework/cli/recorded_sweep.hpp"

#include "framework/cli/sweep_folder.hpp"
#include "framework/cli/sweep_text.hpp"
#include "framework/study/sweep/sweep_journal.hpp"

namespace tomlin {

RecordedSweep record_sweep(RunFolder& folder, SweepPlan& plan, const RecordedSweepOptions& asked) {
  if (asked.begins_anew) remove_sweep(folder);
  RecordedSweep recorded;
  recorded.shard = asked.shard;
  folder.require_in_place();
  SweepJournal journal(folder.file(kSweepJournalFile), plan);
  // A table or arrays that the folder holds were made from all rows.
  const bool had_all = holds_all_results(folder);
  bool is_over = true;
  for (std::size_t k = 0; k < plan.points() && is_over; ++k) is_over = journal.has(k);
  SweepBisection bisection(plan, journal);
  if (plan.refinement() && is_over) is_over = !bisection.add_points();
  recorded.over_before = had_all && is_over && journal.ended() && asked.traced.empty();
  if (recorded.over_before) {
    recorded.status = *journal.ended();
    recorded.bisections = bisection.all();
    return recorded;
  }
  if (had_all && is_over) recorded.shard.reset();  // the results are those of the whole sweep
  if (!is_over) {
    for (const char* name : kSweepResults) folder.remove(name);
  }
  folder.write_file(kSceneFile, plan.scene_text());

  const SweepPart part = asked.shard.value_or(SweepPart{});
  SweepOptions options;
  options.threads = asked.threads;
  options.part = part;
  options.folder = folder.opened() / kPointsFolder;
  options.traced = asked.traced;
  options.stop = asked.stop;
  if (plan.refinement()) options.add_points = [&bisection] { return bisection.add_points(); };
  options.on_progress = asked.on_progress;
  options.run_points = asked.run_points;
  recorded.progress = run_sweep(plan, journal, options);
  if (recorded.progress.complete()) {
    // A kill between a row and the end of its point leaves the checkpoint.
    remove_points(options.folder, false);
    recorded.counts = recorded.shard ? count_rows(plan, journal, part)
                                     : write_sweep_results(folder, plan, journal);
  }
  recorded.bisections = bisection.all();
  folder.write_file(kSweepSummaryFile, sweep_json(plan, recorded, asked.threads));
  if (recorded.counts && !recorded.shard) {
    recorded.status = recorded.counts->status();
    journal.complete(recorded.status);
  }
  return recorded;
}

}  // namespace tomlin
