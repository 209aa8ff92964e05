#pragma once

#include <cstddef>
#include <vector>

#include "framework/core/system/system.hpp"
#include "framework/model/model.hpp"
#include "framework/run/guard/energy_terms.hpp"

namespace tomlin {

struct RunContext;

/// An energy ledger that a run keeps during some of its own steps: the evaluations of these steps
/// also give the heats of all forces, as rates behind those that the run integrates. Positions and
/// velocities keep their bits.
class BriefLedger {
 public:
  explicit BriefLedger(RunContext& run);

  /// False where heats are not known in this way: adaptive schemes, other number types, motion
  /// without inertia, no room in the padding of the rates, velocities that nothing else asks for.
  bool can_be_kept() const { return can_be_kept_; }
  /// The scheme goes on with rates of the step before, so that the first step that the ledger is
  /// kept in lacks some.
  bool lacks_first_step() const;
  /// From this step on, or no more.
  void keep(bool on);
  bool is_kept() const { return kept_; }
  /// The ledger of a single particle on a line is kept by the kernels that take steps in registers.
  bool is_in_registers() const { return !points_.empty(); }
  /// The scheme splits friction off: a run that keeps the ledger takes its steps alone.
  bool splits_friction() const { return splits_friction_; }
  /// Returns work and heat of the steps since `from`, from running integrals then and now; the
  /// stored energy is left out.
  EnergyTerms terms(const double* from_integrals, double from) const;

 private:
  struct Heat {
    std::size_t rate = 0;
    bool of_energy = false;  ///< of one that changes with time: work on the scene
  };

  /// The force of a single particle on a line, with the power that it takes out.
  struct Damper {
    PointKernel<double> run = nullptr;
    const void* parameters = nullptr;
    double start = 0.0;
    std::size_t rate = 0;  ///< of the power; the force stands before it
  };

  bool add_point(const Model::Force& force, std::size_t rate);
  static PointResult<double> with_heat(const void* damper, double position, double velocity,
                                       double start, double elapsed);
  static void write_heat(const void* damper, const Stage<double>& stage);

  RunContext& run_;
  bool can_be_kept_ = false;
  bool splits_friction_ = false;
  bool kept_ = false;
  std::vector<Heat> heats_;
  std::vector<Operation<double>> operations_;  ///< of an evaluation with heats
  std::vector<LaneCall> lane_calls_;           ///< likewise, while it is not kept
  std::vector<PointForce<double>> points_;     ///< likewise; none: operations are called
  std::vector<Damper> dampers_;                ///< among them
  std::size_t used_rates_ = 0;
  std::ptrdiff_t friction_rate_ = kNoRate;  ///< where the scheme splits friction off
  SystemView<double> without_;              ///< while it is kept
};

}  // namespace tomlin
