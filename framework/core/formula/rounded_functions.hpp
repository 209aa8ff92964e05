#pragma once

namespace tomlin {

/// Functions of doubles computed in quadruple precision (binary128.hpp) and rounded once: the
/// double nearest to the exact value, and so the same bits whatever the C library, but for cases
/// too rare to be met. Slow (microseconds): for expressions, not for hot loops. Arguments are
/// finite; results that overflow are infinite.

double rounded_exp(double x);
double rounded_log(double x);  ///< x > 0

/// From here on neighbouring doubles are a radian or more apart: no phase is left.
inline constexpr double kLargestAngle = 7074237752028440.0;  // 2^50 turns

double rounded_sin(double x);  ///< |x| < kLargestAngle, also below
double rounded_cos(double x);
double rounded_tan(double x);

double rounded_asin(double x);  ///< |x| <= 1
double rounded_acos(double x);  ///< |x| <= 1
double rounded_atan2(double y, double x);

double rounded_sinh(double x);
double rounded_cosh(double x);
double rounded_tanh(double x);

/// x^y; x != 0 unless y >= 0, and y is integral where x < 0. x^0 = 1.
double rounded_power(double x, double y);

/// The k-th of n equal steps from a to b, 0 <= k <= n, n > 0: in their difference, or in their
/// ratio where both are positive. The ends are a and b themselves.
double rounded_linear_step(double a, double b, unsigned long k, unsigned long n);
double rounded_logarithmic_step(double a, double b, unsigned long k, unsigned long n);

}  // namespace tomlin
