#pragma once

#include <cmath>
#include <complex>
#include <string>

#include "tests/support/scenes.hpp"

/// A driven, damped harmonic oscillator: the motion that is known at every moment.
namespace tomlin::test {

/// Position and velocity of one particle on a line.
struct State {
  double x = 0.0;
  double v = 0.0;
};

/// m x'' = k (V t - x) - c x', from x0, v0, under- or overdamped; k = 0: no spring.
struct Oscillator {
  double m = 1.3;
  double k = 2.1;
  double c = 0.4;
  double pull = 0.35;
  double x0 = 0.7;
  double v0 = -0.2;
  double duration = 6.4;

  State at(double t) const {
    if (k == 0.0) {
      if (c == 0.0) return {x0 + v0 * t, v0};
      const double rate = c / m;
      return {x0 - v0 * std::expm1(-rate * t) / rate, v0 * std::exp(-rate * t)};
    }
    const double gamma = 0.5 * c / m;
    const std::complex<double> omega = std::sqrt(std::complex<double>(k / m - gamma * gamma));
    const double a = x0 + c * pull / k;
    const std::complex<double> b = (v0 - pull + gamma * a) / omega;
    const double decay = std::exp(-gamma * t);
    const std::complex<double> cosine = std::cos(omega * t);
    const std::complex<double> sine = std::sin(omega * t);
    return {pull * t - c * pull / k + decay * std::real(a * cosine + b * sine),
            pull + decay * std::real((b * omega - gamma * a) * cosine -
                                     (a * omega + gamma * b) * sine)};
  }
  /// From m v' = F - c v, integrated over the run.
  double mean_force() const {
    const State end = at(duration);
    return (m * (end.v - v0) + c * (end.x - x0)) / duration;
  }

  std::string scene(const std::string& integrator, const std::string& more = "") const {
    std::string text = "[[body]]\nname = \"tip\"\ntype = \"point\"\nposition = [" + digits(x0) +
                       "]\nvelocity = [" + digits(v0) + "]\nparticle_mass = " + digits(m) + "\n";
    if (k > 0.0) {
      text +=
          "[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstart = [0.0]\nstiffness = " +
          digits(k) + "\nvelocity = [" + digits(pull) + "]\n";
    }
    if (c > 0.0) text += "[[force]]\ntype = \"viscous_damping\"\ncoefficient = " + digits(c) + "\n";
    return text + "[run]\nduration = " + digits(duration) + "\nintegrator = " + integrator + "\n" +
           more;
  }
};

inline double error_at_end(const RunResult& result, const State& exact) {
  return std::hypot(result.body(0)["centre_of_mass"][0] - exact.x,
                    result.body(0)["velocity"][0] - exact.v);
}

}  // namespace tomlin::test
