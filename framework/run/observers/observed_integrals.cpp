#include "framework/run/observers/observed_integrals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <utility>

#include "framework/run/observers/shown_scene.hpp"
#include "framework/scene/text.hpp"

namespace tomlin::observers {
namespace {

/// One observer of the scene.
struct Accumulator {
  const SceneObserver* scene = nullptr;
  std::vector<ObservedNumber> integrals;
  std::size_t state_size = 0;
  std::vector<std::string> events;
  std::vector<std::shared_ptr<const ResultQuantity>> quantities;
  std::vector<double> results;  ///< once the window is over
  // In the run's state.
  double* sums = nullptr;  ///< of integrals: high and low parts
  double* state = nullptr;
};

class ObservedIntegrals : public RunObserver, public NodeObserver, public StepObserver {
 public:
  explicit ObservedIntegrals(const ObserverParts& parts);
  bool any() const { return !accumulators_.empty(); }

  ObserverFacets facets() override {
    return {.at_nodes = integrands_ > 0 ? this : nullptr, .at_ends = steps_ ? this : nullptr};
  }
  void declare(StateLayout& layout) const override;
  void attach(RunState& state) override;
  void node(const RunMoment& moment, double weight) override;
  void stepped(const RunMoment& moment) override;
  void next_window() override;
  void stopped(const RunMoment& end) override;
  void results(ResultTable& table, const double* rates) const override;

 private:
  void conclude(Accumulator& accumulator);

  ObserverParts parts_;
  ShownScene shown_;
  std::vector<Accumulator> accumulators_;
  std::size_t integrands_ = 0;
  bool steps_ = false;
  std::vector<double> values_;
};

Accumulator accumulator_of(const SceneObserver& from, const Model& model) {
  const ObserverRecord& record = *from.record;
  const SceneOutline outline = outline_of(from, model);
  const void* description = from.description.get();
  Accumulator accumulator;
  accumulator.scene = &from;
  accumulator.integrals = listed(from, outline, record.integrals);
  if (record.state_size != nullptr)
    accumulator.state_size = record.state_size(description, outline);
  if (record.events != nullptr) accumulator.events = record.events(description);
  for (const std::string& event : accumulator.events) {
    if (!is_component_name(event)) {
      throw std::invalid_argument("\"" + event + "\" is no name of an event");
    }
  }
  // Samples are reported by these names.
  std::set<std::string> names;
  for (const ObservedNumber& number : listed(from, outline, record.columns)) {
    names.insert({number.name, "mean_" + number.name});
  }
  const bool as_they_are = record.results == nullptr;
  for (const ObservedNumber& number :
       as_they_are ? accumulator.integrals : listed(from, outline, record.results)) {
    if (!names.insert(number.name).second) {
      throw std::invalid_argument("\"" + number.name + "\" is reported twice");
    }
    accumulator.quantities.push_back(std::make_shared<const ResultQuantity>(
        ResultQuantity{number.name, dimension_of(number), Shape::number, Scope::window,
                       as_they_are ? "integral over the window" : "over the window", number.unit}));
  }
  return accumulator;
}

ObservedIntegrals::ObservedIntegrals(const ObserverParts& parts) : parts_(parts), shown_(parts) {
  std::size_t most = 0;
  for (const SceneObserver& from : parts.run.scene->observers) {
    const ObserverRecord& record = *from.record;
    if (record.integrals == nullptr && record.step == nullptr) continue;
    Accumulator accumulator =
        bound_by(from, "observer", [&] { return accumulator_of(from, parts.run.model); });
    integrands_ += accumulator.integrals.size();
    most = std::max(most, accumulator.integrals.size());
    steps_ = steps_ || record.step != nullptr;
    if (!accumulator.events.empty()) parts.events.expect(EventKind::observed);
    accumulators_.push_back(std::move(accumulator));
  }
  values_.assign(most, 0.0);
}

void ObservedIntegrals::declare(StateLayout& layout) const {
  for (const Accumulator& accumulator : accumulators_) {
    const std::string name = "observer." + accumulator.scene->name;
    layout.add_reals(name + ".sums", 2 * accumulator.integrals.size());
    layout.add_reals(name + ".state", accumulator.state_size);
  }
}

void ObservedIntegrals::attach(RunState& state) {
  for (Accumulator& accumulator : accumulators_) {
    const std::string name = "observer." + accumulator.scene->name;
    accumulator.sums = state.reals(name + ".sums");
    accumulator.state = state.reals(name + ".state");
  }
}

void ObservedIntegrals::node(const RunMoment& moment, double weight) {
  shown_.look(moment);
  for (Accumulator& accumulator : accumulators_) {
    const SceneObserver& scene = *accumulator.scene;
    const std::span<double> values(values_.data(), accumulator.integrals.size());
    if (values.empty()) continue;
    std::fill(values.begin(), values.end(), std::numeric_limits<double>::quiet_NaN());
    in_observer(scene, [&] {
      scene.record->integrands(scene.description.get(), shown_.to(scene), values);
    });
    if (!are_finite(parts_.run, scene, accumulator.integrals, values.data())) return;
    for (std::size_t k = 0; k < values.size(); ++k) {
      add_to(accumulator.sums + 2 * k, weight * values[k]);
    }
  }
}

/// Sends an observer's events to the log.
class LoggedEvents final : public ObservedEvents {
 public:
  LoggedEvents(const Accumulator& accumulator, EventLog& log)
      : accumulator_(accumulator), log_(log) {}
  void record(std::size_t kind, double time, double duration, double size) override {
    if (kind >= accumulator_.events.size()) {
      throw std::out_of_range("an event of a kind that the observer has not named");
    }
    Event event = event_of_kind(EventKind::observed);
    event.label = accumulator_.events[kind];
    event.time = time;
    event.duration = duration;
    event.size = size;
    log_.record(event, accumulator_.scene->name);
  }

