#include "framework/run/observers/observed_integrals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "framework/run/observers/shown_scene.hpp"
#include "framework/scene/text.hpp"

namespace tomlin::observers {
namespace {

/// One observer of the scene.
struct Gatherer {
  const SceneObserver* scene = nullptr;
  std::vector<ObservedNumber> integrals;
  std::size_t own_count = 0;
  std::vector<std::string> events;
  std::vector<std::shared_ptr<const ResultQuantity>> quantities;
  std::vector<double> results;  ///< once the window is over
  // In the run's state.
  double* sums = nullptr;  ///< of integrals: high and low parts
  double* own = nullptr;
};

class ObservedIntegrals : public RunObserver {
 public:
  explicit ObservedIntegrals(const ObserverParts& parts);
  bool any() const { return !gatherers_.empty(); }

  ObserverNeeds needs() const override { return {.nodes = integrands_ > 0, .ends = steps_}; }
  void declare(StateLayout& layout) const override;
  void attach(RunState& state) override;
  void node(const RunMoment& moment, double weight) override;
  void stepped(const RunMoment& moment) override;
  void next_window() override;
  void stopped(const RunMoment& end) override;
  void results(ResultTable& table, const double* rates) const override;

 private:
  void conclude(Gatherer& gatherer);

  ObserverParts parts_;
  ShownScene shown_;
  std::vector<Gatherer> gatherers_;
  std::size_t integrands_ = 0;
  bool steps_ = false;
  std::vector<double> values_;
};

Gatherer gatherer_of(const SceneObserver& from, const Model& model) {
  const ObserverRecord& record = *from.record;
  const SceneOutline outline = outline_of(from, model);
  const void* description = from.description.get();
  Gatherer gatherer;
  gatherer.scene = &from;
  gatherer.integrals = listed(from, outline, record.integrals);
  if (record.own_count != nullptr) gatherer.own_count = record.own_count(description, outline);
  if (record.events != nullptr) gatherer.events = record.events(description);
  for (const std::string& event : gatherer.events) {
    if (!is_component_name(event)) {
      throw std::invalid_argument("\"" + event + "\" is no name of an event");
    }
  }
  const bool as_they_are = record.results == nullptr;
  for (const ObservedNumber& number :
       as_they_are ? gatherer.integrals : listed(from, outline, record.results)) {
    gatherer.quantities.push_back(std::make_shared<const ResultQuantity>(
        ResultQuantity{number.name, dimension::none, Shape::number, Scope::window,
                       as_they_are ? "integral over the window" : "over the window", number.unit}));
  }
  return gatherer;
}

ObservedIntegrals::ObservedIntegrals(const ObserverParts& parts) : parts_(parts), shown_(parts) {
  std::size_t most = 0;
  for (const SceneObserver& from : parts.run.scene->observers) {
    const ObserverRecord& record = *from.record;
    if (record.integrals == nullptr && record.step == nullptr) continue;
    Gatherer gatherer =
        bound_by(from, "observer", [&] { return gatherer_of(from, parts.run.model); });
    integrands_ += gatherer.integrals.size();
    most = std::max(most, gatherer.integrals.size());
    steps_ = steps_ || record.step != nullptr;
    if (!gatherer.events.empty()) parts.events.expect(EventKind::observed);
    gatherers_.push_back(std::move(gatherer));
  }
  values_.assign(most, 0.0);
}

void ObservedIntegrals::declare(StateLayout& layout) const {
  for (const Gatherer& gatherer : gatherers_) {
    const std::string name = "observer." + gatherer.scene->name;
    layout.add_reals(name + ".sums", 2 * gatherer.integrals.size());
    layout.add_reals(name + ".own", gatherer.own_count);
  }
}

void ObservedIntegrals::attach(RunState& state) {
  for (Gatherer& gatherer : gatherers_) {
    const std::string name = "observer." + gatherer.scene->name;
    gatherer.sums = state.reals(name + ".sums");
    gatherer.own = state.reals(name + ".own");
  }
}

void ObservedIntegrals::node(const RunMoment& moment, double weight) {
  shown_.look(moment);
  for (Gatherer& gatherer : gatherers_) {
    const SceneObserver& scene = *gatherer.scene;
    const std::span<double> values(values_.data(), gatherer.integrals.size());
    if (values.empty()) continue;
    std::fill(values.begin(), values.end(), std::numeric_limits<double>::quiet_NaN());
    in_observer(scene, [&] {
      scene.record->integrands(scene.description.get(), shown_.to(scene), values);
    });
    if (!are_finite(parts_.run, scene, gatherer.integrals, values.data())) return;
    for (std::size_t k = 0; k < values.size(); ++k) {
      double* sum = gatherer.sums + 2 * k;
      const DoubleDouble total = DoubleDouble(sum[0], sum[1]) + weight * values[k];
      sum[0] = total.hi;
      sum[1] = total.lo;
    }
  }
}

/// Sends an observer's events to the log.
class ToldEvents final : public ObservedEvents {
 public:
  ToldEvents(const Gatherer& gatherer, EventLog& log) : gatherer_(gatherer), log_(log) {}
  void tell(std::size_t kind, double time, double duration, double size) override {
    if (kind >= gatherer_.events.size()) {
      throw std::out_of_range("an event of a kind that the observer has not named");
    }
    Event event = event_of_kind(EventKind::observed);
    event.label = gatherer_.events[kind];
    event.time = time;
    event.duration = duration;
    event.size = size;
    log_.record(event, gatherer_.scene->name);
  }

