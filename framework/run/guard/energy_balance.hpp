#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "framework/core/numbers/double_double.hpp"
#include "framework/core/system/aligned.hpp"
#include "framework/core/system/stage.hpp"
#include "framework/core/system/state_layout.hpp"
#include "framework/run/guard/brief_ledger.hpp"
#include "framework/run/guard/energy_terms.hpp"
#include "framework/run/run.hpp"

/// Whether the energy balance of a run closes: stored change + heat - work, the numerical work, is
/// what the integrator itself adds or takes. With `[run] ledger` the run knows it; without, it is
/// sampled.
namespace tomlin {

class Observation;
struct RunContext;
struct RunMoment;

/// A warning where the numerical work is neither small beside work and heat nor the chance of a
/// sample. Without heat it is held against the energy itself, too. That of an adaptive scheme is
/// also held against what its tolerance allows in so many steps.
std::optional<Warning> doubt_of_balance(const SampledWork& found, bool sampled, RunContext& run);

/// The balance of a run without a ledger, from some steps at random, some in each of many strata of
/// its steps (stratified sampling). Where the scheme allows it, the run keeps a ledger during a
/// block of steps (BriefLedger). Elsewhere work and heat of a single step are the integrals of
/// their powers over its dense output, by a quadrature. Noise has no such path: a scene with a
/// thermostat is not looked at. All that is known so far stands in the run's state.
///
/// Strata are so long that the balance takes a twentieth of the run's evaluations at most.
class EnergyBalance {
 public:
  /// Over a window of time.
  EnergyBalance(RunContext& run, double from, double to) : run_(run), from_(from), to_(to) {}
  void declare(StateLayout& layout) const;
  void attach(RunState& state);
  /// Is called before the first step. Has no effect where no step can be sampled.
  void prepare();

  /// Before every step of the run, or as many as it said last; and at its end.
  std::int64_t look();
  /// How many steps there are before look() has something to do.
  std::int64_t idle_steps();
  /// The next step is looked into: it is taken alone, with dense output.
  bool looks_into_step() const { return looks_into_step_; }
  /// It has been taken from `begin` on, and the clock is at its end, `next_since` after the anchor.
  void look_into(Observation& observation, const DoubleDouble& begin, double next_since);
  /// At the end of the run. Nothing where too few steps were looked at.
  std::optional<SampledWork> found() const;

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
  enum {
    kBlockBegin,    ///< of the last block that the run keeps a ledger of: the time
    kStoredEnergy,  ///< where what is looked at begins
    kSteps,         ///< that samples stand for
    kWork,          ///< sums over samples, by weight
    kHeat,
    kKinetic,
    kStored,
    kNumerical,
    kUnit,     ///< of energies in the following ones; 0: not yet known
    kSquares,  ///< for the standard error: of w^2 r^2; w are the steps that a sample stands for, r
    kCross,    ///< is its numerical work in a step; of w^2 r
    kWeights,  ///< of w^2
    kReals     ///< followed by the running integrals where a block of the run's own began
  };
  /// Steps count from the first one in the window: kFirst of the run.
  enum { kStarted, kFirst, kSeen, kStratum, kOpen, kBlockFirst, kSamples, kIntegers };
  /// Whether the run keeps a ledger: from the next step on, or for a block of steps.
  enum { kNo, kFromNextStep, kYes };

  /// The power that a force takes out of the scene.
  struct Heat {
    Operation<double> operation;
    bool of_energy = false;  ///< of one that changes with time: work on the scene
  };

  bool find_heats();
  std::int64_t length_of_stratum() const;
  void open_block();
  std::int64_t go_on_with_block();
  void close_block(std::int64_t steps);
  void add_node(const RunMoment& at, double weight);
  void count(EnergyTerms terms, double stored, std::int64_t steps);

  RunContext& run_;
  double from_;
  double to_;
  std::optional<BriefLedger> ledger_;  ///< none: single steps are looked into
  std::vector<Heat> heats_;
  AlignedVector<double> heat_rates_;
  std::vector<double> heat_sums_;
  AlignedVector<double> velocity_;  ///< that follows from forces
  std::vector<double> none_;        ///< integrals before a step
  std::vector<double> sums_of_rates_;
  std::int64_t stratum_ = 0;      ///< steps, at least; 0: nothing is looked at
  std::int64_t steps_ = 1;        ///< that a sample has
  bool kept_throughout_ = false;  ///< the run keeps a ledger in all its steps
  bool grows_ = false;            ///< later strata are longer
  bool looks_into_step_ = false;
  std::int64_t known_ = -1;  ///< the stratum whose sample begins
  std::int64_t next_ = 0;    ///< with this step
  double* sums_ = nullptr;
  std::int64_t* progress_ = nullptr;
};

}  // namespace tomlin
