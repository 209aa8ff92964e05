#include "framework/model/principal_axes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tomlin {
namespace {

/// Elements off the diagonal below this part of the trace are rounding of particles' positions.
constexpr double kRounding = 1e-14;
/// Convergence is quadratic: five or six sweeps do.
constexpr int kMostSweeps = 30;

Quaternion of_length_one(Quaternion q) {
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (double& part : q) part /= length;
  return q;
}

/// Rotates the plane (a, b) so that the element between its axes vanishes; tan(angle/2) of that is
/// the vector's length by two.
std::array<double, 3> rotate_plane(Matrix3& m, std::size_t a, std::size_t b) {
  const double ratio = (m[4 * b] - m[4 * a]) / (2.0 * m[3 * a + b]);
  const double t = std::copysign(1.0, ratio) / (std::abs(ratio) + std::sqrt(1.0 + ratio * ratio));
  const double c = 1.0 / std::sqrt(1.0 + t * t);
  const double s = t * c;
  for (std::size_t k = 0; k < 3; ++k) {
    const double left = m[3 * k + a];
    m[3 * k + a] = c * left - s * m[3 * k + b];
    m[3 * k + b] = s * left + c * m[3 * k + b];
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const double upper = m[3 * a + k];
    m[3 * a + k] = c * upper - s * m[3 * b + k];
    m[3 * b + k] = s * upper + c * m[3 * b + k];
  }
  m[3 * a + b] = m[3 * b + a] = 0.0;
  // Axis a turns towards -b: by the negative angle about a x b.
  std::array<double, 3> p{};
  const std::size_t across = 3 - a - b;
  const double sense = (a + 1) % 3 == b ? -1.0 : 1.0;
  p[across] = sense * 2.0 * s / (1.0 + c);
  return p;
}

}  // namespace

Quaternion principal_axes(Matrix3 inertia) {
  const double trace = inertia[0] + inertia[4] + inertia[8];
  Quaternion rotation = {1.0, 0.0, 0.0, 0.0};
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    bool diagonal = true;
    for (const auto& [a, b] : {std::array<std::size_t, 2>{0, 1}, {0, 2}, {1, 2}}) {
      if (!(std::abs(inertia[3 * a + b]) > kRounding * trace)) continue;
      diagonal = false;
      rotation = rotated_by(rotation, rotate_plane(inertia, a, b));
    }
    if (diagonal) break;
  }
  return rotation;
}

Quaternion product(const Quaternion& a, const Quaternion& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
          a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
          a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

Quaternion inverse(const Quaternion& rotation) {
  return {rotation[0], -rotation[1], -rotation[2], -rotation[3]};
}

Matrix3 matrix_of(const Quaternion& q) {
  const auto [w, x, y, z] = q;
  return {1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z),       2.0 * (x * z + w * y),
          2.0 * (x * y + w * z),       1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x),
          2.0 * (x * z - w * y),       2.0 * (y * z + w * x),       1.0 - 2.0 * (x * x + y * y)};
}

Quaternion rotated_by(const Quaternion& rotation, const std::array<double, 3>& p) {
  return of_length_one(product(rotation, {1.0, 0.5 * p[0], 0.5 * p[1], 0.5 * p[2]}));
}

}  // namespace tomlin
