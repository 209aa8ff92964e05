#pragma once

#include <cmath>

/// Formulas of the models of test_model.cpp, for tests that compute them once more.
namespace tomlin::test {

struct ValueAndSlope {
  double value = 0.0;
  double slope = 0.0;
};

// The pair potential. Species 0 is argon, 1 krypton; eV and Angstrom.
inline constexpr double kPairCutoff = 6.0;
inline constexpr double kDepth[3] = {0.0104, 0.012, 0.014};  ///< by the sum of the species
inline constexpr double kSize[3] = {3.4, 3.5, 3.65};

inline ValueAndSlope lennard_jones_at(double depth, double size, double r) {
  const double sixth = std::pow(size / r, 6);
  return {4.0 * depth * (sixth * sixth - sixth), -24.0 * depth * (2.0 * sixth * sixth - sixth) / r};
}

inline ValueAndSlope pair_energy(int one, int other, double r) {
  const double depth = kDepth[one + other];
  const double size = kSize[one + other];
  const ValueAndSlope v = lennard_jones_at(depth, size, r);
  const ValueAndSlope end = lennard_jones_at(depth, size, kPairCutoff);
  return {v.value - end.value - (r - kPairCutoff) * end.slope, v.slope - end.slope};
}

// The potential by coordination.
inline constexpr double kCoordinatedReach = 4.6;
inline constexpr double kCoordinationReach = 4.2;
inline constexpr double kCoordinationWeight = 0.3;

/// (1 - (r/reach)^2)^3 up to there.
inline ValueAndSlope bump(double reach, double r) {
  const double part = r / reach;
  const double rest = 1.0 - part * part;
  if (!(rest > 0.0)) return {};
  return {rest * rest * rest, -6.0 * part / reach * rest * rest};
}
inline ValueAndSlope coordination(double r) { return bump(kCoordinationReach, r); }
/// `species`: the sum of both.
inline ValueAndSlope phi(int species, double r) {
  const ValueAndSlope v = bump(kCoordinatedReach, r);
  const double strength = 0.4 + 0.1 * species;
  return {strength * v.value, strength * v.slope};
}

}  // namespace tomlin::test
