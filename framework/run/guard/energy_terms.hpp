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
  /// Adds what a force takes out of the scene: heat, or the work of an energy that changes with
  /// time, with the other sign.
  void add_out(bool of_energy, double part) { of_energy ? add_work(-part) : add_heat(part); }
  double numerical() const { return stored + heat - work; }
};

/// A sum over a window, known from some of its steps.
struct SampledWork {
  double work = 0.0;  ///< sizes of its parts, and of those of heat: see EnergyTerms
  double heat = 0.0;
  double kinetic = 0.0;  ///< mean over the window
  double stored = 0.0;   ///< mean size of kinetic and potential energy, which round
  double numerical = 0.0;
  double uncertainty = 0.0;  ///< standard error of `numerical`; 0: all steps were looked at
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
