#include "framework/study/compare.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "framework/model/model.hpp"
#include "framework/model/scales.hpp"
#include "framework/run/results/observables.hpp"
#include "framework/scene/title.hpp"
#include "framework/study/accuracy/accuracy.hpp"
#include "framework/study/tradeoff/variants.hpp"

namespace tomlin {
namespace {

/// Relative tolerance for numbers that are meant to be equal and were computed from parameters.
constexpr double kRoundingOfParameters = 1e-9;
constexpr std::size_t kPointsOfOverlay = 1000;

/// Properties that make models comparable, and those that may differ.
struct Setup {
  std::vector<double> periods;   ///< of all forces along the pull, ascending, each once
  std::vector<double> velocity;  ///< of the only driver; empty where none moves steadily
  double stick_slip = 0.0;       ///< curvature over stiffness; 0: not known
  std::size_t coordinates = 0;
};

bool same(double a, double b) {
  return std::abs(a - b) <= kRoundingOfParameters * std::max(std::abs(a), std::abs(b));
}

bool same(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](double x, double y) { return same(x, y); });
}

Setup setup_of(const std::shared_ptr<const Scene>& scene) {
  Setup setup;
  const Model model(scene);
  setup.coordinates = model.coordinate_count();
  for (const Model::Driver& driver : model.drivers()) {
    if (driver.drive == nullptr || !driver.drive->steady) continue;
    setup.velocity = driver.drive->velocity;
  }
  // Axes that not all have are left out: a tip on a line has no y.
  while (!setup.velocity.empty() && setup.velocity.back() == 0.0) setup.velocity.pop_back();
  const auto axis = static_cast<int>(
      std::max_element(setup.velocity.begin(), setup.velocity.end(),
                       [](double a, double b) { return std::abs(a) < std::abs(b); }) -
      setup.velocity.begin());
  for (const SceneForce& force : scene->forces) {
    const double period = force.record->period(force.description.get(), axis);
    if (period > 0.0) setup.periods.push_back(period);
  }
  std::sort(setup.periods.begin(), setup.periods.end());
  setup.periods.erase(std::unique(setup.periods.begin(), setup.periods.end()), setup.periods.end());
  for (const Sliding& sliding : scales_of(scene).sliding) setup.stick_slip = sliding.stick_slip();
  return setup;
}

double size_of(const std::vector<double>& vector) {
  double square = 0.0;
  for (const double part : vector) square += part * part;
  return std::sqrt(square);
}

std::string listed(const std::vector<double>& numbers) {
  return numbers.empty() ? "none" : fmt::format("{:g}", fmt::join(numbers, ", "));
}

[[noreturn]] void refuse(const Scene& scene, const Scene& first, const std::string& what,
                         const std::vector<double>& found, const std::vector<double>& expected) {
  throw InputError(
      {Fault(FaultCode::compare_different_setups, scene.run.location, what, listed(found),
             fmt::format("not comparable with {}", first.file), listed(expected))});
}

