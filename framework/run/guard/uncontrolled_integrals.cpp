#include "framework/run/guard/uncontrolled_integrals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "framework/core/system/tolerance.hpp"
#include "framework/run/guard/prescribed_inertia.hpp"
#include "framework/run/guard/start_checks.hpp"
#include "framework/run/steps/gauss_rule.hpp"
#include "framework/scene/natural_units.hpp"

namespace tomlin {
namespace {

/// Rates round by so many last digits of the scene's force, or power: no tolerance is finer.
constexpr double kUlpsOfRates = 1e3;
/// An integral rounds where it is added to, and a polynomial through differences of it by a few
/// times as much.
constexpr double kUlpsOfIntegrals = 64.0;
/// Part of the largest rate that the scheme's own polynomial may be off at a node of the
/// quadrature: two quadratures of what neither of them resolves agree by chance now and then.
constexpr double kPolynomialErrorPart = 0.1;
/// A difference that is as small, and does not fall by this factor as the step is halved, is the
/// rounding of a force: a difference of quadratures of order 5 falls by 32. The next step may be so
/// much longer that steps do not dwindle by what falls by chance.
constexpr double kLargestRounding = 1e-6;
constexpr double kLeastFallByHalving = 8.0;
constexpr double kGrowthPastRounding = 4.0;
/// Steps over a jump of a rate end here: the jump adds this part of the tolerance to a mean over
/// the run.
constexpr double kPartAtJump = 1e-2;
/// The step after one that differs by less, in tolerances, may be twice as long: of order 5.
constexpr double kErrorThatAllowsDoubling = 1.0 / 64.0;
/// A plugin's scheme need not say how fine it is.
constexpr double kUndeclaredTolerance = 1e-9;

/// Whether a body has a coordinate that is integrated, or all of its axes are.
bool is_free(const Model::Body& body, int dimension, bool along_all_axes) {
  if (body.prescribed() || (body.bound.slot.mapped && !body.bound.slot.rigid)) return false;
  const auto held = std::count(body.held.begin(), body.held.begin() + dimension, true);
  return along_all_axes ? held == 0 : held < dimension || body.has_free_rotation();
}

bool acts_on_free(const Model& model, const Model::Force& force, bool along_all_axes) {
  return std::any_of(force.bodies.begin(), force.bodies.end(), [&](std::size_t b) {
    return is_free(model.bodies()[b], model.dimension(), along_all_axes);
  });
}

/// A driver's force is known from coordinates that are integrated. A declared driver may act along
/// an axis that is held; a spring is linear along it.
bool is_controlled(const Model& model, const Model::Driver& driver) {
  for (const Model::Force& force : model.forces()) {
    if (force.first_rate == driver.first_rate) {
      return acts_on_free(model, force, force.driver != nullptr);
    }
  }
  return std::none_of(model.forces().begin(), model.forces().end(), [&](const Model::Force& force) {
    return !acts_on_free(model, force, false) &&
           std::any_of(force.bodies.begin(), force.bodies.end(),
                       [&](std::size_t b) { return model.bodies()[b].bound.name == driver.name; });
  });
}

}  // namespace

UncontrolledIntegrals::UncontrolledIntegrals(RunContext& run) : run_(run) {
  if (!run.scheme.adaptive) return;
  find_rates();
  if (!any()) return;
  const SystemView<double>& view = run.model.system().view;
  epsilon_ = epsilon_of(run.scene->run.number_type);
  const double length = tolerance_scales(view).length;
  tolerance_ = std::max(
      tolerance_of(run.scene->run.integrator, length).value_or(kUndeclaredTolerance), epsilon_);
  start_.assign(rates_.size(), 0.0);
  sum_.assign(rates_.size(), 0.0);
  largest_.assign(rates_.size(), 0.0);
  off_.assign(rates_.size(), 0.0);
  position_.assign(view.dofs + 2 * kGroup, 0.0);
  velocity_.assign(view.dofs + 2 * kGroup, 0.0);
  integrals_.assign(view.rates + 2 * kGroup, 0.0);
  values_.assign(view.rates + 2 * kGroup, 0.0);
  polynomial_.assign(view.rates + 2 * kGroup, 0.0);
}

void UncontrolledIntegrals::find_rates() {
  const Model& model = run_.model;
  const NaturalUnits units = natural_units(*run_.scene);
  const double force = units.of(dimension::force);
  const double power = units.of(dimension::energy) / units.time;
  const auto axes = static_cast<std::ptrdiff_t>(model.dimension());
  for (const Model::Driver& driver : model.drivers()) {
    if (is_controlled(model, driver)) continue;
    const bool has_known_part = is_accelerated(model, driver);
    for (std::ptrdiff_t k = 0; k <= axes; ++k) {
      const std::ptrdiff_t rate = driver.first_rate + k;
      rates_.push_back(
          {rate, has_known_part ? rate + axes + 1 : kNoRate, k < axes ? force : power});
    }
  }
  for (const Model::Force& one : model.forces()) {
    if (one.heat_rate == kNoRate || acts_on_free(model, one, one.traits.conservative)) continue;
    rates_.push_back({one.heat_rate, kNoRate, power});
  }
}

void UncontrolledIntegrals::declare(StateLayout& layout) const {
  if (any()) layout.add_reals("uncontrolled_integrals.longest_step", 1);
}

void UncontrolledIntegrals::attach(RunState& state) {
  if (!any()) return;
  longest_ = state.reals("uncontrolled_integrals.longest_step");
  run_.may_go_back();
}

void UncontrolledIntegrals::start() {
  if (any()) *longest_ = std::numeric_limits<double>::max();
}

double UncontrolledIntegrals::longest_step() const {
  return any() ? std::min(*longest_, run_.longest_step) : run_.longest_step;
}

void UncontrolledIntegrals::begin_step() {
  const double* integrals = run_.model.system().view.integrals;
  for (std::size_t k = 0; k < rates_.size(); ++k) start_[k] = rates_[k].of(integrals);
}

bool UncontrolledIntegrals::accept(const DoubleDouble& begin, double h) {
  run_.integrator->finish_dense_from(h);
  const Difference found = difference(begin, h);
  run_.model.anchor(begin);
  run_.model.system().evaluations += kGaussNodes;
  const double before = std::exchange(last_relative_, 0.0);
  if (found.in_tolerances <= 1.0) {
    const double next = found.in_tolerances < kErrorThatAllowsDoubling ? 2.0 * h : h;
    // A step that something else has cut short does not show that a longer one would be wrong.
    if (next > *longest_ || h >= *longest_) *longest_ = next;
    return true;
  }
  const bool is_rounding = found.relative < kLargestRounding &&
                           kLeastFallByHalving * found.relative > before && before > 0.0;
  if (is_rounding || !(h > kPartAtJump * tolerance_ * run_.plan.duration)) {
    *longest_ = kGrowthPastRounding * h;
    return true;
  }
  run_.go_back();
  last_relative_ = found.relative;
  *longest_ = 0.5 * h;
  return false;
}

UncontrolledIntegrals::Difference UncontrolledIntegrals::difference(const DoubleDouble& begin,
                                                                    double h) {
  std::fill(sum_.begin(), sum_.end(), 0.0);
  std::fill(largest_.begin(), largest_.end(), 0.0);
  std::fill(off_.begin(), off_.end(), 0.0);
  for (std::size_t node = 0; node < kGaussNodes; ++node) {
    run_.integrator->interpolate(kGaussNode[node], position_.data(), velocity_.data(),
                                 integrals_.data());
    run_.model.evaluate_at(begin + kGaussNode[node] * h, position_.data(), velocity_.data(),
                           integrals_.data(), values_.data());
    const DenseRates* const dense = run_.integrator->capabilities().dense_rates;
    if (dense) dense->between(kGaussNode[node], velocity_.data(), polynomial_.data());
    for (std::size_t k = 0; k < rates_.size(); ++k) {
      const double value = rates_[k].of(values_.data());
      sum_[k] = std::fma(kGaussWeight[node], value, sum_[k]);
      largest_[k] = std::max(largest_[k], std::abs(value));
      if (!dense) continue;
      off_[k] = std::max(off_[k], std::abs(rates_[k].of(polynomial_.data()) - value));
    }
  }
  const double* integrals = run_.model.system().view.integrals;
  Difference worst;
  for (std::size_t k = 0; k < rates_.size(); ++k) {
    const double end = rates_[k].of(integrals);
    const double by = std::abs((end - start_[k]) - h * sum_[k]);
    const double of_rate = kUlpsOfRates * epsilon_ * rates_[k].unit;
    const double of_integral =
        kUlpsOfIntegrals * epsilon_ * std::max(std::abs(start_[k]), std::abs(end));
    const double rounding = h * of_rate + of_integral;
    // Numbers that are not finite are the run's to report.
    const auto include = [&worst](double found, double least, double size, double part) {
      if (!(found > least)) return;
      worst.in_tolerances = std::max(worst.in_tolerances, found / (part * size + least));
      worst.relative = std::max(worst.relative, found / size);
    };
    include(by, rounding, h * largest_[k], tolerance_);
    if (off_[k] > kPolynomialErrorPart * largest_[k])
      include(off_[k], rounding / h, largest_[k], kPolynomialErrorPart);
  }
  return worst;
}

}  // namespace tomlin
