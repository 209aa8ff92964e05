#pragma once

#include <array>
#include <cmath>
#include <vector>

/// The rigid ring of Sircar and Patra once more, by hand: classical Runge-Kutta of fixed step and
/// the standard library's functions. It shares no line with the engine that it is held against.
namespace tomlin::test {

struct RigidRing {
  int count = 8;
  double radius = 1.0;
  double lambda = 0.0;
  double stiffness = 2.0;
  double velocity = 1e-3;
  double corrugation = 0.1;
  double damping = 2.0 * std::sqrt(2.0);
  bool turns = true;
  double reverse_above = HUGE_VAL;  ///< the driver turns back once, when the centre is past this

  struct Sample {
    double x, y, rotation;
    double force_x, force_y;  ///< of the driver
    double driver;            ///< where it is
    double work;              ///< that it has done
  };

  /// The positions at 0, `interval`, ..., with `steps` steps in each interval.
  std::vector<Sample> trace(int intervals, double interval, int steps) const {
    State s = {0.0, radius, 0.0, 0.0, 0.0, 0.0, 0.0};
    Driver driver = {0.0, 0.0, velocity};
    std::vector<Sample> samples = {sample(s, driver, 0.0)};
    const double h = interval / steps;
    for (int n = 0; n < intervals; ++n) {
      for (int j = 0; j < steps; ++j) s = advanced(s, driver, interval * n + h * j, h);
      samples.push_back(sample(s, driver, interval * (n + 1)));
    }
    return samples;
  }

 private:
  /// x, y, rotation, their rates, and the work done; mass and period are 1
  using State = std::array<double, 7>;

  struct Driver {
    double since, from, velocity;

    double at(double t) const { return from + velocity * (t - since); }
  };

  Sample sample(const State& s, const Driver& driver, double t) const {
    const double along = driver.at(t);
    return {s[0], s[1], s[2], stiffness * (along - s[0]), stiffness * (radius - s[1]), along, s[6]};
  }

  State rates(const State& s, const Driver& driver, double t) const {
    constexpr double kTurn = 6.283185307179586;
    const double b = lambda / radius;
    double fx = 0.0, fy = 0.0, torque = 0.0;
    for (int i = 0; i < count; ++i) {
      const double angle = kTurn * i / count + s[2];
      const double arm_x = radius * std::cos(angle);
      const double arm_y = radius * std::sin(angle);
      const double x = s[0] + arm_x;
      const double y = s[1] + arm_y;
      const double height = corrugation / count * std::exp(-b * y * y);
      const double gx = height * kTurn * std::sin(kTurn * x);
      const double gy = height * 2.0 * b * y * std::cos(kTurn * x);
      fx += gx;
      fy += gy;
      torque += arm_x * gy - arm_y * gx;
    }
    const double pull = stiffness * (driver.at(t) - s[0]);
    fx += pull - damping * s[3];
    fy += stiffness * (radius - s[1]) - damping * s[4];
    const double spin = turns ? torque / (radius * radius) - damping * s[5] : 0.0;
    return {s[3], s[4], s[5], fx, fy, spin, pull * driver.velocity};
  }

  static State moved(const State& s, const State& rate, double h) {
    State to = s;
    for (std::size_t c = 0; c < s.size(); ++c) to[c] += h * rate[c];
    return to;
  }

  State step(const State& s, const Driver& driver, double t, double h) const {
    const State a = rates(s, driver, t);
    const State b = rates(moved(s, a, 0.5 * h), driver, t + 0.5 * h);
    const State c = rates(moved(s, b, 0.5 * h), driver, t + 0.5 * h);
    const State d = rates(moved(s, c, h), driver, t + h);
    State to = s;
    for (std::size_t q = 0; q < s.size(); ++q) {
      to[q] += h / 6.0 * (a[q] + 2.0 * b[q] + 2.0 * c[q] + d[q]);
    }
    return to;
  }

  /// A step; one in which the driver turns back is made in two, up to that moment and from it.
  State advanced(const State& s, Driver& driver, double t, double h) const {
    const State to = step(s, driver, t, h);
    if (driver.velocity < 0.0 || to[0] < reverse_above) return to;
    double before = 0.0;
    double after = h;
    for (int n = 0; n < 60; ++n) {
      const double middle = 0.5 * (before + after);
      (step(s, driver, t, middle)[0] < reverse_above ? before : after) = middle;
    }
    const State turning = step(s, driver, t, after);
    const double moment = t + after;
    driver = {moment, driver.at(moment), -driver.velocity};
    return step(turning, driver, moment, h - after);
  }
};

}  // namespace tomlin::test
