#include "framework/core/formula/rounded_functions.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>

#include <boost/multiprecision/cpp_bin_float.hpp>

// Written out with + - * / and sqrt of the quadruple type only, which it rounds correctly. Its own
// functions start some iterations from libm and change between Boost's versions.
namespace tomlin {
namespace {

using Quad = boost::multiprecision::cpp_bin_float_quad;

// 60 bits a word, so that a word times an integer below 2^53 is exact in the 113 bits of a Quad.
constexpr int kWordBits = 60;
using Words = std::array<std::uint64_t, 4>;
// pi / 4 = 0.C90FDAA2... in hexadecimal.
constexpr Words kQuarterPi{0xC90FDAA22168C23, 0x4C4C6628B80DC1C, 0xD129024E088A67C,
                           0xC74020BBEA63B13};
// ln 2 = 0.B17217F7... in hexadecimal.
constexpr Words kLn2{0xB17217F7D1CF79A, 0xBC9E3B39803F2F6, 0xAF40F343267298B, 0x62D8A0D175B8BAA};

Quad power_of_two(int exponent) { return ldexp(Quad(1), exponent); }

// Word i of a constant in its place, times 2^shift.
Quad part(const Words& words, std::size_t i, int shift) {
  return Quad(words[i]) * power_of_two(shift - kWordBits * (static_cast<int>(i) + 1));
}

Quad whole(const Words& words, int shift) {
  Quad sum = 0;
  for (std::size_t i = words.size(); i-- > 0;) sum += part(words, i, shift);
  return sum;
}

const Quad& quad_pi() {
  static const Quad pi = whole(kQuarterPi, 2);
  return pi;
}

const Quad& quad_ln2() {
  static const Quad ln2 = whole(kLn2, 0);
  return ln2;
}

// To double, ties to even. Boost's conversion rounds twice below the normal range.
double rounded(const Quad& x) {
  const Quad magnitude = abs(x);
  if (magnitude >= power_of_two(-1022)) return x.convert_to<double>();
  const Quad units = magnitude * power_of_two(1074);
  const Quad low = floor(units);
  const Quad rest = units - low;
  auto count = low.convert_to<std::int64_t>();
  if (rest > 0.5 || (rest == 0.5 && count % 2 != 0)) ++count;
  const double result = std::ldexp(static_cast<double>(count), -1074);
  return x < 0 ? -result : result;
}

Quad exp_quad(const Quad& x) {
  // x = n ln 2 + r; the first word times n is exact.
  const Quad n = floor(x / quad_ln2() + 0.5);
  const Quad r = (x - n * part(kLn2, 0, 0)) - n * (quad_ln2() - part(kLn2, 0, 0));
  Quad sum = 1;
  for (int k = 30; k > 0; --k) sum = 1 + sum * r / k;  // |r| < 0.35: 0.35^31 / 31! < 2^-150
  return ldexp(sum, n.convert_to<int>());
}

Quad log_quad(double x) {
  // x = m 2^e, m between sqrt(1/2) and sqrt(2); log m = 2 atanh z. Near 1 nothing cancels.
  int e = 0;
  double m = std::frexp(x, &e);
  if (m < std::numbers::sqrt2 / 2) {
    m *= 2;
    --e;
  }
  const Quad z = (Quad(m) - 1) / (Quad(m) + 1);
  const Quad z2 = z * z;
  Quad sum = 0;
  for (int k = 26; k >= 0; --k) sum = sum * z2 + Quad(1) / (2 * k + 1);  // z2 < 0.03
  return 2 * z * sum + e * quad_ln2();
}

struct SineAndCosine {
  Quad sine, cosine;
};

SineAndCosine sine_and_cosine(double x) {
  // x = n pi/2 + r, with pi/2 in words: exact but for the last.
  const Quad n = floor(Quad(x) / (quad_pi() / 2) + 0.5);
  Quad r = x;
  for (std::size_t i = 0; i < kQuarterPi.size(); ++i) r -= n * part(kQuarterPi, i, 1);
  const Quad r2 = r * r;
  Quad sine = 1;
  Quad cosine = 1;
  for (int k = 17; k > 0; --k) {  // |r| < 0.79: 0.79^36 / 36! < 2^-150
    sine = 1 - sine * r2 / (2 * k * (2 * k + 1));
    cosine = 1 - cosine * r2 / (2 * k * (2 * k - 1));
  }
  sine *= r;
  switch (n.convert_to<std::int64_t>() & 3) {
    case 0:
      return {sine, cosine};
    case 1:
      return {cosine, -sine};
    case 2:
      return {-sine, -cosine};
    default:
      return {-cosine, sine};
  }
}

// The angle of (x, y) for y >= 0, not both zero.
Quad angle(const Quad& y, const Quad& x) {
  const Quad ax = abs(x);
  const bool steep = y > ax;
  Quad t = steep ? Quad(ax / y) : Quad(y / ax);
  for (int i = 0; i < 3; ++i) t = t / (1 + sqrt(1 + t * t));  // halves the angle
  const Quad t2 = t * t;
  Quad sum = 0;
  for (int k = 20; k >= 0; --k) sum = Quad(1) / (2 * k + 1) - sum * t2;  // t2 < 0.0098
  Quad result = 8 * t * sum;
  if (steep) result = quad_pi() / 2 - result;
  return x < 0 ? Quad(quad_pi() - result) : result;
}

// Bounds of exp beyond which doubles overflow, or round to zero.
constexpr double kOverflowLog = 709.79;
constexpr double kUnderflowLog = -745.14;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

double rounded_exp(double x) {
  if (x > kOverflowLog) return kInfinity;
  if (x < kUnderflowLog) return 0.0;
  return rounded(exp_quad(x));
}

double rounded_log(double x) { return rounded(log_quad(x)); }

// Zeros keep their sign, which the quadruple type loses.
double rounded_sin(double x) { return x == 0.0 ? x : rounded(sine_and_cosine(x).sine); }

double rounded_cos(double x) { return rounded(sine_and_cosine(x).cosine); }

double rounded_tan(double x) {
  if (x == 0.0) return x;
  const auto [sine, cosine] = sine_and_cosine(x);
  return rounded(sine / cosine);
}

double rounded_asin(double x) {
  if (x == 0.0) return x;
  const double result = rounded(angle(abs(Quad(x)), sqrt((1 - Quad(x)) * (1 + Quad(x)))));
  return x < 0 ? -result : result;
}

double rounded_acos(double x) { return rounded(angle(sqrt((1 - Quad(x)) * (1 + Quad(x))), x)); }

double rounded_atan2(double y, double x) {
  if (y == 0.0) return std::signbit(x) ? std::copysign(std::numbers::pi, y) : y;
  const double result = rounded(angle(abs(Quad(y)), x));
  return y < 0 ? -result : result;
}

double rounded_power(double x, double y) {
  const bool integral = std::floor(y) == y;
  const bool odd = integral && std::floor(y / 2) != y / 2;
  if (y == 0.0) return 1.0;
  if (x == 0.0) return odd ? x : 0.0;

  const double sign = x < 0 && odd ? -1.0 : 1.0;
  const Quad log_of_result = y * log_quad(std::fabs(x));
  if (log_of_result > kOverflowLog) return sign * kInfinity;
  if (log_of_result < kUnderflowLog) return sign * 0.0;

  // Multiplied out, a power that is exact stays exact, and so do ties. 1074 covers those of 2.
  if (integral && std::fabs(y) <= 1074) {
    Quad result = 1;
    Quad square = std::fabs(x);
    for (auto n = static_cast<unsigned>(std::fabs(y)); n != 0; n /= 2) {
      if (n % 2 != 0) result *= square;
      if (n > 1) square *= square;
    }
    if (y < 0) result = 1 / result;
    return sign * rounded(result);
  }
  return sign * rounded(exp_quad(log_of_result));
}

}  // namespace tomlin
