#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "framework/run/observers/shown_scene.hpp"

namespace tomlin::observers {

/// The columns of [[observer]] tables, whose numbers are read off bodies at every sample and where
/// the run stops.
class SceneObservers : public RunObserver {
 public:
  /// Throws InputError where the record of one gives no names of numbers.
  explicit SceneObservers(const ObserverParts& parts);

  void declare(StateLayout& layout) const override;
  void attach(RunState& state) override;
  void stopped(const RunMoment& end) override;
  void results(ResultTable& table, const double* rates) const override;

  bool any() const { return !last_.empty(); }
  void list_columns(std::vector<SampleColumn>& columns) const;
  /// The numbers of all observers at a state that has just been evaluated, in the scene's units,
  /// and their means. Returns the end of the numbers; null where one is not finite, which ends the
  /// run.
  double* sample(const RunMoment& moment, double* numbers);

 private:
  /// An observer of the scene.
  struct Watcher {
    const SceneObserver* scene = nullptr;
    std::vector<ObservedNumber> columns;
    /// Quantities of each number, where the run stops and as a mean.
    std::vector<std::shared_ptr<const ResultQuantity>> quantities;
  };
  void observe(const RunMoment& moment, double* numbers);
  void keep_means(double time, const double* numbers);

  ObserverParts parts_;
  ShownScene shown_;
  std::vector<Watcher> watchers_;
  std::vector<double> last_;         ///< numbers where the run stops
  std::vector<double> units_;        ///< of the scene, of each number
  double* sums_ = nullptr;           ///< over samples in the window: high and low parts
  std::int64_t* samples_ = nullptr;  ///< of them
};

}  // namespace tomlin::observers
