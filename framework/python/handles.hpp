#pragma once

#include <atomic>
#include <csignal>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "framework/core/records/registry.hpp"
#include "framework/run/run.hpp"
#include "framework/scene/scene.hpp"
#include "framework/scene/scene_document.hpp"

/// The extension module `tomlin._core`. The Python package in tomlin/ wraps it and adds names,
/// defaults, documentation and everything that needs no C++.
namespace tomlin::python {

namespace py = pybind11;

/// A checked scene with all that it refers to and was read from.
struct SceneHandle {
  std::shared_ptr<const Registry> registry;
  std::shared_ptr<const SceneDocument> document;
  std::vector<std::string> plugins;  ///< that were given beside the scene
  std::vector<Setting> settings;
  std::shared_ptr<const Scene> scene;
};

/// An event that outlives its run.
struct KeptEvent {
  std::string kind;
  std::string name;
  double time = 0.0;
  double duration = 0.0;
  double size = 0.0;
  double energy_lost = 0.0;
  double peak_force = 0.0;
};

/// Keeps samples and events in memory.
class MemorySink : public RunSink {
 public:
  /// Throws InputError where the samples of the run need more memory than there is.
  void begin(const RunLayout& layout) override;
  void sample(const std::vector<double>& row) override;
  void event(const Event& event) override;

  const RunLayout& layout() const { return layout_; }
  /// [sample][column, then particle and axis]
  const std::vector<double>& samples() const { return samples_; }
  const std::vector<KeptEvent>& events() const { return events_; }
  /// Numbers of samples, and events.
  std::pair<std::size_t, std::size_t> size() const { return {samples_.size(), events_.size()}; }
  /// Forgets what came later.
  void cut_to(const std::pair<std::size_t, std::size_t>& size);

 private:
  RunLayout layout_;
  std::vector<double> samples_;
  std::vector<KeptEvent> events_;
};

/// A run that has ended.
struct RunHandle {
  SceneHandle scene;
  std::shared_ptr<const Scene> as_run;  ///< with the integrator that it was run with
  RunResult result;
  MemorySink kept;  ///< of a run without a folder
};

/// Blocks for ever in a thread other than the main one if the interpreter is about to end: such a
/// thread can no longer acquire the interpreter's lock, and the process ends a little later.
void wait_for_ever_if_interpreter_ends();

/// The interpreter's lock is released while this lives.
class Unlocked {
 public:
  Unlocked() : state_(PyEval_SaveThread()) {}
  // Python may end the thread while it waits for the lock.
  ~Unlocked() noexcept(false) {
    wait_for_ever_if_interpreter_ends();
    PyEval_RestoreThread(state_);
  }
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

 private:
  PyThreadState* state_;
};

/// Returns the result of `work`, which is done with the interpreter's lock released.
template <class Work>
auto without_lock(Work work) {
  const Unlocked unlocked;
  return work();
}

bool is_main_thread();

/// Reports the progress of a call to a Python function; holds the interpreter's lock for as long as
/// that takes. In the main thread, Python's handlers of signals are called then as well. An
/// exception of either asks the run to stop, and is thrown by rethrow().
class ProgressCall {
 public:
  explicit ProgressCall(py::object callable)
      : callable_(std::move(callable)), handles_signals_(is_main_thread()) {}

  explicit operator bool() const { return handles_signals_ || !callable_.is_none(); }
  template <class... Arguments>
  void operator()(std::atomic<bool>& stop, const Arguments&... arguments) {
    wait_for_ever_if_interpreter_ends();
    const py::gil_scoped_acquire lock;
    if (thrown_) return;
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      if (!callable_.is_none()) callable_(arguments...);
    } catch (py::error_already_set& error) {
      thrown_ = std::make_unique<py::error_already_set>(error);
      stop = true;
    }
  }
  /// With the interpreter's lock.
  void rethrow() {
    if (thrown_) throw py::error_already_set(*thrown_);
  }

 private:
  py::object callable_;
  bool handles_signals_;
  std::unique_ptr<py::error_already_set> thrown_;
};

/// In the main thread of the interpreter, Ctrl-C asks a run to stop while this lives, and does
/// nothing else, unless the program has a handler of its own for it.
class InterruptGuard {
 public:
  /// With the interpreter's lock.
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  std::atomic<bool>& stop() { return stop_; }

 private:
  std::atomic<bool> stop_{false};
  std::atomic<bool>* outer_ = nullptr;
  struct sigaction before_ = {};
  bool is_set_ = false;
};

/// Any bytes as a text, as names of files may be: what is no UTF-8 is escaped.
py::str text_of(const std::string& bytes);

/// A read-only array of numbers that stand in memory of `owner`, which lives as long as the array.
py::array numbers_of(py::handle owner, const double* numbers, std::vector<py::ssize_t> shape);

/// Columns of samples, bodies of positions behind them, and the dimension.
py::dict layout_of(const MemorySink& kept);
/// A tuple for each: time, event, name, duration, size, energy lost, peak force.
py::list events_of(const MemorySink& kept);

void define_scenes(py::module_& module);
/// Figures need these beside samples: shapes, potentials, names of results.
void define_figures(py::module_& module, py::class_<SceneHandle>& scene);
void define_runs(py::module_& module);
void define_simulations(py::module_& module);
void define_sweeps(py::module_& module);

}  // namespace tomlin::python
