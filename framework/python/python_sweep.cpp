#include <algorithm>
#include <array>
#include <atomic>
#include <bitset>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "framework/cli/build_version.hpp"
#include "framework/cli/recorded_sweep.hpp"
#include "framework/cli/sweep_folder.hpp"
#include "framework/cli/sweep_text.hpp"
#include "framework/python/handles.hpp"
#include "framework/scene/text.hpp"
#include "framework/study/sweep/bisection.hpp"
#include "framework/study/sweep/files.hpp"
#include "framework/study/sweep/runner.hpp"
#include "framework/study/sweep/sweep_journal.hpp"
#include "framework/study/sweep/sweep_plan.hpp"

namespace tomlin::python {
namespace {

/// The sweep that tomlin/_sweep.py requests; texts are those of the options of the program.
struct SweepRequest {
  /// Values are a text, "1:5:9", or a list of texts.
  using Values = std::variant<std::string, std::vector<std::string>>;
  std::vector<std::pair<std::string, Values>> over;
  std::vector<std::vector<std::string>> zips;
  std::vector<std::string> observables;
  std::optional<std::string> repeats;
  std::optional<std::string> refine;
  std::optional<std::string> refine_along;
  std::optional<std::string> refine_to;
  std::optional<bool> continues;
  std::size_t threads = 0;            ///< 0: one for each processor
  std::optional<std::string> folder;  ///< that everything is written to
  std::string journal;                ///< without a folder: a file that is made for the rows
  bool force = false;
  py::object progress;
  /// A callable that gets a SweepRound and runs its points elsewhere; None: threads run them. It
  /// calls `progress` itself.
  py::object run_points = py::none();
};

/// The rows of a sweep in the order of its results.
struct SweepHandle {
  struct Axis {
    std::string name;
    std::size_t dimension = 0;
    std::vector<double> numbers;     ///< [row]
    std::vector<std::string> words;  ///< [row]; of an axis that is not numeric
  };
  std::vector<Axis> axes;
  std::vector<std::size_t> shape;                   ///< one number, of points, with a refinement
  std::vector<std::array<std::string, 3>> columns;  ///< name, unit, meaning
  std::vector<double> numbers;                      ///< [column][row]
  std::vector<std::string> status;                  ///< [row]; "missing" where it was stopped
  std::vector<std::string> reasons;                 ///< [row]
  std::string summary;                              ///< sweep.json
  bool complete = false;
};

SweepSettings settings_of(const SceneHandle& scene, const SweepRequest& request,
                          std::vector<Fault>& faults) {
  SweepSettings settings = scene.document->sweep(faults).value_or(SweepSettings{});
  if (!request.over.empty()) {
    settings.over.clear();
    settings.unread.clear();
    settings.zips.clear();
  }
  const SourceLocation location{"over"};
  for (const auto& [name, given] : request.over) {
    if (const auto* texts = std::get_if<std::vector<std::string>>(&given)) {
      if (texts->empty()) {
        faults.emplace_back(FaultCode::command_missing_argument, location, name, "", "no values",
                            "at least one value");
        settings.unread.push_back(name);
        continue;
      }
      settings.over.push_back({name, SweepValues::listed(*texts), location, ""});
      continue;
    }
    add_axis(settings, name, std::get<std::string>(given), location, faults);
  }
  if (!request.zips.empty()) settings.zips.clear();
  for (const auto& zip : request.zips) settings.zips.push_back({zip, SourceLocation{"zip"}});
  settings.continues = request.continues.value_or(settings.continues);
  if (request.repeats) settings.repeats = {*request.repeats, SourceLocation{"repeats"}, ""};
  add_repeats(settings, faults);
  if (request.refine) settings.refine.what = {*request.refine, SourceLocation{"refine"}, ""};
  if (request.refine_along)
    settings.refine.along = {*request.refine_along, SourceLocation{"refine_along"}, ""};
  if (request.refine_to) settings.refine.to = {*request.refine_to, SourceLocation{"refine_to"}, ""};
  if (!request.observables.empty()) {
    settings.observables = request.observables;
    settings.observables_location = SourceLocation{"observables"};
  }
  if (settings.over.empty() && settings.unread.empty()) {
    faults.emplace_back(FaultCode::command_missing_argument, location, "", "",
                        "nothing to sweep over", "names and their values");
  }
  if (settings.observables.empty() && !settings.refine.what) {
    faults.emplace_back(FaultCode::command_missing_argument, SourceLocation{"observables"}, "", "",
                        "no observable", "a dotted path in the summary");
  }
  return settings;
}

SweepPlan plan_of(const SceneHandle& scene, const SweepRequest& request) {
  std::vector<Fault> faults;
  SweepSettings settings = settings_of(scene, request, faults);
  return SweepPlan(*scene.document, *scene.registry, scene.settings, std::move(settings),
                   build_version(), std::move(faults));
}

/// Rows that are missing have no numbers.
void read_rows(const SweepPlan& plan, const SweepJournal& journal, SweepHandle& handle) {
  const RowOrder order(plan);
  const std::size_t rows = order.size();
  const bool grid = !plan.refinement();
  if (grid) {
    for (const SweepDimension& one : plan.dimensions()) handle.shape.push_back(one.count);
  } else {
    handle.shape = {rows};
  }
  for (std::size_t a = 0; a < plan.axes().size(); ++a) {
    SweepHandle::Axis axis;
    axis.name = plan.axis_title(a);
    const auto& dimensions = plan.dimensions();
    while (grid &&
           std::find(dimensions[axis.dimension].axes.begin(), dimensions[axis.dimension].axes.end(),
                     a) == dimensions[axis.dimension].axes.end()) {
      ++axis.dimension;
    }
    const SweepValues& values = plan.axes()[a].values;
    const std::size_t count = grid ? values.size() : rows;
    for (std::size_t k = 0; k < count; ++k) {
      if (values.numeric()) {
        axis.numbers.push_back(grid ? values.number(k) : plan.number(a, order.point(k)));
      } else {
        axis.words.push_back(values.plain_text(grid ? k : plan.index(a, order.point(k))));
      }
    }
    handle.axes.push_back(std::move(axis));
  }
  for (const SweepColumn& column : plan.columns()) {
    const SweepObservable& observable = plan.observables()[column.observable];
    handle.columns.push_back({column.name, observable.unit, observable.meaning});
  }
  handle.numbers.assign(plan.columns().size() * rows, std::numeric_limits<double>::quiet_NaN());
  handle.status.assign(rows, "missing");
  handle.reasons.assign(rows, "");
  SweepRow row;
  for (std::size_t k = 0; k < rows; ++k) {
    if (!journal.has(order.point(k))) continue;
    order.read(journal, k, {&row, 1});
    for (std::size_t c = 0; c < row.numbers.size(); ++c) {
      handle.numbers[c * rows + k] = row.numbers[c];
    }
    handle.status[k] = to_string(row.status);
    handle.reasons[k] = row.reason;
  }
}

/// A row as it is sent from a worker: point, status, numbers, reason and warnings.
using SentRow = std::tuple<std::size_t, std::size_t, std::vector<double>, std::string, std::string>;

SentRow sent(std::size_t point, const SweepRow& row) {
  return {point, static_cast<std::size_t>(row.status), row.numbers, row.reason,
          row.warnings.to_string()};
}

/// Throws std::invalid_argument where it is no row of so many columns.
SweepRow received(const SentRow& sent, std::size_t columns) {
  const auto& [point, status, numbers, reason, warnings] = sent;
  if (status >= kSweepStatuses || numbers.size() != columns ||
      warnings.size() != kMostWarningCodes) {
    throw std::invalid_argument("a worker has sent no row of this sweep");
  }
  SweepRow row;
  row.status = static_cast<SweepStatus>(status);
  row.numbers = numbers;
  row.reason = reason;
  row.warnings = std::bitset<kMostWarningCodes>(warnings);
  return row;
}

py::tuple to_python(const SentRow& row) {
  const auto& [point, status, numbers, reason, warnings] = row;
  return py::make_tuple(point, status, numbers, py::bytes(reason), warnings);
}

/// The points of a sweep that have no row, while the workers of an executor run them. It lives as
/// long as the call that it is given to.
class SweepRound {
 public:
  SweepRound(const SweepPlan& plan, SweepRows& rows, const SweepOptions& options,
             const SweepProgress& so_far)
      : plan_(plan),
        rows_(rows),
        queue_(plan, rows, options.part),
        seconds_before_(so_far.seconds),
        progress_(progress_before(plan, rows, options, so_far)) {}

