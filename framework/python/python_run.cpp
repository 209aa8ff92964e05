#include <algorithm>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <unistd.h>

#include "framework/cli/build_version.hpp"
#include "framework/cli/inputs.hpp"
#include "framework/cli/progress.hpp"
#include "framework/cli/result_text.hpp"
#include "framework/core/system/thread_team.hpp"
#include "framework/output/hdf5_file.hpp"
#include "framework/output/output_file.hpp"
#include "framework/output/output_size.hpp"
#include "framework/output/resumption.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/output/summary.hpp"
#include "framework/python/handles.hpp"
#include "framework/run/results/observables.hpp"
#include "framework/run/results/results.hpp"
#include "framework/study/accuracy/accuracy.hpp"
#include "framework/study/recorded_run.hpp"

namespace tomlin::python {

void MemorySink::begin(const RunLayout& layout) {
  layout_ = layout;
  const double bytes = layout.most_samples * static_cast<double>(layout.row() * sizeof(double));
  const double memory =
      static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
  if (layout.columns.empty() || !(memory > 0.0) || bytes <= memory) return;
  Fault fault(FaultCode::output_too_large);
  fault.key = "output.every";
  fault.why = fmt::format("{:.10g} samples take {} of memory, of which there are {}",
                          layout.most_samples, bytes_text(bytes), bytes_text(memory));
  fault.admissible = "a longer interval, or a run with a folder";
  throw InputError({fault});
}

void MemorySink::sample(const std::vector<double>& row) {
  samples_.insert(samples_.end(), row.begin(), row.end());
}

void MemorySink::event(const Event& event) {
  if (events_.size() >= kMostEvents) return;  // as many as the program keeps
  const std::string_view kind = event.label.empty() ? to_string(event.kind) : event.label;
  events_.push_back({std::string(kind), std::string(event.name), event.time, event.duration,
                     event.size, event.energy_lost, event.peak_force});
}

void MemorySink::cut_to(const std::pair<std::size_t, std::size_t>& size) {
  samples_.resize(std::min(samples_.size(), size.first));
  events_.resize(std::min(events_.size(), size.second));
}

namespace {

std::unique_ptr<RunHandle> run_in_memory(const SceneHandle& scene, std::size_t threads,
                                         const py::object& progress) {
  InterruptGuard guard;
  ProgressCall show(progress);
  auto handle = std::make_unique<RunHandle>();
  handle->scene = scene;
  handle->as_run = scene.scene;
  const std::unique_ptr<ThreadTeam> team = team_of(threads);
  RunOptions options;
  if (team) options.team = &team->team();
  options.sink = &handle->kept;
  options.stop = &guard.stop();
  if (show) options.on_progress = [&](const RunProgress& now) { show(guard.stop(), now); };
  handle->result = without_lock([&] { return run(scene.scene, options); });
  show.rethrow();
  return handle;
}

/// Nothing where the run in the folder had ended before.
std::unique_ptr<RunHandle> run_in_folder(const SceneHandle& scene, const std::string& path,
                                         bool resume, bool force, std::size_t threads,
                                         const py::object& progress) {
  const Occupied occupied = resume  ? Occupied::go_on
                            : force ? Occupied::replace_results
                                    : Occupied::refuse;
  RunFolder folder(path, occupied);
  refuse_to_lose_inputs(folder, *scene.scene, kFilesOfARun);
  Resumption found =
      resume ? find_resumption(folder, *scene.scene, build_version()) : start_again(folder);
  if (found.kind == Resumption::Kind::finished || found.kind == Resumption::Kind::failed) {
    remove_leftovers(folder);
    return nullptr;
  }
  folder.own(found.journal);
  note_missing_locks(folder, false);
  InterruptGuard guard;
  ProgressCall show(progress);
  const std::unique_ptr<ThreadTeam> team = team_of(threads);
  RecordedRunOptions options;
  if (team) options.team = &team->team();
  options.program_version = build_version();
  options.before = resume ? StoreFile::Before::read : StoreFile::Before::ignore;
  options.stop = &guard.stop();
  options.on_trouble = [&guard] { guard.stop() = true; };
  if (show) options.on_progress = [&](const RunProgress& now) { show(guard.stop(), now); };
  RecordedRun recorded = without_lock(
      [&] { return record_run(folder, scene.scene, *scene.registry, std::move(found), options); });
  show.rethrow();
  if (recorded.trouble) throw OutputError(*recorded.trouble);
  auto handle = std::make_unique<RunHandle>();
  handle->scene = scene;
  handle->as_run = recorded.scene ? recorded.scene : scene.scene;
  handle->result = std::move(recorded.result);
  if (recorded.stopped_before) handle->result.status = RunStatus::interrupted;
  return handle;
}

py::object dict_of(const std::optional<RunFailure>& failure) {
  if (!failure) return py::none();
  py::dict all;
  all["step"] = failure->step;
  all["time"] = failure->time;
  all["body"] = failure->body;
  all["particle"] = failure->particle < 0 ? py::object(py::none()) : py::cast(failure->particle);
  all["axis"] = failure->axis;
  all["force"] = failure->force;
  all["what"] = failure->what;
  all["cause"] = failure->cause;
  all["code"] = std::string(id_of(failure->code));
  all["message"] = to_string(*failure);
  return all;
}

/// Path, value or None, unit and meaning of every number.
py::list quantities_of(const RunHandle& handle) {
  py::list all;
  const UnitSystem units = handle.as_run->units;
  for (const Observable& one : observables(handle.result)) {
    all.append(py::make_tuple(one.path, one.value, unit_in_tables(units, *one.quantity),
                              one.quantity->meaning));
  }
  return all;
}

py::array samples_of(const py::object& self) {
  const auto& handle = self.cast<const RunHandle&>();
  const std::vector<double>& numbers = handle.kept.samples();
  const auto row = static_cast<py::ssize_t>(handle.kept.layout().row());
  const py::ssize_t rows = row > 0 ? static_cast<py::ssize_t>(numbers.size()) / row : 0;
  return numbers_of(self, numbers.data(), {rows, row});
}

/// Positions of a trajectory [frame, particle, axis], with three axes whatever the scene has.
py::array positions_in(const std::string& file) {
  auto read = std::make_unique<Hdf5Numbers>(
      without_lock([&] { return read_hdf5(file, "particles/all/position/value"); }));
  const Hdf5Numbers& found = *read;
  const py::capsule owner(read.release(), [](void* it) { delete static_cast<Hdf5Numbers*>(it); });
  return numbers_of(owner, found.numbers.data(), {found.shape.begin(), found.shape.end()});
}

}  // namespace

py::dict layout_of(const MemorySink& kept) {
  const RunLayout& layout = kept.layout();
  py::list columns;
  for (const SampleColumn& column : layout.columns) {
    columns.append(py::make_tuple(column.name, column.unit));
  }
  py::list bodies;
  for (const TrajectoryBody& body : layout.bodies) {
    bodies.append(py::make_tuple(body.name, body.mass.size()));
  }
  py::dict all;
  all["columns"] = columns;
  all["bodies"] = bodies;
  all["dimension"] = layout.dimension;
  return all;
}

py::list events_of(const MemorySink& kept) {
  py::list all;
  for (const KeptEvent& one : kept.events()) {
    all.append(py::make_tuple(one.time, one.kind, one.name, one.duration, one.size, one.energy_lost,
                              one.peak_force));
  }
  return all;
}

void define_runs(py::module_& module) {
  py::class_<RunProgress>(module, "Progress", "How far a run is.")
      .def_readonly("time", &RunProgress::time)
      .def_readonly("duration", &RunProgress::duration)
      .def_readonly("steps", &RunProgress::steps)
      .def_readonly("elapsed_seconds", &RunProgress::elapsed_seconds)
      .def("__str__", &progress_text);
  py::class_<RunHandle>(module, "Run")
      .def_property_readonly(
          "status", [](const RunHandle& it) { return std::string(to_string(it.result.status)); })
      .def_property_readonly("failure",
                             [](const RunHandle& it) { return dict_of(it.result.failure); })
      .def_property_readonly("scene",
                             [](const RunHandle& it) {
                               SceneHandle scene = it.scene;
                               scene.scene = it.as_run;
                               return scene;
                             })
      .def("summary_json", [](const RunHandle& it) { return summary_json(*it.as_run, it.result); })
      .def("text",
           [](const RunHandle& it, const std::string& where) {
             return result_text(*it.as_run, it.result, where);
           })
      .def("observable",
           [](const RunHandle& it, const std::string& path) { return observable(it.result, path); })
      .def("quantities", &quantities_of)
      .def("samples", &samples_of)
      .def("layout", [](const RunHandle& it) { return layout_of(it.kept); })
      .def("events", [](const RunHandle& it) { return events_of(it.kept); });
  module.def("run", &run_in_memory);
  module.def("run_in_folder", &run_in_folder);
  module.def("positions_in", &positions_in);
}

}  // namespace tomlin::python
