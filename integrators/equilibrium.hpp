#pragma once

#include <cstddef>
#include <vector>

#include "framework/core/system/aligned.hpp"
#include "framework/core/system/system.hpp"

namespace tomlin {

/// The balance of forces F(q, t) = 0 of a bound scene in its n free coordinates, at rest, and what
/// is needed to solve it: K = -dF/dq exactly, dF/dt, the zero modes of the
/// scene, and the flow that it relaxes by.
///
/// Lengths are given in natural units: the largest allowed move of a coordinate (a lattice period,
/// or half the shortest bond) where it has one, else 1 (of a rotation: half a turn). Norms of
/// directions are Euclid's in these units.
class Equilibrium {
 public:
  /// Zero modes, at most.
  static constexpr std::size_t kMostNeutral = 6;

  explicit Equilibrium(System<double>& system);

  std::size_t size() const { return n_; }
  /// Unit of coordinate k.
  double unit(std::size_t k) const { return unit_[k]; }
  /// sqrt(sum of (x_k / unit_k)^2), and the largest |x_k / unit_k|.
  double norm(const double* x) const;
  double largest(const double* x) const;

  /// A steady force that acts beside the scene's own from now on, [n], in place of the last one;
  /// null: none. Rates do not know of it.
  void apply(const double* steady) { steady_ = steady; }

  /// Positions are relative to the present state from now on; times are counted from the
  /// anchor, and the present one is `since`.
  void start_at(double since);
  /// Evaluates at a position and time: force(), and rates() of the running integrals.
  void evaluate(const double* offset, double t);
  /// Evaluates K, too.
  void linearise(const double* offset, double t);
  /// [n], of the last evaluation.
  const double* force() const { return force_.data(); }
  const double* rates() const { return rates_.data(); }

  /// dF/dt at the position and time of the last evaluation, [n]. The scene moves by about a natural
  /// unit in the time `pace`. Forces that change in proportion to time take one evaluation more.
  void time_derivative(const double* offset, double t, double pace, double* result);
  /// Finds out whether they do so here.
  void look_at_time(const double* offset, double t, double pace);

  /// Factors K + stiffness_scale() b b^T of the last linearise(), with what holds neutral
  /// directions; without b (null) K alone.
  bool factor(const double* border);
  void solve(double* x) const { tangent_.solve(x); }
  std::size_t negative() const { return tangent_.negative(); }
  double log_determinant() const { return tangent_.log_determinant(); }
  /// A typical second derivative of the energy in natural units; measured by find_neutral().
  double stiffness_scale() const { return control_[kScale]; }

  /// At the last linearise(): the zero modes, up to rounding, and the softest
  /// of those that something does. They are kept in `control`, see attach().
  void find_neutral();
  /// How far rounding of forces displaces an equilibrium along its softest direction, in natural
  /// units: positions are known no better. Measured by find_neutral().
  double noise() const { return control_[kNoise]; }
  std::size_t neutral() const { return static_cast<std::size_t>(control_[kNeutral]); }
  /// Direction k, of norm 1.
  const double* neutral(std::size_t k) const { return control_ + kNumbers + k * n_; }
  /// The softest direction that is not neutral, of norm 1, at the last linearise(), and the second
  /// derivative of the energy along it, in natural units.
  double softest(double* direction);
  /// At the last linearise(), angles counting as arcs at the scene's length: the smallest second
  /// derivative along a direction of unit length that is not neutral, and ln |det K|; not a number
  /// where a direction is neutral.
  void describe(double& softest_of_all, double& log_determinant_of_all);

  /// Relaxes at time t by the scene's own friction, or by friction in proportion to mass where that
  /// does not reach every coordinate, until nothing moves: `offset` is moved along. False when it
  /// does not come to rest.
  bool descend(double* offset, double t);
  /// Newton's method at time t from close by.
  bool polish(double* offset, double t);

  /// Numbers to be kept in the run's state.
  std::size_t control_count() const { return kNumbers + kMostNeutral * n_; }
  void attach(double* control) { control_ = control; }

 private:
  enum { kScale, kNeutral, kLinearInTime, kNoise, kNumbers };
  enum class Friction { of_scene, of_masses };

  void place(const double* offset, double t);
  void advance_own(double t);
  void run_operations(const double* own, double t);
  void take_force();
  double scale_of_stiffness();
  void iterate_subspace(std::size_t count, int times);
  void rotate_to_ritz(std::size_t count);
  void remove_parts(std::size_t k);
  Friction friction_that_reaches_all();
  bool factor_flow(Friction friction, double rate);
  void drag(Friction friction, const double* x, double* result) const;
  double scale_of_drag(Friction friction);

  System<double>& system_;
  Tangent& tangent_;
  std::size_t n_;
  std::vector<double> unit_;
  double* control_ = nullptr;
  const double* steady_ = nullptr;

  double since_ = 0.0;
  std::vector<double> start_;  ///< [n]
  std::vector<double> force_;  ///< [n]
  std::vector<double> change_;
  std::vector<double> trial_;
  std::vector<double> scratch_;
  std::vector<double> held_;
  std::vector<double> borders_;
  std::vector<double> subspace_;  ///< [vector * n + coordinate]
  std::vector<double> images_;
  double ritz_[kMostNeutral] = {};
  AlignedVector<double> position_;
  AlignedVector<double> at_rest_;
  AlignedVector<double> rates_;
  AlignedVector<double> own_start_;
  AlignedVector<double> own_;
};

}  // namespace tomlin
