#pragma once

#include "framework/core/records/body.hpp"
#include "framework/core/text/axis_names.hpp"

/// A single-walled carbon nanotube: graphene rolled up along C = n a1 + m a2, the chirality [n, m].
///
/// With b the length of a bond, L = n^2 + n m + m^2, N = 2 L/D and D = gcd(2n + m, 2m + n),
///
///   radius             R = sqrt(3 L) b/(2 pi)
///   length of a cell   T = 3 sqrt(L) b/D
///   particles a cell   2 N = 4 L/D
///
/// A lattice point i a1 + j a2 of the sheet, seen from outside, is at the angle
/// 2 pi (i (2n + m) + j (2m + n))/(2L), counter-clockwise about the axis, and at the height
/// (n j - m i) T/N along it; each has a particle there and another one at (a1 + a2)/3 from it.
/// Angles and heights are fractions of whole numbers. Bonds have the length b along the sheet;
/// their chords across the rolled one are shorter by b (b/R)^2/24 at most, in the lowest order.
///
/// Particles are numbered cell by cell along the axis, within a cell in slabs about 3 b long, and
/// within a slab by their angle, so that consecutive ones lie close together. Where a zigzag tube
/// ends it is cut through the bonds along its axis, and each particle there keeps two. The mean of
/// all particles is at `centre`. A particle of the first slab is at the angle `roll`; angles count
/// from y towards z about x, from z towards x about y, and from x towards y about z. A periodic box
/// of the length of all cells along the axis continues it: "neighbours" are then those through it,
/// too.
///
/// Source: R. Saito, G. Dresselhaus and M. S. Dresselhaus, Physical Properties of Carbon Nanotubes
/// (Imperial College Press, 1998), doi:10.1142/p080, chapter 3.
namespace tomlin {

struct NanotubeDescription : BodyDescription {
  WordOrNumbers chirality;  ///< n and m
  double bond_length = 0.0;
  std::int64_t cells = 0;  ///< 0: as many as fit into `length`
  double length = 0.0;
  Axis axis = Axis::x;
  double roll = 0.0;
  SpaceVector centre;
};

BodyRecord nanotube_record();

}  // namespace tomlin
