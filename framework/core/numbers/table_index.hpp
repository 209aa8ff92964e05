// Numbers of a table that each lane picks for itself.
#pragma once

#include <cstddef>
#include <type_traits>

#include "framework/core/numbers/dual.hpp"
#include "framework/core/numbers/number_types.hpp"

namespace tomlin {
inline namespace TOMLIN_TARGET {

// Indices in a table of doubles, from whole numbers between 0 and 2^53. What is no number means the
// first index.
template <class T>
class TableIndex {
 public:
  TOMLIN_INLINE explicit TableIndex(const T& index) {
    if constexpr (kScalar) {
      index_[0] = whole(index);
    } else {
      for (int i = 0; i < kLanes; ++i) index_[i] = whole(index.lane(i));
    }
  }

  // table[index] in every lane.
  TOMLIN_INLINE T of(const double* table) const {
    using Real = Scalar<T>;
    if constexpr (kScalar) {
      return T(static_cast<Real>(table[index_[0]]));
    } else {
      alignas(64) Real picked[kLanes];
      for (int i = 0; i < kLanes; ++i) picked[i] = static_cast<Real>(table[index_[i]]);
      return T::load(picked);
    }
  }

 private:
  static constexpr bool kScalar = std::is_same_v<T, Scalar<T>>;
  TOMLIN_INLINE static std::ptrdiff_t whole(Scalar<T> x) {
    const auto number = static_cast<double>(x);
    return number >= 0.0 ? static_cast<std::ptrdiff_t>(number) : 0;
  }

  std::ptrdiff_t index_[kScalar ? 1 : kLanes];
};

// By its value: the table's numbers have no derivative.
template <class T, int n>
class TableIndex<Dual<T, n>> {
 public:
  TOMLIN_INLINE explicit TableIndex(const Dual<T, n>& index) : index_(index.value) {}
  TOMLIN_INLINE Dual<T, n> of(const double* table) const { return Dual<T, n>(index_.of(table)); }

 private:
  TableIndex<T> index_;
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
