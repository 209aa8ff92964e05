#pragma once

#include <limits>
#include <optional>
#include <string>

#include "framework/model/model.hpp"

/// Bounds on the fastest and the slowest motions of a model about its attached state, and the steps
/// that schemes can take with them.
namespace tomlin {

/// Bounds on the fastest motion: angular frequency and damping rate, or without inertia the
/// relaxation rate.
struct Stiffness {
  double frequency = 0.0;
  double damping_rate = 0.0;
  double least_damping_rate = 0.0;
  double relaxation_rate = 0.0;
  double spring_frequency = 0.0;  ///< of springs alone, without bounds on substrates
};

/// At the start; where energies change with time, the largest over the run.
Stiffness stiffness_of(Model& model, bool without_bonds = false);
/// The largest of friction coefficients over masses; part of the stiffness.
double damping_rate_of(const Model& model);
/// Name of the force with the largest share in the stiffness.
std::string stiffest_force_of(const Model& model);
/// A bound of the slowest time that what is off its steady state decays in, but for what
/// substrates do: of variables of the forces' own, and of the modes about the start under springs
/// and friction, an underdamped mode's period included. 0: there is none. Nothing for more
/// coordinates than are looked at.
std::optional<double> slowest_time_of(Model& model);
/// Fastest rotation of rigid bodies in space, about a principal axis; an angular velocity.
double fastest_spin_of(const Model& model);
/// The largest fixed step that this scheme is stable with; infinite when nothing limits it. May
/// return a lower bound that is easier to find if the bound is beyond `enough`.
double stable_step_of(Model& model, const IntegratorRecord& scheme,
                      double enough = std::numeric_limits<double>::infinity());
/// Steps of an adaptive scheme cannot exceed this for long, since friction and springs would make
/// them grow; infinite when nothing limits them. Generous: a lower bound of the cost.
double longest_lasting_step_of(Model& model, const IntegratorRecord& scheme);

}  // namespace tomlin
