#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>

#include <Eigen/Dense>

#include "framework/model/model.hpp"
#include "framework/model/storage.hpp"

/// The largest stable step, from bounds on curvature and damping before the first step.
namespace tomlin {
namespace {

/// Up to so many coordinates the fastest mode is found exactly, beyond it bounded row by row.
constexpr std::size_t kDenseLimit = 300;

/// Second derivatives scaled by mass: M^(-1/2) H M^(-1/2), or its absolute row sums. Particles of a
/// rigid body count by what they do to its centre and its rotation.
class ScaledHessian : public HessianSink {
 public:
  ScaledHessian(const Model& model, bool dense) : model_(model), dense_(dense) {
    const std::size_t n = model.bodies().empty() ? 0 : index_coordinates();
    if (dense_) {
      matrix_ = Eigen::MatrixXd::Zero(n, n);
    } else {
      rows_.assign(n, 0.0);
    }
  }

  void site(std::size_t body, std::size_t particle, int a, int b, double value) override {
    add(parts(body, particle, a), parts(body, particle, b), value);
  }

  void pair(std::size_t body1, std::size_t i, std::size_t body2, std::size_t j, int a, int b,
            double value) override {
    add(parts(body1, i, a), parts(body1, i, b), value);
    add(parts(body2, j, a), parts(body2, j, b), value);
    add(parts(body1, i, a), parts(body2, j, b), -value);
    add(parts(body2, j, a), parts(body1, i, b), -value);
  }

  void centre(std::size_t body, const double* weight, int a, int b, double value) override {
    const BodySlot<double>& slot = model_.bodies()[body].bound.slot;
    if (slot.rigid) {
      add(weighted_parts(body, weight, a), weighted_parts(body, weight, b), value);
      return;
    }
    if (!dense_) {
      // Largest eigenvalue of value * w w^T scaled by mass: value * sum w_i^2 / m_i.
      double sum = 0.0;
      for (std::size_t i = 0; i < slot.count; ++i) {
        sum += weight[i] * weight[i] / model_.bodies()[body].bound.mass[i];
      }
      if (a == b) common_ += std::abs(value) * sum;
      return;
    }
    for (std::size_t i = 0; i < slot.count; ++i) {
      if (weight[i] == 0.0) continue;
      for (std::size_t j = 0; j < slot.count; ++j) {
        add(parts(body, i, a), parts(body, j, b), value * weight[i] * weight[j]);
      }
    }
  }

  double largest() const {
    if (dense_) {
      if (matrix_.rows() == 0) return 0.0;
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix_, Eigen::EigenvaluesOnly);
      return std::max(0.0, solver.eigenvalues().maxCoeff());
    }
    return rows_.empty() ? 0.0 : *std::max_element(rows_.begin(), rows_.end()) + common_;
  }

 private:
  static constexpr std::ptrdiff_t kNone = -1;

  std::size_t index_coordinates() {
    std::size_t n = 0;
    for (const Model::Body& body : model_.bodies()) {
      const BodySlot<double>& slot = body.bound.slot;
      first_.push_back(static_cast<std::ptrdiff_t>(n));
      const int axes = model_.dimension();
      if (slot.rigid) {
        for (int d = 0; d < axes; ++d) root_.push_back(1.0 / std::sqrt(body.total_mass));
        root_.push_back(body.inertia > 0.0 ? 1.0 / std::sqrt(body.inertia) : 0.0);
        n += axes + 1;
      } else if (slot.mapped) {
        first_.back() = kNone;
      } else {
        for (std::size_t i = 0; i < slot.count; ++i) {
          for (int d = 0; d < axes; ++d) root_.push_back(1.0 / std::sqrt(body.bound.mass[i]));
        }
        n += slot.count * axes;
      }
    }
    return n;
  }

  /// How a place follows from coordinates: by one of them, or by a rigid body's centre and
  /// rotation.
  struct Part {
    std::ptrdiff_t coordinate = kNone;
    double factor = 0.0;
  };
  using Parts = std::array<Part, 2>;

  Parts parts(std::size_t b, std::size_t particle, int axis) const {
    const Model::Body& body = model_.bodies()[b];
    if (first_[b] == kNone) return {};
    if (body.bound.slot.rigid) return rigid_parts(b, axis, across(body.arms[particle], axis));
    return {
        Part{first_[b] + static_cast<std::ptrdiff_t>(particle) * model_.dimension() + axis, 1.0},
        Part{}};
  }

  Parts weighted_parts(std::size_t b, const double* weight, int axis) const {
    const Model::Body& body = model_.bodies()[b];
    double arm = 0.0;
    for (std::size_t i = 0; i < body.arms.size(); ++i)
      arm += weight[i] * across(body.arms[i], axis);
    return rigid_parts(b, axis, arm);
  }

  Parts rigid_parts(std::size_t b, int axis, double arm) const {
    return {Part{first_[b] + axis, 1.0}, Part{first_[b] + model_.dimension(), arm}};
  }

  /// How far a place moves along an axis when the body turns by a small angle.
  static double across(const std::vector<double>& arm, int axis) {
    return axis == 0 ? -arm[1] : arm[0];
  }

  void add(const Parts& one, const Parts& other, double value) {
    for (const Part& i : one) {
      for (const Part& j : other) {
        if (i.coordinate == kNone || j.coordinate == kNone) continue;
        const double scaled =
            value * i.factor * j.factor * root_[i.coordinate] * root_[j.coordinate];
        if (dense_) {
          matrix_(i.coordinate, j.coordinate) += scaled;
        } else {
          rows_[i.coordinate] += std::abs(scaled);
        }
      }
    }
  }

