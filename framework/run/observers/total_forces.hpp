#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "framework/core/system/aligned.hpp"
#include "framework/run/observers/run_observer.hpp"

namespace tomlin::observers {

/// Any force on all of any body, of those that are asked for: `forces.NAME.on.BODY`. Each force is
/// evaluated by itself, which takes time.
class TotalForces {
 public:
  explicit TotalForces(const ObserverParts& parts);

  /// Their names, NAME.on.BODY.
  const std::vector<std::string>& names() const { return names_; }
  /// Calls take(k, axis, force) for each of them.
  void evaluate(const RunMoment& moment,
                const std::function<void(std::size_t, std::size_t, double)>& take);

 private:
  struct Pair {
    const Model::Force* force = nullptr;
    std::size_t body = 0;
    std::vector<Pass<double>> passes;
  };
  void list_bodies_of(const Model::Force& force);
  std::string name_of(const Model::Force& force, std::size_t body) const;
  bool wants(const Model::Force& force, std::size_t body) const;
  double total_on(std::size_t body, std::size_t axis) const;

  ObserverParts parts_;
  std::vector<Pair> pairs_;
  std::vector<std::string> names_;
  AlignedVector<double> force_;  // aligned: kernels write them
  AlignedVector<double> mapped_force_;
  AlignedVector<double> rates_;
};

}  // namespace tomlin::observers
