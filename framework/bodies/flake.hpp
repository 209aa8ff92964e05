#pragma once

#include "framework/core/records/body.hpp"
#include "framework/core/text/words.hpp"

/// A flake: the particles of a two-dimensional lattice within a shape, in the x-y plane.
///
///   x = centre + R(misfit) (i a1 + j a2 + basis) within the shape
///
/// a is `lattice_constant`, the length of a1 and a2:
///
///   hexagonal  a1 = a (1, 0), a2 = a (1/2, sqrt(3)/2), one particle a cell
///   honeycomb  the same cells with two particles a cell, at (0, +-a/sqrt(3)) from the middle of
///   each
///              hexagon: a is sqrt(3) times the length of a bond
///   square     a1 = a (1, 0), a2 = a (0, 1), one particle a cell
///
/// `size` is in lattice constants. A shape is closed: particles on its border belong to it.
///
///   hexagon    corners on the lattice vectors, edges of `size` = n: 3n(n + 1) + 1 particles of a
///              hexagonal lattice about a particle, 6n^2 of a honeycomb about the middle of a
///              hexagon
///   circle     of radius `size`, about a particle (honeycomb: the middle of a hexagon)
///   rectangle  `size` = [along x, along y] before it is turned; a square with one size. About a
///              particle (honeycomb: the middle of a hexagon); a square lattice has particles on
///              the edges of a whole size n, n + 1 of them, and so may have the middle of a cell
///              there
///   triangle   equilateral, an edge below, of a whole size n: (n + 1)(n + 2)/2 particles of a
///              hexagonal lattice; n hexagons of a honeycomb along an edge, n^2 + 4n + 1 particles
///
/// A hexagon and a triangle suit the hexagonal lattice and the honeycomb alone. The middle of the
/// shape is at `centre`; it is the centre of mass where masses are equal. Particles are in order
/// row by row, upwards and each from left to right, before they are turned. "neighbours" are the
/// nearest neighbours in the lattice: six, three or four of each particle inside.
///
/// Whether a particle belongs to it is decided in whole numbers, for sizes widened by 1e-9: what
/// stands on the border belongs to it however `size` was rounded, as in size = "sqrt(7)".
///
/// Source: G. S. Verhoeven, M. Dienwiebel and J. W. M. Frenken, Phys. Rev. B 70, 165418 (2004),
/// doi:10.1103/PhysRevB.70.165418: rigid graphite flakes of 6n^2 atoms, 6, 24, 54, 96, 150, turned
/// by a misfit angle.
namespace tomlin {

enum class FlakeLattice { hexagonal, honeycomb, square };

constexpr auto word_table(FlakeLattice) {
  using enum FlakeLattice;
  return std::to_array<Word<FlakeLattice>>(
      {{hexagonal, "hexagonal"}, {honeycomb, "honeycomb"}, {square, "square"}});
}

enum class FlakeShape { hexagon, circle, square, rectangle, triangle };

constexpr auto word_table(FlakeShape) {
  using enum FlakeShape;
  return std::to_array<Word<FlakeShape>>({{hexagon, "hexagon"},
                                          {circle, "circle"},
                                          {square, "square"},
                                          {rectangle, "rectangle"},
                                          {triangle, "triangle"}});
}

struct FlakeDescription : BodyDescription {
  FlakeLattice lattice = FlakeLattice::hexagonal;
  double lattice_constant = 0.0;
  FlakeShape shape = FlakeShape::hexagon;
  WordOrNumbers size;  ///< one number, or two of a rectangle
  double misfit = 0.0;
  SpaceVector centre;
};

BodyRecord flake_record();

}  // namespace tomlin
