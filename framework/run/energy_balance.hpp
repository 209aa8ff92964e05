#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "framework/core/system/aligned.hpp"
#include "framework/core/system/state_layout.hpp"
#include "framework/run/energy_terms.hpp"
#include "framework/run/run.hpp"

/// Whether the energy balance of a run closes: stored change + heat - work, the numerical work, is
/// what the integrator itself adds or takes. With `[run] ledger` the run knows it; without, it is
/// sampled.
namespace tomlin {

class BriefLedger;
class Engine;
struct RunContext;

/// A sum over a window, known from some of its steps.
struct SampledWork {
  double work = 0.0;  ///< sizes of its parts, and of those of heat: see EnergyTerms
  double heat = 0.0;
  double kinetic = 0.0;  ///< mean over the window
  double stored = 0.0;   ///< mean size of kinetic and potential energy, which round
  double numerical = 0.0;
  double uncertainty = 0.0;  ///< standard error of `numerical`; 0: all steps were looked at
};

/// A warning where the numerical work is neither small beside work and heat nor the chance of a
/// sample. Without heat it is held against the energy itself, too. That of an adaptive scheme is
/// also held against what its tolerance allows in so many steps.
std::optional<Warning> doubt_of_balance(const SampledWork& found, bool sampled, RunContext& run);

/// The balance of a run without a ledger, from short blocks of steps at random times, one in each
/// of some equal parts of the window (stratified sampling). Where the scheme allows it, the run
/// keeps a ledger during a block (BriefLedger). Elsewhere a second engine with a ledger takes the
/// steps of a block from the run's own state; where steps are fixed, the energy that the run itself
/// has after them counts. All that is known so far stands in the run's state.
///
/// Evaluations of energies take time: parts are so long, and blocks so short, that the balance of a
/// run which keeps the ledger itself costs a few per cent of it.
class EnergyBalance {
 public:
  /// Numbers in the run state.
  static constexpr std::size_t reals(std::size_t rates) { return kReals + rates; }
  static constexpr std::size_t integers() { return kIntegers; }

  EnergyBalance(const std::shared_ptr<const Scene>& scene, const RunOptions& options);
  ~EnergyBalance();
  EnergyBalance(const EnergyBalance&) = delete;
  EnergyBalance& operator=(const EnergyBalance&) = delete;

  void attach(double* reals, std::int64_t* integers);
  /// Begins a window.
  void start(double from, double to);
  /// Before the first step. Without effect where no ledger can be kept.
  void prepare(RunContext& run);

  /// Before every step of the run, or as many as it said last; and at its end.
  std::uint64_t look(RunContext& run);
  /// Up to which time look() does nothing.
  double idle_until(const RunContext& run) const;
  /// At the end of the run. Nothing where too few steps were looked at.
  std::optional<SampledWork> found() const;

 private:
  enum {
    kBlockBegin,   ///< of the last block: the time
    kBlockEnd,     ///< likewise, as planned
    kBlockLength,  ///< its time
    kBlockWeight,  ///< what it stands for, in parts of its length
    kBlockEnergy,  ///< energy that the second engine has at its end, or the run at its begin
    kOpenWork,     ///< numerical work of it
    kTime,         ///< that blocks stand for
    kWork,         ///< sums over blocks, by weight
    kHeat,
    kKinetic,
    kStored,
    kNumerical,
    kUnit,     ///< of energies in the following ones; 0: not yet known
    kSquares,  ///< for the standard error: of w^2 r^2; w is the part of the window that a block
    kCross,    ///< stands for, r its numerical work in a window's time; of w^2 r
    kWeights,  ///< of w^2
    kReals     ///< followed by the running integrals where a block of the run's own began
  };
  /// kDropped: the second engine has failed; nothing more is looked at.
  enum { kStratum, kOpen, kBlocks, kDropped, kIntegers };

  double time_of(std::int64_t stratum) const;
  bool looks() const { return (ledger_ || twin_) && place_[kDropped] == 0; }
  void make_twin(RunState& state);
  void open(RunContext& run);
  void open_own(RunContext& run);
  void close_own(RunContext& run, bool there);
  void close_of_twin(RunContext& run, bool there);
  void count(const EnergyTerms& terms, double begin, double end, double kinetic);
  void close(double numerical);

  std::shared_ptr<const Scene> scene_;
  RunOptions options_;
  std::unique_ptr<BriefLedger> ledger_;
  std::unique_ptr<Engine> twin_;     ///< where the run cannot keep it
  AlignedVector<double> integrals_;  ///< of the twin, where a block begins
  double from_ = 0.0;
  double to_ = 0.0;
  std::int64_t known_ = -1;  ///< the stratum whose block begins
  double next_ = 0.0;        ///< at this time
  std::int64_t strata_ = 0;
  std::uint64_t steps_ = 0;  ///< in a block
  bool whole_ = false;       ///< one block, or block after block of the second engine
  double* sums_ = nullptr;
  std::int64_t* place_ = nullptr;
};

}  // namespace tomlin
