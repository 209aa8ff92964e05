#pragma once

#include <cstddef>

#include "framework/core/formula/formula_arguments.hpp"
#include "framework/core/numbers/hyperbolic.hpp"
#include "framework/core/numbers/inverse_trigonometry.hpp"
#include "framework/core/numbers/math.hpp"
#include "framework/core/numbers/number_types.hpp"

/// Runs the code of a formula on blocks of elements.
///
/// Each instruction goes over a whole block, so that finding out what to do costs little; a block
/// of registers stays in the nearest cache.
namespace tomlin {
inline namespace TOMLIN_TARGET {

/// T is Real, for one element, or Packed<Real>, for blocks: how to load and store it.
template <class T, class Real>
struct Numbers {
  static constexpr std::size_t kStep = std::is_same_v<T, Real> ? 1 : kGroup;
  TOMLIN_INLINE static T load(const Real* from) {
    if constexpr (kStep == 1) {
      return *from;
    } else {
      return T::load(from);
    }
  }
  TOMLIN_INLINE static void store(const T& value, Real* to) {
    if constexpr (kStep == 1) {
      *to = value;
    } else {
      value.store(to);
    }
  }
};

/// Turns from which on their sine is none: `sin_turns` is exact below, and beyond the phase of most
/// numbers is lost. On every instruction set the same.
inline constexpr double kMostTurns = 0x1p50;

template <class T, class Real>
TOMLIN_INLINE T no_number() {
  return T(Real(__builtin_nan("")));
}

/// `packs` is 1 where T is Real.
template <class T, class Real>
__attribute__((noinline)) void run_steps(const FormulaStep<Real>* code, std::size_t length,
                                         std::size_t packs) {
  using N = Numbers<T, Real>;
  for (const FormulaStep<Real>* end = code + length; code != end; ++code) {
    const FormulaStep<Real> s = *code;
    const auto of_one = [&](auto&& f) TOMLIN_INLINE_LAMBDA {
      for (std::size_t k = 0; k < packs; ++k) {
        N::store(f(N::load(s.a.at + k * s.a.step)), s.to + k * N::kStep);
      }
    };
    const auto of_two = [&](auto&& f) TOMLIN_INLINE_LAMBDA {
      for (std::size_t k = 0; k < packs; ++k) {
        N::store(f(N::load(s.a.at + k * s.a.step), N::load(s.b.at + k * s.b.step)),
                 s.to + k * N::kStep);
      }
    };
    const auto of_three = [&](auto&& f) TOMLIN_INLINE_LAMBDA {
      for (std::size_t k = 0; k < packs; ++k) {
        N::store(f(N::load(s.a.at + k * s.a.step), N::load(s.b.at + k * s.b.step),
                   N::load(s.c.at + k * s.c.step)),
                 s.to + k * N::kStep);
      }
    };
    switch (s.op) {
      case FormulaOp::add:
        of_two([](const T& x, const T& y) { return x + y; });
        break;
      case FormulaOp::subtract:
        of_two([](const T& x, const T& y) { return x - y; });
        break;
      case FormulaOp::multiply:
        of_two([](const T& x, const T& y) { return x * y; });
        break;
      case FormulaOp::divide:
        of_two([](const T& x, const T& y) { return x / y; });
        break;
      case FormulaOp::multiply_add:
        of_three([](const T& x, const T& y, const T& z) { return fma(x, y, z); });
        break;
      case FormulaOp::negate:
        of_one([](const T& x) { return -x; });
        break;
      case FormulaOp::square_root:
        of_one([](const T& x) { return sqrt(x); });
        break;
      case FormulaOp::exponential:
        of_one([](const T& x) { return exp(x); });
        break;
      case FormulaOp::logarithm:
        of_one([](const T& x) { return log(x); });
        break;
      case FormulaOp::power:
        of_two([](const T& x, const T& y) { return pow(x, y); });
        break;
      case FormulaOp::sine:
        of_one([](const T& x) { return sin_turns(x); });
        break;
      case FormulaOp::cosine:
        of_one([](const T& x) { return cos_turns(x); });
        break;
      case FormulaOp::sine_and_cosine:
        for (std::size_t k = 0; k < packs; ++k) {
          T sine;
          T cosine;
          sincos_turns(N::load(s.a.at + k * s.a.step), sine, cosine);
          N::store(sine, s.to + k * N::kStep);
          N::store(cosine, s.also + k * N::kStep);
        }
        break;
      case FormulaOp::scaled_sine:
        of_two([](const T& x, const T& factor) { return factor * sin_turns(x); });
        break;
      case FormulaOp::scaled_cosine:
        of_two([](const T& x, const T& factor) { return factor * cos_turns(x); });
        break;
      case FormulaOp::tangent:
        of_one([](const T& x) { return tan_turns(x); });
        break;
      case FormulaOp::arc_sine:
        of_one([](const T& x) { return asin(x); });
        break;
      case FormulaOp::arc_cosine:
        of_one([](const T& x) { return acos(x); });
        break;
      case FormulaOp::arc_tangent:
        of_one([](const T& x) { return atan(x); });
        break;
      case FormulaOp::arc_tangent_2:
        of_two([](const T& x, const T& y) { return atan2(x, y); });
        break;
      case FormulaOp::magnitude:
        of_one([](const T& x) { return abs(x); });
        break;
      case FormulaOp::minimum:
        of_two([](const T& x, const T& y) { return select(x == x, select(x < y, x, y), x); });
        break;
      case FormulaOp::maximum:
        of_two([](const T& x, const T& y) { return select(x == x, select(y < x, x, y), x); });
        break;
      case FormulaOp::round_down:
        of_one([](const T& x) { return floor(x); });
        break;
      case FormulaOp::hyperbolic_sine:
        of_one([](const T& x) { return sinh(x); });
        break;
      case FormulaOp::hyperbolic_cosine:
        of_one([](const T& x) { return cosh(x); });
        break;
      case FormulaOp::hyperbolic_tangent:
        of_one([](const T& x) { return tanh(x); });
        break;
      case FormulaOp::sech_squared:
        of_one([](const T& x) { return sech_squared(x); });
        break;
      case FormulaOp::sign:
        of_one([](const T& x) { return sign(x); });
        break;
      case FormulaOp::unit_step:
        of_one([](const T& x) { return unit_step(x); });
        break;
      case FormulaOp::less:
        of_two([](const T& x, const T& y) {
          const T at_most = select(y <= x, T(Real(0.0)), no_number<T, Real>());
          return select(x < y, T(Real(1.0)), at_most);
        });
        break;
      case FormulaOp::when_positive:
        of_one([](const T& x) { return select(x > T(Real(0.0)), x, no_number<T, Real>()); });
        break;
      case FormulaOp::phase:
        of_one([](const T& x) {
          return select(abs(x) < T(Real(kMostTurns)), x, no_number<T, Real>());
        });
        break;
      case FormulaOp::where_finite:
        of_two([](const T& x, const T& y) {
          return select(y - y == T(Real(0.0)), x, no_number<T, Real>());
        });
        break;
      case FormulaOp::pick:
        of_three([](const T& x, const T& y, const T& z) {
          return select(x == T(Real(0.0)), z, select(x == x, y, x));
        });
        break;
    }
  }
}

/// Evaluates what all elements have in common: the time, and what follows from it.
template <class T, class Real>
TOMLIN_INLINE void begin_formula(const FormulaView<Real>& code, Real elapsed) {
  if (code.time != nullptr) {
    const Real now = *code.start_of_time + elapsed;
    for (std::size_t k = 0; k < kGroup; ++k) code.time[k] = now;
  }
  if (code.prologue_length > 0) run_steps<T, Real>(code.prologue, code.prologue_length, 1);
}

/// Inputs are read where they stand: [input], each a block.
template <class T, class Real>
TOMLIN_INLINE void run_formula(const FormulaView<Real>& code, const Real* const* inputs,
                               std::size_t packs) {
  for (std::size_t k = 0; k < code.patch_count; ++k) {
    *code.patches[k].at = inputs[code.patches[k].input];
  }
  run_steps<T, Real>(code.body, code.body_length, packs);
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
