#include "framework/run/observers/scene_observers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "framework/scene/text.hpp"

namespace tomlin::observers {
namespace {

/// In the code of a plugin, or of the program.
template <class Action>
auto in_observer(const SceneObserver& observer, Action action) {
  if (observer.record->library.empty()) return action();
  return in_plugin("observer " + observer.name, observer.record->library, action);
}

std::vector<ObservedNumber> columns_of(const SceneObserver& from, const SceneOutline& outline) {
  std::vector<ObservedNumber> columns = from.record->columns(from.description.get(), outline);
  std::set<std::string> names;
  for (const ObservedNumber& column : columns) {
    if (!is_component_name(column.name) || !names.insert(column.name).second) {
      throw std::invalid_argument("\"" + column.name +
                                  "\" is no name of a number, or not the only");
    }
  }
  if (columns.empty()) throw std::invalid_argument("it gives no numbers");
  return columns;
}

std::shared_ptr<const ResultQuantity> quantity(const std::string& key, const ObservedNumber& number,
                                               Scope scope, const char* meaning) {
  return std::make_shared<const ResultQuantity>(
      ResultQuantity{key, dimension::none, Shape::number, scope, meaning, number.unit});
}

}  // namespace

SceneObservers::SceneObservers(const ObserverParts& parts) : parts_(parts) {
  const Model& model = parts_.run.model;
  std::size_t numbers = 0;
  for (const SceneObserver& from : parts_.run.scene->observers) {
    SceneOutline outline;
    outline.dimension = model.dimension();
    for (const std::size_t b : from.bodies) {
      const BoundBody<double>& body = model.bodies()[b].bound;
      outline.bodies.push_back(
          {body.name, static_cast<std::int64_t>(body.slot.count), body.closed});
    }
    Watcher watcher;
    watcher.scene = &from;
    watcher.bodies = from.bodies;
    watcher.columns = bound_by(from, "observer", [&] { return columns_of(from, outline); });
    for (const ObservedNumber& number : watcher.columns) {
      watcher.quantities.push_back(quantity(number.name, number, Scope::end, "at the end"));
      watcher.quantities.push_back(quantity("mean_" + number.name, number, Scope::window,
                                            "mean over the samples in the window"));
    }
    numbers += watcher.columns.size();
    watchers_.push_back(std::move(watcher));
  }
  if (watchers_.empty()) return;
  last_.assign(numbers, std::numeric_limits<double>::quiet_NaN());
  for (const Model::Body& body : model.bodies()) {
    places_.emplace_back(body.bound.slot.count * parts_.axes());
    velocities_.emplace_back(body.bound.slot.count * parts_.axes());
  }
}

void SceneObservers::declare(StateLayout& layout) const {
  layout.add_reals("observed.sums", 2 * last_.size());
  layout.add_integers("observed.count", 1);
}

void SceneObservers::attach(RunState& state) {
  sums_ = state.reals("observed.sums");
  samples_ = state.integers("observed.count");
}

void SceneObservers::list_columns(std::vector<SampleColumn>& columns) const {
  for (const Watcher& watcher : watchers_) {
    for (const ObservedNumber& number : watcher.columns) {
      columns.push_back({watcher.scene->name + "." + number.name, number.unit});
    }
  }
}

void SceneObservers::observe(double time, const double* position, const double* velocity,
                             double* numbers) {
  const Model& model = parts_.run.model;
  const std::size_t axes = parts_.axes();
  const SystemView<double>& view = model.system().view;
  for (std::size_t b = 0; b < model.bodies().size(); ++b) {
    const BodySlot<double>& slot = model.bodies()[b].bound.slot;
    model.place_particles(b, position, places_[b].data());
    const double* from = (slot.mapped ? view.mapped_velocity : velocity) + slot.offset;
    for (std::size_t i = 0; i < slot.count; ++i) {
      for (std::size_t d = 0; d < axes; ++d) {
        velocities_[b][i * axes + d] = from[d * slot.stride + i];
      }
    }
  }
  for (const Watcher& watcher : watchers_) {
    shown_.clear();
    for (const std::size_t b : watcher.bodies) {
      const BoundBody<double>& body = model.bodies()[b].bound;
      shown_.push_back({body.name, body.mass, places_[b], velocities_[b]});
    }
    const std::span<double> own(numbers, watcher.columns.size());
    std::fill(own.begin(), own.end(), std::numeric_limits<double>::quiet_NaN());
    in_observer(*watcher.scene, [&] {
      watcher.scene->record->observe(watcher.scene->description.get(),
                                     {time, model.dimension(), shown_}, own);
    });
    numbers += watcher.columns.size();
  }
}

double* SceneObservers::sample(double time, const double* position, const double* velocity,
                               double* numbers) {
  observe(time, position, velocity, numbers);
  if (!are_finite(numbers)) return nullptr;
  keep_means(time, numbers);
  return numbers + last_.size();
}

/// A table has no room for what is no number: the run ends there.
bool SceneObservers::are_finite(const double* numbers) {
  RunContext& run = parts_.run;
  for (const Watcher& watcher : watchers_) {
    for (const ObservedNumber& column : watcher.columns) {
      if (std::isfinite(*numbers++)) continue;
      RunFailure failure;
      failure.step = static_cast<std::uint64_t>(run.clock.steps());
      failure.time = run.clock.time();
      failure.what = "the observer " + watcher.scene->name + " gives " + column.name +
                     ", which is not a finite number";
      failure.cause = "what it looks at, or its code";
      if (!run.outcome.failure) run.outcome.failure = std::move(failure);
      return false;
    }
  }
  return true;
}

/// Sums of what lies in the window, high and low parts.
void SceneObservers::keep_means(double time, const double* numbers) {
  if (!parts_.window.contains(time)) return;
  ++*samples_;
  for (std::size_t k = 0; k < last_.size(); ++k) {
    const DoubleDouble sum = DoubleDouble(sums_[2 * k], sums_[2 * k + 1]) + numbers[k];
    sums_[2 * k] = sum.hi;
    sums_[2 * k + 1] = sum.lo;
  }
}

void SceneObservers::stopped(const RunEnd&) {
  const SystemView<double>& view = parts_.run.model.system().view;
  std::vector<double> numbers(last_.size());
  observe(parts_.run.clock.time(), view.position, view.velocity, numbers.data());
  last_ = numbers;
}

/// Means of samples of equal weight; none without `[output] every`, and in a run until it is
/// steady.
void SceneObservers::results(ResultTable& table, const double*) const {
  const bool any = *samples_ > 0 && parts_.run.plan.period == 0.0;
  const auto set = [](ResultValue& value, double number) {
    if (std::isfinite(number)) value.set({&number, 1});
  };
  std::size_t k = 0;
  for (const Watcher& watcher : watchers_) {
    ResultGroup& group = table.group("observers", watcher.scene->name);
    for (const auto& quantity : watcher.quantities) group.add_row(quantity);
    for (std::size_t n = 0; n < watcher.columns.size(); ++n, ++k) {
      set(group.values[2 * n], last_[k]);
      if (any) set(group.values[2 * n + 1], sums_[2 * k] / static_cast<double>(*samples_));
    }
  }
}

}  // namespace tomlin::observers
