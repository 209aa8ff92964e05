#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "framework/run/observers/run_observer.hpp"

namespace tomlin::observers {

/// A moment as it is shown to observers of the scene: particles' positions and velocities, and the
/// forces of drivers, all in the engine's units.
class ShownScene {
 public:
  explicit ShownScene(const ObserverParts& parts);
  /// The model has just been evaluated there.
  void look(const RunMoment& moment);
  /// To one that looks at these bodies; good until it is asked again.
  ObservedMoment to(const SceneObserver& observer);

 private:
  ObserverParts parts_;
  double time_ = 0.0;
  std::vector<std::vector<double>> positions_;   ///< of each body's particles
  std::vector<std::vector<double>> velocities_;  ///< likewise
  std::vector<double> forces_;                   ///< [driver][axis]
  std::vector<ObservedBody> bodies_;
  std::vector<ObservedDriver> drivers_;
};

/// Outline of the scene that an observer is bound to.
SceneOutline outline_of(const SceneObserver& observer, const Model& model);

/// The numbers of one of its lists; none where the record has no such list. Throws
/// std::invalid_argument where a name is no name, or not the only one.
std::vector<ObservedNumber> listed(const SceneObserver& observer, const SceneOutline& outline,
                                   std::vector<ObservedNumber> (*list)(const void*,
                                                                       const SceneOutline&));

/// The dimension of a number as its unit spells it; of "rad", say, none.
inline Dimension dimension_of(const ObservedNumber& number) {
  return dimension_named(number.unit).value_or(dimension::none);
}

/// Runs code of an observer, which may be a plugin's. Throws PluginError.
template <class Action>
auto in_observer(const SceneObserver& observer, Action action) {
  if (observer.record->library.empty()) return action();
  return in_plugin("observer " + observer.name, observer.record->library, action);
}

/// Whether all of an observer's numbers are finite; a run in which they are not ends as failed.
bool are_finite(RunContext& run, const SceneObserver& observer,
                const std::vector<ObservedNumber>& names, const double* numbers);

}  // namespace tomlin::observers
