#pragma once

#include <array>

namespace tomlin {

using Matrix3 = std::array<double, 9>;     ///< row by row
using Quaternion = std::array<double, 4>;  ///< of a rotation, the real part first; of length 1

/// From space to the principal axes of a symmetric tensor of inertia, a right-handed system, by
/// Jacobi's rotations with the same bits on every machine. Axes along which the tensor is diagonal
/// already stay where they are.
Quaternion principal_axes(Matrix3 inertia);

/// Its columns are the axes.
Matrix3 matrix_of(const Quaternion& rotation);

/// A rotation by b in the frame that a has rotated.
Quaternion product(const Quaternion& a, const Quaternion& b);
Quaternion inverse(const Quaternion& rotation);

/// A rotation, and after it that by p = 2 tan(angle/2) n in the rotated frame; see
/// framework/core/numbers/rotation_vector.hpp.
Quaternion rotated_by(const Quaternion& rotation, const std::array<double, 3>& p);

}  // namespace tomlin
