// Rotations in space by a vector p = 2 tan(angle/2) n, n the unit vector along the axis: twice the
// Rodrigues (Gibbs) vector. For small angles it is the rotation vector; every formula is rational;
// it has no value for half a turn. With the angular velocity w in the rotated frame,
//
//   dp/dt = w + p x w / 2 + p (p.w) / 4,    w = (dp/dt - p x dp/dt / 2) / (1 + p^2/4).
//
// M. D. Shuster, J. Astronaut. Sci. 41, 439 (1993), section on the Rodrigues vector.
#pragma once

#include "framework/core/numbers/vec.hpp"

namespace tomlin {
inline namespace TOMLIN_TARGET {

template <class T>
TOMLIN_INLINE Vec<T, 3> cross(const Vec<T, 3>& a, const Vec<T, 3>& b) {
  return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}

/// 1 / (1 + p^2/4).
template <class T>
TOMLIN_INLINE T shrinkage(const Vec<T, 3>& p) {
  return T(1.0) / (T(1.0) + T(0.25) * (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]));
}

/// The angular velocity where the vector changes at the rate u.
template <class T>
TOMLIN_INLINE Vec<T, 3> angular_velocity(const Vec<T, 3>& p, const Vec<T, 3>& u) {
  return shrinkage(p) * (u - T(0.5) * cross(p, u));
}

/// The rate of the vector under an angular velocity.
template <class T>
TOMLIN_INLINE Vec<T, 3> rate_of_vector(const Vec<T, 3>& p, const Vec<T, 3>& w) {
  const T along = p[0] * w[0] + p[1] * w[1] + p[2] * w[2];
  return w + T(0.5) * cross(p, w) + (T(0.25) * along) * p;
}

/// Its second derivative, where its rate is u, under an angular acceleration in the rotated frame.
template <class T>
TOMLIN_INLINE Vec<T, 3> acceleration_of_vector(const Vec<T, 3>& p, const Vec<T, 3>& u,
                                               const Vec<T, 3>& angular) {
  const T along = p[0] * u[0] + p[1] * u[1] + p[2] * u[2];
  return rate_of_vector(p, angular) + (T(0.5) * shrinkage(p) * along) * u;
}

/// to = from R(p), row by row; R(p) = 1 + s ([p] + [p]^2 / 2), s = 1 / (1 + p^2/4).
template <class T>
TOMLIN_INLINE void rotate_axes(const T* from, const Vec<T, 3>& p, T* to) {
  const T s = shrinkage(p);
  for (int row = 0; row < 3; ++row, from += 3, to += 3) {
    // The transpose of R(p) on a row of `from`.
    const Vec<T, 3> a = {{from[0], from[1], from[2]}};
    const Vec<T, 3> once = cross(a, p);
    const Vec<T, 3> twice = cross(once, p);
    for (int k = 0; k < 3; ++k) to[k] = a[k] + s * (once[k] + T(0.5) * twice[k]);
  }
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
