#include "integrators/equilibrium.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "framework/core/numbers/math.hpp"
#include "framework/core/numbers/random.hpp"
#include "framework/core/system/tolerance.hpp"

namespace tomlin {
namespace {

/// Curvatures below this part of the typical one are rounding: such a direction is a zero mode.
constexpr double kZeroMode = 1e-12;
/// Masses that keep a stiffness with neutral directions from being singular, as a part of it.
constexpr double kRegularising = 1e-9;
constexpr double kMoreRegularising = 1e3;
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kMostNoise = 1e-4;
constexpr int kSubspaceIterations = 6;
constexpr int kSoftestIterations = 40;
constexpr int kJacobiSweeps = 30;

/// Parts of a pace: intervals over which forces are differenced in time.
constexpr double kLongInterval = 0.1;
constexpr double kShortInterval = 1e-3;
/// Second differences below this part of the first are rounding.
constexpr double kLinearInTimePart = 1e-10;

/// The flow, by the linearly implicit Euler rule: lengths in natural units, errors as parts of a
/// step, rates as parts of the fastest.
constexpr double kLongestFlowStep = 0.1;
constexpr double kLargestFlowError = 0.5;
constexpr double kSmallFlowError = 0.1;
constexpr double kRateAfterSmallError = 0.125;
constexpr double kRateAfterRefusal = 4.0;
constexpr double kLeastRate = 1e-9;
constexpr double kSlowRate = 1e-5;
constexpr double kSettledStep = 1e-7;
constexpr double kRestingStep = 1e-12;
constexpr int kMostFlowSteps = 5000;
constexpr int kMostTries = 200;

/// Newton's method close by.
constexpr int kMostPolishing = 30;
constexpr double kPolished = 1e-14;

}  // namespace

Equilibrium::Equilibrium(System<double>& system)
    : system_(system), tangent_(*system.tangent), n_(tangent_.coordinates().size()) {
  const SystemView<double>& view = system.view;
  constexpr double kUnbounded = 1e300;
  for (const std::size_t at : tangent_.coordinates()) {
    const double move = view.largest_move[at];
    unit_.push_back(move < kUnbounded ? move : 1.0 / view.tolerance_scale[at]);
  }
  for (auto* vector : {&start_, &force_, &change_, &trial_, &scratch_, &held_})
    vector->assign(n_, 0.0);
  borders_.assign((kMostNeutral + 1) * n_, 0.0);
  subspace_.assign(kMostNeutral * n_, 0.0);
  images_.assign(kMostNeutral * n_, 0.0);
  position_.assign(view.dofs + 2 * kGroup, 0.0);
  at_rest_.assign(view.dofs + 2 * kGroup, 0.0);
  rates_.assign(view.rates + 2 * kGroup, 0.0);
  own_start_.assign(view.rates + 2 * kGroup, 0.0);
  own_.assign(view.rates + 2 * kGroup, 0.0);
}

double Equilibrium::norm(const double* x) const {
  double square = 0.0;
  for (std::size_t k = 0; k < n_; ++k) {
    const double y = x[k] / unit_[k];
    square = std::fma(y, y, square);
  }
  return std::sqrt(square);
}

double Equilibrium::largest(const double* x) const {
  double most = 0.0;
  for (std::size_t k = 0; k < n_; ++k) {
    const double y = std::abs(x[k] / unit_[k]);
    if (!(y <= most)) most = y;
  }
  return most;
}

void Equilibrium::start_at(double since) {
  const SystemView<double>& view = system_.view;
  since_ = since;
  std::copy(view.position, view.position + view.dofs, position_.begin());
  std::copy(view.integrals, view.integrals + view.own, own_start_.begin());
  const auto& coordinates = tangent_.coordinates();
  for (std::size_t k = 0; k < n_; ++k) start_[k] = view.position[coordinates[k]];
}

void Equilibrium::run_operations(const double* own, double t) {
  const SystemView<double>& view = system_.view;
  const Stage<double> here = stage_of(view, std::as_const(position_).data(),
                                      std::as_const(at_rest_).data(), own, rates_.data(), t);
  for (std::size_t k = 0; k < view.operation_count; ++k) {
    view.operations[k].run(view.operations[k].arguments, here);
  }
  system_.evaluations += 1;
}

/// Ways that are prescribed by their velocity: by Gauss' rule of five points, as far as a step.
void Equilibrium::advance_own(double t) {
  const std::size_t count = system_.view.own_count;
  if (count == 0) return;
  constexpr double kNode[] = {0.046910077030668004, 0.23076534494715845, 0.5, 0.7692346550528415,
                              0.953089922969332};
  constexpr double kShare[] = {0.11846344252809454, 0.23931433524968324, 0.28444444444444444,
                               0.23931433524968324, 0.11846344252809454};
  std::copy(own_start_.begin(), own_start_.end(), own_.begin());
  const double length = t - since_;
  if (length == 0.0) return;
  for (std::size_t j = 0; j < std::size(kNode); ++j) {
    run_operations(own_start_.data(), since_ + kNode[j] * length);
    for (std::size_t k = 0; k < count; ++k) own_[k] += kShare[j] * length * rates_[k];
  }
}

void Equilibrium::place(const double* offset, double t) {
  const auto& coordinates = tangent_.coordinates();
  for (std::size_t k = 0; k < n_; ++k) position_[coordinates[k]] = start_[k] + offset[k];
  advance_own(t);
}

void Equilibrium::take_force() {
  const auto& coordinates = tangent_.coordinates();
  for (std::size_t k = 0; k < n_; ++k) force_[k] = system_.view.force[coordinates[k]];
  if (steady_ == nullptr) return;
  for (std::size_t k = 0; k < n_; ++k) force_[k] += steady_[k];
}

void Equilibrium::evaluate(const double* offset, double t) {
  place(offset, t);
  run_operations(own_.data(), t);
  take_force();
}

void Equilibrium::linearise(const double* offset, double t) {
  place(offset, t);
  tangent_.linearise(position_.data(), at_rest_.data(), own_.data(), t, rates_.data());
  system_.evaluations += 1;
  system_.columns += tangent_.columns();
  take_force();
}

void Equilibrium::look_at_time(const double* offset, double t, double pace) {
  const double interval = kLongInterval * pace;
  evaluate(offset, t);
  scratch_ = force_;
  evaluate(offset, t + interval);
  change_ = force_;
  evaluate(offset, t + 2.0 * interval);
  double first = 0.0;
  double second = 0.0;
  for (std::size_t k = 0; k < n_; ++k) {
    first = std::max(first, unit_[k] * std::abs(change_[k] - scratch_[k]));
    second = std::max(second, unit_[k] * std::abs(force_[k] - 2.0 * change_[k] + scratch_[k]));
  }
  control_[kLinearInTime] = second <= kLinearInTimePart * first ? 1.0 : 0.0;
}

void Equilibrium::time_derivative(const double* offset, double t, double pace, double* result) {
  scratch_ = force_;
  if (control_[kLinearInTime] != 0.0) {
    const double interval = kLongInterval * pace;
    evaluate(offset, t + interval);
    for (std::size_t k = 0; k < n_; ++k) result[k] = (force_[k] - scratch_[k]) / interval;
    return;
  }
  // Differences forwards, of the fourth order: a motion may have no meaning before the start.
  constexpr double kShare[] = {-25.0 / 12.0, 4.0, -3.0, 4.0 / 3.0, -0.25};
  const double interval = kShortInterval * pace;
  for (std::size_t k = 0; k < n_; ++k) result[k] = kShare[0] * scratch_[k];
  for (int j = 1; j <= 4; ++j) {
    evaluate(offset, t + j * interval);
    for (std::size_t k = 0; k < n_; ++k) result[k] += kShare[j] * force_[k];
  }
  for (std::size_t k = 0; k < n_; ++k) result[k] /= interval;
}

// ---- K and its soft directions

bool Equilibrium::factor(const double* border) {
  std::size_t count = 0;
  if (border != nullptr) {
    std::copy(border, border + n_, borders_.begin());
    ++count;
  }
  for (std::size_t d = 0; d < neutral(); ++d) {
    const double* direction = neutral(d);
    double* dual = borders_.data() + count++ * n_;
    for (std::size_t k = 0; k < n_; ++k) dual[k] = direction[k] / (unit_[k] * unit_[k]);
  }
  return tangent_.factor(0.0, 0.0, 1.0, borders_.data(), count, stiffness_scale());
}

/// The largest row sum of K, signs as they happen to be.
double Equilibrium::scale_of_stiffness() {
  double scale = 0.0;
  for (std::uint64_t pass = 0; pass < 4; ++pass) {
    for (std::size_t k = 0; k < n_; ++k) {
      trial_[k] = unit_[k] * (uniform_symmetric({0, 0}, {pass, k, 0, 0}) < 0.0 ? -1.0 : 1.0);
    }
    tangent_.times_stiffness(trial_.data(), change_.data());
    for (std::size_t k = 0; k < n_; ++k) {
      scale = std::max(scale, unit_[k] * std::abs(change_[k]));
    }
  }
  if (scale > 0.0) return scale;
  // Nothing holds the scene: what else has the unit of an energy.
  const double time = tolerance_scales(system_.view).time;
  for (std::size_t k = 0; k < n_; ++k) {
    scale = std::max(scale, tangent_.masses()[k] * unit_[k] * unit_[k] / time / time);
  }
  return scale > 0.0 ? scale : 1.0;
}

/// Orthogonal to those before it, and of norm 1.
void Equilibrium::remove_parts(std::size_t k) {
  double* x = subspace_.data() + k * n_;
  for (int pass = 0; pass < 2; ++pass) {
    for (std::size_t j = 0; j < k; ++j) {
      const double* other = subspace_.data() + j * n_;
      double part = 0.0;
      for (std::size_t i = 0; i < n_; ++i) {
        part = std::fma(x[i] / unit_[i], other[i] / unit_[i], part);
      }
      for (std::size_t i = 0; i < n_; ++i) x[i] -= part * other[i];
    }
  }
  const double length = norm(x);
  for (std::size_t i = 0; i < n_; ++i) x[i] /= length;
}

/// Inverse iteration with what was factored last, from directions that are random but always the
/// same.
void Equilibrium::iterate_subspace(std::size_t count, int times) {
  for (std::size_t v = 0; v < count; ++v) {
    for (std::size_t k = 0; k < n_; ++k) {
      subspace_[v * n_ + k] = unit_[k] * uniform_symmetric({0, 1}, {v, k, 0, 0});
    }
    remove_parts(v);
  }
  for (int pass = 0; pass < times; ++pass) {
    for (std::size_t v = 0; v < count; ++v) {
      double* x = subspace_.data() + v * n_;
      for (std::size_t k = 0; k < n_; ++k) x[k] /= unit_[k] * unit_[k];
      tangent_.solve(x);
      const double length = norm(x);
      for (std::size_t k = 0; k < n_; ++k) x[k] /= length;
    }
    for (std::size_t v = 0; v < count; ++v) remove_parts(v);
  }
  rotate_to_ritz(count);
}

/// Diagonalises K within the subspace (Jacobi's rotations); the smallest curvatures come first.
void Equilibrium::rotate_to_ritz(std::size_t count) {
  double matrix[kMostNeutral][kMostNeutral];
  for (std::size_t v = 0; v < count; ++v) {
    tangent_.times_stiffness(subspace_.data() + v * n_, images_.data() + v * n_);
  }
  for (std::size_t v = 0; v < count; ++v) {
    for (std::size_t w = 0; w < count; ++w) {
      double sum = 0.0;
      for (std::size_t k = 0; k < n_; ++k) {
        sum = std::fma(subspace_[v * n_ + k], images_[w * n_ + k], sum);
      }
      matrix[v][w] = sum;
    }
  }
  for (int sweep = 0; sweep < kJacobiSweeps; ++sweep) {
    for (std::size_t p = 0; p < count; ++p) {
      for (std::size_t q = p + 1; q < count; ++q) {
        if (matrix[p][q] == 0.0) continue;
        const double angle = 0.5 * (matrix[q][q] - matrix[p][p]) / matrix[p][q];
        const double t =
            (angle < 0.0 ? -1.0 : 1.0) / (std::abs(angle) + std::sqrt(1.0 + angle * angle));
        const double c = 1.0 / std::sqrt(1.0 + t * t);
        const double s = t * c;
        for (std::size_t k = 0; k < count; ++k) {
          const double a = matrix[k][p];
          const double b = matrix[k][q];
          matrix[k][p] = c * a - s * b;
          matrix[k][q] = s * a + c * b;
        }
        for (std::size_t k = 0; k < count; ++k) {
          const double a = matrix[p][k];
          const double b = matrix[q][k];
          matrix[p][k] = c * a - s * b;
          matrix[q][k] = s * a + c * b;
        }
        for (std::size_t k = 0; k < n_; ++k) {
          double& a = subspace_[p * n_ + k];
          double& b = subspace_[q * n_ + k];
          const double old = a;
          a = c * old - s * b;
          b = s * old + c * b;
        }
      }
    }
  }
  for (std::size_t v = 0; v < count; ++v) {
    std::size_t least = v;
    for (std::size_t w = v + 1; w < count; ++w) {
      if (std::abs(matrix[w][w]) < std::abs(matrix[least][least])) least = w;
    }
    if (least != v) {
      std::swap(matrix[v][v], matrix[least][least]);
      std::swap_ranges(subspace_.begin() + v * n_, subspace_.begin() + (v + 1) * n_,
                       subspace_.begin() + least * n_);
    }
    ritz_[v] = matrix[v][v];
  }
}

void Equilibrium::find_neutral() {
  control_[kNeutral] = 0.0;
  control_[kNoise] = kEpsilon;
  control_[kScale] = scale_of_stiffness();
  if (n_ == 0) return;
  double heaviest = 0.0;
  for (std::size_t k = 0; k < n_; ++k) {
    heaviest = std::max(heaviest, tangent_.masses()[k] * unit_[k] * unit_[k]);
  }
  double mass = kRegularising * stiffness_scale() / heaviest;
  for (int k = 0; k < kMostTries && !tangent_.factor(mass, 0.0, 1.0); ++k) {
    mass *= kMoreRegularising;
  }
  const std::size_t count = std::min(n_, kMostNeutral);
  iterate_subspace(count, kSubspaceIterations);
  std::size_t found = 0;
  while (found < count && std::abs(ritz_[found]) <= kZeroMode * stiffness_scale()) ++found;
  std::copy(subspace_.begin(), subspace_.begin() + found * n_, control_ + kNumbers);
  control_[kNeutral] = static_cast<double>(found);
  if (found == count) return;
  control_[kNoise] =
      std::clamp(kEpsilon * stiffness_scale() / std::abs(ritz_[found]), kEpsilon, kMostNoise);
}

double Equilibrium::softest(double* direction) {
  std::fill(direction, direction + n_, 0.0);
  if (neutral() == n_ || !factor(nullptr)) return 0.0;
  iterate_subspace(std::min(n_ - neutral(), kMostNeutral), kSoftestIterations);
  std::copy(subspace_.begin(), subspace_.begin() + n_, direction);
  return ritz_[0];
}

void Equilibrium::describe(double& softest_of_all, double& log_determinant_of_all) {
  softest_of_all = log_determinant_of_all = 0.0;
  if (n_ == 0 || !factor(nullptr)) return;
  log_determinant_of_all =
      neutral() == 0 ? log_determinant() : std::numeric_limits<double>::quiet_NaN();
  std::vector<double> plain(n_);
  for (std::size_t k = 0; k < n_; ++k) {
    plain[k] = 1.0 / tolerance_scales(system_.view).in_units[tangent_.coordinates()[k]];
    log_determinant_of_all += 2.0 * log(plain[k]);
  }
  std::swap(unit_, plain);
  softest_of_all = softest(scratch_.data());
  std::swap(unit_, plain);
}

// ---- relaxing

Equilibrium::Friction Equilibrium::friction_that_reaches_all() {
  const bool definite = tangent_.factor(0.0, 1.0, 0.0) && tangent_.negative() == 0;
  return definite ? Friction::of_scene : Friction::of_masses;
}

bool Equilibrium::factor_flow(Friction friction, double rate) {
  const double masses = friction == Friction::of_masses ? rate : 0.0;
  return tangent_.factor(masses, rate - masses, 1.0) && tangent_.negative() == 0;
}

void Equilibrium::drag(Friction friction, const double* x, double* result) const {
  if (friction == Friction::of_scene) {
    tangent_.times_friction(x, result);
    return;
  }
  for (std::size_t k = 0; k < n_; ++k) result[k] = tangent_.masses()[k] * x[k];
}

double Equilibrium::scale_of_drag(Friction friction) {
  drag(friction, unit_.data(), scratch_.data());
  double scale = 0.0;
  for (std::size_t k = 0; k < n_; ++k) scale = std::max(scale, unit_[k] * std::abs(scratch_[k]));
  return scale;
}

bool Equilibrium::descend(double* offset, double t) {
  if (n_ == 0) return true;
  linearise(offset, t);
  const Friction friction = friction_that_reaches_all();
  const double fastest = scale_of_stiffness() / scale_of_drag(friction);
  double rate = fastest;  // of the flow that a step resolves: 1/h
  for (int step = 0; step < kMostFlowSteps; ++step) {
    if (step > 0) linearise(offset, t);
    for (int tries = 0;; ++tries) {
      if (tries == kMostTries) return false;
      if (!factor_flow(friction, rate)) {
        rate *= kRateAfterRefusal;
        continue;
      }
      change_ = force_;
      tangent_.solve(change_.data());
      const double size = largest(change_.data());
      if (!std::isfinite(size)) return false;
      if (size <= kRestingStep) return true;
      if (size > kLongestFlowStep) {
        rate *= kRateAfterRefusal;
        continue;
      }
      // The remainder in the rule's equation is taken as a correction of the step.
      for (std::size_t k = 0; k < n_; ++k) trial_[k] = offset[k] + change_[k];
      held_ = force_;
      evaluate(trial_.data(), t);
      drag(friction, change_.data(), scratch_.data());
      for (std::size_t k = 0; k < n_; ++k) scratch_[k] = force_[k] - rate * scratch_[k];
      tangent_.solve(scratch_.data());
      const double error = largest(scratch_.data()) / size;
      if (!(error <= kLargestFlowError)) {
        force_ = held_;
        rate *= kRateAfterRefusal;
        continue;
      }
      std::copy(trial_.begin(), trial_.end(), offset);
      if (size <= kSettledStep && rate <= kSlowRate * fastest) return true;
      if (error <= kSmallFlowError) {
        rate = std::max(kRateAfterSmallError * rate, kLeastRate * fastest);
      }
      break;
    }
  }
  return false;
}

bool Equilibrium::polish(double* offset, double t) {
  double last = 0.0;
  for (int k = 0; k < kMostPolishing; ++k) {
    linearise(offset, t);
    if (n_ == 0) return true;
    if (!factor(nullptr)) return false;
    change_ = force_;
    tangent_.solve(change_.data());
    const double size = largest(change_.data());
    if (!(size <= kLongestFlowStep)) return false;
    // Rounding: no better than the last time.
    if (k > 1 && size >= last) return true;
    for (std::size_t i = 0; i < n_; ++i) offset[i] += change_[i];
    if (size <= kPolished) return true;
    last = size;
  }
  return true;
}

}  // namespace tomlin
