#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "framework/core/records/body.hpp"
#include "framework/core/records/force.hpp"
#include "framework/core/records/registry.hpp"

/// Observers measure further quantities of bodies and drivers during a run, and never change it. A
/// record may give any of:
///
///   columns    functions of the instantaneous state, at every sample of [output] every and at the
///              end
///   integrals  time integrals over the window of [measure], by Gauss-Legendre quadrature with four
///              nodes a step (order 8, on the scheme's dense output)
///   events     detected at the ends of steps, from an internal state of the observer's own
///   results    computed at the end from the integrals and the internal state
///
/// All numbers are in the engine's units (unit_system.hpp); where ObservedNumber spells a
/// dimension, tables and summary have them in those of the scene.
///
/// Integrals and internal states are part of checkpoints.
namespace tomlin {

/// A body at one moment.
struct ObservedBody {
  std::string_view name;
  std::span<const double> mass;      ///< [particle]
  std::span<const double> position;  ///< [particle * dimension + axis], in the scene's coordinates
  std::span<const double> velocity;  ///< likewise
};

/// A driver at one moment.
struct ObservedDriver {
  std::string_view name;
  std::span<const double> force;  ///< [axis], on what it drives
};

struct ObservedMoment {
  double time = 0.0;
  int dimension = 0;
  std::span<const ObservedBody> bodies;          ///< those that are observed, in the order named
  std::span<const ObservedDriver> drivers = {};  ///< all of the scene
};

/// Data that an observer has gathered over the window.
struct ObservedWindow {
  double from = 0.0;  ///< times
  double to = 0.0;
  std::span<const double> integrals;  ///< in the order of ObserverRecord::integrals
  std::span<const double> state;      ///< its internal state, at the end of the run
};

/// One of the numbers that an observer gives.
struct ObservedNumber {
  std::string name;  ///< "x", "length"
  std::string unit;  ///< "length", "mass/time^2", "energy", "rad", "1"
};

/// Records the events that an observer detects.
class ObservedEvents {
 public:
  /// `kind` is an index into ObserverRecord::events. Duration and size are in units of the
  /// observer's choice; NaN where an event has none.
  virtual void record(std::size_t kind, double time, double duration, double size) = 0;

 protected:
  ObservedEvents() = default;
  ~ObservedEvents() = default;
};

struct ObserverRecord : ComponentRecord {
  int fewest_bodies = 1;
  int most_bodies = 1;

  /// Faults across keys and against the bodies; empty when valid.
  std::vector<Complaint> (*complaints)(const void* description,
                                       const SceneOutline& scene) = &no_complaints;

  /// The numbers that it reads off a state, each of another name.
  std::vector<ObservedNumber> (*columns)(const void* description,
                                         const SceneOutline& scene) = nullptr;
  /// Writes them, in that order. A sample that is no finite number ends the run as failed; at the
  /// end of a run it is null in the summary.
  void (*observe)(const void* description, const ObservedMoment& moment,
                  std::span<double> numbers) = nullptr;

  /// Its integrals over the window; without `conclude` the summary has them as they are.
  std::vector<ObservedNumber> (*integrals)(const void* description,
                                           const SceneOutline& scene) = nullptr;
  /// Writes their integrands. One that is no finite number ends the run as failed.
  void (*integrands)(const void* description, const ObservedMoment& moment,
                     std::span<double> values) = nullptr;

  /// The length of its internal state, which is 0 at the start of a run.
  std::size_t (*state_size)(const void* description, const SceneOutline& scene) = nullptr;
  /// Names of the kinds of events that it detects, as in events.csv.
  std::vector<std::string> (*events)(const void* description) = nullptr;
  /// At the start and after every step of the run; may change its internal state.
  void (*step)(const void* description, const ObservedMoment& moment, std::span<double> state,
               ObservedEvents& events) = nullptr;

  /// Quantities computed from integrals and state, for the summary.
  std::vector<ObservedNumber> (*results)(const void* description,
                                         const SceneOutline& scene) = nullptr;
  /// Writes them once the window is over; null in the summary where they are not finite.
  void (*conclude)(const void* description, const ObservedWindow& window,
                   std::span<double> numbers) = nullptr;
};

}  // namespace tomlin
