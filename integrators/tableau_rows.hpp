#pragma once

#include <cstdint>
#include <type_traits>

#include "framework/core/numbers/number_types.hpp"
#include "integrators/explicit_tableau.hpp"

/// Rows of a tableau as arithmetic of numbers and of packs, unrolled at compile time.
namespace tomlin {
inline namespace TOMLIN_TARGET {

/// The row of a stage, or after the last the weights, and what multiplies accelerations in the
/// positions there.
template <class Tableau, int stage>
struct FixedRow {
  static constexpr auto row = tableau_row<Tableau>(stage);
  static constexpr WholeRow<Tableau> slopes{row};
  static constexpr auto time = row.sum();
  static constexpr bool of_previous_alone = slopes.is_unit(stage - 1);
};
template <class Tableau, int stage>
struct NystroemRow {
  static constexpr WholeRow<Tableau> slopes{times_matrix<Tableau>(FixedRow<Tableau, stage>::row)};
};

/// Sum of count[j] * value(j) over a row. What has equal counts is added first, from the last to
/// the first.
template <class Row>
struct RowSum {
  static constexpr int n = decltype(Row::slopes)::n;

  template <class Value>
  TOMLIN_INLINE static auto of(const Value& value) {
    constexpr int j = Row::slopes.first();
    auto total = equal_from<j>(value);
    using Number = decltype(total);
    if constexpr (Row::slopes.count[j] != 1) total = constant<Number, j>() * total;
    return more<j + 1>(total, value);
  }

 private:
  template <int j, class Value>
  TOMLIN_INLINE static auto equal_from(const Value& value) {
    constexpr int next = Row::slopes.equal_after(j);
    const auto one = value(std::integral_constant<int, j>());
    if constexpr (next == n) {
      return one;
    } else {
      return one + equal_from<next>(value);
    }
  }
  template <int j, class Number, class Value>
  TOMLIN_INLINE static Number more(const Number& total, const Value& value) {
    if constexpr (j == n) {
      return total;
    } else if constexpr (Row::slopes.new_at(j)) {
      return more<j + 1>(fma(constant<Number, j>(), equal_from<j>(value), total), value);
    } else {
      return more<j + 1>(total, value);
    }
  }
  template <class Number, int j>
  TOMLIN_INLINE static Number constant() {
    return Number(Scalar<Number>(Row::slopes.count[j]));
  }
};

/// The factors of a row for steps of h: of slopes, of accelerations in positions, and its time.
template <class Tableau, int stage, class Real>
struct RowSteps {
  using Row = FixedRow<Tableau, stage>;
  Real slope, time, square;

  TOMLIN_INLINE explicit RowSteps(Real h)
      : slope(part<Row::slopes.numerator, Row::slopes.denominator>(h)),
        time(part<Row::time.numerator[0], Row::time.denominator>(h)),
        square(0.0) {
    if constexpr (!Row::of_previous_alone) {
      using Positions = NystroemRow<Tableau, stage>;
      square = part<Positions::slopes.numerator, Positions::slopes.denominator>(h * h);
    }
  }

  /// x_s - x, where `velocity` is that of the stage before.
  template <class Number, class Slope>
  TOMLIN_INLINE Number move(const Number& v, const Number& velocity,
                            const Slope& acceleration) const {
    if constexpr (Row::of_previous_alone) {
      return Number(slope) * velocity;
    } else {
      return fma(Number(square), RowSum<NystroemRow<Tableau, stage>>::of(acceleration),
                 Number(time) * v);
    }
  }
  template <class Number, class Slope>
  TOMLIN_INLINE Number position(const Number& x, const Number& v, const Number& velocity,
                                const Slope& acceleration) const {
    if constexpr (Row::of_previous_alone) {
      return fma(Number(slope), velocity, x);
    } else {
      return x + move(v, velocity, acceleration);
    }
  }

 private:
  template <std::int64_t numerator, std::int64_t denominator>
  TOMLIN_INLINE static Real part(Real h) {
    return h * Real(numerator) / Real(denominator);
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
