// Functions of the C library for quadruple precision (IEEE binary128; ISO/IEC TS 18661-3,
// glibc 2.26 or later). Declared here by their symbols, since the header of the library does not
// declare them to every compiler.
#pragma once

#include "framework/core/numbers/quad.hpp"

namespace tomlin::binary128 {

using Number = Quad::Number;

Number acos(Number x) __asm__("acosf128");
Number asin(Number x) __asm__("asinf128");
Number atan(Number x) __asm__("atanf128");
Number atan2(Number y, Number x) __asm__("atan2f128");
Number copysign(Number magnitude, Number sign) __asm__("copysignf128");
Number cos(Number x) __asm__("cosf128");
Number cosh(Number x) __asm__("coshf128");
Number exp(Number x) __asm__("expf128");
Number fabs(Number x) __asm__("fabsf128");
Number floor(Number x) __asm__("floorf128");
Number log(Number x) __asm__("logf128");
Number pow(Number x, Number y) __asm__("powf128");
Number roundeven(Number x) __asm__("roundevenf128");
Number sin(Number x) __asm__("sinf128");
Number sinh(Number x) __asm__("sinhf128");
Number sqrt(Number x) __asm__("sqrtf128");
Number tan(Number x) __asm__("tanf128");
Number tanh(Number x) __asm__("tanhf128");

}  // namespace tomlin::binary128
