#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "framework/study/tradeoff/methods.hpp"
#include "framework/study/tradeoff/trial_run.hpp"

namespace tomlin {

/// Value of an observable from one run, and the cost of the run.
struct Measurement {
  TrialRun::End end = TrialRun::End::finished;
  std::optional<double> value;  ///< nothing when the run did not finish or the number is undefined
  std::uint64_t evaluations = 0;  ///< of all forces
  std::uint64_t columns = 0;      ///< of Jacobians
  double seconds = 0.0;           ///< the best of a few runs when it is short
  std::string why;                ///< there is no value

  bool defined() const { return value.has_value(); }
  std::uint64_t cost() const { return evaluations + columns; }
};

/// Measures one observable by the methods, within a budget of time: of the machine, or counted in
/// evaluations at a given pace, which is the same on every machine. No run is done twice.
class Measurer {
 public:
  /// The variants must outlive this. A `pace` of zero is the machine's own.
  Measurer(const Variants& variants, std::string observable, double budget_seconds,
           const std::atomic<bool>* stop, double pace = 0.0);

  /// The run takes at most so many seconds, and never more than the budget has left.
  const Measurement& at(const Method& method, double resolution, double most_seconds);
  /// Measures other settings or starts within the same limits, and remembers nothing.
  Measurement with(const std::vector<Setting>& settings, double most_seconds,
                   const std::optional<Perturbation>& perturbation = {});

  const std::string& observable() const { return observable_; }
  double budget() const { return budget_; }
  double used() const;
  double left() const { return budget_ - used(); }
  bool is_over() const { return left() <= 0.0 || interrupted(); }
  bool interrupted() const { return stop_ != nullptr && stop_->load(); }

 private:
  struct Remembered {
    Measurement measurement;
    double limit = 0.0;  ///< seconds that it was given
  };

  const Variants& variants_;
  std::string observable_;
  double budget_;
  const std::atomic<bool>* stop_;
  double pace_;              ///< evaluations and columns that count as a second
  std::uint64_t spent_ = 0;  ///< evaluations and columns
  std::chrono::steady_clock::time_point started_;
  std::map<std::pair<std::string, double>, Remembered> known_;  ///< by method and resolution
};

}  // namespace tomlin
