#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <utility>

#include "framework/core/system/aligned.hpp"
#include "framework/run/context.hpp"
#include "framework/run/events/triggers.hpp"
#include "framework/run/guard/energy_balance.hpp"
#include "framework/run/guard/uncontrolled_integrals.hpp"
#include "framework/run/housekeeping.hpp"
#include "framework/run/results/observation.hpp"

/// How a run is cut into steps: on a fixed grid, as an adaptive scheme has them, or along a path of
/// equilibria.
namespace tomlin {

/// Parts of a run that its steps share.
struct StepParts {
  RunContext& run;
  Observation& observation;
  Triggers& triggers;
  Housekeeping& housekeeping;
  UncontrolledIntegrals& uncontrolled;
  EnergyBalance* balance = nullptr;  ///< null where nothing is sampled
  /// True: another window begins where the last one has ended.
  std::function<bool()> window_ended;
};

class Stepping {
 public:
  virtual ~Stepping() = default;
  /// One step of the run; on a grid up to `most` of them, where nothing falls between.
  virtual void advance(std::uint64_t most) = 0;
  /// How many steps from here on have nothing to be served between them, for a batch of runs that
  /// takes them together (lane_batch.hpp): whole blocks of kBlock. 0: the run goes on by itself.
  virtual std::int64_t steps_for_lanes() = 0;
  /// Counts steps that a batch has taken up to a time; the numbers of the state are those after.
  virtual void count_steps(std::int64_t steps, const DoubleDouble& time) = 0;
  /// The run continues from other numbers.
  virtual void state_changed() {}

 protected:
  /// A step that may be taken.
  struct Step {
    double since = 0.0;  ///< its start, after the anchor
    double h = 0.0;
    DoubleDouble end;
    bool to_grid = false;   ///< it ends where a step of the grid does
    bool may_split = true;  ///< by an event
  };

  explicit Stepping(StepParts parts) : parts_(std::move(parts)), run_(parts_.run) {}

  /// One step with everything that may go with it: samples, edges of the window, events that change
  /// forces. False where the run has failed.
  bool take(const Step& step);
  /// Nothing is looked at in or after every step.
  bool may_be_in_lanes() const;
  /// The energy balance looks into the next step.
  bool is_looked_into() const {
    return parts_.balance != nullptr && parts_.balance->looks_into_step();
  }
  /// The step, or as much of it as there is before a force becomes active or ceases to be.
  Step up_to_switch(Step step) const;
  /// The time of the next switch, less what is no step.
  double next_switch_time() const { return run_.model.next_switch() - kNoStep * run_.plan.dt; }
  /// One step of the scheme.
  StepReport step_scheme(double since, double h, bool dense);

  /// Looks at the step that has been taken.
  virtual void look(const DoubleDouble& from, const DoubleDouble& to) = 0;
  /// Anchors forces afresh before any evaluation that belongs to the next step; returns how far it
  /// starts after the anchor.
  virtual double anchor_next() = 0;
  /// At the end of a step, after samples.
  virtual bool end_step() { return true; }

  StepParts parts_;
  RunContext& run_;

 private:
  bool take_to_event(const Triggers::Passed& passed, const Step& step, const DoubleDouble& begin,
                     double length, const DoubleDouble& arrived);
  void fire(const Triggers::Passed& passed);
  void switch_forces();
};

/// Steps of equal length. Most have nothing to be served between them: they are taken in blocks.
class FixedGrid : public Stepping {
 public:
  explicit FixedGrid(StepParts parts);
  void advance(std::uint64_t most) override;
  std::int64_t steps_for_lanes() override;
  void count_steps(std::int64_t steps, const DoubleDouble& time) override;
  void state_changed() override {
    plain_left_ = 0;
    on_grid_ = false;
  }

 protected:
  void look(const DoubleDouble&, const DoubleDouble&) override {
    parts_.observation.end_step();
    parts_.observation.end_block();
  }
  double anchor_next() override { return run_.since_anchor(); }

 private:
  DoubleDouble into_step();
  void take_one(const Step& step);
  DoubleDouble end_of_step() const;
  std::int64_t plain_steps();
  std::int64_t blocks_before(double time) const;
  void take_block(std::int64_t most);
  std::int64_t point_block(std::int64_t most, StepFault& fault);
  void sample_within_block(std::int64_t grid, std::int64_t taken);
  void sample_end_of_block();
  std::int64_t plain_block(std::int64_t most, StepFault& fault);

  bool on_grid_ = false;            ///< known to be between two steps of the grid
  std::int64_t plain_left_ = 0;     ///< steps known to have nothing to serve
  bool samples_each_step_ = false;  ///< each of them ends on a sample
  AlignedVector<double> point_rates_;
  AlignedVector<double> point_positions_;
  AlignedVector<double> point_velocities_;
  PointStarts<double> starts_;  ///< these
};

/// Steps as long as the scheme has them.
class AdaptiveSteps : public Stepping {
 public:
  explicit AdaptiveSteps(StepParts parts) : Stepping(std::move(parts)) {}
  void advance(std::uint64_t most) override;
  std::int64_t steps_for_lanes() override;
  void count_steps(std::int64_t steps, const DoubleDouble& time) override;

 protected:
  void look(const DoubleDouble& from, const DoubleDouble& to) override {
    parts_.observation.look_between(static_cast<double>(from), static_cast<double>(to));
  }
  double anchor_next() override;

 private:
  bool foresees_too_many_steps();
};

/// Steps along a path of equilibria, each of which may end; the next one follows at once.
class EquilibriumSteps : public AdaptiveSteps {
 public:
  using AdaptiveSteps::AdaptiveSteps;

 protected:
  void look(const DoubleDouble& from, const DoubleDouble& to) override {
    parts_.observation.look_along_path(static_cast<double>(from), static_cast<double>(to));
  }
  bool end_step() override { return !run_.path->ends() || slip(); }

 private:
  bool slip();
};

/// For the scheme of the run.
std::unique_ptr<Stepping> stepping_of(StepParts parts);

}  // namespace tomlin
