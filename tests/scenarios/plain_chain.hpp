#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace tomlin::test {

/// The Frenkel-Kontorova chain once more, closed around `periods` periods: std::sin, Euler steps,
/// nothing of the engine. Unit springs, the potential (K/(2 pi)^2)(1 - cos 2 pi u).
class PlainChain {
 public:
  PlainChain(double K, std::size_t count, double periods) : K_(K), periods_(periods), u_(count) {
    for (std::size_t i = 0; i < count; ++i) u_[i] = spacing() * static_cast<double>(i);
  }

  /// Down the gradient. With `centre_held` the mean force is taken off each particle's, so that the
  /// centre stays.
  void relax(double time, bool centre_held = false) {
    for (int step = 0; step < static_cast<int>(time / kStep); ++step) {
      const auto f = forces();
      const double taken = centre_held ? mean(f) : 0.0;
      for (std::size_t i = 0; i < u_.size(); ++i) u_[i] += kStep * (f[i] - taken);
    }
  }

  void shift(double by) {
    for (double& u : u_) u += by;
  }

  /// Returns the mean force of the substrate on a particle: at rest with the centre held it is
  /// minus the force that holds it.
  double mean_force() const { return mean(forces()); }

  /// Less that of the unstretched chain at the bottom of its wells.
  double energy() const {
    double sum = 0.0;
    for (std::size_t i = 0; i < u_.size(); ++i) {
      const double stretch = after(u_, i, periods_) - u_[i] - spacing();
      sum += 0.5 * stretch * stretch + K_ / (kTwoPi * kTwoPi) * (1.0 - std::cos(kTwoPi * u_[i]));
    }
    return sum;
  }

  /// Velocity over force of the slow, unpinned chain at friction 1: it slides along its zero mode
  /// e, which dissipates v^2 sum e_i^2 / (mean e)^2 = F N v.
  double mobility(double time) const {
    std::vector<double> e(u_.size(), 1.0);
    for (int step = 0; step < static_cast<int>(time / kStep); ++step) {
      auto next = e;  // what is not the zero mode decays under the linearised equations
      for (std::size_t i = 0; i < e.size(); ++i) {
        const double bonds = after(e, i, 0.0) - 2.0 * e[i] + before(e, i, 0.0);
        next[i] += kStep * (bonds - K_ * std::cos(kTwoPi * u_[i]) * e[i]);
      }
      e = next;
    }
    double squares = 0.0;
    for (const double each : e) squares += each * each;
    return mean(e) * mean(e) / (squares / static_cast<double>(e.size()));
  }

 private:
  static constexpr double kTwoPi = 6.283185307179586;
  static constexpr double kStep = 0.3;  // stable below 2/(4 + K)

  double spacing() const { return periods_ / static_cast<double>(u_.size()); }

  static double mean(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
  }
  static double after(const std::vector<double>& u, std::size_t i, double around) {
    return i + 1 < u.size() ? u[i + 1] : u.front() + around;
  }
  static double before(const std::vector<double>& u, std::size_t i, double around) {
    return i > 0 ? u[i - 1] : u.back() - around;
  }

  std::vector<double> forces() const {
    std::vector<double> f(u_.size());
    for (std::size_t i = 0; i < u_.size(); ++i) {
      f[i] = after(u_, i, periods_) - 2.0 * u_[i] + before(u_, i, periods_) -
             K_ / kTwoPi * std::sin(kTwoPi * u_[i]);
    }
    return f;
  }

  double K_;
  double periods_;
  std::vector<double> u_;
};

/// The force per particle at which a pinned chain lets go: with the centre led over one period of
/// its landscape (1/count), the largest force that holds it. No dynamics in it.
inline double depinning_force(double K, std::size_t count, double periods) {
  constexpr std::size_t kPoints = 24;  // good to 1 %; with 96 to 1e-4
  constexpr double kLong = 4000.0;     // with the centre held the slowest rates are some 1e-2
  PlainChain chain(K, count, periods);
  std::vector<double> held;
  while (held.size() < kPoints) {
    chain.shift(1.0 / static_cast<double>(kPoints * count));
    chain.relax(kLong, true);
    held.push_back(-chain.mean_force());
  }
  const auto top = std::max_element(held.begin(), held.end()) - held.begin();
  const auto n = static_cast<std::size_t>(top);
  const double left = held[(n + kPoints - 1) % kPoints];
  const double right = held[(n + 1) % kPoints];
  const double bend = left - 2.0 * held[n] + right;
  const double slope = 0.5 * (right - left);
  return held[n] - 0.5 * slope * slope / bend;  // the top of the parabola through three positions
}

/// Velocity over force of the chain that slides slowly through its landscape, over one period of
/// it.
inline double mean_mobility(double K, std::size_t count, double periods) {
  constexpr int kPoints = 8;
  constexpr double kLong = 4000.0;
  PlainChain chain(K, count, periods);
  chain.relax(kLong);
  double time = 0.0;  // taken at unit force
  for (int position = 0; position < kPoints; ++position) {
    chain.shift(1.0 / (kPoints * static_cast<double>(count)));
    chain.relax(kLong, true);
    time += 1.0 / chain.mobility(kLong) / kPoints;
  }
  return 1.0 / time;
}

}  // namespace tomlin::test
