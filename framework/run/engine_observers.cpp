#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "framework/run/engine.hpp"
#include "framework/scene/text.hpp"

/// What observers of the scene are shown and what becomes of their numbers.
namespace tomlin {
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

}  // namespace

void Engine::bind_observers() {
  for (const SceneObserver& from : scene_->observers) {
    SceneOutline outline;
    outline.dimension = model_.dimension();
    for (const std::size_t b : from.bodies) {
      const BoundBody<double>& body = model_.bodies()[b].bound;
      outline.bodies.push_back(
          {body.name, static_cast<std::int64_t>(body.slot.count), body.closed});
    }
    Watcher watcher;
    watcher.scene = &from;
    watcher.bodies = from.bodies;
    watcher.columns = bound_by(from, "observer", [&] { return columns_of(from, outline); });
    for (const ObservedNumber& number : watcher.columns) {
      watcher.quantities.push_back(std::make_shared<const ResultQuantity>(ResultQuantity{
          number.name, dimension::none, Shape::number, Scope::end, "at the end", number.unit}));
      watcher.quantities.push_back(std::make_shared<const ResultQuantity>(
          ResultQuantity{"mean_" + number.name, dimension::none, Shape::number, Scope::window,
                         "mean over the samples in the window", number.unit}));
    }
    watchers_.push_back(std::move(watcher));
  }
  if (watchers_.empty()) return;
  observed_.assign(observed_numbers(), 0.0);
  for (const Model::Body& body : model_.bodies()) {
    const std::size_t numbers = body.bound.slot.count * model_.dimension();
    seen_places_.emplace_back(numbers);
    seen_velocities_.emplace_back(numbers);
  }
}

std::size_t Engine::observed_numbers() const {
  std::size_t count = 0;
  for (const Watcher& watcher : watchers_) count += watcher.columns.size();
  return count;
}

void Engine::list_observed(std::vector<SampleColumn>& columns) const {
  for (const Watcher& watcher : watchers_) {
    for (const ObservedNumber& number : watcher.columns) {
      columns.push_back({watcher.scene->name + "." + number.name, number.unit});
    }
  }
}

/// The numbers of all observers at a state that has just been evaluated. How many there are.
std::size_t Engine::observe(double at, const double* position, const double* velocity,
                            double* numbers) {
  const auto axes = static_cast<std::size_t>(model_.dimension());
  const SystemView<double>& view = model_.system().view;
  for (std::size_t b = 0; b < model_.bodies().size(); ++b) {
    const BodySlot<double>& slot = model_.bodies()[b].bound.slot;
    model_.place_particles(b, position, seen_places_[b].data());
    const double* from = (slot.mapped ? view.mapped_velocity : velocity) + slot.offset;
    for (std::size_t i = 0; i < slot.count; ++i) {
      for (std::size_t d = 0; d < axes; ++d) {
        seen_velocities_[b][i * axes + d] = from[d * slot.stride + i];
      }
    }
  }
  double* next = numbers;
  for (const Watcher& watcher : watchers_) {
    shown_.clear();
    for (const std::size_t b : watcher.bodies) {
      const BoundBody<double>& body = model_.bodies()[b].bound;
      shown_.push_back({body.name, body.mass, seen_places_[b], seen_velocities_[b]});
    }
    const std::span<double> own(next, watcher.columns.size());
    std::fill(own.begin(), own.end(), std::numeric_limits<double>::quiet_NaN());
    in_observer(*watcher.scene, [&] {
      watcher.scene->record->observe(watcher.scene->description.get(),
                                     {at, model_.dimension(), shown_}, own);
    });
    next += watcher.columns.size();
  }
  return static_cast<std::size_t>(next - numbers);
}

/// A table has no room for what is no number: the run ends there.
bool Engine::are_finite(const double* numbers) {
  for (const Watcher& watcher : watchers_) {
    for (const ObservedNumber& column : watcher.columns) {
      if (std::isfinite(*numbers++)) continue;
      RunFailure failure;
      failure.step = steps();
      failure.time = time();
      failure.what = "the observer " + watcher.scene->name + " gives " + column.name +
                     ", which is not a finite number";
      failure.cause = "what it looks at, or its code";
      if (!failure_) failure_ = std::move(failure);
      return false;
    }
  }
  return true;
}

/// Sums of what lies in the window, high and low parts.
void Engine::keep_means(double at, const double* numbers) {
  if (at < from_.time || at > to_.time) return;
  ++*observed_count_;
  for (std::size_t k = 0; k < observed_.size(); ++k) {
    const DoubleDouble sum =
        DoubleDouble(observed_sums_[2 * k], observed_sums_[2 * k + 1]) + numbers[k];
    observed_sums_[2 * k] = sum.hi;
    observed_sums_[2 * k + 1] = sum.lo;
  }
}

/// Means of samples of equal weight; none without `[output] every`, and in a run until it is
/// steady.
void Engine::observer_results(std::vector<ResultGroup>& groups) const {
  const bool any = *observed_count_ > 0 && plan_.period == 0.0;
  const auto finite = [](double number) -> std::optional<double> {
    if (!std::isfinite(number)) return {};
    return number;
  };
  std::size_t k = 0;
  for (const Watcher& watcher : watchers_) {
    ResultGroup& group = groups.emplace_back(ResultGroup{"observers", watcher.scene->name, {}});
    for (const auto& quantity : watcher.quantities) group.add_row(quantity);
    for (std::size_t n = 0; n < watcher.columns.size(); ++n, ++k) {
      if (const auto value = finite(observed_[k])) group.values[2 * n].set({&*value, 1});
      if (!any) continue;
      const auto mean = finite(observed_sums_[2 * k] / static_cast<double>(*observed_count_));
      if (mean) group.values[2 * n + 1].set({&*mean, 1});
    }
  }
}

}  // namespace tomlin
