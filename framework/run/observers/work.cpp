#include <algorithm>

#include "framework/run/guard/energy_terms.hpp"
#include "framework/run/guard/prescribed_inertia.hpp"
#include "framework/run/guard/watched_integrals.hpp"
#include "framework/run/observers/kinds.hpp"
#include "framework/run/steps/run_plan.hpp"

/// Work of drivers over the window.
namespace tomlin::observers {
namespace {

const ResultQuantity kWork{"work", dimension::energy, Shape::number, Scope::window,
                           "work of the driver on the scene"};
const ResultQuantity kWorkPerDistance{"work_per_distance", dimension::force, Shape::number,
                                      Scope::window, "work by distance"};
const ResultQuantity kDistance{"distance", dimension::length, Shape::number, Scope::window,
                               "displacement of the support, at steady velocity"};
const ResultQuantity kDissipatedPerPeriod{"dissipated_per_period", dimension::energy, Shape::number,
                                          Scope::window,
                                          "work_in less stored_change, of the whole scene, while "
                                          "the driver moves a period; with ledger = true, and a "
                                          "period that forces declare along the driver, or in = "
                                          "\"driver_periods\" with a period in [measure]"};

class Work : public RunObserver {
 public:
  explicit Work(const ObserverParts& parts) : parts_(parts) {}

  void finish(const RunMoment&) override {
    RunContext& run = parts_.run;
    double work = 0.0;
    for (const Model::Driver& driver : parts_.signals.drivers()) {
      work += parts_.window.gained(driver.first_rate + static_cast<std::ptrdiff_t>(parts_.axes()));
    }
    const ErrorControl* const control = run.integrator->capabilities().error_control;
    const double rounding = control ? control->rounding_of_works() : 0.0;
    run.outcome.warn(doubt_of_rounding(rounding, work, run.tolerance()));
  }

  void results(ResultTable& table, const double*) const override {
    const MeasureWindow& window = parts_.window;
    for (const Model::Driver& driver : parts_.signals.drivers()) {
      std::optional<double> work;
      std::optional<double> work_per_distance;
      std::optional<double> distance;
      std::optional<double> dissipated;
      if (window.is_over()) {
        const auto axes = static_cast<std::ptrdiff_t>(parts_.axes());
        const double speed = speed_of(*driver.drive);
        work = window.gained(driver.first_rate + axes) +
               inertia_lacking_in(parts_.run.model, driver, window).back();
        if (driver.drive->steady) distance = speed * active_time(driver);
        if (distance && *distance > 0.0) work_per_distance = *work / *distance;
        dissipated = dissipated_per_period(driver);
      }
      ResultGroup& group = table.driver(driver);
      group.add(kWork, work);
      group.add(kWorkPerDistance, work_per_distance);
      group.add(kDistance, distance);
      group.add(kDissipatedPerPeriod, dissipated);
    }
  }

 private:
  /// How long the driver acts within the window.
  double active_time(const Model::Driver& driver) const {
    const MeasureWindow& window = parts_.window;
    for (const SceneForce& force : parts_.run.scene->forces) {
      if (force.name != driver.name || !force.active) continue;
      const double until =
          std::min(force.active->until.value_or(window.to().time), window.to().time);
      return std::max(0.0, until - std::max(force.active->from, window.from().time));
    }
    return window.length();
  }

  std::optional<double> dissipated_per_period(const Model::Driver& driver) const {
    const RunContext& run = parts_.run;
    const std::optional<double> period = time_of_period(run.model, *driver.drive);
    if (!run.scene->run.ledger || !period) return {};
    const EnergyTerms terms = ledger_of(run.model, parts_.window);
    const double time = active_time(driver);
    if (!(time > 0.0)) return {};
    return (terms.work - terms.stored) * (*period / time);
  }

  ObserverParts parts_;
};

}  // namespace

ObserverKind work() {
  return kind_of<Work>(
      {{"drivers", {&kWork, &kWorkPerDistance, &kDistance, &kDissipatedPerPeriod}}});
}

}  // namespace tomlin::observers