  std::uint64_t identity() const { return plan_.identity(); }
  std::size_t missing() const { return progress_.points - progress_.with_row(); }
  /// At least so many of the points that were not taken before, whole lines where points continue
  /// from their neighbour, and the values of the refined axis there. Empty: there are no more.
  std::pair<std::vector<std::size_t>, std::vector<double>> take(std::size_t most) {
    std::pair<std::vector<std::size_t>, std::vector<double>> taken{queue_.take(most), {}};
    if (!plan_.refinement()) return taken;
    for (const std::size_t point : taken.first) {
      taken.second.push_back(plan_.number(plan_.refinement()->axis, point));
    }
    return taken;
  }
  void keep(const std::vector<SentRow>& rows) {
    for (const SentRow& one : rows) {
      const std::size_t point = std::get<0>(one);
      if (point >= plan_.point_numbers() || rows_.has(point)) continue;
      const SweepRow row = received(one, plan_.columns().size());
      rows_.keep(point, row);
      ++progress_.done[static_cast<std::size_t>(row.status)];
    }
  }
  SweepProgress progress() const {
    SweepProgress now = progress_;
    now.seconds = seconds_before_ + std::chrono::duration<double>(Clock::now() - started_).count();
    return now;
  }

 private:
  using Clock = std::chrono::steady_clock;

