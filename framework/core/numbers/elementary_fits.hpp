// The polynomials and constants of the elementary functions.
//
// The polynomials are least-squares fits at Chebyshev points on the reduced interval, computed
// with 60 to 90 decimal digits. Coefficients were rounded one at a time, lowest power first, and
// the remaining ones fitted again after each rounding. The error of each fit, rounding of the
// coefficients included, is stated beside it.
#pragma once

#include <cstdint>

#include "framework/core/numbers/target.hpp"

namespace tomlin {
inline namespace TOMLIN_TARGET {
namespace math_detail {

struct Fit {
  using Bits = std::uint64_t;
  static constexpr int kFractionBits = 52, kBias = 1023;
  static constexpr double kSmallestNormal = 0x1p-1022;
  static constexpr Bits kRootHalf = 0x3fe6a09e667f3bcd;  // of sqrt(1/2)
  // exp(x) is infinity above the one and zero below the other.
  static constexpr double kExpHighest = 710.0, kExpLowest = -746.0;

  static constexpr double kLog2E = 0x1.71547652b82fep+0;
  // ln 2 = kLn2High + kLn2Low, both full doubles.
  static constexpr double kLn2High = 0x1.62e42fefa39efp-1;
  static constexpr double kLn2Low = 0x1.abc9e3b39803fp-56;
  // ln 2 = kLn2Short + kLn2Rest; a product of kLn2Short with an exponent is exact.
  static constexpr double kLn2Short = 0x1.62e42fee00000p-1;
  static constexpr double kLn2Rest = 0x1.a39ef35793c76p-33;

  // sin(2 pi r) / r in z = r^2 on [0, 1/16]; error of the sine 4.4e-18.
  static constexpr double kSin0 = 0x1.921fb54442d18p+2, kSin1 = -0x1.4abbce625be40p+5;
  static constexpr double kSin[7] = {
      0x1.466bc6775a409p+6, -0x1.32d2cce604ae5p+6, 0x1.5078347826517p+5, -0x1.e307483c1b49bp+3,
      0x1.e8f1f3b8d1890p+1, -0x1.6f486175c2fe9p-1, 0x1.97972a35f7df8p-4};
  // cos(2 pi r) in z = r^2 on [0, 1/16], the constant term 1; error of the cosine 5.5e-18.
  static constexpr double kCos1 = -0x1.3bd3cc9be45dcp+4;
  static constexpr double kCos[7] = {
      0x1.03c1f081b59a7p+6, -0x1.55d3c7e3c0266p+6, 0x1.e1f506815e272p+5, -0x1.a6d1efd023277p+4,
      0x1.f9d2561c35bd5p+2, -0x1.b695b5d772851p+0, 0x1.167c22aeef940p-2};
  // (exp(r) - 1 - r) / r^2 on |r| <= 1.0005 ln(2) / 2; relative error of exp(r) 4.6e-18.
  static constexpr double kExp[10] = {
      0x1.000000000000cp-1,  0x1.5555555555516p-3,  0x1.555555554fe59p-5,  0x1.1111111120de0p-7,
      0x1.6c16c185eeaaap-10, 0x1.a01a014ee5450p-13, 0x1.a01996022775ap-16, 0x1.71ded4c954336p-19,
      0x1.28b0b47905805p-22, 0x1.adfd93bffe702p-26};
  // (2 atanh(s) / s - 2) / s^2 in z = s^2, |s| <= tanh(ln(2) / 4); error of 2 atanh(s)/s 1.9e-20.
  static constexpr double kLog[8] = {
      0x1.5555555555555p-1, 0x1.9999999999d0ap-2, 0x1.249249243a361p-2, 0x1.c71c724a82c6fp-3,
      0x1.745ce20ffd0bcp-3, 0x1.3b2018a521d73p-3, 0x1.0f68463bb8667p-3, 0x1.0f05040883d52p-3};
  // (atanh(s) / s - 1 - z / 3) / z^2 in z = s^2, same interval; error of atanh(s)/s 9.0e-23.
  static constexpr double kLogTail[8] = {
      0x1.9999999999995p-3, 0x1.2492492493150p-3, 0x1.c71c71c56444fp-4, 0x1.745d183dec639p-4,
      0x1.3b135fff863dfp-4, 0x1.112112a7d433ep-4, 0x1.de26213628c94p-5, 0x1.eb76255ddc6b8p-5};
};

}  // namespace math_detail
}  // namespace TOMLIN_TARGET
}  // namespace tomlin
