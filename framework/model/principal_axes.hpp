#pragma once

#include <array>

namespace tomlin {

using Matrix3 = std::array<double, 9>;     ///< row by row
using Quaternion = std::array<double, 4>;  ///< of a rotation, the real part first; of length 1

/// The principal axes of a symmetric tensor of inertia.
struct PrincipalAxes {
  std::array<double, 3> moments{};  ///< in no order; 0 along a rod
  Quaternion rotation{};            ///< from space to the axes, a right-handed system
};

/// Jacobi's rotations, with the same bits on every machine. Axes along which the tensor is diagonal
/// already stay where they are.
PrincipalAxes principal_axes(Matrix3 inertia);

/// Its columns are the axes.
Matrix3 matrix_of(const Quaternion& rotation);

/// A rotation, and after it that by p = 2 tan(angle/2) n in the rotated frame; see
/// framework/core/numbers/rotation_vector.hpp.
Quaternion rotated_by(const Quaternion& rotation, const std::array<double, 3>& p);

}  // namespace tomlin
