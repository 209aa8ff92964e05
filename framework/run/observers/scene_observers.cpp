#include "framework/run/observers/scene_observers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tomlin::observers {
namespace {

std::shared_ptr<const ResultQuantity> quantity(const std::string& key, const ObservedNumber& number,
                                               Scope scope, const char* meaning) {
  return std::make_shared<const ResultQuantity>(
      ResultQuantity{key, dimension_of(number), Shape::number, scope, meaning, number.unit});
}

}  // namespace

SceneObservers::SceneObservers(const ObserverParts& parts) : parts_(parts), shown_(parts) {
  const Model& model = parts_.run.model;
  std::size_t numbers = 0;
  for (const SceneObserver& from : parts_.run.scene->observers) {
    if (from.record->columns == nullptr) continue;
    Watcher watcher;
    watcher.scene = &from;
    watcher.columns = bound_by(from, "observer", [&] {
      return listed(from, outline_of(from, model), from.record->columns);
    });
    for (const ObservedNumber& number : watcher.columns) {
      watcher.quantities.push_back(quantity(number.name, number, Scope::end, "at the end"));
      watcher.quantities.push_back(quantity("mean_" + number.name, number, Scope::window,
                                            "mean over the samples in the window"));
      units_.push_back(scene_unit(parts_.run.scene->units, dimension_of(number)));
    }
    numbers += watcher.columns.size();
    watchers_.push_back(std::move(watcher));
  }
  last_.assign(numbers, std::numeric_limits<double>::quiet_NaN());
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
      columns.push_back({watcher.scene->name + "." + number.name,
                         unit_in_tables(parts_.run.scene->units, number.unit)});
    }
  }
}

void SceneObservers::observe(const RunMoment& moment, double* numbers) {
  shown_.look(moment);
  for (const Watcher& watcher : watchers_) {
    const std::span<double> own(numbers, watcher.columns.size());
    std::fill(own.begin(), own.end(), std::numeric_limits<double>::quiet_NaN());
    in_observer(*watcher.scene, [&] {
      watcher.scene->record->observe(watcher.scene->description.get(), shown_.to(*watcher.scene),
                                     own);
    });
    numbers += watcher.columns.size();
  }
}

double* SceneObservers::sample(const RunMoment& moment, double* numbers) {
  observe(moment, numbers);
  const double* next = numbers;
  for (const Watcher& watcher : watchers_) {
    if (!are_finite(parts_.run, *watcher.scene, watcher.columns, next)) return nullptr;
    next += watcher.columns.size();
  }
  keep_means(moment.time, numbers);
  for (const double unit : units_) *numbers++ /= unit;
  return numbers;
}

/// Sums of what lies in the window, high and low parts.
void SceneObservers::keep_means(double time, const double* numbers) {
  if (!parts_.window.contains(time)) return;
  ++*samples_;
  for (std::size_t k = 0; k < last_.size(); ++k) add_to(sums_ + 2 * k, numbers[k]);
}

void SceneObservers::stopped(const RunMoment& end) {
  std::vector<double> numbers(last_.size());
  observe(end, numbers.data());
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
