#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/run/events/events.hpp"
#include "framework/run/observers/run_observer.hpp"
#include "framework/run/window/blocked_series.hpp"

namespace tomlin::observers {

/// Statistics of each driver's slips that begin in the window: number, mean, standard deviation and
/// range of length, peak force, energy and the time between two of them, and the stiffness of what
/// the driver pulls before them; with noise the standard errors of these means.
/// Numbers are brought up to date by every slip, so that they take no more memory in a long run:
/// B. P. Welford, Technometrics 4 (1962) 419, doi:10.1080/00401706.1962.10490022.
class SlipStatistics {
 public:
  explicit SlipStatistics(const ObserverParts& parts);
  void declare(StateLayout& layout) const;
  void attach(RunState& state);
  /// A window begins.
  void start();

  /// `stiffness`: the steepest slope of the force since the slip before; infinite or not a number
  /// where there is none.
  void add(std::size_t driver, const Event& slip, double stiffness);
  /// Adds the rows of a driver; without numbers unless its slips are looked for.
  void add_rows(ResultGroup& group, std::size_t driver, bool looked_for) const;
  /// Adds the errors of all drivers; the functions are those of ErrorEstimator.
  void add_errors(ResultTable& table) const;
  const std::vector<std::string>& estimated() const { return paths_; }
  std::optional<double> error_so_far(std::string_view path) const;

  static std::vector<const ResultQuantity*> rows();

 private:
  enum { kLength, kForce, kEnergy, kWaiting, kStiffness, kQuantities };
  enum { kMean, kSquares, kSmallest, kLargest, kNumbers };
  std::size_t drivers() const { return parts_.signals.drivers().size(); }
  static const ResultQuantity& mean_row(int quantity);
  std::optional<double> error_of(std::size_t series) const;

  ObserverParts parts_;
  double* numbers_ = nullptr;          ///< [driver][quantity][number]
  double* last_ = nullptr;             ///< [driver]: when the slip before began
  std::int64_t* counts_ = nullptr;     ///< [driver]: slips, then [quantity]: of them with a number
  std::vector<std::string> paths_;     ///< [driver][quantity], with noise
  std::vector<BlockedSeries> series_;  ///< likewise
  mutable std::vector<double> scratch_;
};

}  // namespace tomlin::observers