/// Throws unless all are driven alike over like substrates; notes what else differs.
void check_setups(const std::vector<std::shared_ptr<const Scene>>& scenes,
                  const std::vector<Setup>& setups, std::vector<std::string>& notes) {
  for (std::size_t k = 1; k < scenes.size(); ++k) {
    const Scene& first = *scenes.front();
    if (scenes[k]->units != first.units) {
      throw InputError(
          {Fault(FaultCode::compare_different_setups, scenes[k]->run.location, "scene.units",
                 to_string(scenes[k]->units), fmt::format("not comparable with {}", first.file),
                 to_string(first.units))});
    }
    const std::vector<double>& periods = setups[k].periods;
    const std::vector<double>& velocity = setups[k].velocity;
    if (!same(periods, setups.front().periods)) {
      // A sheet of atoms declares none.
      if (!periods.empty() && !setups.front().periods.empty()) {
        refuse(*scenes[k], first, "lattice periods", periods, setups.front().periods);
      }
      notes.push_back(fmt::format("declared lattice periods: {} in {}, {} in {}",
                                  listed(setups.front().periods), first.file, listed(periods),
                                  scenes[k]->file));
    }
    if (!same(velocity, setups.front().velocity)) {
      // Axes of scenes of other dimensions may have other names.
      if (scenes[k]->dimension == first.dimension ||
          !same(size_of(velocity), size_of(setups.front().velocity))) {
        refuse(*scenes[k], first, "driving velocity", velocity, setups.front().velocity);
      }
      notes.push_back(fmt::format("driving velocity: {} in {}, {} in {}",
                                  listed(setups.front().velocity), first.file, listed(velocity),
                                  scenes[k]->file));
    }
    if (scenes[k]->run.dynamics != first.run.dynamics) {
      notes.push_back(fmt::format("dynamics: {} in {}, {} in {}", to_string(first.run.dynamics),
                                  first.file, to_string(scenes[k]->run.dynamics), scenes[k]->file));
    }
    if (!same(setups[k].stick_slip, setups.front().stick_slip)) {
      notes.push_back(fmt::format(
          "substrate curvature over driver stiffness: {:g} in {}, {:g} in {}",
          setups.front().stick_slip, first.file, setups[k].stick_slip, scenes[k]->file));
    }
  }
}

/// "driver.mean_force.x" where the only driver goes by another name, and "body.turns" likewise.
std::string path_in(const RunResult& result, const std::string& path) {
  const auto replaced = [&](std::string_view word, const auto& all) -> std::optional<std::string> {
    for (const std::string& start :
         {std::string(word) + ".", std::string(word) + "s." + std::string(word) + "."}) {
      if (!path.starts_with(start) || all.size() != 1 || all.front().name == word) continue;
      return std::string(word == "body" ? "bodies" : "drivers") + "." + all.front().name + "." +
             path.substr(start.size());
    }
    return std::nullopt;
  };
  if (const auto driver = replaced("driver", result.family("drivers"))) return *driver;
  if (const auto body = replaced("body", result.family("bodies"))) return *body;
  return path;
}

/// Keeps what the overlay shows.
class Trace : public RunSink {
 public:
  explicit Trace(const std::vector<double>& velocity) {
    speed_ = size_of(velocity);
    for (std::size_t d = 0; d < velocity.size(); ++d) along_[d] = velocity[d] / speed_;
  }

  void begin(const RunLayout& layout) override {
    static constexpr std::array kForceComponents = {".force.x", ".force.y", ".force.z"};
    for (std::size_t c = 0; c < layout.columns.size(); ++c) {
      for (std::size_t d = 0; d < kForceComponents.size(); ++d) {
        if (layout.columns[c].name.ends_with(kForceComponents[d]) && columns_[d] == 0)
          columns_[d] = c;
      }
    }
  }

  void sample(const std::vector<double>& row) override {
    time.push_back(row.front());
    double pull = 0.0;
    for (std::size_t d = 0; d < columns_.size(); ++d) {
      if (columns_[d] > 0) pull += along_[d] * row[columns_[d]];
    }
    force.push_back(pull);
  }

  double speed() const { return speed_; }

  std::vector<double> time;
  std::vector<double> force;

 private:
  double speed_ = 0.0;
  std::array<double, 3> along_{};
  std::array<std::size_t, 3> columns_{};
};

/// A run has some thousand samples, at ends of steps: some schemes know no others.
double sampling_interval(const Scene& scene) {
  const double every = scene.run.duration / static_cast<double>(4 * kPointsOfOverlay);
  const auto& integrator = scene.run.integrator;
  const double dt = integrator.record->step(integrator.description.get());
  return dt > 0.0 ? std::max(1.0, std::round(every / dt)) * dt : every;
}

