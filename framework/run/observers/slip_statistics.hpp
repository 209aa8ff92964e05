#pragma once

#include <vector>

#include "framework/run/events.hpp"
#include "framework/run/observer.hpp"

namespace tomlin::observers {

/// Of the slips of each driver that begin in the window: their number, mean, standard deviation and
/// range of length, peak force and energy, and the stiffness of what the driver pulls before them.
/// Numbers are brought up to date by every slip, so that they take no more memory in a long run:
/// B. P. Welford, Technometrics 4 (1962) 419, doi:10.1080/00401706.1962.10490022.
class SlipStatistics {
 public:
  explicit SlipStatistics(const ObserverParts& parts) : parts_(parts) {}
  void declare(StateLayout& layout) const;
  void attach(RunState& state);
  /// A window begins.
  void start();

  /// `stiffness`: the steepest slope of the force since the slip before; infinite or not a number
  /// where there is none.
  void add(std::size_t driver, const Event& slip, double stiffness);
  /// Of a driver whose slips are looked for.
  void add_rows(ResultGroup& group, std::size_t driver, bool looked_for) const;

  static std::vector<const ResultQuantity*> rows();

 private:
  enum { kLength, kForce, kEnergy, kStiffness, kQuantities };
  enum { kMean, kSquares, kSmallest, kLargest, kNumbers };
  std::size_t drivers() const { return parts_.signals.drivers().size(); }

  ObserverParts parts_;
  double* numbers_ = nullptr;       ///< [driver][quantity][number]
  std::int64_t* counts_ = nullptr;  ///< [driver]: slips, then [quantity]: of them with a number
};

}  // namespace tomlin::observers
