#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/run/guard/energy_balance.hpp"
#include "framework/run/guard/energy_terms.hpp"
#include "framework/run/observers/kinds.hpp"

/// The energy ledger: kinetic and potential energy where the run stops; over the window each term
/// from its own integral, with the scheme's order, so that what does not balance is the
/// integrator's.
namespace tomlin::observers {
namespace {

const ResultQuantity kKinetic{"kinetic", dimension::energy, Shape::number, Scope::end,
                              "kinetic energy"};
const ResultQuantity kPotential{"potential", dimension::energy, Shape::number, Scope::end,
                                "potential energy, but for a constant"};
const ResultQuantity kWorkIn{"work_in", dimension::energy, Shape::number, Scope::window,
                             "work of all drivers and of energies that change with time"};
const ResultQuantity kHeatOut{"heat_out", dimension::energy, Shape::number, Scope::window,
                              "energy dissipated by all dampers"};
const ResultQuantity kStoredChange{"stored_change", dimension::energy, Shape::number, Scope::window,
                                   "change of kinetic and potential energy"};
const ResultQuantity kNumericalWork{
    "numerical_work", dimension::energy, Shape::number, Scope::window,
    "stored_change + heat_out - work_in: what the integrator added"};

class EnergyLedger : public RunObserver {
 public:
  explicit EnergyLedger(const ObserverParts& parts) : parts_(parts) {}

  void stopped(const RunMoment&) override {
    RunContext& run = parts_.run;
    const SystemView<double>& view = run.model.system().view;
    kinetic_ = kinetic_energy(run.model, view.position, view.velocity, run.clock.time());
    potential_ =
        run.model.potential_energy(run.clock.now(), view.position, view.velocity, view.integrals);
  }

  void finish(const RunMoment&) override {
    RunContext& run = parts_.run;
    if (!run.options.watches_energy || run.path != nullptr || !parts_.window.is_over()) return;
    const EnergyTerms terms = ledger_of(run.model, parts_.window);
    const double at_end = kinetic_ + potential_;
    const SampledWork whole = {
        .work = terms.size_of_work,
        .heat = terms.size_of_heat,
        .kinetic = kinetic_,
        .stored = std::max(std::abs(at_end), std::abs(at_end - terms.stored)),
        .numerical = terms.numerical()};
    run.outcome.warn(doubt_of_balance(whole, false, run));
  }

  void results(ResultTable& table, const double*) const override {
    const MeasureWindow& window = parts_.window;
    std::optional<EnergyTerms> terms;
    if (window.is_over()) terms = ledger_of(parts_.run.model, window);
    const auto term = [&terms](double EnergyTerms::*one) -> std::optional<double> {
      if (!terms) return {};
      return (*terms).*one;
    };
    ResultGroup& group = table.group("energy");
    group.add(kKinetic, kinetic_);
    group.add(kPotential, potential_);
    group.add(kWorkIn, term(&EnergyTerms::work));
    group.add(kHeatOut, term(&EnergyTerms::heat));
    group.add(kStoredChange, term(&EnergyTerms::stored));
    group.add(kNumericalWork, terms ? std::optional(terms->numerical()) : std::nullopt);
  }

 private:
  ObserverParts parts_;
  double kinetic_ = std::numeric_limits<double>::quiet_NaN();
  double potential_ = std::numeric_limits<double>::quiet_NaN();
};

std::unique_ptr<RunObserver> make_energy_ledger(const ObserverParts& parts) {
  if (!parts.run.scene->run.ledger) return nullptr;
  return std::make_unique<EnergyLedger>(parts);
}

}  // namespace

ObserverKind energy_ledger() {
  return {
      .rows = {{"energy",
                {&kKinetic, &kPotential, &kWorkIn, &kHeatOut, &kStoredChange, &kNumericalWork}}},
      .make = make_energy_ledger};
}

}  // namespace tomlin::observers
