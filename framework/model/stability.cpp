#include "framework/model/stability.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include <Eigen/Dense>

#include "framework/core/numbers/constants.hpp"
#include "framework/core/system/tolerance.hpp"

namespace tomlin {
namespace {

/// Up to so many coordinates the fastest mode is found exactly, beyond it bounded row by row.
constexpr std::size_t kDenseLimit = 300;
/// Up to so many the slowest one is: a second for a run that takes longer by far.
constexpr std::size_t kDenseLimitOfSlowest = 1000;
/// An eigenvalue below this part of the largest is zero: its mode is unconstrained.
constexpr double kLeastEigenvalueRatio = 1e-12;

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
    if (!dense_ && is_particles(body1) && is_particles(body2)) {
      add_entry(index(body1, i, a), index(body1, i, b), value);
      add_entry(index(body2, j, a), index(body2, j, b), value);
      add_entry(index(body1, i, a), index(body2, j, b), value);
      add_entry(index(body2, j, a), index(body1, i, b), value);
      return;
    }
    add(parts(body1, i, a), parts(body1, i, b), value);
    add(parts(body2, j, a), parts(body2, j, b), value);
    add(parts(body1, i, a), parts(body2, j, b), -value);
    add(parts(body2, j, a), parts(body1, i, b), -value);
  }

  void block(std::size_t body1, std::size_t i, int a, std::size_t body2, std::size_t j, int b,
             double value) override {
    add(parts(body1, i, a), parts(body2, j, b), value);
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
        const double response =
            model_.system().view.inverse_mass[slot.offset + a * slot.stride + i];
        sum += weight[i] * weight[i] * response;
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

  /// Eigenvalues of a dense matrix.
  std::vector<double> eigenvalues() const {
    if (matrix_.rows() == 0) return {};
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix_, Eigen::EigenvaluesOnly);
    return {solver.eigenvalues().begin(), solver.eigenvalues().end()};
  }

