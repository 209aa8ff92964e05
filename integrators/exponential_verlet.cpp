#include "integrators/exponential_verlet.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "framework/core/records/integrator.hpp"
#include "framework/core/system/evaluate.hpp"
#include "framework/core/system/scheme.hpp"
#include "integrators/hermite.hpp"
#include "integrators/modal_flow.hpp"

namespace tomlin {
namespace {

struct Description {
  double dt = 0.0;
};

class ExponentialVerlet : public Integrator<double> {
 public:
  explicit ExponentialVerlet(System<double>& system)
      : Integrator<double>(system), hermite_(system.view.dofs, system.view.rates) {
    for (const ElasticBody& body : *system.elastic) bodies_.emplace_back(body);
    const std::size_t n = system.view.dofs;
    const std::size_t m = system.view.rates;
    for (Numbers* numbers : {&move_, &position_, &velocity_, &acceleration_}) {
      numbers->assign(n + kGap, 0.0);
    }
    for (Numbers* numbers : {&own_, &end_rates_, &start_rates_, &slopes_}) {
      numbers->assign(m + kGap, 0.0);
    }
  }

  void declare(StateLayout& layout) override {
    layout.add_reals("exponential_verlet.force", system_.view.dofs);
    layout.add_reals("exponential_verlet.rates", system_.view.rates);
    layout.add_reals("exponential_verlet.largest", bodies_.size());
    layout.add_integers("exponential_verlet.started", 1);
  }

  void attach(RunState& state) override {
    force_ = state.reals("exponential_verlet.force");
    rates_ = state.reals("exponential_verlet.rates");
    largest_ = state.reals("exponential_verlet.largest");
    started_ = state.integers("exponential_verlet.started");
  }

  StepReport step_from(double since, double h, bool dense) override {
    const SystemView<double>& s = system_.view;
    if (*started_ == 0) {
      evaluate_at(s.position, s.velocity, s.integrals, rates_, since);
      *started_ = 1;
    }
    std::copy(rates_, rates_ + s.rates, start_rates_.begin());
    if (dense) {
      find_slopes();
      hermite_.keep_start(s);
      hermite_.keep_first(acceleration_.data(), slopes_.data());
    }
    last_ = h;
    const StepFault fault = step_within(since, h);
    if (fault != StepFault::none) return {0.0, fault};
    // Shapes are looked at in the first of so many steps.
    *started_ = *started_ % kLookEvery + 1;
    return {h, StepFault::none};
  }

  const double* first_rates() const override { return start_rates_.data(); }
  void forces_changed() override { *started_ = 0; }
  void finish_dense_from(double) override { find_slopes(); }

  void interpolate(double theta, double* position, double* velocity,
                   double* integrals) const override {
    const SystemView<double>& s = system_.view;
    hermite_.interpolate(theta, last_, s, acceleration_.data(), slopes_.data(), position, velocity,
                         integrals);
    if (theta == 1.0) return;
    const double* const start[2] = {hermite_.start_position(), hermite_.start_velocity()};
    const double* const end[2] = {s.position, s.velocity};
    for (const ModalBody& body : bodies_) {
      if (!body.is_stopped_within(last_)) continue;
      body.interpolate(theta, last_, start, end, position, velocity);
    }
  }

 private:
  using Numbers = AlignedVector<double>;
  static constexpr std::size_t kGap = 2 * kGroup;
  static constexpr std::int64_t kLookEvery = 8;

  /// With a fault the state is as it was.
  StepFault step_within(double since, double h) {
    const SystemView<double>& s = system_.view;
    double heat = 0.0;
    for (ModalBody& body : bodies_) {
      heat += body.enter(s.position, s.velocity, force_, h);
      const auto which = static_cast<std::size_t>(&body - bodies_.data());
      // Its modes are no longer about an equilibrium of the bonds.
      if (*started_ == 1 && !body.keeps_shape(largest_[which])) return StepFault::no_equilibrium;
      body.flow(h, move_.data(), velocity_.data());
    }
    for (std::size_t i = 0; i < s.dofs; ++i) {
      if (!(std::abs(move_[i]) <= s.largest_move[i])) return StepFault::not_finite_or_too_far;
      position_[i] = s.position[i] + move_[i];
    }
    // Own variables here follow from the time alone: their rates are known at both ends.
    for (std::size_t i = 0; i < s.own; ++i) own_[i] = s.integrals[i] + h * rates_[i];
    // The forces at the start are kept in their place until the step is known to be valid.
    evaluate(s, stage_of(s, static_cast<const double*>(position_.data()),
                         static_cast<const double*>(velocity_.data()),
                         static_cast<const double*>(own_.data()), end_rates_.data(), since + h));
    system_.evaluations += 1;
    for (std::size_t i = 0; i < s.dofs; ++i) {
      if (!std::isfinite(s.force[i] * s.inverse_mass[i])) return StepFault::not_finite_or_too_far;
    }
    for (ModalBody& body : bodies_) body.leave(s.force, velocity_.data());
    std::copy(s.force, s.force + s.dofs, force_);
    std::copy(position_.begin(), position_.begin() + static_cast<std::ptrdiff_t>(s.dofs),
              s.position);
    std::copy(velocity_.begin(), velocity_.begin() + static_cast<std::ptrdiff_t>(s.dofs),
              s.velocity);
    for (std::size_t i = 0; i < s.rates; ++i) {
      const bool is_heat = static_cast<std::ptrdiff_t>(i) == s.friction_rate;
      s.integrals[i] += is_heat ? heat : 0.5 * h * (rates_[i] + end_rates_[i]);
      rates_[i] = end_rates_[i];
    }
    return StepFault::none;
  }