  const SweepPlan& plan_;
  SweepRows& rows_;
  SweepQueue queue_;
  Clock::time_point started_ = Clock::now();
  double seconds_before_;
  SweepProgress progress_;
};

/// The points that a worker has been given, and their rows.
class ChunkRows : public SweepRows {
 public:
  explicit ChunkRows(std::vector<std::size_t> points) : points_(std::move(points)) {
    std::sort(points_.begin(), points_.end());
  }

  /// Points that are not in the chunk are no work of this worker.
  bool has(std::size_t point) const override {
    return !std::binary_search(points_.begin(), points_.end(), point);
  }
  void keep(std::size_t point, const SweepRow& row) override {
    const std::lock_guard lock(mutex_);
    rows_.push_back(sent(point, row));
  }
  const std::vector<SentRow>& rows() const { return rows_; }

 private:
  std::vector<std::size_t> points_;
  std::mutex mutex_;
  std::vector<SentRow> rows_;
};

/// The plan of a sweep in a worker of an executor.
struct WorkerPlan {
  WorkerPlan(const SceneHandle& handle, const SweepRequest& request)
      : scene(handle), plan(plan_of(handle, request)) {}

  /// Runs points with values of the refined axis, as SweepRound::take() gives them. Checkpoints go
  /// into the folder of the sweep where this machine sees it. Ctrl-C leaves the rows so far.
  py::list run(std::vector<std::size_t> points, const std::vector<double>& values,
               const std::optional<std::string>& folder, std::size_t threads) {
    InterruptGuard guard;
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (points.at(k) >= plan.points()) plan.add(points[k], values[k]);
    }
    ChunkRows rows(std::move(points));
    SweepOptions options;
    options.threads = threads;
    options.stop = &guard.stop();
    std::error_code error;
    if (folder &&
        std::filesystem::exists(std::filesystem::path(*folder) / kSweepJournalFile, error)) {
      options.folder = std::filesystem::path(*folder) / kPointsFolder;
    }
    without_lock([&] { return run_sweep(plan, rows, options); });
    py::list all;
    for (const SentRow& row : rows.rows()) all.append(to_python(row));
    return all;
  }

