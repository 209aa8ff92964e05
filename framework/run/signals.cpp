#include "framework/run/signals.hpp"

#include <cmath>

#include "framework/run/steps/run_plan.hpp"

namespace tomlin {

Signals::Signals(const Model& model)
    : model_(model), drivers_(model.drivers()), axes_(static_cast<std::size_t>(model.dimension())) {
  for (const Model::Driver& driver : drivers()) {
    const std::vector<double>& velocity = driver.drive->velocity;
    start_velocity_.insert(start_velocity_.end(), velocity.begin(), velocity.end());
    speed_.push_back(pull_speed_of(*driver.drive));
    along_.push_back(1.0 / speed_.back());
  }
}

void Signals::write_speeds(const double* velocity, double time, double* signals) const {
  const int axes = model_.dimension();
  double* speed = signals + speed_of(0);
  for (const Model::Body& body : model_.bodies()) {
    const BodySlot<double>& slot = body.bound.slot;
    double v[3] = {0.0, 0.0, 0.0};
    if (slot.rigid) {
      for (int d = 0; d < axes; ++d) v[d] = velocity[slot.centre + d];
    } else if (body.prescribed()) {
      for (int d = 0; d < axes; ++d) v[d] = body.motion->velocity[d](time);
    } else if (slot.count == 1 && !slot.mapped) {
      for (int d = 0; d < axes; ++d) v[d] = velocity[slot.offset + d * slot.stride];
    } else if (!slot.mapped) {
      model_.observe().mean(slot, velocity, axes, v);
    }
    double square = 0.0;
    for (int d = 0; d < axes; ++d) square += v[d] * v[d];
    *speed++ = std::sqrt(square);
  }
}

void Signals::set_directions() {
  for (std::size_t k = 0; k < drivers().size(); ++k) {
    const std::vector<double>& velocity = drivers()[k].drive->velocity;
    double along = 0.0;
    for (std::size_t d = 0; d < axes_; ++d) along += velocity[d] * start_velocity(k, d);
    along_[k] = (along < 0.0 ? -1.0 : 1.0) / speed_[k];
  }
}

SignalSpan::SignalSpan(Model& model, const Signals& signals, Integrator<double>& integrator)
    : model_(model),
      signals_(signals),
      integrator_(integrator),
      position_(model.system().view.dofs + 2 * kGroup),
      velocity_(model.system().view.dofs + 2 * kGroup),
      integrals_(model.system().view.rates + 2 * kGroup),
      rates_(model.system().view.rates + 2 * kGroup),
      within_(signals.count()) {
  for (std::vector<double>& values : at) values.assign(signals.count(), 0.0);
}

bool SignalSpan::read_dense(double theta, double time, std::vector<double>& into) const {
  const DenseRates* const dense = integrator_.capabilities().dense_rates;
  if (dense == nullptr) return false;
  dense->between(theta, velocity_.data(), rates_.data());
  if (evaluates_) evaluate(theta);
  signals_.write_forces(rates_.data(), into.data());
  signals_.write_speeds(velocity_.data(), time, into.data());
  return true;
}

/// The step is complete for interpolation.
void SignalSpan::evaluate(double theta) const {
  const DoubleDouble anchored = model_.anchor_time();
  integrator_.interpolate(theta, position_.data(), velocity_.data(), integrals_.data());
  model_.evaluate_at(anchored + theta * (to - from), position_.data(), velocity_.data(),
                     integrals_.data(), rates_.data());
  model_.anchor(anchored);
}

}  // namespace tomlin