 private:
  const Gatherer& gatherer_;
  EventLog& log_;
};

void ObservedIntegrals::stepped(const RunMoment& moment) {
  shown_.look(moment);
  for (const Gatherer& gatherer : gatherers_) {
    const SceneObserver& scene = *gatherer.scene;
    if (scene.record->step == nullptr) continue;
    ToldEvents events(gatherer, parts_.events);
    in_observer(scene, [&] {
      scene.record->step(scene.description.get(), shown_.to(scene),
                         {gatherer.own, gatherer.own_count}, events);
    });
  }
}

/// Own numbers go on: they are of the whole run.
void ObservedIntegrals::next_window() {
  for (Gatherer& gatherer : gatherers_) {
    std::fill_n(gatherer.sums, 2 * gatherer.integrals.size(), 0.0);
  }
}

void ObservedIntegrals::stopped(const RunMoment&) {
  if (!parts_.window.is_over()) return;
  for (Gatherer& gatherer : gatherers_) conclude(gatherer);
}

void ObservedIntegrals::conclude(Gatherer& gatherer) {
  const SceneObserver& scene = *gatherer.scene;
  std::vector<double> integrals;
  for (std::size_t k = 0; k < gatherer.integrals.size(); ++k) {
    integrals.push_back(gatherer.sums[2 * k]);
  }
  gatherer.results = integrals;
  if (scene.record->conclude == nullptr) return;
  gatherer.results.assign(gatherer.quantities.size(), std::numeric_limits<double>::quiet_NaN());
  const ObservedWindow window{parts_.window.from().time,
                              parts_.window.to().time,
                              integrals,
                              {gatherer.own, gatherer.own_count}};
  in_observer(scene,
              [&] { scene.record->conclude(scene.description.get(), window, gatherer.results); });
}

void ObservedIntegrals::results(ResultTable& table, const double*) const {
  for (const Gatherer& gatherer : gatherers_) {
    ResultGroup& group = table.group("observers", gatherer.scene->name);
    for (std::size_t k = 0; k < gatherer.quantities.size(); ++k) {
      ResultValue& value = group.add_row(gatherer.quantities[k]);
      if (k < gatherer.results.size() && std::isfinite(gatherer.results[k])) {
        value.set({&gatherer.results[k], 1});
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