  SceneHandle scene;
  SweepPlan plan;
};

std::unique_ptr<SweepHandle> sweep(const SceneHandle& scene, SweepRequest request) {
  const bool is_elsewhere = !request.run_points.is_none();
  // With an executor the caller waits in Python, which handles Ctrl-C.
  std::optional<InterruptGuard> guard;
  if (!is_elsewhere) guard.emplace();
  std::atomic<bool> never = false;
  std::atomic<bool>& stop = guard ? guard->stop() : never;
  ProgressCall show(is_elsewhere ? py::none() : std::move(request.progress));
  auto handle = std::make_unique<SweepHandle>();
  const auto report = [&](const SweepProgress& now) {
    show(stop, sweep_progress_text(now), now.with_row(), now.points);
  };
  const auto run_elsewhere = [&request](const SweepPlan& plan, SweepRows& rows,
                                        const SweepOptions& options, const SweepProgress& so_far) {
    SweepRound round(plan, rows, options, so_far);
    const py::gil_scoped_acquire lock;
    request.run_points(py::cast(&round, py::return_value_policy::reference));
    return round.progress();
  };
  {
    const Unlocked unlocked;
    SweepPlan plan = plan_of(scene, request);
    const std::size_t all = std::max<std::size_t>(1, std::thread::hardware_concurrency());
    const std::size_t threads = request.threads > 0 ? request.threads : all;
    RecordedSweepOptions options;
    options.threads = threads;
    options.begins_anew = request.force;
    options.stop = &stop;
    if (show) options.on_progress = report;
    if (is_elsewhere) options.run_points = run_elsewhere;
    if (request.folder) {
      RunFolder folder(*request.folder, occupied_by_sweep(*request.folder, plan, request.force),
                       kSweepFiles);
      own_sweep_folder(folder, plan, request.force, false);
      const RecordedSweep recorded = record_sweep(folder, plan, options);
      handle->complete = recorded.over_before || recorded.counts.has_value();
      const SweepJournal journal(folder.file(kSweepJournalFile), plan, SweepJournal::Use::read);
      read_rows(plan, journal, *handle);
    } else {
      SweepJournal journal(request.journal, plan);
      SweepBisection bisection(plan, journal);
      SweepOptions in_memory;
      in_memory.threads = threads;
      in_memory.stop = options.stop;
      in_memory.on_progress = options.on_progress;
      in_memory.run_points = options.run_points;
      if (plan.refinement()) in_memory.add_points = [&] { return bisection.add_points(); };
      RecordedSweep recorded;
      recorded.progress = run_sweep(plan, journal, in_memory);
      recorded.bisections = bisection.all();
      handle->complete = recorded.progress.complete();
      if (handle->complete) recorded.counts = count_rows(plan, journal);
      handle->summary = sweep_json(plan, recorded, threads);
      read_rows(plan, journal, *handle);
    }
  }
  show.rethrow();
  return handle;
}

py::list axes_of(const py::object& self) {
  const auto& handle = self.cast<const SweepHandle&>();
  py::list all;
  for (const SweepHandle::Axis& axis : handle.axes) {
    const py::object values =
        axis.words.empty() ? py::object(numbers_of(self, axis.numbers.data(),
                                                   {static_cast<py::ssize_t>(axis.numbers.size())}))
                           : py::object(py::cast(axis.words));
    all.append(py::make_tuple(axis.name, axis.dimension, values));
  }
  return all;
}

py::array column_of(const py::object& self, std::size_t column) {
  const auto& handle = self.cast<const SweepHandle&>();
  if (column >= handle.columns.size()) throw py::index_error("there is no such column");
  const std::size_t rows = handle.status.size();
  return numbers_of(self, handle.numbers.data() + column * rows,
                    {handle.shape.begin(), handle.shape.end()});
}

}  // namespace

void define_sweeps(py::module_& module) {
  py::class_<SweepRequest>(module, "SweepRequest")
      .def(py::init<>())
      .def_readwrite("over", &SweepRequest::over)
      .def_readwrite("zips", &SweepRequest::zips)
      .def_readwrite("observables", &SweepRequest::observables)
      .def_readwrite("repeats", &SweepRequest::repeats)
      .def_readwrite("refine", &SweepRequest::refine)
      .def_readwrite("refine_along", &SweepRequest::refine_along)
      .def_readwrite("refine_to", &SweepRequest::refine_to)
      .def_readwrite("continues", &SweepRequest::continues)
      .def_readwrite("threads", &SweepRequest::threads)
      .def_readwrite("folder", &SweepRequest::folder)
      .def_readwrite("journal", &SweepRequest::journal)
      .def_readwrite("force", &SweepRequest::force)
      .def_readwrite("progress", &SweepRequest::progress)
      .def_readwrite("run_points", &SweepRequest::run_points);
  py::class_<SweepRound>(module, "SweepRound")
      .def_property_readonly("identity", &SweepRound::identity)
      .def_property_readonly("missing", &SweepRound::missing)
      .def("take", &SweepRound::take)
      .def("keep", &SweepRound::keep)
      .def("progress", [](const SweepRound& it) {
        const SweepProgress now = it.progress();
        return py::make_tuple(sweep_progress_text(now), now.with_row(), now.points);
      });
  py::class_<WorkerPlan>(module, "WorkerPlan")
      .def(py::init<const SceneHandle&, const SweepRequest&>())
      .def_property_readonly("identity", [](const WorkerPlan& it) { return it.plan.identity(); })
      .def("run", &WorkerPlan::run);
  py::class_<SweepHandle>(module, "Sweep")
      .def_readonly("columns", &SweepHandle::columns)
      .def_readonly("shape", &SweepHandle::shape)
      .def_readonly("status", &SweepHandle::status)
      .def_readonly("reasons", &SweepHandle::reasons)
      .def_readonly("summary_json", &SweepHandle::summary)
      .def_readonly("complete", &SweepHandle::complete)
      .def("axes", &axes_of)
      .def("column", &column_of);
  module.def("sweep", &sweep);
}

}  // namespace tomlin::python