  const Model& model_;
  bool dense_;
  std::vector<std::ptrdiff_t> first_;
  std::vector<double> root_;
  Eigen::MatrixXd matrix_;
  std::vector<double> rows_;
  double common_ = 0.0;
};

class LargestDampingRate : public FrictionSink {
 public:
  explicit LargestDampingRate(const Model& model) : model_(model) {
    for (const Model::Body& body : model.bodies()) sums_.emplace_back(body.bound.slot.count, 0.0);
  }
  void site(std::size_t body, std::size_t particle, double coefficient) override {
    sums_[body][particle] += coefficient / model_.bodies()[body].bound.mass[particle];
  }
  double largest() const {
    double largest = 0.0;
    for (const auto& body : sums_) {
      for (const double rate : body) largest = std::max(largest, rate);
    }
    return largest;
  }

 private:
  const Model& model_;
  std::vector<std::vector<double>> sums_;
};

/// Largest h at which a damped oscillator, y'' = -omega^2 y - gamma y', does not grow.
double stable_step_of(const IntegratorRecord& scheme, double omega, double gamma) {
  using Complex = std::complex<double>;
  const Complex root = std::sqrt(Complex(0.25 * gamma * gamma - omega * omega, 0.0));
  const Complex modes[2] = {-0.5 * gamma + root, -0.5 * gamma - root};
  double largest = std::numeric_limits<double>::infinity();
  for (const Complex& mode : modes) {
    const double speed = std::abs(mode);
    if (!(speed > 0.0)) continue;
    // Growth of rounding, and of schemes that are neutral only to their order, is not instability.
    constexpr double kTolerated = 1.0 + 1e-9;
    const auto stable = [&](double h) { return scheme.growth(h * mode) <= kTolerated; };
    // March outwards in units of the mode's own time until it grows, then bisect.
    constexpr double kMarch = 0.02;
    constexpr double kFarthest = 50.0;
    double high = kMarch;
    while (high < kFarthest && stable(high / speed)) high += kMarch;
    if (high >= kFarthest) continue;
    double low = high - kMarch;
    for (int pass = 0; pass < 60; ++pass) {
      const double middle = 0.5 * (low + high);
      (stable(middle / speed) ? low : high) = middle;
    }
    largest = std::min(largest, low / speed);
  }
  return largest;
}

}  // namespace

Model::Stiffness Model::stiffness() {
  const DoubleDouble zero(0.0);
  evaluate_at(zero, system_.view.position, system_.view.velocity, system_.view.integrals,
              storage_->rates.data());
  const Stage<double> here = stage(system_.view.position, system_.view.velocity,
                                   system_.view.integrals, storage_->rates.data());
  ScaledHessian springs(*this, coordinate_count() <= kDenseLimit);
  LargestDampingRate damping(*this);
  std::vector<double> site_bounds(bodies_.size(), 0.0);
  for (const Force& force : forces_) {
    const double bound = force.bound->curvature_bound();
    if (bound >= 0.0) {
      for (const std::size_t b : force.bodies) {
        const auto& mass = bodies_[b].bound.mass;
        if (bodies_[b].bound.coordinates == "fixed") continue;
        site_bounds[b] += bound / *std::min_element(mass.begin(), mass.end());
      }
    } else {
      force.bound->hessian(here, springs);
    }
    force.bound->friction(damping);
  }
  const double squared =
      springs.largest() + *std::max_element(site_bounds.begin(), site_bounds.end());
  return {std::sqrt(squared), damping.largest()};
}

double Model::share_of_stiffness(const Force& force, const Stage<double>& here) {
  double share = 0.0;
  const double bound = force.bound->curvature_bound();
  if (bound >= 0.0) {
    for (const std::size_t b : force.bodies) {
      const auto& mass = bodies_[b].bound.mass;
      share = std::max(share, bound / *std::min_element(mass.begin(), mass.end()));
    }
  } else {
    ScaledHessian alone(*this, coordinate_count() <= kDenseLimit);
    force.bound->hessian(here, alone);
    share = alone.largest();
  }
  LargestDampingRate damping(*this);
  force.bound->friction(damping);
  return std::max(share, damping.largest() * damping.largest());
}

std::string Model::stiffest_force() {
  const Stage<double> here = stage(system_.view.position, system_.view.velocity,
                                   system_.view.integrals, storage_->rates.data());
  std::string name;
  double most = 0.0;
  for (const Force& force : forces_) {
    const double share = share_of_stiffness(force, here);
    if (share > most) {
      most = share;
      name = force.name;
    }
  }
  return name;
}

double Model::stable_step(const IntegratorRecord& scheme) {
  if (scheme.adaptive) return std::numeric_limits<double>::infinity();
  const Stiffness fastest = stiffness();
  // Slower modes meet the same damping: the worst of a range of frequencies counts.
  double largest = std::numeric_limits<double>::infinity();
  constexpr int kModes = 16;
  for (int k = 0; k <= kModes; ++k) {
    const double omega = fastest.frequency * k / kModes;
    largest = std::min(largest, stable_step_of(scheme, omega, fastest.damping_rate));
  }
  return std::min(largest, stable_step_of(scheme, fastest.frequency, 0.0));
}

}  // namespace tomlin
