#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "framework/run/observer.hpp"

namespace tomlin::observers {

/// The [[observer]] tables of the scene, whose numbers are read off bodies at every sample and
/// where the run stops.
class SceneObservers : public RunObserver {
 public:
  /// Throws InputError where the record of one gives no names of numbers.
  explicit SceneObservers(const ObserverParts& parts);
  bool any() const { return !watchers_.empty(); }

  void declare(StateLayout& layout) const override;
  void attach(RunState& state) override;
  void stopped(const RunEnd& end) override;
  void results(ResultTable& table, const double* rates) const override;

  void list_columns(std::vector<SampleColumn>& columns) const;
  /// The numbers of all observers at a state that has just been evaluated, and their means. Returns
  /// the end of the numbers; null where one is not finite, which ends the run.
  double* sample(double time, const double* position, const double* velocity, double* numbers);

 private:
  /// An observer of the scene.
  struct Watcher {
    const SceneObserver* scene = nullptr;
    std::vector<ObservedNumber> columns;
    std::vector<std::size_t> bodies;
    /// Of each number, where the run stops and as a mean.
    std::vector<std::shared_ptr<const ResultQuantity>> quantities;
  };
  void observe(double time, const double* position, const double* velocity, double* numbers);
  bool are_finite(const double* numbers);
  void keep_means(double time, const double* numbers);

  ObserverParts parts_;
  std::vector<Watcher> watchers_;
  std::vector<std::vector<double>> places_;      ///< of each body's particles
  std::vector<std::vector<double>> velocities_;  ///< likewise
  std::vector<ObservedBody> shown_;
  std::vector<double> last_;         ///< numbers where the run stops
  double* sums_ = nullptr;           ///< over samples in the window: high and low parts
  std::int64_t* samples_ = nullptr;  ///< of them
};

}  // namespace tomlin::observers
