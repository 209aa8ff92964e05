#pragma once

#include "framework/core/records/body.hpp"
#include "framework/core/text/words.hpp"

/// Particles on an ellipse in the x-y plane; with equal semi-axes a ring.
///
///   x_i = centre + R(orientation) (a cos t_i, b sin t_i),   i = 0 .. count - 1
///
/// `spacing` decides the parametric angles t_i, which begin at 0 and run counter-clockwise:
///
///   arc    s(t_i) = i P / count, with the arc length s(t) and the perimeter P = s(2 pi):
///   neighbours
///          are equally far apart along the ellipse;
///   angle  t_i = 2 pi i / count: the positions of a ring, stretched along both axes.
///
/// The arc length follows from incomplete elliptic integrals of the second kind by Carlson's
/// duplication: B. C. Carlson, Numer. Algorithms 10, 13 (1995), doi:10.1007/BF02198293, and DLMF
/// 19.25.10, whose terms are all positive, so that P and the positions are exact to a few units in
/// the last place of the larger semi-axis.
///
/// `centre` is that of the ellipse. With equal masses it is the centre of mass for an even count
/// and with "angle" for any count but 1. With "arc" and an odd count the centre of mass lies off it
/// on the first axis: about it the body turns, and there a spring at the centre of mass acts.
///
/// The perimeter of the ellipse, not that of the polygon through its particles, is what one turn
/// without sliding advances it by: see framework/bodies/outline.hpp for what rolling means then.
namespace tomlin {

enum class EllipseSpacing { arc, angle };

constexpr auto word_table(EllipseSpacing) {
  using enum EllipseSpacing;
  return std::to_array<Word<EllipseSpacing>>({{arc, "arc"}, {angle, "angle"}});
}

struct EllipseDescription : BodyDescription {
  std::int64_t count = 0;
  WordOrNumbers semi_axes;  ///< a along its first axis, b along the second
  SpaceVector centre;
  double orientation = 0.0;  ///< of the first axis against x, rad, counter-clockwise
  EllipseSpacing spacing = EllipseSpacing::arc;
};

BodyRecord ellipse_record();

}  // namespace tomlin
