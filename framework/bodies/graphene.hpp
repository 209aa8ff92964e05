#pragma once

#include "framework/core/records/body.hpp"
#include "framework/core/text/axis_names.hpp"

/// A flat sheet of graphene across z in space, of rectangular cells of four particles.
///
/// With b the length of a bond a cell is 3 b long along the armchair direction s and sqrt(3) b
/// along the zigzag direction t, and has its particles at
///
///   (s, t) = (0, 0), (1/2, sqrt(3)/2) b, (3/2, sqrt(3)/2) b, (2, 0) b
///
/// so that a sheet without a periodic box ends in zigzag edges across s, and in armchair edges
/// across t, whose particles have two neighbours each (one at two of the corners). The mean of all
/// particles is at `centre`. A periodic box of the length of all cells, 3 b or sqrt(3) b times
/// their number, continues the sheet without a seam: "neighbours" are then those through it, too.
///
/// Particles are numbered cell by cell, in rows of cells along t, there and back: the cells of
/// eight consecutive particles always share a side. Positions are whole multiples of b/2 and of
/// sqrt(3) b/4 from the middle, rounded once or twice.
///
/// Source: A. H. Castro Neto, F. Guinea, N. M. R. Peres, K. S. Novoselov and A. K. Geim, Rev. Mod.
/// Phys. 81, 109 (2009), doi:10.1103/RevModPhys.81.109, Fig. 2.
namespace tomlin {

struct GrapheneDescription : BodyDescription {
  double bond_length = 0.0;
  WordOrNumbers cells;  ///< along x and y; empty: as many as fit into `size`
  WordOrNumbers size;   ///< along x and y
  Axis armchair = Axis::x;
  SpaceVector centre;
};

BodyRecord graphene_record();

}  // namespace tomlin
