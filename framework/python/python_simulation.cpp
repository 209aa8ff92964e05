#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "framework/python/handles.hpp"
#include "framework/run/context.hpp"
#include "framework/run/engine.hpp"
#include "framework/study/accuracy/pilot.hpp"

namespace tomlin::python {
namespace {

/// A run that waits between steps.
class Simulation {
 public:
  explicit Simulation(SceneHandle scene);

  double time() const { return engine_->time(); }
  std::uint64_t steps() const { return engine_->steps(); }
  bool done() const { return engine_->done(); }
  double duration() const { return engine_->context().plan.duration; }
  /// Up to the first end of a step at this time or later, or through so many steps. False when it
  /// was stopped by Ctrl-C.
  bool advance(double to, std::uint64_t most_steps);

  // These hold all particles, [particle][axis], in memory that stays where it is.
  const std::vector<double>& positions();
  const std::vector<double>& velocities();
  const std::vector<double>& forces();
  std::vector<double> driver_force(std::size_t driver);
  double kinetic_energy();
  double potential_energy();

  std::vector<std::string> drivers() const;
  std::vector<std::pair<std::string, std::size_t>> bodies() const;
  int dimension() const { return scene_.scene->dimension; }
  std::size_t particles() const {
    return positions_.size() / static_cast<std::size_t>(dimension());
  }

  /// A saved state, which restore() takes.
  struct State {
    std::vector<std::byte> numbers;
    std::pair<std::size_t, std::size_t> kept;  ///< numbers of samples, and events, before it
    bool is_over = false;                      ///< the run ended from here without a stop
  };
  State state();
  void restore(const State& state);
  /// Returns the result; that of a run that is not over is as if it were interrupted here.
  std::unique_ptr<RunHandle> result();
  const MemorySink& kept() const { return kept_; }

  /// One thread at a time.
  class Use {
   public:
    explicit Use(Simulation& simulation) : busy_(simulation.busy_) {
      if (busy_.exchange(true)) {
        throw std::runtime_error("another thread is using this simulation");
      }
    }
    ~Use() { busy_ = false; }
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    std::atomic<bool>& busy_;
  };

 private:
  bool take_steps(double to, std::uint64_t most_steps, std::atomic<bool>& stop,
                  ProgressCall* signals);
  bool has_more_than_numbers() const;
  std::vector<std::byte> numbers();
  void evaluate();
  void read(const double* of_coordinates, const double* mapped, std::vector<double>& into) const;
  RunOptions options(RunSink& sink, const std::vector<std::byte>* resume_from) const;
  std::unique_ptr<RunHandle> handle_of(RunResult result) const;

  SceneHandle scene_;
  std::shared_ptr<const Scene> as_run_;
  MemorySink kept_;
  std::unique_ptr<Engine> engine_;
  std::unique_ptr<RunResult> end_;  ///< of a run that is over
  State before_;  ///< that what is over is made again from, where its numbers are not enough
  std::vector<double> positions_;
  std::vector<double> velocities_;
  std::vector<double> forces_;
  std::vector<double> rates_;
  std::vector<double> drift_;
  std::atomic<bool> busy_{false};
};

Simulation::Simulation(SceneHandle scene) : scene_(std::move(scene)), as_run_(scene_.scene) {
  const Unlocked unlocked;
  if (as_run_->run.accuracy) as_run_ = choose_integrator(as_run_, *scene_.registry).scene;
  engine_ = std::make_unique<Engine>(as_run_, options(kept_, nullptr));
  std::size_t count = 0;
  for (const auto& [name, particles] : bodies()) count += particles;
  count *= static_cast<std::size_t>(dimension());
  for (std::vector<double>* all : {&positions_, &velocities_, &forces_}) all->assign(count, 0.0);
  const SystemView<double>& view = engine_->model().system().view;
  rates_.assign(view.rates + 2 * kGroup, 0.0);
  drift_.assign(view.dofs, 0.0);
}

RunOptions Simulation::options(RunSink& sink, const std::vector<std::byte>* resume_from) const {
  RunOptions all;
  all.sink = &sink;
  all.resume_from = resume_from;
  return all;
}

bool Simulation::advance(double to, std::uint64_t most_steps) {
  InterruptGuard guard;
  ProgressCall signals{py::none()};
  const bool is_there = without_lock([&] {
    if (has_more_than_numbers() && !done()) before_ = {numbers(), kept_.size(), true};
    return take_steps(to, most_steps, guard.stop(), &signals);
  });
  signals.rethrow();
  return is_there;
}

/// Handlers of signals are called every so often, between two steps.
bool Simulation::take_steps(double to, std::uint64_t most_steps, std::atomic<bool>& stop,
                            ProgressCall* signals) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::milliseconds kSignalInterval{50};
  constexpr std::uint64_t kMostAtOnce = std::uint64_t{1} << 32;  // steps; doubled, still a number
  std::uint64_t at_once = 1;
  auto last_look = Clock::now();
  const double dt = engine_->context().plan.dt;
  const double early = dt > 0.0 ? kNoStep * dt : 0.0;
  const std::uint64_t last = engine_->steps() + std::min(most_steps, ~engine_->steps());
  while (!engine_->done() && engine_->steps() < last && engine_->time() < to - early) {
    if (stop) return false;
    std::uint64_t most = last - engine_->steps();
    // Adaptive schemes choose steps of unknown length: they take one at a time.
    const double left = dt > 0.0 ? std::ceil((to - early - engine_->time()) / dt) : 1.0;
    if (left < static_cast<double>(most)) {
      most = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(left));
    }
    const auto before = Clock::now();
    engine_->advance(std::min(most, at_once));
    const auto after = Clock::now();
    at_once = after - before < kSignalInterval / 4 ? std::min(2 * at_once, kMostAtOnce)
                                                   : std::max<std::uint64_t>(1, at_once / 2);
    if (signals == nullptr || !*signals || after - last_look < kSignalInterval) continue;
    last_look = after;
    (*signals)(stop);
  }
  // Whether a run is over shows where its next step would be.
  if (!engine_->done() && engine_->time() >= engine_->context().plan.duration) {
    engine_->advance(1);
  }
  return true;
}

