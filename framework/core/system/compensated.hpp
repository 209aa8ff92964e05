#pragma once

#include <cstddef>
#include <type_traits>

#include "framework/core/numbers/number_types.hpp"
#include "framework/core/system/stage.hpp"

/// Adding many small steps to a number of few digits. A float carries what each sum rounds away in
/// a second number, its rest, so that a run does not lose digits with its length (W. Kahan, Commun.
/// ACM 8 (1965) 40, doi:10.1145/363707.363723; here with the exact sum of D. E. Knuth).
namespace tomlin {
inline namespace TOMLIN_TARGET {

/// Whether states of this number type are kept with their rests.
template <class Real>
inline constexpr bool kCompensated = std::is_same_v<Real, float>;

/// x[i] <- x[i] + factor * change, for a group of numbers. `rest` is null unless compensated.
template <class Real>
TOMLIN_INLINE void add_scaled(Real* x, Real* rest, std::size_t i, const Packed<Real>& factor,
                              const Packed<Real>& change) {
  using Group = Packed<Real>;
  const Group before = Group::load(x + i);
  if constexpr (kCompensated<Real>) {
    const Group due = fma(factor, change, Group::load(rest + i));
    const Group after = before + due;
    const Group part = after - before;
    ((before - (after - part)) + (due - part)).store(rest + i);
    after.store(x + i);
  } else {
    fma(factor, change, before).store(x + i);
  }
}

/// x[i] <- x[i] + move.
template <class Real>
TOMLIN_INLINE void add_move(Real* x, Real* rest, std::size_t i, const Packed<Real>& move) {
  using Group = Packed<Real>;
  if constexpr (kCompensated<Real>) {
    add_scaled(x, rest, i, Group(Real(1.0)), move);
  } else {
    (Group::load(x + i) + move).store(x + i);
  }
}

/// The same of a single number.
template <class Real>
TOMLIN_INLINE void add_one(Real* x, Real* rest, std::size_t i, Real move) {
  alignas(64) Real lanes[kGroup];
  for (std::size_t k = 0; k < kGroup; ++k) lanes[k] = k == i % kGroup ? move : Real(0.0);
  add_move(x, rest, i - i % kGroup, Packed<Real>::load(lanes));
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
