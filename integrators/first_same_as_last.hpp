#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "framework/core/system/scheme.hpp"
#include "integrators/hermite.hpp"

namespace tomlin {

/// Fixed schemes whose last evaluation in a step is the first of the next one: what it gives of
/// coordinates and rates is state of a run, alone or in a lane.
template <class Real>
class FirstSameAsLast : public Integrator<Real>, public FixedLanes {
 public:
  void declare(StateLayout& layout) override {
    layout.add_numbers<Real>(coordinates_name_, system_.view.dofs);
    layout.add_numbers<Real>(rates_name_, system_.view.rates);
    layout.add_integers(name_ + ".started", 1);
    if (counts_steps_) layout.add_integers(name_ + ".step", 1);
  }

  void attach(RunState& state) override {
    first_ = state.numbers<Real>(coordinates_name_);
    first_rates_ = state.numbers<Real>(rates_name_);
    started_ = state.integers(name_ + ".started");
    if (counts_steps_) step_ = state.integers(name_ + ".step");
  }

  const Real* first_rates() const override { return start_rates_; }
  void forces_changed() override { *started_ = 0; }
  bool is_started() const override { return *started_ != 0; }
  Capabilities<Real> capabilities() override { return {.lanes = this}; }

  void put_lane(const LaneLayout& layout, std::size_t lane, RunState& run) override {
    if constexpr (std::is_same_v<Real, double>) {
      lanes_.resize(layout.width);
      Lane& own = lanes_[lane];
      own = {run.reals(coordinates_name_), run.reals(rates_name_)};
      if (counts_steps_) {
        own.step = run.integers(name_ + ".step");
        own.ahead = *own.step - *step_;
      }
      layout.coordinates.put(own.first, lane, layout.width, first_);
      layout.rates.put(own.rates, lane, layout.width, first_rates_);
      *started_ = 1;
    }
  }

  void get_lane(const LaneLayout& layout, std::size_t lane, RunState&) const override {
    if constexpr (std::is_same_v<Real, double>) {
      const Lane& own = lanes_[lane];
      layout.coordinates.get(first_, lane, layout.width, own.first);
      layout.rates.get(first_rates_, lane, layout.width, own.rates);
      if (counts_steps_) *own.step = *step_ + own.ahead;
    }
  }

  void finish_dense_from(double) override {}

  void interpolate(double theta, double* position, double* velocity,
                   double* integrals) const override {
    hermite_.interpolate(theta, last_, system_.view, first_, first_rates_, position, velocity,
                         integrals);
  }

 protected:
  /// `coordinates` and `rates` are the names of the arrays in the state, behind that of the scheme.
  FirstSameAsLast(const std::string& name, const char* coordinates, const char* rates,
                  bool counts_steps, System<Real>& system)
      : Integrator<Real>(system),
        name_(name),
        coordinates_name_(name + coordinates),
        rates_name_(name + rates),
        counts_steps_(counts_steps),
        hermite_(system.view.dofs, system.view.rates) {}

  using Integrator<Real>::system_;

 private:
  /// A run in a lane: its numbers between steps, and how many more steps it has taken than the
  /// lanes.
  struct Lane {
    double* first = nullptr;
    double* rates = nullptr;
    std::int64_t* step = nullptr;
    std::int64_t ahead = 0;
  };

  std::string name_;
  std::string coordinates_name_;
  std::string rates_name_;
  bool counts_steps_;
  std::vector<Lane> lanes_;

 protected:
  HermiteOutput<Real> hermite_;
  Real* first_ = nullptr;        ///< of coordinates
  Real* first_rates_ = nullptr;  ///< of the next step
  Real* start_rates_ = nullptr;  ///< of the last step
  std::int64_t* started_ = nullptr;
  std::int64_t* step_ = nullptr;  ///< so many have been taken
  double last_ = 0.0;
};

}  // namespace tomlin
