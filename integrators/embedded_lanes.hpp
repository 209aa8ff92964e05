#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "framework/core/numbers/math.hpp"
#include "framework/core/system/scheme.hpp"
#include "framework/core/system/tolerance.hpp"
#include "integrators/adaptive.hpp"
#include "integrators/embedded.hpp"
#include "integrators/embedded_kernels.hpp"
#include "integrators/spread_arrays.hpp"

namespace tomlin {

/// The embedded pair of EmbeddedPair over replicas in lanes: attempts are taken together, each lane
/// with its own step; what follows from an attempt is decided lane by lane.
class EmbeddedPairLanes : public AdaptiveLanes {
 public:
  EmbeddedPairLanes(const EmbeddedScheme<double>& scheme, const LaneLayout& layout,
                    System<double>& system)
      : layout_(layout),
        system_(system),
        name_(scheme.name),
        control_law_(scheme.control),
        kernels_(scheme.kernels),
        lanes_(layout.width),
        memory_(3 * stages_of(scheme) + 17, (2 * stages_of(scheme) + 4) * system.view.dofs +
                                                (stages_of(scheme) + 1) * system.view.rates +
                                                12 * layout.width) {
    const std::size_t n = system.view.dofs;
    const std::size_t m = system.view.rates;
    const std::size_t w = layout.width;
    for (std::size_t s = 0; s < stages_of(scheme); ++s) {
      arrays_.velocity[s] = memory_.take(n);
      arrays_.acceleration[s] = memory_.take(n);
      arrays_.rates[s] = memory_.take(m);
    }
    arrays_.position = memory_.take(n);
    arrays_.integrals = memory_.take(m);
    position_scale_ = memory_.take(n);
    velocity_scale_ = memory_.take(n);
    absolute_ = memory_.take(w);
    relative_ = memory_.take(w);
    numbers_ = memory_.take(w);
    step_ = memory_.take(w);
    old_error_ = memory_.take(w);
    for (const std::size_t k : layout.coordinates.from) residue_.push_back(k % kGroup);
    call_ = {.width = w,
             .coordinates = layout.coordinates.from.size(),
             .rates = layout.rates.from.size(),
             .residue = residue_.data(),
             .position_scale = position_scale_,
             .velocity_scale = velocity_scale_,
             .absolute_tolerance = absolute_,
             .relative_tolerance = relative_,
             .numbers = numbers_,
             .step = step_,
             .elapsed = memory_.take(w),
             .error = memory_.take(w),
             .within_moves = memory_.take(w),
             .accepted = memory_.take(w),
             .evaluations = memory_.take(w),
             .law = scheme.control,
             .old_error = old_error_,
             .accepted_factor = memory_.take(w),
             .refused_factor = memory_.take(w)};
  }
  EmbeddedPairLanes(const EmbeddedPairLanes&) = delete;
  EmbeddedPairLanes& operator=(const EmbeddedPairLanes&) = delete;

  void put(std::size_t lane, const System<double>& run, const void* description,
           RunState& state) override {
    const auto& d = *static_cast<const AdaptiveDescription*>(description);
    const SystemView<double>& view = run.view;
    const ToleranceScales<double> scales = tolerance_scales(view);
    const std::size_t w = layout_.width;
    layout_.coordinates.put(scales.position, lane, w, position_scale_);
    layout_.coordinates.put(scales.velocity, lane, w, velocity_scale_);
    absolute_[lane] = d.absolute_tolerance / scales.length;
    relative_[lane] = d.relative_tolerance;
    const double numbers = (view.inertial ? 2.0 : 1.0) * static_cast<double>(view.coordinates);
    numbers_[lane] = numbers > 0.0 ? numbers : 1.0;
    layout_.coordinates.put(state.reals(name_ + ".first_acceleration"), lane, w,
                            arrays_.acceleration[0]);
    layout_.rates.put(state.reals(name_ + ".first_rates"), lane, w, arrays_.rates[0]);
    const double* control = state.reals(name_ + ".control");
    const std::int64_t* counts = state.integers(name_ + ".counts");
    Lane& own = lanes_[lane];
    own = {.smallest_step = d.smallest_step,
           .largest_step = d.largest_step,
           .most_steps = d.most_steps,
           .kept_next = control[0],
           .old_error = control[1],
           .next = control[0],
           .taken = counts[1],
           .kept_refusals = counts[2],
           .refusals = counts[2]};
    old_error_[lane] = control[1];
  }

