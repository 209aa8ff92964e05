#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "forcefields/sheet_field_lattice.hpp"

/// The harmonics of the field of a sheet, as the loop over particles reads them.
///
/// Harmonics of reciprocal vectors G = m b1 + n b2 that are equally long depend on the height z
/// above the sheet by one function, since all atoms of the sheet are alike. Those of them whose
/// weights by the atoms of a cell are equal, too, make a star:
///
///   V(R, z) = V_0(z) + sum over stars s of f_s(z) W_s(R),  R from the lattice's centre
///   W_s(R)  = sum over one of each pair G, -G of the star of cos(2 pi G.R)
///   f_s(z)  = 2 sum over atoms u of the cell of cos(2 pi G.u) times the coefficient of one atom
///
/// Each f_s is a spline of fifth order in z, twice continuously differentiable, zero from the reach
/// of its star on. Stars stand in the order of |G|, and reaches fall.
namespace tomlin {

/// Lennard-Jones' pair energy with zero energy and force at the cutoff, as LennardJonesSmooth.
struct SheetLaw {
  double four_epsilon = 0.0;
  double sigma_squared = 0.0;
  double at_cutoff = 0.0;  ///< V(cutoff)
  double slope = 0.0;      ///< V'(cutoff)
  double cutoff = 0.0;
};

/// By how much the field differs from sums over atoms.
struct SheetError {
  /// The largest difference of an energy, in parts of the depth of the well or, where it is larger,
  /// of the size of V_0; or that of a component of a force, likewise in parts of the largest
  /// attraction or of the size of V_0'. It is this that the tolerance limits.
  double relative = 0.0;
  double energy = 0.0;  ///< largest difference at the height of the well and above
  double force = 0.0;   ///< the same of a component of the force
};

struct SheetTable {
  static constexpr std::size_t kHead = 2;        ///< numbers before the first star
  static constexpr std::size_t kStarHead = 3;    ///< of a star before its terms
  static constexpr std::size_t kTerm = 2;        ///< m, n
  static constexpr std::size_t kKnot = 3;        ///< f, its slope, half its curvature
  static constexpr std::size_t kMostOrder = 12;  ///< of m and |n|

  /// Position, from the scene's first origin: where the lattice has its centre, and the height.
  std::array<double, 3> centre{};
  SheetLattice lattice;
  SheetLaw law;
  double density = 0.0;  ///< atoms per area
  double nearest = 0.0;  ///< heights begin here
  std::size_t intervals = 0;
  /// [0] stars, [1] where heights begin; then for each star its reach, its highest order, the
  /// number of its terms, and the terms; then for each height, intervals + 1 of them, f of each
  /// star, its slope and half its curvature by intervals.
  std::vector<double> numbers;
  SheetError error;

  // Notes report these numbers.
  double equilibrium = 0.0;  ///< height of the well of V_0
  double depth = 0.0;        ///< of this well
  double pull = 0.0;         ///< largest attraction of V_0
  double first = 0.0;        ///< weight f of the first star there
  double first_decay = 0.0;  ///< -d ln f/dz there

  std::size_t stars() const { return static_cast<std::size_t>(numbers[0]); }
};

/// The lowest height of a table, in sigma: the energy is some hundred times the well's depth.
inline constexpr double kNearestSheet = 0.6;

/// A table for a tolerance, the coarsest at attempt 0 and finer with each. What is left out is held
/// to the tolerance by an estimate: the error remains to be measured.
inline constexpr int kSheetAttempts = 6;
SheetTable make_sheet_table(const SheetLattice& lattice, const SheetLaw& law, double sigma,
                            double tolerance, int attempt);

/// The differences from sums over the atoms at some hundred points, spread evenly over the box on
/// both sides of the sheet, and more densely near it.
SheetError measure_sheet_error(const SheetTable& table, const SheetAtoms& atoms);

}  // namespace tomlin
