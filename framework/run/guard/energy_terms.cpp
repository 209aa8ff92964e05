#include "framework/run/guard/energy_terms.hpp"

#include <cstddef>

#include "framework/run/context.hpp"
#include "framework/run/guard/prescribed_inertia.hpp"
#include "framework/run/window/window.hpp"

namespace tomlin {

EnergyTerms energy_terms(const Model& model, const double* from_integrals,
                         const double* to_integrals, double from, double to) {
  const auto between = [&](std::ptrdiff_t rate) {
    return to_integrals[rate] - from_integrals[rate];
  };
  EnergyTerms terms;
  for (const Model::Driver& driver : model.drivers()) {
    terms.add_work(between(driver.first_rate + model.dimension()));
    if (is_accelerated(model, driver)) {
      terms.work += inertia_lacking(model, driver, from_integrals, to_integrals, from, to).back();
    }
  }
  for (const Model::Force& force : model.forces()) {
    if (force.heat_rate == kNoRate) continue;
    terms.add_out(force.traits.conservative, between(force.heat_rate));
  }
  if (model.assembly().friction_rate() != kNoRate)
    terms.add_heat(between(model.assembly().friction_rate()));
  return terms;
}

EnergyTerms ledger_of(const Model& model, const MeasureWindow& window) {
  const MeasureWindow::Edge& from = window.from();
  const MeasureWindow::Edge& to = window.to();
  EnergyTerms terms = energy_terms(model, from.integrals, to.integrals, from.time, to.time);
  terms.stored = *to.stored - *from.stored;
  return terms;
}

double kinetic_energy(const Model& model, const double* position, const double* velocity,
                      double time) {
  return model.kinetic_energy(position, velocity) + prescribed_kinetic_energy(model, time);
}

double stored_energy(Model& model, const DoubleDouble& time, const double* position,
                     const double* velocity, const double* integrals) {
  return kinetic_energy(model, position, velocity, time.hi + time.lo) +
         model.potential_energy(time, position, velocity, integrals);
}

double stored_energy(RunContext& run) {
  const SystemView<double>& view = run.model.system().view;
  return stored_energy(run.model, run.clock.now(), view.position, view.velocity, view.integrals);
}

double heat_so_far(RunContext& run) {
  Model& model = run.model;
  const SystemView<double>& view = model.system().view;
  const std::ptrdiff_t axes = model.dimension();
  double work = 0.0;
  for (const Model::Driver& driver : model.drivers()) {
    work += view.integrals[driver.first_rate + axes];
    // The kinetic energy below is that of what is free.
    if (is_accelerated(model, driver)) {
      work -= view.integrals[driver.first_rate + 2 * axes + 1];
    }
  }
  for (const Model::Force& force : model.forces()) {
    // With the ledger: what an energy that changes with time puts in.
    if (force.traits.conservative && force.heat_rate != kNoRate) {
      work -= view.integrals[force.heat_rate];
    }
  }
  return work - model.kinetic_energy(view.position, view.velocity) -
         model.potential_energy(run.seen, view.position, view.velocity, view.integrals);
}

}  // namespace tomlin