ComparedModel run_model(const std::shared_ptr<const Scene>& scene, const Setup& setup,
                        const CompareRequest& request) {
  ComparedModel model;
  model.file = scene->file;
  model.name = title_of(*scene);
  model.bodies = scene->bodies.size();
  for (const SceneBody& body : scene->bodies) {
    model.particles += static_cast<std::size_t>(body.record->count(body.description.get()));
  }
  model.coordinates = setup.coordinates;

  // Samples do not change the steps, so the scene may have its own interval.
  auto sampled = std::make_shared<Scene>(*scene);
  sampled->output.every = sampling_interval(*scene);
  sampled->output.trajectory = false;
  Trace trace(setup.velocity);
  RunOptions options;
  options.stop = request.stop;
  if (!setup.velocity.empty()) options.sink = &trace;
  model.result = run_with_errors(sampled, options);
  if (model.result.status != RunStatus::finished) return model;

  const std::string path = path_in(model.result, request.observable);
  model.value = observable(model.result, path, {.file = scene->file});
  const std::string full = full_path(model.result, path);
  for (const ErrorEstimate& one : model.result.errors) {
    if (one.path == full) model.error = one.error;
  }
  for (std::size_t k = 0; k < trace.time.size(); ++k) {
    if (trace.time[k] < model.result.window_from || trace.time[k] > model.result.window_to)
      continue;
    model.way.push_back(trace.speed() * trace.time[k]);
    model.force.push_back(trace.force[k]);
  }
  return model;
}

ComparedModel::Verdict verdict_on(const ComparedModel& model, const ComparedModel& reference,
                                  double tolerance) {
  using Verdict = ComparedModel::Verdict;
  if (!model.value) return Verdict::failed;
  const double size = std::abs(*reference.value);
  const double allowed = size > 0.0 ? tolerance * size : tolerance;
  const double errors = model.error.value_or(0.0) + reference.error.value_or(0.0);
  const double apart = std::abs(*model.difference);
  if (apart + errors <= allowed) return Verdict::agrees;
  return apart - errors > allowed ? Verdict::differs : Verdict::undecided;
}

/// The most coordinates; of several the most expensive.
std::optional<std::size_t> most_complete(const std::vector<ComparedModel>& models) {
  std::optional<std::size_t> found;
  for (std::size_t k = 0; k < models.size(); ++k) {
    if (!found || std::pair(models[k].coordinates, models[k].cost()) >
                      std::pair(models[*found].coordinates, models[*found].cost())) {
      found = k;
    }
  }
  return found && models[*found].value ? found : std::nullopt;
}

void judge(Comparison& comparison) {
  comparison.reference = most_complete(comparison.models);
  if (!comparison.reference) return;
  const ComparedModel& reference = comparison.models[*comparison.reference];
  std::optional<std::pair<std::size_t, std::uint64_t>> least;
  for (std::size_t k = 0; k < comparison.models.size(); ++k) {
    ComparedModel& model = comparison.models[k];
    if (model.value) model.difference = *model.value - *reference.value;
    const bool itself = k == *comparison.reference;
    model.verdict = itself ? ComparedModel::Verdict::reference
                           : verdict_on(model, reference, comparison.tolerance);
    if (!itself && model.verdict != ComparedModel::Verdict::agrees) continue;
    const std::pair size(model.coordinates, model.cost());
    if (!least || size < *least) {
      least = size;
      comparison.simplest = k;
    }
  }
}

}  // namespace

Comparison compare_models(const std::vector<std::shared_ptr<const Scene>>& scenes,
                          const CompareRequest& request) {
  Comparison comparison;
  comparison.observable = request.observable;
  comparison.tolerance = request.tolerance;
  comparison.units = scenes.front()->units;
  std::vector<Setup> setups;
  setups.reserve(scenes.size());
  for (const auto& scene : scenes) setups.push_back(setup_of(scene));
  check_setups(scenes, setups, comparison.notes);
  for (std::size_t k = 0; k < scenes.size(); ++k) {
    if (request.on_progress) request.on_progress(scenes[k]->file);
    comparison.models.push_back(run_model(scenes[k], setups[k], request));
    if (comparison.models.back().result.status == RunStatus::interrupted) {
      comparison.interrupted = true;
      return comparison;
    }
  }
  judge(comparison);
  return comparison;
}

}  // namespace tomlin