  void evaluate_at(const double* position, const double* velocity, const double* own, double* rates,
                   double elapsed) {
    const SystemView<double>& s = system_.view;
    evaluate(s, stage_of(s, position, velocity, own, rates, elapsed));
    system_.evaluations += 1;
    std::copy(s.force, s.force + s.dofs, force_);
  }

  /// Accelerations and rates at the present state, friction included.
  void find_slopes() {
    const SystemView<double>& s = system_.view;
    std::copy(force_, force_ + s.dofs, s.force);
    std::copy(rates_, rates_ + s.rates, slopes_.begin());
    const double power =
        add_drags(s, stage_of(s, static_cast<const double*>(s.position),
                              static_cast<const double*>(s.velocity),
                              static_cast<const double*>(s.integrals), slopes_.data(), 0.0));
    if (s.friction_rate != kNoRate) slopes_[s.friction_rate] = power;
    for (std::size_t i = 0; i < s.dofs; ++i) acceleration_[i] = s.force[i] * s.inverse_mass[i];
  }

  HermiteOutput<double> hermite_;
  std::vector<ModalBody> bodies_;
  Numbers move_, position_, velocity_, acceleration_, own_, end_rates_, start_rates_, slopes_;
  double* force_ = nullptr;
  double* rates_ = nullptr;
  double* largest_ = nullptr;        ///< force on each body but its bonds', so far
  std::int64_t* started_ = nullptr;  ///< 0: no; else which of the steps between looks this is
  double last_ = 0.0;
};

/// Stable step for the forces that are left to kicks. Bonds and friction limit nothing.
double stable_step(double frequency, double) {
  return frequency > 0.0 ? 2.0 / frequency : std::numeric_limits<double>::infinity();
}

double step(const void* description) { return static_cast<const Description*>(description)->dt; }

std::vector<Complaint> complaints(const void*) { return {}; }

std::unique_ptr<Integrator<double>> bind(const void*, System<double>& system) {
  return std::make_unique<ExponentialVerlet>(system);
}

}  // namespace

IntegratorRecord exponential_verlet_record() {
  IntegratorRecord record;
  record.name = "exponential_verlet";
  record.summary = "splitting of second order with the exact flow of stiff bonds and friction";
  record.equation =
      "kick by F + K u, exact flow h of u'' = -K u/m - gamma u', kick by F + K u; the kicks last h "
      "together";
  record.source =
      "E. Hairer, C. Lubich and G. Wanner, Geometric Numerical Integration (Springer, 2006), "
      "doi:10.1007/3-540-30666-8, sections XIII.1 and XIII.2; B. Garcia-Archilla, J. M. "
      "Sanz-Serna and R. D. Skeel, SIAM J. Sci. Comput. 20 (1998) 930, "
      "doi:10.1137/S1064827596313851";
  record.order = 2;
  record.evaluations_per_step = 1;
  record.without_inertia = false;
  record.splits_friction = true;
  record.splits_bonds = true;
  record.make_description = &make_description<Description>;
  record.parameters = {parameter("dt", &Description::dt, dimension::time, "the step").in(positive)};
  record.stable_step = &stable_step;
  record.step = &step;
  record.complaints = &complaints;
  record.bind = {&bind};
  record.example = R"(# A chain of hard springs, dragged over a soft corrugation.
[[body]]
type = "chain"
count = 8
spacing = 1.1
particle_mass = 1.0

[[force]]
type = "harmonic_bonds"
pairs = "neighbours"
stiffness = 1e8

[[force]]
type = "driving_spring"
stiffness = 1.0
velocity = [0.1]

[[force]]
type = "viscous_damping"
coefficient = 0.5

[[force]]
type = "sinusoidal_substrate"
amplitude = 0.05
period = 1.0

[run]
duration = 50.0
integrator = { type = "exponential_verlet", dt = 1e-2 }
)";
  return record;
}

}  // namespace tomlin
