// Reference loops: each model as a one-off C++ program would have it. No part of the engine is
// used, save its sine and exponential in the OwnMath variants, which shows how much of a
// difference comes from the library functions alone.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "framework/core/numbers/math.hpp"

namespace tomlin::plain {

// Sines of 2 pi x / period, and the exponential, from the system's library.
struct StdMath {
  double wave_number;

  explicit StdMath(double period) : wave_number(2.0 * std::numbers::pi / period) {}
  double sine(double x) const { return std::sin(wave_number * x); }
  void sine_cosine(double x, double& s, double& c) const {
    const double angle = wave_number * x;
    s = std::sin(angle);
    c = std::cos(angle);
  }
  static void rotation(double angle, double& s, double& c) {
    s = std::sin(angle);
    c = std::cos(angle);
  }
  static double exponential(double x) { return std::exp(x); }
};

// Sines and the exponential from the engine, whose sines take their argument in turns.
struct OwnMath {
  double inverse_period;

  explicit OwnMath(double period) : inverse_period(1.0 / period) {}
  double sine(double x) const { return tomlin::sin_turns(inverse_period * x); }
  void sine_cosine(double x, double& s, double& c) const {
    tomlin::sincos_turns(inverse_period * x, s, c);
  }
  // Eight at once.
  void sine_cosine(tomlin::Pack x, tomlin::Pack& s, tomlin::Pack& c) const {
    tomlin::sincos_turns(tomlin::Pack(inverse_period) * x, s, c);
  }
  static void rotation(double angle, double& s, double& c) {
    tomlin::sincos_turns(angle * (0.5 * std::numbers::inv_pi), s, c);
  }
  static double exponential(double x) { return tomlin::exp(x); }
};

// One particle dragged over a cosine: m x'' = k (v t - x) - drag + (2 pi V0 / a) sin(2 pi x / a).
// The drag is damping x', or it has a memory kernel, a Maxwell element: its spring's stretch q is
// one more unknown, q' = x' - q / memory_time, and the drag (damping / memory_time) q.
template <class Math, bool remembers>
struct DraggedTip {
  double mass = 1.0;
  double stiffness = 2.0;
  double damping = remembers ? 0.3 : 2.0 * std::numbers::sqrt2;
  double memory_time = 0.5;
  double speed = 1e-3;
  double period = 1.0;
  double amplitude = 0.1;

  double x = 0.0;
  double v = 0.0;
  double q = 0.0;
  double force_integral = 0.0;  // of the driving spring's force over time
  std::int64_t done = 0;

  void advance(std::int64_t steps, double h);
};

template <class Math>
using PrandtlTomlinson = DraggedTip<Math, false>;
template <class Math>
using RememberingTip = DraggedTip<Math, true>;

// Tips side by side in vectors, each with numbers of its own; [tip].
struct TipReplicas {
  explicit TipReplicas(std::size_t count);

  std::vector<double> stiffness, damping, speed, inverse_period, site, inverse_mass;
  std::vector<double> x, v, force_integral;
  std::int64_t done = 0;

  void advance(std::int64_t steps, double h);
};

// Flexible rings of eight side by side in vectors, each pulled by a spring of its own; [particle *
// count + ring]. Each pair is computed once, with a square root and a division, and added to both
// of its particles at once.
struct RingReplicas {
  explicit RingReplicas(std::size_t count);

  static constexpr std::size_t kParticles = 8;
  std::vector<double> stiffness;
  std::vector<double> x, y, vx, vy;
  std::vector<double> force_integral_x, force_integral_y;
  std::int64_t done = 0;

  void advance(std::int64_t steps, double h);
};

// Normal numbers for replicas side by side, each with a key of its own: Philox 4x64-10 (Salmon,
// Moraes, Dror, Shaw, SC '11, doi:10.1145/2063384.2063405) and Box-Muller, all four of a block.
struct NormalReplicas {
  explicit NormalReplicas(std::size_t count) : replicas(count), numbers(4 * count, 0.0) {}

  std::size_t replicas;
  std::vector<double> numbers;  // [step][replica], of four steps

  void draw(std::uint64_t four);
};

// Particles in the plane, with what a step of RK4 needs.
struct PlaneParticles {
  explicit PlaneParticles(int particles);

  int count;
  std::vector<double> x, y, vx, vy;
  double force_integral_x = 0.0;
  double force_integral_y = 0.0;
  std::int64_t done = 0;

  std::vector<double> xs, ys, vxs, vys;                // the state at a stage
  std::vector<double> ax, ay;                          // its accelerations
  std::vector<double> sum_vx, sum_vy, sum_ax, sum_ay;  // weighted sums over the stages
};

// A ring of particles in the plane with a harmonic bond between every two of them. Quantities
// without "each" are the whole ring's; the particles share them equally.
template <class Math>
struct FlexibleRing : PlaneParticles {
  double radius;
  double bond_stiffness = 1e6;
  double stiffness = 2.0;
  double damping = 2.0 * std::numbers::sqrt2;
  double speed = 1e-3;
  double period = 1.0;
  double amplitude = 0.1;
  double lambda = 1.0;
  double mass = 1.0;

