#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "framework/core/body.hpp"
#include "framework/core/force.hpp"
#include "framework/core/registry.hpp"

/// Observers: numbers of one's own that are read off bodies. They look on and change nothing.
namespace tomlin {

/// A body at one moment.
struct ObservedBody {
  std::string_view name;
  std::span<const double> mass;      ///< [particle]
  std::span<const double> position;  ///< [particle * dimension + axis], in the scene's coordinates
  std::span<const double> velocity;  ///< likewise
};

struct ObservedMoment {
  double time = 0.0;
  int dimension = 0;
  std::span<const ObservedBody> bodies;  ///< those that are observed, in the order named
};

/// One of the numbers that an observer gives.
struct ObservedNumber {
  std::string name;  ///< "x", "length"
  std::string unit;  ///< "length", "mass/time^2", "rad", "1"
};

struct ObserverRecord : ComponentRecord {
  int fewest_bodies = 1;
  int most_bodies = 1;

  /// Faults across keys and against the bodies; empty when sound.
  std::vector<Complaint> (*complaints)(const void* description,
                                       const SceneOutline& scene) = &no_complaints;
  /// The numbers that it gives, one or more, each of another name.
  std::vector<ObservedNumber> (*columns)(const void* description,
                                         const SceneOutline& scene) = nullptr;
  /// Writes them, in that order. A sample that is no finite number ends the run as failed; at the
  /// end of a run it is null in the summary.
  void (*observe)(const void* description, const ObservedMoment& moment,
                  std::span<double> numbers) = nullptr;
};

}  // namespace tomlin