 private:
  const Accumulator& accumulator_;
  EventLog& log_;
};

void ObservedIntegrals::stepped(const RunMoment& moment) {
  shown_.look(moment);
  for (const Accumulator& accumulator : accumulators_) {
    const SceneObserver& scene = *accumulator.scene;
    if (scene.record->step == nullptr) continue;
    LoggedEvents events(accumulator, parts_.events);
    in_observer(scene, [&] {
      scene.record->step(scene.description.get(), shown_.to(scene),
                         {accumulator.state, accumulator.state_size}, events);
    });
  }
}

/// Internal states go on: they are of the whole run.
void ObservedIntegrals::next_window() {
  for (Accumulator& accumulator : accumulators_) {
    std::fill_n(accumulator.sums, 2 * accumulator.integrals.size(), 0.0);
  }
}

void ObservedIntegrals::stopped(const RunMoment&) {
  if (!parts_.window.is_over()) return;
  for (Accumulator& accumulator : accumulators_) conclude(accumulator);
}

void ObservedIntegrals::conclude(Accumulator& accumulator) {
  const SceneObserver& scene = *accumulator.scene;
  std::vector<double> integrals;
  for (std::size_t k = 0; k < accumulator.integrals.size(); ++k) {
    integrals.push_back(accumulator.sums[2 * k]);
  }
  accumulator.results = integrals;
  if (scene.record->conclude == nullptr) return;
  accumulator.results.assign(accumulator.quantities.size(),
                             std::numeric_limits<double>::quiet_NaN());
  const ObservedWindow window{parts_.window.from().time,
                              parts_.window.to().time,
                              integrals,
                              {accumulator.state, accumulator.state_size}};
  in_observer(
      scene, [&] { scene.record->conclude(scene.description.get(), window, accumulator.results); });
}

void ObservedIntegrals::results(ResultTable& table, const double*) const {
  for (const Accumulator& accumulator : accumulators_) {
    ResultGroup& group = table.group("observers", accumulator.scene->name);
    for (std::size_t k = 0; k < accumulator.quantities.size(); ++k) {
      ResultValue& value = group.add_row(accumulator.quantities[k]);
      if (k < accumulator.results.size() && std::isfinite(accumulator.results[k])) {
        value.set({&accumulator.results[k], 1});
      }
    }
  }
}

}  // namespace

std::unique_ptr<RunObserver> observed_integrals(const ObserverParts& parts) {
  auto observer = std::make_unique<ObservedIntegrals>(parts);
  if (!observer->any()) return nullptr;
  return observer;
}

}  // namespace tomlin::observers
