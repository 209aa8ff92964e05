#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Dense>

#include "tests/scenarios/scenario_fixture.hpp"

/// Reference results for a tip without inertia in a bath, by quadrature and by linear algebra: no
/// random number is drawn here.
namespace tomlin::test {

/// xi x' = force + (2 pi V0/a) sin(2 pi x/a) + noise, in units of the period a and of xi.
struct BrownianTip {
  double V0 = 0.1;
  double temperature = 0.1;
  double force = 0.0;

  double drift(double x) const { return force + 2.0 * kPi * V0 * std::sin(2.0 * kPi * x); }
  double slope(double x) const { return 4.0 * kPi * kPi * V0 * std::cos(2.0 * kPi * x); }

  /// v = T (1 - exp(-F/T)) / integral over x and y from 0 to 1 of
  /// exp((V(x) - V(x - y) - F y)/T), of which that over x is a Bessel function.
  double stratonovich_velocity() const {
    constexpr int kPoints = 4000;  // of the midpoint rule: relative error 1e-6
    double integral = 0.0;
    for (int j = 0; j < kPoints; ++j) {
      const double y = (j + 0.5) / kPoints;
      const double barrier = 2.0 * V0 * std::sin(kPi * y) / temperature;
      integral += std::cyl_bessel_i(0.0, barrier) * std::exp(-force * y / temperature) / kPoints;
    }
    return temperature * -std::expm1(-force / temperature) / integral;
  }

  /// Mean velocity of a scheme at a finite step h, from the stationary state of its Markov chain on
  /// the circle:  y' = y + h drift(y + c z) + s z,  s = sqrt(2 T h), z normal. c = 0 is Euler and
  /// Maruyama's scheme; c = s/2 that of Leimkuhler and Matthews, whose position is y + c z.
  double velocity_of_chain(double h, bool averaged_noise) const {
    constexpr int kPoints = 200;   // a fifth of s and less: periodic quadrature is exact then
    constexpr double kFar = 12.0;  // of normal numbers
    constexpr double kCloseTo = 1e-14;
    const double s = std::sqrt(2.0 * temperature * h);
    const double c = averaged_noise ? 0.5 * s : 0.0;
    const auto normal = [](double z) { return std::exp(-0.5 * z * z) / std::sqrt(2.0 * kPi); };
    Eigen::MatrixXd chain = -Eigen::MatrixXd::Identity(kPoints, kPoints);
    Eigen::VectorXd drifts = Eigen::VectorXd::Zero(kPoints);
    for (int i = 0; i < kPoints; ++i) {
      const double y = static_cast<double>(i) / kPoints;
      for (int m = -2 * kPoints; m <= 2 * kPoints; ++m) {
        const double moved = static_cast<double>(m) / kPoints;
        double z = (moved - h * drift(y)) / s;
        if (std::abs(z) > kFar) continue;
        double by_z = s;
        for (double change = 1.0; std::abs(change) > kCloseTo * (1.0 + std::abs(z)); z -= change) {
          by_z = h * c * slope(y + c * z) + s;
          change = (h * drift(y + c * z) + s * z - moved) / by_z;
        }
        const double probability = normal(z) / (by_z * kPoints);
        chain((i + m + 2 * kPoints) % kPoints, i) += probability;
        drifts(i) += probability * drift(y + c * z);
      }
    }
    chain.row(0).setOnes();
    const Eigen::VectorXd norm = Eigen::VectorXd::Unit(kPoints, 0);
    return drifts.dot(chain.partialPivLu().solve(norm));
  }
};

/// A BrownianTip held by a spring of stiffness k whose end X = 1/2 + v t moves. Its Smoluchowski
/// equation, by finite volumes in the frame of the spring's end, y = x - X:
///   dp/dt = d/dy (U'(y, t) p + T dp/dy),  U = V(y + X) + k y^2/2 + v y,
/// with the fluxes of Scharfetter and Gummel, which have exactly the Boltzmann distribution at
/// rest, and Crank and Nicolson's rule in time. After some periods the state is periodic.
class SmoluchowskiTip {
 public:
  SmoluchowskiTip(double V0, double temperature, double k, double v, int cells, int steps)
      : V0_(V0), temperature_(temperature), k_(k), v_(v), steps_(steps) {
    constexpr double kWidths =
        9.0;  // thermal ones of the spring beyond substrate and drag stretch it
    const double thermal = kWidths * std::sqrt(temperature / k);
    low_ = -((2.0 * kPi * V0 + v) / k + thermal);
    width_ = (thermal + 1.0 - low_) / cells;
    const Eigen::ArrayXd y = positions(cells);
    p_ = (-0.5 * k * y * y / temperature).exp();
    p_ /= p_.sum();
    now_ = rates(0.5);
  }