  double largest() const {
    if (dense_) {
      const std::vector<double> all = eigenvalues();
      return all.empty() ? 0.0 : std::max(0.0, *std::max_element(all.begin(), all.end()));
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
        for (int d = 0; d < axes; ++d) root_.push_back(std::sqrt(body.response[d]));
        if (body.rotor) {
          for (const double moment : body.moments) {
            root_.push_back(moment > 0.0 ? std::sqrt(1.0 / moment) : 0.0);
          }
        } else {
          root_.push_back(std::sqrt(body.response_of_rotation));
        }
        n += axes + (body.rotor ? 3 : 1);
      } else if (slot.mapped) {
        first_.back() = kNone;
      } else {
        const double* inverse = model_.system().view.inverse_mass + slot.offset;
        for (std::size_t i = 0; i < slot.count; ++i) {
          for (int d = 0; d < axes; ++d) root_.push_back(std::sqrt(inverse[d * slot.stride + i]));
        }
        n += slot.count * axes;
      }
    }
    return n;
  }

  /// How a position follows from coordinates: by one of them, or by a rigid body's centre and
  /// rotation, or rotations. Those without one come last.
  struct Part {
    std::ptrdiff_t coordinate = kNone;
    double factor = 0.0;
  };
  using Parts = std::array<Part, 4>;
  using Arm = std::array<double, 3>;  ///< how far a position moves by each rotation

  Parts parts(std::size_t b, std::size_t particle, int axis) const {
    const Model::Body& body = model_.bodies()[b];
    if (first_[b] == kNone) return {};
    if (body.bound.slot.rigid) return rigid_parts(b, axis, across(body, body.arms[particle], axis));
    return {
        Part{first_[b] + static_cast<std::ptrdiff_t>(particle) * model_.dimension() + axis, 1.0}};
  }

  Parts weighted_parts(std::size_t b, const double* weight, int axis) const {
    const Model::Body& body = model_.bodies()[b];
    Arm arm{};
    for (std::size_t i = 0; i < body.arms.size(); ++i) {
      const Arm of_particle = across(body, body.arms[i], axis);
      for (std::size_t k = 0; k < arm.size(); ++k) arm[k] += weight[i] * of_particle[k];
    }
    return rigid_parts(b, axis, arm);
  }

  Parts rigid_parts(std::size_t b, int axis, const Arm& arm) const {
    const std::ptrdiff_t rotation = first_[b] + model_.dimension();
    Parts parts = {Part{first_[b] + axis, 1.0}, Part{rotation, arm[0]}};
    if (!model_.bodies()[b].rotor) return parts;
    parts[2] = {rotation + 1, arm[1]};
    parts[3] = {rotation + 2, arm[2]};
    return parts;
  }

  /// How far a position moves along an axis when the body turns by a small angle: in the plane
  /// about its pivot, in space about each of its principal axes.
  static Arm across(const Model::Body& body, const std::array<double, 3>& arm, int axis) {
    if (body.rotor) {
      const Matrix3 axes = matrix_of(body.orientation);
      const auto next = static_cast<std::size_t>((axis + 1) % 3);
      const auto last = static_cast<std::size_t>((axis + 2) % 3);
      Arm moved;
      for (std::size_t k = 0; k < 3; ++k) {
        moved[k] = axes[3 * next + k] * arm[last] - axes[3 * last + k] * arm[next];
      }
      return moved;
    }
    if (body.dimension != 2) return {};
    return {axis == 0 ? body.pivot[1] - arm[1] : arm[0] - body.pivot[0]};
  }

  // Pairs of particles that are free, or fixed, are the most of a large system.
  bool is_particles(std::size_t b) const { return !model_.bodies()[b].bound.slot.rigid; }
  std::ptrdiff_t index(std::size_t b, std::size_t particle, int axis) const {
    if (first_[b] == kNone) return kNone;
    return first_[b] + static_cast<std::ptrdiff_t>(particle) * model_.dimension() + axis;
  }
  void add_entry(std::ptrdiff_t one, std::ptrdiff_t other, double value) {
    if (one != kNone && other != kNone) rows_[one] += std::abs(value * root_[one] * root_[other]);
  }

  void add(const Parts& one, const Parts& other, double value) {
    for (const Part& i : one) {
      if (i.coordinate == kNone) break;
      for (const Part& j : other) {
        if (j.coordinate == kNone) break;
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

/// The fastest and the slowest decay by friction alone: coefficient/mass of a free particle, the
/// extreme eigenvalues of friction over mass and inertia for a rigid body.
class DampingRates : public FrictionSink {
 public:
  explicit DampingRates(const Model& model) : model_(model) {
    for (const Model::Body& body : model.bodies()) {
      coefficients_.emplace_back(body.bound.slot.count, 0.0);
    }
  }
  void site(std::size_t body, std::size_t particle, double coefficient) override {
    coefficients_[body][particle] += coefficient;
  }
  double largest() const { return extremes().largest; }
  double least() const { return extremes().least; }

 private:
  struct Extremes {
    double least = std::numeric_limits<double>::infinity();
    double largest = 0.0;
    void include(double rate) {
      least = std::min(least, rate);
      largest = std::max(largest, rate);
    }
  };

  /// Least: infinite where nothing moves.
  Extremes extremes() const {
    Extremes all;
    for (const Model::Body& body : model_.bodies()) {
      const std::vector<double>& coefficient = coefficients_[body.bound.index];
      if (body.bound.slot.rigid) {
        include_rigid(body, coefficient, all);
        continue;
      }
      if (body.bound.slot.mapped) continue;
      for (std::size_t i = 0; i < coefficient.size(); ++i) {
        all.include(coefficient[i] / body.bound.mass[i]);
      }
    }
    return all;
  }

  /// Scaled by the roots of inverse mass and inertia on both sides; what is held has none.
  static void include_rigid(const Model::Body& body, const std::vector<double>& coefficient,
                            Extremes& all) {
    if (body.rotor) {
      include_rotor(body, coefficient, all);
      return;
    }
    Eigen::Matrix3d friction = Eigen::Matrix3d::Zero();
    const bool planar = body.dimension == 2;
    const double root_of_rotation = std::sqrt(body.response_of_rotation);
    for (std::size_t i = 0; i < coefficient.size(); ++i) {
      const std::array<double, 3>& arm = body.arms[i];
      for (std::size_t d = 0; d < static_cast<std::size_t>(body.dimension); ++d) {
        const auto axis = static_cast<Eigen::Index>(d);
        Eigen::Vector3d moves = Eigen::Vector3d::Zero();
        moves[axis] = std::sqrt(body.response[d]);
        if (planar) moves[2] = (d == 0 ? -arm[1] : arm[0]) * root_of_rotation;
        friction += coefficient[i] * moves * moves.transpose();
      }
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(friction, Eigen::EigenvaluesOnly);
    // Held coordinates have no motion to be damped: their zeros are the first eigenvalues.
    std::array<double, 3> response = body.response;
    if (planar) response[2] = body.response_of_rotation;
    const auto held = std::count(response.begin(), response.end(), 0.0);
    for (auto k = held; k < 3; ++k) all.include(std::max(0.0, solver.eigenvalues()[k]));
  }

  static void include_rotor(const Model::Body& body, const std::vector<double>& coefficient,
                            Extremes& all) {
    using Vector = Eigen::Matrix<double, 6, 1>;
    using Matrix = Eigen::Matrix<double, 6, 6>;
    Matrix friction = Matrix::Zero();
    for (std::size_t i = 0; i < coefficient.size(); ++i) {
      const std::array<double, 3> arm = body.reference_arm(i);
      const Matrix3 axes = matrix_of(body.orientation);
      for (std::size_t d = 0; d < 3; ++d) {
        Vector moves = Vector::Zero();
        moves[static_cast<Eigen::Index>(d)] = std::sqrt(body.response[d]);
        for (std::size_t k = 0; k < 3; ++k) {
          // e_k x arm along the principal axes, then its part along axis d of space.
          const std::size_t next = (k + 1) % 3;
          const std::size_t last = (k + 2) % 3;
          const double by = axes[3 * d + last] * arm[next] - axes[3 * d + next] * arm[last];
          if (body.moments[k] > 0.0)
            moves[static_cast<Eigen::Index>(3 + k)] = by / std::sqrt(body.moments[k]);
        }
        friction += coefficient[i] * moves * moves.transpose();
      }
    }
    const Eigen::SelfAdjointEigenSolver<Matrix> solver(friction, Eigen::EigenvaluesOnly);
    const auto held = std::count(body.response.begin(), body.response.end(), 0.0) +
                      std::count(body.moments.begin(), body.moments.end(), 0.0);
    for (auto k = held; k < 6; ++k) all.include(std::max(0.0, solver.eigenvalues()[k]));
  }

  const Model& model_;
  std::vector<std::vector<double>> coefficients_;
};

/// Friction that is not linear damps by its bound at most, near rest as a rule, and by nothing at
/// least: it limits fixed steps, but says nothing of how motions decay.
void add_friction_bound(const Model& model, const Model::Force& force, DampingRates& most) {
  const double bound = force.friction->friction_bound();
  if (!(bound > 0.0)) return;
  for (const std::size_t b : force.bodies) {
    const std::size_t count = model.bodies()[b].bound.slot.count;
    for (std::size_t i = 0; i < count; ++i) most.site(b, i, bound);
  }
}

/// The fastest decay that friction of either kind may cause.
double largest_damping_rate(const Model& model) {
  DampingRates damping(model);
  for (const Model::Force& force : model.forces()) {
    force.friction->friction(damping);
    add_friction_bound(model, force, damping);
  }
  return damping.largest();
}

constexpr double kForever = std::numeric_limits<double>::infinity();

/// A distance from zero, in units of a mode's own time, within which no mode without growth of its
/// own grows: 0 where the scheme is not known to have one. The growth of an analytic function is
/// largest on the edge of the half disc, and changes smoothly along it.
double damped_within(double (*growth)(std::complex<double> z)) {
  constexpr double kLargestProvedStep = 2.4;  // of the classical scheme of order four it is 2.6
  constexpr int kPointsOnEdge = 32;
  constexpr double kMostGrowthByRounding = 1.0 + 1e-12;
  for (int k = 1; k <= kPointsOnEdge; ++k) {
    const double part = static_cast<double>(k) / kPointsOnEdge;
    const double angle = 0.5 * std::numbers::pi * (1.0 + part);
    if (!(growth({0.0, kLargestProvedStep * part}) <= kMostGrowthByRounding)) return 0.0;
    if (!(growth(std::polar(kLargestProvedStep, angle)) <= kMostGrowthByRounding)) return 0.0;
  }
  return kLargestProvedStep;
}

/// The points of a sweep ask the same scheme again and again.
double damped_within(const IntegratorRecord& scheme) {
  if (scheme.growth == nullptr) return 0.0;
  thread_local decltype(scheme.growth) last = nullptr;
  thread_local double reach = 0.0;
  if (last != scheme.growth) {
    last = scheme.growth;
    reach = damped_within(scheme.growth);
  }
  return reach;
}

/// Largest h up to `most` with which y' = mode y does not grow. It is known not to within `damped`
/// of its own time.
double stable_step_of(const IntegratorRecord& scheme, std::complex<double> mode,
                      double most = kForever, double damped = 0.0) {
  const double speed = std::abs(mode);
  if (!(speed > 0.0)) return most;
  // Growth of rounding, and of schemes that are neutral only to their order, is not instability.
  constexpr double kMostNeutralGrowth = 1.0 + 1e-9;
  const auto stable = [&](double h) { return scheme.growth(h * mode) <= kMostNeutralGrowth; };
  // March outwards in units of the mode's own time until it grows, then bisect.
  constexpr double kMarchStep = 0.02;
  constexpr double kLargestMarch = 50.0;
  double high = kMarchStep;
  while (high < kLargestMarch && (high < damped || stable(high / speed))) {
    if (high / speed >= most) return most;
    high += kMarchStep;
  }
  if (high >= kLargestMarch) return most;
  double low = high - kMarchStep;
  for (int pass = 0; pass < 60; ++pass) {
    const double middle = 0.5 * (low + high);
    (stable(middle / speed) ? low : high) = middle;
  }
  return std::min(most, low / speed);
}

/// Stable step for a damped oscillator, y'' = -omega^2 y - gamma y'.
double stable_step_of(const IntegratorRecord& scheme, double omega, double gamma,
                      double most = kForever, double damped = 0.0) {
  if (scheme.stable_step != nullptr) return std::min(most, scheme.stable_step(omega, gamma));
  using Complex = std::complex<double>;
  const Complex root = std::sqrt(Complex(0.25 * gamma * gamma - omega * omega, 0.0));
  const double of_one = stable_step_of(scheme, -0.5 * gamma + root, most, damped);
  // Its conjugate grows alike.
  return root.imag() != 0.0 ? of_one : stable_step_of(scheme, -0.5 * gamma - root, of_one, damped);
}

/// Whether there are steps at which an undamped oscillation does not grow.
bool stable_without_friction(const IntegratorRecord& scheme) {
  constexpr double kLeastStableStep = 0.1;  // in units of 1/omega
  return stable_step_of(scheme, 1.0, 0.0) > kLeastStableStep;
}

/// Effect of forces' internal variables on the motion: how fast they decay by themselves, and the
/// square frequency at which they swing with the velocities that drive them.
struct OwnModes {
  double rate = 0.0;
  double square = 0.0;
};

/// How forces' own variables answer, at the start, to one change of all of them or of all
/// velocities: kernels know their slopes, and variables of different particles do not see each
/// other.
class OwnResponse {
 public:
  explicit OwnResponse(Model& model)
      : change(kRelativeVelocityChange * unit_of_velocity(model)),
        own(model.system().view.integrals,
            model.system().view.integrals + model.system().view.rates),
        model_(model),
        velocity_(model.system().view.velocity,
                  model.system().view.velocity + model.system().view.dofs) {
    own.resize(own.size() + 2 * kGroup, 0.0);
    velocity_.resize(velocity_.size() + 2 * kGroup, 0.0);
    before.assign(own.size(), 0.0);
    after = before;
    evaluate(before);
    force.assign(model.system().view.force, model.system().view.force + model.system().view.dofs);
  }

  void move_own(double by) {
    for (std::size_t k = 0; k < model_.system().view.own_count; ++k) own[k] += by;
  }
  void move_velocities(double by) {
    const SystemView<double>& view = model_.system().view;
    for (std::size_t i = 0; i < view.dofs; ++i) {
      if (view.inverse_mass[i] > 0.0) velocity_[i] += by;
    }
  }
  /// Rates in `after`, forces in the system.
  void evaluate() { evaluate(after); }

  const double change;           ///< a velocity, small beside the scene's own
  AlignedVector<double> own;     ///< the variables
  AlignedVector<double> before;  ///< rates at the start
  AlignedVector<double> after;
  std::vector<double> force;  ///< at the start

 private:
  static constexpr double kRelativeVelocityChange = 1e-6;
  static double unit_of_velocity(const Model& model) {
    const ToleranceScales<double> scales = tolerance_scales(model.system().view);
    return scales.length / scales.time;
  }
  void evaluate(AlignedVector<double>& rates) {
    model_.evaluate_at(DoubleDouble(0.0), model_.system().view.position, velocity_.data(),
                       own.data(), rates.data());
  }

  Model& model_;
  AlignedVector<double> velocity_;
};

OwnModes own_modes(Model& model) {
  const SystemView<double>& view = model.system().view;
  OwnModes modes;
  if (view.own_count == 0) return modes;
  OwnResponse response(model);
  const auto largest_change = [&] {
    double most = 0.0;
    for (std::size_t k = 0; k < view.own_count; ++k) {
      most = std::max(most, std::abs(response.after[k] - response.before[k]) / response.change);
    }
    return most;
  };
  response.move_own(response.change);
  response.evaluate();
  modes.rate = largest_change();
  double acceleration = 0.0;
  for (std::size_t i = 0; i < view.dofs; ++i) {
    acceleration = std::max(acceleration, std::abs(view.force[i] - response.force[i]) /
                                              response.change * view.inverse_mass[i]);
  }
  response.move_own(-response.change);
  response.move_velocities(response.change);
  response.evaluate();
  modes.square = acceleration * largest_change();
  return modes;
}

/// How forces' own variables decay, and the friction over mass that they are on what is slow.
struct OwnDecay {
  double slowest = 0.0;   ///< time
  double friction = 0.0;  ///< the largest, 1/time; with inertia
};

OwnDecay own_decay(Model& model) {
  const SystemView<double>& view = model.system().view;
  OwnDecay decay;
  if (view.own_count == 0) return decay;
  OwnResponse response(model);
  response.move_own(response.change);
  response.evaluate();
  std::vector<double> rate(view.own_count);
  for (std::size_t k = 0; k < view.own_count; ++k) {
    rate[k] = (response.before[k] - response.after[k]) / response.change;
    if (rate[k] > 0.0) decay.slowest = std::max(decay.slowest, 1.0 / rate[k]);
  }
  response.move_own(-response.change);
  if (!view.inertial) return decay;
  response.move_velocities(response.change);
  response.evaluate();
  const std::vector<double> driven(view.force, view.force + view.dofs);
  // To where they come to rest at that velocity.
  for (std::size_t k = 0; k < view.own_count; ++k) {
    if (rate[k] > 0.0) response.own[k] += (response.after[k] - response.before[k]) / rate[k];
  }
  response.evaluate();
  for (std::size_t i = 0; i < view.dofs; ++i) {
    const double slowed = (driven[i] - view.force[i]) / response.change * view.inverse_mass[i];
    decay.friction = std::max(decay.friction, slowed);
  }
  return decay;
}

/// Slowest time of an oscillator of this square frequency, whose friction over mass lies between
/// two bounds; 0 where it has neither stiffness nor friction.
double slowest_time_of_mode(double square, double least_friction, double most_friction) {
  if (!(square > 0.0)) return least_friction > 0.0 ? 1.0 / least_friction : 0.0;
  double slowest = kTau / std::sqrt(square);
  if (least_friction > 0.0) slowest = std::max(slowest, 2.0 / least_friction);
  const double half = 0.5 * most_friction;
  if (square >= half * half) return slowest;
  return std::max(least_friction > 0.0 ? 2.0 / least_friction : 0.0,
                  (half + std::sqrt(half * half - square)) / square);
}

/// Largest effect of a curvature of the energy per particle on the fastest motion of a body: its
/// square frequency, or without inertia the relaxation rate.
double response_to_sites(const Model& model, const Model::Body& body, double curvature) {
  const BodySlot<double>& slot = body.bound.slot;
  double most = 0.0;
  if (slot.rigid) {
    double squares = 0.0;
    for (const auto& arm : body.arms) {
      for (std::size_t d = 0; d < arm.size(); ++d) {
        const double part = arm[d] - (d < 2 ? body.pivot[d] : 0.0);
        squares += part * part;
      }
    }
    for (int d = 0; d < model.dimension(); ++d) {
      most = std::max(most, static_cast<double>(slot.count) * body.response[d]);
    }
    most = std::max(most, squares * body.response_of_rotation);
  } else if (!slot.mapped) {
    const double* inverse = model.system().view.inverse_mass + slot.offset;
    for (int d = 0; d < model.dimension(); ++d) {
      for (std::size_t i = 0; i < slot.count; ++i) {
        most = std::max(most, inverse[d * slot.stride + i]);
      }
    }
  }
  return curvature * most;
}

/// Kernels may read a group past the end.
AlignedVector<double> rates_for(const Model& model) {
  return AlignedVector<double>(model.system().view.rates + 2 * kGroup, 0.0);
}

Stage<double> stage_at_state(const Model& model, AlignedVector<double>& rates) {
  const SystemView<double>& view = model.system().view;
  return stage_of(view, view.position, view.velocity, view.integrals, rates.data(), 0.0);
}

Stiffness stiffness_at(Model& model, double time, bool without_bonds) {
  const SystemView<double>& view = model.system().view;
  AlignedVector<double> rates = rates_for(model);
  model.evaluate_at(DoubleDouble(time), view.position, view.velocity, view.integrals, rates.data());
  const Stage<double> here = stage_at_state(model, rates);
  const DoubleDouble anchored = model.anchor_time();
  model.anchor(DoubleDouble(time));
  ScaledHessian springs(model, model.coordinate_count() <= kDenseLimit);
  DampingRates damping(model);
  std::vector<double> site_bounds(model.bodies().size(), 0.0);
  for (const Model::Force& force : model.forces()) {
    if (without_bonds && is_bonds(model.assembly(), force)) continue;
    const double bound = force.curvature->curvature_bound();
    if (bound >= 0.0) {
      for (const std::size_t b : force.bodies) {
        site_bounds[b] += response_to_sites(model, model.bodies()[b], bound);
      }
    } else {
      force.curvature->hessian(here, springs);
    }
    force.friction->friction(damping);
  }
  model.anchor(anchored);
  const double fastest =
      springs.largest() + *std::max_element(site_bounds.begin(), site_bounds.end());
  if (!view.inertial) return {.relaxation_rate = fastest};
  return {.frequency = std::sqrt(fastest),
          .damping_rate = damping.largest(),
          .least_damping_rate = damping.least(),
          .spring_frequency = std::sqrt(springs.largest())};
}

/// Repeats itself along an axis: what moves over it sees its mean.
bool is_substrate(const Model& model, const Model::Force& force) {
  for (const SceneForce& one : model.scene().forces) {
    if (one.name != force.name) continue;
    for (int d = 0; d < model.dimension(); ++d) {
      if (one.record->period(one.description.get(), d) > 0.0) return true;
    }
  }
  return false;
}

double share_of_stiffness(const Model& model, const Model::Force& force,
                          const Stage<double>& here) {
  double share = 0.0;
  const double bound = force.curvature->curvature_bound();
  if (bound >= 0.0) {
    for (const std::size_t b : force.bodies) {
      share = std::max(share, response_to_sites(model, model.bodies()[b], bound));
    }
  } else {
    ScaledHessian alone(model, model.coordinate_count() <= kDenseLimit);
    force.curvature->hessian(here, alone);
    share = alone.largest();
  }
  if (!model.system().view.inertial) return share;
  DampingRates damping(model);
  force.friction->friction(damping);
  add_friction_bound(model, force, damping);
  return std::max(share, damping.largest() * damping.largest());
}

}  // namespace

Stiffness stiffness_of(Model& model, bool without_bonds) {
  constexpr int kTimes = 32;  // of energies that change with time, over the run
  const bool changes =
      std::any_of(model.forces().begin(), model.forces().end(), [](const Model::Force& force) {
        const Traits& traits = force.traits;
        return traits.depends_on_time && traits.conservative && !traits.does_work;
      });
  Stiffness most = stiffness_at(model, 0.0, without_bonds);
  if (!changes) return most;
  for (int k = 1; k <= kTimes; ++k) {
    // Positions that no period of the scene hits again and again.
    const double turn = 0.6180339887498949 * k;
    const Stiffness one =
        stiffness_at(model, (turn - std::floor(turn)) * model.scene().run.duration, without_bonds);
    most.frequency = std::max(most.frequency, one.frequency);
    most.spring_frequency = std::max(most.spring_frequency, one.spring_frequency);
    most.relaxation_rate = std::max(most.relaxation_rate, one.relaxation_rate);
  }
  return most;
}

double damping_rate_of(const Model& model) {
  DampingRates damping(model);
  for (const Model::Force& force : model.forces()) force.friction->friction(damping);
  return damping.largest();
}

std::optional<double> slowest_time_of(Model& model) {
  if (model.coordinate_count() > kDenseLimitOfSlowest) return std::nullopt;
  const SystemView<double>& view = model.system().view;
  const OwnDecay own = own_decay(model);
  AlignedVector<double> rates = rates_for(model);
  model.evaluate_at(DoubleDouble(0.0), view.position, view.velocity, view.integrals, rates.data());
  const Stage<double> here = stage_at_state(model, rates);
  ScaledHessian springs(model, true);
  DampingRates damping(model);
  for (const Model::Force& force : model.forces()) {
    force.friction->friction(damping);
    if (force.curvature->curvature_bound() < 0.0 && !is_substrate(model, force)) {
      force.curvature->hessian(here, springs);
    }
  }
  const std::vector<double> squares = springs.eigenvalues();
  double slowest = own.slowest;
  if (squares.empty()) return slowest;
  const double nothing = kLeastEigenvalueRatio * *std::max_element(squares.begin(), squares.end());
  for (const double square : squares) {
    if (!view.inertial) {
      if (square > nothing) slowest = std::max(slowest, 1.0 / square);
      continue;
    }
    const double held = square > nothing ? square : 0.0;
    // A memory slows what is faster than it the less.
    const double swing = held * own.slowest * own.slowest;
    const double least = damping.least() + own.friction / (1.0 + swing);
    if (!std::isfinite(least)) continue;
    slowest =
        std::max(slowest, slowest_time_of_mode(held, least, damping.largest() + own.friction));
  }
  return slowest;
}

std::string stiffest_force_of(const Model& model) {
  AlignedVector<double> rates = rates_for(model);
  const Stage<double> here = stage_at_state(model, rates);
  std::string name;
  double most = 0.0;
  for (const Model::Force& force : model.forces()) {
    const double share = share_of_stiffness(model, force, here);
    if (share > most) {
      most = share;
      name = force.name;
    }
  }
  return name;
}

double fastest_spin_of(const Model& model) {
  double fastest = 0.0;
  for (const Model::Body& body : model.bodies()) {
    if (!body.rotor) continue;
    const double* u = model.system().view.velocity + body.bound.slot.centre + 3;
    for (int k = 0; k < 3; ++k) fastest = std::max(fastest, std::abs(u[k]));
  }
  return fastest;
}

double stable_step_of(Model& model, const IntegratorRecord& scheme, double enough) {
  if (scheme.adaptive) return kForever;
  Stiffness fastest = stiffness_of(model, scheme.splits_bonds);
  const double damped = scheme.stable_step == nullptr ? damped_within(scheme) : 0.0;
  if (!model.system().view.inertial) {
    const double known = damped / fastest.relaxation_rate;
    return known > enough ? known : stable_step_of(scheme, -fastest.relaxation_rate);
  }
  const OwnModes own = own_modes(model);
  fastest.frequency = std::sqrt(fastest.frequency * fastest.frequency + own.square);
  fastest.damping_rate = std::max(largest_damping_rate(model), own.rate);
  // Slower modes meet the same damping: the worst of a range of frequencies counts.
  const double spin = fastest_spin_of(model);
  double largest = spin > 0.0 ? kLargestRotation / spin : kForever;
  // No root of y'' = -omega^2 y - gamma y' is larger than both omega and gamma.
  const double known = damped / std::max(fastest.frequency, fastest.damping_rate);
  if (std::min(known, largest) > enough) return std::min(known, largest);
  constexpr int kModes = 16;
  for (int k = kModes; k >= 0; --k) {
    const double omega = fastest.frequency * k / kModes;
    largest = stable_step_of(scheme, omega, fastest.damping_rate, largest, damped);
  }
  // Some motions meet less; none is safe to take for a scheme that only friction keeps from
  // growing.
  const double least = stable_without_friction(scheme) ? 0.0 : fastest.least_damping_rate;
  return stable_step_of(scheme, fastest.frequency, least, largest, damped);
}

double longest_lasting_step_of(Model& model, const IntegratorRecord& scheme) {
  constexpr double kMarginOfBound = 2.0;
  if (scheme.growth == nullptr || !model.system().view.inertial) return kForever;
  const Stiffness fastest = stiffness_of(model);
  // Whatever springs do, the two rates of a damped coordinate add up to its friction's.
  const double by_friction = stable_step_of(scheme, {-0.5 * fastest.damping_rate, 0.0});
  const double by_springs = stable_step_of(scheme, fastest.spring_frequency, fastest.damping_rate);
  return kMarginOfBound * std::min(by_friction, by_springs);
}

}  // namespace tomlin
