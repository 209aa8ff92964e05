#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "framework/model/model.hpp"

/// Changes with time have a time scale, which steps have to resolve: those of energies and
/// forces with a time in their formula, and of motions that are prescribed. Drivers of steady
/// velocity change in proportion to time and are none of them.
namespace tomlin {

struct TimeDependence {
  std::string what;         ///< for messages: "shake: its force"
  std::string key;          ///< of the scene: "force.shake", "body.tip.motion.velocity"
  std::size_t numbers = 0;  /// of a value
  std::size_t effort = 1;   ///< of one value, about, in evaluations of a particle
  /// Its value at a time, everything else as it is at the start of the run.
  std::function<void(double time, double* value)> at;
};

/// Time dependences of a scene, at its start. They refer to the model, whose clock they move:
/// anchor it anew afterwards.
std::vector<TimeDependence> time_dependences(Model& model);

/// The mean time of its cycles in a run, or the time at which it has settled where it has none.
double slowest_cycle(const TimeDependence& of, double duration);

/// How much of its integral a step of h misses at most, as a part of the most that a step has:
/// Simpson's rule, which a step amounts to, against the same on parts of it, all over the run.
double missed_by_steps(const TimeDependence& of, double h, double duration);

/// The longest step that misses less than this part; infinite when a step as long as the run does.
/// Features shorter than about 1e-4 of the run may be missed.
double resolving_step(const TimeDependence& of, double part, double duration);

}  // namespace tomlin
