#include "framework/core/formula/rounded_functions.hpp"

#include <cmath>

#include "framework/core/numbers/binary128.hpp"

namespace tomlin {
namespace {

double rounded(binary128::Number x) { return static_cast<double>(x); }

}  // namespace

double rounded_exp(double x) { return rounded(binary128::exp(x)); }
double rounded_log(double x) { return rounded(binary128::log(x)); }
double rounded_sin(double x) { return rounded(binary128::sin(x)); }
double rounded_cos(double x) { return rounded(binary128::cos(x)); }
double rounded_tan(double x) { return rounded(binary128::tan(x)); }
double rounded_asin(double x) { return rounded(binary128::asin(x)); }
double rounded_acos(double x) { return rounded(binary128::acos(x)); }
double rounded_atan2(double y, double x) { return rounded(binary128::atan2(y, x)); }
double rounded_sinh(double x) { return rounded(binary128::sinh(x)); }
double rounded_cosh(double x) { return rounded(binary128::cosh(x)); }
double rounded_tanh(double x) { return rounded(binary128::tanh(x)); }

double rounded_power(double x, double y) {
  // Multiplied out, a power that is exact stays exact, and so do ties. 1074 covers those of 2.
  const bool integral = std::floor(y) == y;
  if (!integral || std::fabs(y) > 1074) return rounded(binary128::pow(x, y));
  binary128::Number result = 1;
  binary128::Number square = x;
  for (auto n = static_cast<unsigned>(std::fabs(y)); n != 0; n /= 2) {
    if (n % 2 != 0) result *= square;
    if (n > 1) square *= square;
  }
  return rounded(y < 0 ? 1 / result : result);
}

double rounded_linear_step(double a, double b, unsigned long k, unsigned long n) {
  if (k == 0) return a;
  if (k == n) return b;
  const binary128::Number before = n - k;
  return rounded((before * a + binary128::Number(k) * b) / n);
}

double rounded_logarithmic_step(double a, double b, unsigned long k, unsigned long n) {
  if (k == 0) return a;
  if (k == n) return b;
  const binary128::Number before = n - k;
  const binary128::Number after = k;
  return rounded(binary128::exp((before * binary128::log(a) + after * binary128::log(b)) / n));
}

}  // namespace tomlin