void Simulation::evaluate() {
  Model& model = engine_->model();
  const SystemView<double>& view = model.system().view;
  model.evaluate_at(engine_->context().clock.now(), view.position, view.velocity, view.integrals,
                    rates_.data());
}

/// `mapped`: of bodies whose particles follow from few coordinates.
void Simulation::read(const double* of_coordinates, const double* mapped,
                      std::vector<double>& into) const {
  const auto axes = static_cast<std::size_t>(dimension());
  double* next = into.data();
  for (const Model::Body& body : engine_->model().bodies()) {
    const BodySlot<double>& slot = body.bound.slot;
    const double* from = (slot.mapped ? mapped : of_coordinates) + slot.offset;
    for (std::size_t i = 0; i < slot.count; ++i) {
      for (std::size_t d = 0; d < axes; ++d) *next++ = from[d * slot.stride + i];
    }
  }
}

const std::vector<double>& Simulation::positions() {
  evaluate();
  Model& model = engine_->model();
  double* next = positions_.data();
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    next = model.place_particles(b, model.system().view.position, next);
  }
  return positions_;
}

const std::vector<double>& Simulation::velocities() {
  evaluate();
  const Model& model = engine_->model();
  const SystemView<double>& view = model.system().view;
  if (view.inertial) {
    read(view.velocity, view.mapped_velocity, velocities_);
  } else {
    model.drift_velocity(drift_.data());
    read(drift_.data(), view.mapped_velocity, velocities_);
  }
  return velocities_;
}

const std::vector<double>& Simulation::forces() {
  evaluate();
  const SystemView<double>& view = engine_->model().system().view;
  read(view.force, view.mapped_force, forces_);
  return forces_;
}

std::vector<double> Simulation::driver_force(std::size_t driver) {
  evaluate();
  const auto first = engine_->model().drivers().at(driver).first_rate;
  const double* from = rates_.data() + first;
  return {from, from + dimension()};
}

double Simulation::kinetic_energy() {
  const Model& model = engine_->model();
  return model.kinetic_energy(model.system().view.position, model.system().view.velocity);
}

double Simulation::potential_energy() {
  Model& model = engine_->model();
  const SystemView<double>& view = model.system().view;
  return model.potential_energy(engine_->context().clock.now(), view.position, view.velocity,
                                view.integrals);
}

std::vector<std::string> Simulation::drivers() const {
  std::vector<std::string> names;
  for (const Model::Driver& driver : engine_->model().drivers()) names.push_back(driver.name);
  return names;
}

std::vector<std::pair<std::string, std::size_t>> Simulation::bodies() const {
  std::vector<std::pair<std::string, std::size_t>> all;
  for (const Model::Body& body : engine_->model().bodies()) {
    all.emplace_back(body.bound.name, body.bound.slot.count);
  }
  return all;
}

/// Quasistatic runs, and those until something, know more at their end than a checkpoint has.
bool Simulation::has_more_than_numbers() const {
  return engine_->context().path != nullptr || as_run_->run.until;
}

/// All that the run goes on from.
std::vector<std::byte> Simulation::numbers() {
  RunContext& run = engine_->context();
  run.clock.keep_cost(run.model.system(), run.integrator->evaluations_ahead());
  return run.state.to_bytes();
}

