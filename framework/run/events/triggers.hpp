#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "framework/core/system/aligned.hpp"
#include "framework/run/context.hpp"
#include "framework/run/results/rotations.hpp"
#include "framework/run/steps/instant.hpp"

namespace tomlin {

/// Forces that change when an observable passes a value: the step in which it does is taken again
/// up to that moment, which is found on its dense output.
class Triggers {
 public:
  Triggers(RunContext& run, const Rotations& rotations);
  void declare(StateLayout& layout) const;
  void attach(RunState& state);
  /// A value that is beyond its limit at the start has to come back before it can pass it.
  void start();

  bool any() const { return !triggers_.empty(); }
  bool waiting() const;

  struct Passed {
    std::size_t trigger = 0;
    double theta = 1.0;  ///< part of the step
  };
  /// The first event within the step that has just been taken.
  std::optional<Passed> first_passed(const DoubleDouble& begin, double h, double since);
  /// The force changes here and now; the step that has come this far was taken with the old one.
  /// Returns its name.
  const std::string& fire(const Passed& passed);

 private:
  /// kWaits: it has counted, and does again once the other side has.
  enum Side : std::int64_t { kNotBeyond, kBeyond, kWaits };
  struct Trigger {
    std::size_t force = 0;
    Instant instant;
    std::int64_t* beyond = nullptr;  ///< above the upper value, below the lower one: a Side
  };
  const Model::Force& force_of(const Trigger& trigger) const {
    return run_.model.forces()[trigger.force];
  }
  void read(const DoubleDouble& time, const double* position, const double* velocity,
            const double* integrals);
  double beyond(const Trigger& trigger, int side) const;
  int side_behind(const Trigger& trigger) const;
  double theta_of(const Trigger& trigger, int side, const DoubleDouble& begin, double h);

  RunContext& run_;
  const Rotations& rotations_;
  std::vector<Trigger> triggers_;
  bool stochastic_ = false;
  AlignedVector<double> rates_;  // aligned: kernels read them
  std::vector<double> turns_;
  Instant::State instant_;
  AlignedVector<double> position_;
  AlignedVector<double> velocity_;
  AlignedVector<double> integrals_;
};

}  // namespace tomlin
