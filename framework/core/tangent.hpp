#pragma once

#include <cstddef>
#include <string>
#include <vector>

/// Derivatives of the forces, for schemes that solve equations: implicit ones, and those that
/// follow equilibria.
namespace tomlin {

/// The forces of a bound scene, linearised about one state in its n free coordinates q (those that
/// are neither held nor fixed nor prescribed):
///   dF = -K dq - G du,   u = dq/dt,
/// with the stiffness K (of all energies, and of rigid bodies' turning under their forces), the
/// friction G and the mass matrix M, which is diagonal. Built from the forces' element Hessians:
/// exact derivatives, not differences. Kept as a band plus a few dense terms where the scene is a
/// chain, and as a full matrix where it is small. In double only.
class Tangent {
 public:
  virtual ~Tangent() = default;

  /// Where free coordinate k stands among position, velocity and force; its length is n.
  virtual const std::vector<std::size_t>& coordinates() const = 0;
  /// Mass (or moment of inertia) of free coordinate k, [n].
  virtual const std::vector<double>& masses() const = 0;
  /// The first force whose derivatives are not known, and why; empty when all are.
  virtual std::string unknown() const = 0;
  /// What one linearise() is counted as: so many evaluations of all forces.
  virtual std::size_t columns() const = 0;

  /// K and G at a state, `elapsed` after the time that forces are anchored at. Evaluates the forces
  /// there, too: System::view.force holds them afterwards.
  virtual void linearise(const double* position, const double* velocity, const double* integrals,
                         double elapsed) = 0;

  /// y <- K x and y <- G x; [n].
  virtual void times_stiffness(const double* x, double* y) const = 0;
  virtual void times_friction(const double* x, double* y) const = 0;

  /// Factors A = mass M + friction G + stiffness K + sum over k of border_weight d_k d_k^T, with
  /// `borders` directions d_k, [k * n + i] (to keep what nothing holds from making A singular).
  /// False when A is singular to rounding; solve() must not be called then.
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

 protected:
  Tangent() = default;
};

}  // namespace tomlin