  /// Over the last of so many periods.
  double mean_force(int periods) {
    double mean = 0.0;
    for (int period = 0; period < periods; ++period) {
      mean = 0.0;
      for (int n = 0; n < steps_; ++n) {
        const double before = force();
        take(0.5 + (n + 1.0) / steps_);
        mean += 0.5 * (before + force()) / steps_;
      }
    }
    return mean;
  }

 private:
  /// Rates of the probability in a cell: from the one below, of itself, from the one above.
  struct Rates {
    Eigen::ArrayXd below, self, above;
  };

  Eigen::ArrayXd positions(Eigen::Index cells) const {
    return low_ +
           width_ * (Eigen::ArrayXd::LinSpaced(cells, 0.0, static_cast<double>(cells - 1)) + 0.5);
  }
  double force() const { return -k_ * (p_ * positions(p_.size())).sum(); }

  Rates rates(double X) const {
    const auto bernoulli = [](double x) {
      constexpr double kSmall = 1e-8;
      return std::abs(x) < kSmall ? 1.0 - 0.5 * x : x / std::expm1(x);
    };
    const Eigen::Index n = p_.size();
    const Eigen::ArrayXd y = positions(n);
    const Eigen::ArrayXd U = V0_ * (2.0 * kPi * (y + X)).cos() + 0.5 * k_ * y * y + v_ * y;
    Rates result{Eigen::ArrayXd::Zero(n), Eigen::ArrayXd::Zero(n), Eigen::ArrayXd::Zero(n)};
    const double hop = temperature_ / (width_ * width_);
    for (Eigen::Index i = 0; i + 1 < n; ++i) {
      const double step = (U(i + 1) - U(i)) / temperature_;
      const double up = hop * bernoulli(step);
      const double down = hop * bernoulli(-step);
      result.self(i) -= up;
      result.above(i) += down;
      result.below(i + 1) += up;
      result.self(i + 1) -= down;
    }
    return result;
  }

  /// (1 - h/2 L') p' = (1 + h/2 L) p, by elimination.
  void take(double X) {
    const double half = 0.5 / (v_ * steps_);
    const Eigen::Index n = p_.size();
    Eigen::ArrayXd right = p_ * (1.0 + half * now_.self);
    right.tail(n - 1) += half * now_.below.tail(n - 1) * p_.head(n - 1);
    right.head(n - 1) += half * now_.above.head(n - 1) * p_.tail(n - 1);
    now_ = rates(X);
    Eigen::ArrayXd upper = Eigen::ArrayXd::Zero(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double below = i > 0 ? -half * now_.below(i) : 0.0;
      const double pivot = 1.0 - half * now_.self(i) - (i > 0 ? below * upper(i - 1) : 0.0);
      upper(i) = -half * now_.above(i) / pivot;
      right(i) = (right(i) - (i > 0 ? below * right(i - 1) : 0.0)) / pivot;
    }
    p_(n - 1) = right(n - 1);
    for (Eigen::Index i = n - 2; i >= 0; --i) p_(i) = right(i) - upper(i) * p_(i + 1);
  }

  double V0_, temperature_, k_, v_;
  int steps_;
  double low_ = 0.0;
  double width_ = 0.0;
  Eigen::ArrayXd p_;
  Rates now_;
};

}  // namespace tomlin::test