  void get(std::size_t lane, RunState& state) const override {
    const std::size_t w = layout_.width;
    layout_.coordinates.get(arrays_.acceleration[0], lane, w,
                            state.reals(name_ + ".first_acceleration"));
    layout_.rates.get(arrays_.rates[0], lane, w, state.reals(name_ + ".first_rates"));
    const Lane& own = lanes_[lane];
    double* control = state.reals(name_ + ".control");
    std::int64_t* counts = state.integers(name_ + ".counts");
    control[0] = own.kept_next;
    control[1] = own.old_error;
    counts[1] = own.taken;
    counts[2] = own.kept_refusals;
  }

  double next_attempt(std::size_t lane, double most) const override {
    const Lane& own = lanes_[lane];
    return ends(own, most) ? most : std::min(own.next, own.largest_step);
  }

  void attempt(const std::vector<double>& most, std::vector<Attempt>& attempts) override {
    for (std::size_t k = 0; k < lanes_.size(); ++k) {
      Lane& own = lanes_[k];
      own.ends = ends(own, most[k]);
      own.next = std::min(own.next, own.largest_step);
      step_[k] = own.ends ? most[k] : own.next;
    }
    kernels_.attempt_in_lanes(system_.view, arrays_, call_);
    for (std::size_t k = 0; k < lanes_.size(); ++k) attempts[k] = decide(k);
    kernels_.accept_in_lanes(system_.view, arrays_, call_);
  }

 private:
  static std::size_t stages_of(const EmbeddedScheme<double>& scheme) {
    return static_cast<std::size_t>(scheme.end) + 1;
  }

  struct Lane {
    double smallest_step = 0.0;
    double largest_step = 0.0;
    std::int64_t most_steps = 0;
    double kept_next = 0.0;  ///< as it was before the step
    double old_error = 0.0;
    double next = 0.0;
    std::int64_t taken = 0;
    std::int64_t kept_refusals = 0;  ///< as they were before the step
    std::int64_t refusals = 0;
    bool refused = false;  ///< an attempt of this step
    bool ends = false;     ///< the attempt is as long as the step may be
  };

  static bool ends(const Lane& own, double most) {
    return kStretchOfStep * std::min(own.next, own.largest_step) >= most &&
           most <= own.largest_step;
  }

  /// Handles an attempt as EmbeddedPair::step_from() does.
  Attempt decide(std::size_t k) {
    Lane& own = lanes_[k];
    Attempt result{.evaluations = static_cast<unsigned>(call_.evaluations[k])};
    const double error = call_.error[k];
    if (own.taken + own.refusals >= own.most_steps) {
      return failed(k, {0.0, StepFault::too_many_steps, 0});
    }
    if (call_.accepted[k] == 1.0) {
      const double next =
          next_after(control_law_, step_[k], error, call_.accepted_factor[k], own.refused);
      own.next = own.kept_next = std::max(next, own.ends && !own.refused ? own.next : 0.0);
      own.old_error = old_error_[k] = std::max(error, kLeastOldError);
      own.kept_refusals = own.refusals;
      own.refused = false;
      ++own.taken;
      result.taken = step_[k];
      return result;
    }
    ++own.refusals;
    own.refused = true;
    own.next = next_after_refusal(control_law_, step_[k], error, call_.refused_factor[k]);
    if (own.next >= own.smallest_step) return result;
    const bool valid = call_.within_moves[k] == 1.0 && std::isfinite(error);
    result.fault = valid ? StepFault::step_too_small : StepFault::not_finite_or_too_far;
    return failed(k, result);
  }

  /// The lane is as before the step.
  Attempt failed(std::size_t k, Attempt result) {
    Lane& own = lanes_[k];
    call_.accepted[k] = 0.0;
    own.refusals = own.kept_refusals;
    own.next = own.kept_next;
    own.refused = false;
    return result;
  }

  LaneLayout layout_;
  System<double>& system_;
  std::string name_;
  StepControl control_law_;
  const EmbeddedTable<double>& kernels_;
  std::vector<Lane> lanes_;
  std::vector<std::size_t> residue_;
  SpreadArrays<double> memory_;
  EmbeddedArrays<double> arrays_;
  EmbeddedLanes call_;
  double* position_scale_ = nullptr;
  double* velocity_scale_ = nullptr;
  double* absolute_ = nullptr;
  double* relative_ = nullptr;
  double* numbers_ = nullptr;
  double* step_ = nullptr;
  double* old_error_ = nullptr;
};

}  // namespace tomlin
