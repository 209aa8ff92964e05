#include "framework/study/recorded_run.hpp"

#include <cstddef>
#include <mutex>
#include <utility>
#include <vector>

#include "framework/output/hdf5_file.hpp"
#include "framework/output/output_size.hpp"
#include "framework/output/run_recorder.hpp"
#include "framework/run/guard/trial.hpp"
#include "framework/study/accuracy/accuracy.hpp"

namespace tomlin {

RecordedRun record_run(RunFolder& folder, const std::shared_ptr<const Scene>& scene,
                       const Registry& registry, Resumption found,
                       const RecordedRunOptions& asked) {
  StoreFile store(folder, *scene, asked.program_version, asked.before);
  // The recorder looks at it when the run begins, which is after the pilot.
  if (scene->run.accuracy) {
    if (const auto layout = layout_of(scene)) {
      require_room(*scene, output_size(*scene, *layout), room_in(folder.path()));
    }
  }
  // The program chooses the integrator where there is an accuracy; it is kept for a run that
  // resumes.
  RecordedRun recorded;
  ChosenIntegrator chosen;
  chosen.scene = scene;
  if (scene->run.accuracy) {
    chosen = choose_integrator(scene, registry, asked.stop, kMostPilotWork, &store);
    recorded.stopped_before = chosen.interrupted;
    if (chosen.interrupted) return recorded;
  }
  recorded.scene = chosen.scene;
  const std::vector<std::byte> state = std::move(found.state);
  RunOptions options;
  if (found.kind == Resumption::Kind::go_on) options.resume_from = &state;
  RunRecorder recorder(folder, *scene, asked.program_version, std::move(found), [&asked] {
    if (asked.on_trouble) asked.on_trouble();
  });
  options.sink = &recorder;
  options.on_progress = asked.on_progress;
  options.stop = asked.stop;
  options.team = asked.team;
  options.store = &store;
  recorded.result = run_as_bound(chosen.scene, options);
  if (asked.on_end) asked.on_end();
  if (scene->run.accuracy) estimate_errors(chosen, options, recorded.result);
  recorded.failure = recorded.result.failure;
  const std::lock_guard lock(hdf5_mutex());  // for the trajectory
  recorded.trouble = recorder.finish(recorded.result);
  return recorded;
}

}  // namespace tomlin
