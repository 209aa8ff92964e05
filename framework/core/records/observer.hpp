#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "framework/core/records/body.hpp"
#include "framework/core/records/force.hpp"
#include "framework/core/records/registry.hpp"

/// Observers: numbers of one's own that are read off bodies and drivers. They look on and change
/// nothing. A record may give any of:
///
///   columns    numbers read off a state, at every sample of [output] every and at the end
///   integrals  over the window of [measure], of numbers read off states within each step: by Gauss
///              and Legendre with four nodes a step (order 8 on the scheme's dense output)
///   events     found at the ends of steps, with numbers of its own in between
///   results    computed at the end from the integrals and its own numbers
///
/// Sums and own numbers stand in the run's state: a run that was killed goes on with them.
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

/// What an observer has gathered over the window.
struct ObservedWindow {
  double from = 0.0;  ///< times
  double to = 0.0;
  std::span<const double> integrals;  ///< in the order of ObserverRecord::integrals
  std::span<const double> own;        ///< its own numbers, at the end of the run
};

/// One of the numbers that an observer gives.
struct ObservedNumber {
  std::string name;  ///< "x", "length"
  std::string unit;  ///< "length", "mass/time^2", "rad", "1"
};

/// Where an observer tells of events.
class ObservedEvents {
 public:
  /// `kind` counts in ObserverRecord::events; the size is what the event has one of, else not a
  /// number.
  virtual void tell(std::size_t kind, double time, double duration, double size) = 0;

 protected:
  ObservedEvents() = default;
  ~ObservedEvents() = default;
};

struct ObserverRecord : ComponentRecord {
  int fewest_bodies = 1;
  int most_bodies = 1;

  /// Faults across keys and against the bodies; empty when sound.
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

  /// How many numbers of its own it keeps; they are 0 at the start.
  std::size_t (*own_count)(const void* description, const SceneOutline& scene) = nullptr;
  /// Names of the kinds of events that it tells of, in events.csv.
  std::vector<std::string> (*events)(const void* description) = nullptr;
  /// At the start and after every step of the run; may change its own numbers.
  void (*step)(const void* description, const ObservedMoment& moment, std::span<double> own,
               ObservedEvents& events) = nullptr;

  /// Numbers that follow from all this, in the summary.
  std::vector<ObservedNumber> (*results)(const void* description,
                                         const SceneOutline& scene) = nullptr;
  /// Writes them once the window is over; null in the summary where they are not finite.
  void (*conclude)(const void* description, const ObservedWindow& window,
                   std::span<double> numbers) = nullptr;
};

}  // namespace tomlin