  std::vector<double> rest_length;  // count x count, the upper half used

  explicit FlexibleRing(int particles = 8, double ring_radius = 1.0);
  void advance(std::int64_t steps, double h);
  void accelerations(const double* px, const double* py, const double* ux, const double* uy,
                     double t, double& driver_x, double& driver_y);
};

// This ring is rigid: its centre and its angle are the unknowns.
template <class Math>
struct RigidRing {
  int count;
  double radius;
  double stiffness = 2.0;
  double damping = 2.0 * std::numbers::sqrt2;
  double speed = 1e-3;
  double period = 1.0;
  double amplitude = 0.1;
  double lambda = 1.0;
  double mass = 1.0;

  double x = 0.0, y, phi = 0.0;
  double vx = 0.0, vy = 0.0, omega = 0.0;
  double force_integral_x = 0.0;
  double force_integral_y = 0.0;
  std::int64_t done = 0;

  explicit RigidRing(int particles = 8, double ring_radius = 1.0);
  void advance(std::int64_t steps, double h);

 private:
  struct Acceleration {
    double x, y, phi, driver_x, driver_y;
  };
  std::vector<double> reference_x, reference_y;

  Acceleration acceleration(double px, double py, double angle, double ux, double uy, double spin,
                            double t) const;
};

// A rigid body in space, 24 points of a box that is dragged by its centre: centre, a quaternion of
// its orientation and the angular velocity along its principal axes are the unknowns.
template <class Math>
struct RigidBox {
  double stiffness = 2.0;
  double damping_each = 0.05;
  double speed = 1e-3;
  double period = 1.0;
  double amplitude_each = 0.05;
  double decay = 1.0;
  double mass_each = 0.125;

  static std::vector<std::array<double, 3>> positions();

  RigidBox();
  void advance(std::int64_t steps, double h);
  const std::array<double, 3>& centre() const { return state.x; }

 private:
  struct State {
    std::array<double, 3> x, v;
    std::array<double, 4> q;
    std::array<double, 3> w;
  };
  State state{};
  std::int64_t done = 0;
  std::array<double, 3> start{};
  std::array<double, 3> inertia{};
  std::vector<std::array<double, 3>> reference;

  State rates(const State& s, double t) const;
};

// An open Frenkel-Kontorova chain, dragged by its centre of mass.
template <class Math>
struct Chain {
  int count;
  double rest_length;
  double bond_stiffness = 1.0;
  double stiffness = 1.0;
  double damping_each = 0.1;
  double speed = 1e-3;
  double period = 1.0;
  double amplitude_each = 0.05;
  double mass_each = 1.0;

  std::vector<double> x, v;
  double force_integral = 0.0;
  std::int64_t done = 0;

  explicit Chain(int particles, double spacing = 1.0);
  void advance(std::int64_t steps, double h);
  // Returns the energy of bonds and substrate.
  double energy() const;

 private:
  double start_centre;
  std::vector<double> xs, vs, acc, sum_v, sum_a;

  double accelerations(const double* px, const double* pv, double t);
};

// Particles in the plane without bonds on a hexagonal surface,
// V = A [cos p + cos q + cos(p + q)], p = 2 pi (x/a - y/(sqrt(3) a)), q = 4 pi y/(sqrt(3) a),
// dragged by their centre of mass. With the engine's mathematics it takes eight particles at once.
template <class Math>
struct Flake : PlaneParticles {
  double stiffness = 1.0;
  double damping_each = 0.1;
  double speed_x = 1e-3;
  double speed_y = 5e-4;
  double period = 1.0;
  double amplitude_each = 0.05;
  double mass_each = 1.0;
  double start_x, start_y;

  // Rows of particles at that distance in both directions, a multiple of 8 together.
  Flake(int columns, int rows, double spacing);
  void advance(std::int64_t steps, double h);
  void accelerations(const double* px, const double* py, const double* ux, const double* uy,
                     double t, double& driver_x, double& driver_y);
};

// Forces of (1/2) (theta - pi)^2 at each particle of a closed ring in the plane, theta the angle
// between the bonds to its neighbours.
struct Bending {
  std::vector<double> x, y, fx, fy;

  Bending(int count, double radius);
  void evaluate();
};

// One evaluation of a force on particles: of a cosine whose amplitude is each particle's own.
template <class Math>
struct VariedSubstrate {
  std::vector<double> x, amplitude, fx;

  VariedSubstrate(int count, double spacing);
  void evaluate();
};

// Periodic bicubic spline in the plane, from points^2 coefficients over a cell of length 1.
struct SplineSurface {
  int points;
  std::vector<double> coefficient, x, y, fx, fy;

  SplineSurface(int points, int columns, int rows, double spacing);
  void evaluate();
};

// Dry friction, -f v / sqrt(v^2 + w^2) in the plane.
struct DryFriction {
  double force = 0.1;
  double width = 0.01;
  std::vector<double> vx, vy, fx, fy;

  explicit DryFriction(int count);
  void evaluate();
};

}  // namespace tomlin::plain