Simulation::State Simulation::state() {
  const RunOutcome& outcome = engine_->context().outcome;
  if (end_ || (outcome.ended && has_more_than_numbers())) return before_;
  return {numbers(), kept_.size(), outcome.ended};
}

void Simulation::restore(const State& state) {
  const Unlocked unlocked;
  // An engine that has failed or ended does not go on.
  engine_ = std::make_unique<Engine>(as_run_, options(kept_, &state.numbers));
  kept_.cut_to(state.kept);
  end_.reset();
  if (!state.is_over) return;
  before_ = state;
  std::atomic<bool> stop{false};
  take_steps(std::numeric_limits<double>::infinity(), ~std::uint64_t{0}, stop, nullptr);
}

std::unique_ptr<RunHandle> Simulation::handle_of(RunResult result) const {
  auto handle = std::make_unique<RunHandle>();
  handle->scene = scene_;
  handle->as_run = as_run_;
  handle->result = std::move(result);
  handle->kept = kept_;
  return handle;
}

std::unique_ptr<RunHandle> Simulation::result() {
  if (engine_->done()) {
    if (!end_) {
      before_ = state();  // what is left open at the end is closed then
      end_ = std::make_unique<RunResult>(engine_->end());
    }
    return handle_of(*end_);
  }
  const std::vector<std::byte> state = numbers();
  MemorySink nothing;
  Engine other(as_run_, options(nothing, &state));
  other.context().outcome.interrupt();
  return handle_of(other.end());
}

/// A method that one thread at a time may call.
template <class Value, class... Arguments>
auto alone(Value (Simulation::*method)(Arguments...)) {
  return [method](Simulation& it, Arguments... arguments) {
    const Simulation::Use use(it);
    return (it.*method)(arguments...);
  };
}

py::array view_of(const py::object& self, const std::vector<double>& (Simulation::*read)()) {
  auto& simulation = self.cast<Simulation&>();
  const Simulation::Use use(simulation);
  const std::vector<double>& numbers = (simulation.*read)();
  return numbers_of(self, numbers.data(),
                    {static_cast<py::ssize_t>(simulation.particles()), simulation.dimension()});
}

}  // namespace

void define_simulations(py::module_& module) {
  py::class_<Simulation>(module, "Simulation")
      .def(py::init<SceneHandle>())
      .def_property_readonly("time", &Simulation::time)
      .def_property_readonly("steps", &Simulation::steps)
      .def_property_readonly("done", &Simulation::done)
      .def_property_readonly("duration", &Simulation::duration)
      .def_property_readonly("drivers", &Simulation::drivers)
      .def_property_readonly("bodies", &Simulation::bodies)
      .def("advance",
           [](Simulation& it, double to, std::uint64_t steps) {
             const Simulation::Use use(it);
             if (it.advance(to, steps)) return;
             PyErr_SetNone(PyExc_KeyboardInterrupt);
             throw py::error_already_set();
           })
      .def_property_readonly(
          "positions", [](const py::object& it) { return view_of(it, &Simulation::positions); })
      .def_property_readonly(
          "velocities", [](const py::object& it) { return view_of(it, &Simulation::velocities); })
      .def_property_readonly("forces",
                             [](const py::object& it) { return view_of(it, &Simulation::forces); })
      .def("driver_force", alone(&Simulation::driver_force))
      .def_property_readonly("kinetic_energy", alone(&Simulation::kinetic_energy))
      .def_property_readonly("potential_energy", alone(&Simulation::potential_energy))
      .def("save",
           [](Simulation& it) {
             const Simulation::Use use(it);
             const Simulation::State now = it.state();
             const auto& numbers = now.numbers;
             return py::make_tuple(
                 py::bytes(reinterpret_cast<const char*>(numbers.data()), numbers.size()),
                 now.kept.first, now.kept.second, now.is_over);
           })
      .def("restore",
           [](Simulation& it, const std::string& numbers, std::size_t samples, std::size_t events,
              bool is_over) {
             const Simulation::Use use(it);
             const auto* bytes = reinterpret_cast<const std::byte*>(numbers.data());
             it.restore({{bytes, bytes + numbers.size()}, {samples, events}, is_over});
           })
      .def("result", alone(&Simulation::result))
      .def("samples",
           [](Simulation& it) {
             const Simulation::Use use(it);
             const std::vector<double>& numbers = it.kept().samples();
             const auto row = static_cast<py::ssize_t>(it.kept().layout().row());
             const py::ssize_t rows = row > 0 ? static_cast<py::ssize_t>(numbers.size()) / row : 0;
             return py::array_t<double>({rows, row}, numbers.data());
           })
      .def("layout", [](const Simulation& it) { return layout_of(it.kept()); })
      .def("events", [](const Simulation& it) { return events_of(it.kept()); });
}

}  // namespace tomlin::python
