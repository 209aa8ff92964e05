#pragma once

#include <cmath>

#include "framework/model/model.hpp"

namespace tomlin {

class MeasureWindow;
struct RunContext;

/// Changes of the energy over some time.
struct EnergyTerms {
  double work = 0.0;    ///< by drivers, and by energies that change with time
  double heat = 0.0;    ///< to all dampers
  double stored = 0.0;  ///< change of kinetic and potential energy
  /// Sizes of the parts of work and heat: one may put in what another one takes out.
  double size_of_work = 0.0;
  double size_of_heat = 0.0;

  void add_work(double part) {
    work += part;
    size_of_work += std::abs(part);
  }
  void add_heat(double part) {
    heat += part;
    size_of_heat += std::abs(part);
  }
  double numerical() const { return stored + heat - work; }
};

/// Work and heat between two times, from running integrals with a ledger.
EnergyTerms energy_terms(const Model& model, const double* from_integrals,
                         const double* to_integrals, double from, double to);

/// Over the window.
EnergyTerms ledger_of(const Model& model, const MeasureWindow& window);

/// Kinetic energy at a time, prescribed bodies included.
double kinetic_energy(const Model& model, const double* position, const double* velocity,
                      double time);
/// Kinetic and potential energy at a state, but for a constant.
double stored_energy(Model& model, const DoubleDouble& time, const double* position,
                     const double* velocity, const double* integrals);
/// Kinetic and potential energy of a run, now.
double stored_energy(RunContext& run);

/// Heat of the whole scene so far, but for a constant: what was put in and is stored no more.
double heat_so_far(RunContext& run);

}  // namespace tomlin
