#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

/// Derivatives of the forces, for schemes that solve equations: implicit ones, and those that
/// follow equilibria.
namespace tomlin {

/// Factors of a complex combination of a tangent's matrices, kept until the next factor().
class ShiftedTangent {
 public:
  virtual ~ShiftedTangent() = default;
  /// A = mass M + friction G + stiffness K as the last linearise() left them. False when A is
  /// singular to rounding; solve() must not be called then.
  virtual bool factor(std::complex<double> mass, std::complex<double> friction,
                      double stiffness) = 0;
  /// real + i imaginary <- A^-1 (real + i imaginary).
  virtual void solve(double* real, double* imaginary) const = 0;

 protected:
  ShiftedTangent() = default;
};

/// The forces of a bound scene, linearised about one state in its n free coordinates q (those that
/// are neither held nor fixed nor prescribed):
///   dF = -K dq - G du,   u = dq/dt,
/// F being all forces, friction included; with the stiffness K (of all energies, of rigid bodies'
/// turning under their forces, and of friction that turns with them), the friction G and the mass
/// matrix M, which is diagonal. K is symmetric where nothing moves. Without inertia the motion is
/// G u = (all other forces) with u the drift at that state, so that du = -G^-1 K dq. Angles count
/// turns, as in the state.
///
/// Built from the forces' element Hessians: exact derivatives, not differences. Kept as a band,
/// with coordinates ordered so that it is narrow, plus one term for each axis of a force on a
/// body's centre of mass; as a full matrix where scenes are small. In double only.
class Tangent {
 public:
  virtual ~Tangent() = default;

  /// Index of free coordinate k in position, velocity and force; the length is n.
  virtual const std::vector<std::size_t>& coordinates() const = 0;
  /// Mass (or moment of inertia, per turn squared) of free coordinate k, [n].
  virtual const std::vector<double>& masses() const = 0;
  /// Why there is no tangent of this scene: the first force whose derivatives are not known, or a
  /// matrix too large; empty when there is.
  virtual std::string unknown() const = 0;
  /// Cost of one linearise() beside its evaluation, counted as so many evaluations of all forces,
  /// as differences would take them. n for a full matrix; for a band the groups of coordinates that
  /// can be displaced at once without meeting in a force, and one for each term beside it.
  virtual std::size_t columns() const = 0;

  /// K and G at a state, `elapsed` after the time that forces are anchored at. Evaluates the forces
  /// there, too: System::view.force holds them afterwards, as after any evaluation, and `rates` the
  /// rates. Counts nothing: that is the caller's.
  virtual void linearise(const double* position, const double* velocity, const double* integrals,
                         double elapsed, double* rates) = 0;
  void linearise(const double* position, const double* velocity, const double* integrals,
                 double elapsed) {
    linearise(position, velocity, integrals, elapsed, nullptr);
  }

  /// y <- K x and y <- G x; [n].
  virtual void times_stiffness(const double* x, double* y) const = 0;
  virtual void times_friction(const double* x, double* y) const = 0;

  /// Factors A = mass M + friction G + stiffness K + sum over k of border_weight d_k d_k^T, with
  /// `borders` directions d_k, [k * n + i] (to keep zero modes from making A singular).
  /// False when A is singular to rounding; the others must not be called then.
  virtual bool factor(double mass, double friction, double stiffness, const double* borders,
                      std::size_t border_count, double border_weight) = 0;
  bool factor(double mass, double friction, double stiffness) {
    return factor(mass, friction, stiffness, nullptr, 0, 0.0);
  }
  /// x <- A^-1 x, of the last factor().
  virtual void solve(double* x) const = 0;
  /// Negative eigenvalues of the last factored A where that is symmetric (Sylvester's law).
  virtual std::size_t negative() const = 0;
  /// ln |det A| of the last factor().
  virtual double log_determinant() const = 0;

  /// For complex combinations, as many at a time as are asked for; none outlives the tangent.
  virtual std::unique_ptr<ShiftedTangent> shifted() const = 0;

 protected:
  Tangent() = default;
};

}  // namespace tomlin
