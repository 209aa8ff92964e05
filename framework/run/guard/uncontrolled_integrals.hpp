#pragma once

#include <cstddef>
#include <vector>

#include "framework/core/system/aligned.hpp"
#include "framework/run/context.hpp"

namespace tomlin {

/// Running integrals of forces that act on no coordinate that is integrated: forces on prescribed
/// and fixed bodies and along held axes. The error estimate of an adaptive scheme does not see
/// them, so that they would follow the steps that other bodies need. Each step is therefore held
/// against a quadrature of its own over these rates, evaluated on the dense output, and taken again
/// at half the length where the two differ by more than the tolerance allows: a part of the largest
/// rate times the step. A scene without such integrals is not affected.
class UncontrolledIntegrals {
 public:
  explicit UncontrolledIntegrals(RunContext& run);
  void declare(StateLayout& layout) const;
  void attach(RunState& state);
  /// Applies to a run that begins.
  void start();

  bool any() const { return !rates_.empty(); }
  /// A step may not be longer.
  double longest_step() const;
  /// Before a step, whose start RunContext::keep_state() has kept.
  void begin_step();
  /// Whether the step that has just been taken may stand. Anchors forces at its begin.
  bool accept(const DoubleDouble& begin, double h);

 private:
  /// A rate, less the part of it that is known without a quadrature, if any.
  struct Rate {
    std::ptrdiff_t whole = kNoRate;
    std::ptrdiff_t known_part = kNoRate;
    double unit = 0.0;  ///< the scene's force, or power

    double of(const double* numbers) const {
      return numbers[whole] - (known_part == kNoRate ? 0.0 : numbers[known_part]);
    }
  };
  /// The difference between scheme and quadrature, in the largest rate times the step, and in what
  /// the tolerance allows.
  struct Difference {
    double relative = 0.0;
    double in_tolerances = 0.0;
  };

  void find_rates();
  Difference difference(const DoubleDouble& begin, double h);

  RunContext& run_;
  std::vector<Rate> rates_;
  double tolerance_ = 0.0;
  double epsilon_ = 0.0;         ///< of the number type
  double* longest_ = nullptr;    ///< in the run's state
  double last_relative_ = 0.0;   ///< of the attempt before at the same step; 0: this is the first
  std::vector<double> start_;    ///< integrals at the start of the step
  std::vector<double> sum_;      ///< of the quadrature
  std::vector<double> largest_;  ///< size of each rate at the nodes
  std::vector<double> off_;      ///< how far the scheme's polynomial is from it at most
  AlignedVector<double> position_;  // aligned: kernels read them
  AlignedVector<double> velocity_;
  AlignedVector<double> integrals_;
  AlignedVector<double> values_;
  AlignedVector<double> polynomial_;
};

}  // namespace tomlin
