#pragma once

#include <cstdint>
#include <vector>

#include "framework/run/observers/run_observer.hpp"
#include "framework/run/observers/scene_observers.hpp"
#include "framework/run/observers/total_forces.hpp"

namespace tomlin::observers {

/// Rows of the table of samples, and particles' positions, at equal times: for the run's sink, and
/// for the observers of the scene.
class Samples {
 public:
  explicit Samples(const ObserverParts& parts);
  /// Observers of the scene have columns, too.
  void show(SceneObservers& scene);

  void declare(StateLayout& layout) const { layout.add_integers("samples.next", 1); }
  void attach(RunState& state) { next_ = state.integers("samples.next"); }
  bool are_wanted() const { return wanted_; }
  /// Columns of the table, and whose positions come with them: what a sink that wants samples gets.
  RunLayout layout() const;
  void begin_sink();
  /// The time of the next sample; infinite where none is wanted.
  double next_time() const;
  bool is_taken_at(double time) const;
  /// At multiples of this time, for the sink alone: moments need no more than the state and rates.
  bool are_taken_every(double time) const;
  void take(const RunMoment& moment);

 private:
  ObserverParts parts_;
  SceneObservers* scene_ = nullptr;
  TotalForces forces_;
  bool wanted_ = false;
  bool sink_has_begun_ = false;
  std::int64_t* next_ = nullptr;  ///< how many have been taken
  std::vector<double> row_;
};

}  // namespace tomlin::observers
