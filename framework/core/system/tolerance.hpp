#pragma once

#include <cstddef>

#include "framework/core/system/system.hpp"

/// Scales for errors of a bound scene. SystemView::tolerance_scale is a block of
///   dofs    coordinate times this is a part of the scene's length, or an angle in rad
///   dofs    velocity times this is such a part in the scene's time
///   dofs    coordinate times this is a length; of an angle, that of an arc at the scene's length
///   own     as the first for prescribed motions, as the second for forces' own variables
///   kGroup  the scene's length, and its time (framework/scene/natural_units.hpp)
/// so that weighted errors are pure numbers, in units of any size.
namespace tomlin {

template <class Real>
struct ToleranceScales {
  const Real* position = nullptr;
  const Real* velocity = nullptr;
  const Real* in_units = nullptr;
  const Real* own = nullptr;
  Real length = Real(1.0);
  Real time = Real(1.0);
};

/// Numbers in such a block.
template <class Real>
std::size_t size_of_tolerance_scales(const SystemView<Real>& view) {
  return 3 * view.dofs + view.own + kGroup;
}

template <class Real>
ToleranceScales<Real> tolerance_scales(const SystemView<Real>& view) {
  const Real* first = view.tolerance_scale;
  const Real* last = first + 3 * view.dofs + view.own;
  return {first, first + view.dofs, first + 2 * view.dofs, first + 3 * view.dofs, last[0], last[1]};
}

}  // namespace tomlin
