// The two number types that a run can be computed in, and what generic code asks of them:
//
//   double  Pack         the one to use
//   Quad    QuadPack     a reference, to see what rounding does
//
// Kernels are templates of the scalar, Real; Packed<Real> is eight of them.
#pragma once

#include <type_traits>

#include "framework/core/numbers/pack.hpp"
#include "framework/core/numbers/quad.hpp"

namespace tomlin {
inline namespace TOMLIN_TARGET {

// The pack of eight of a scalar.
template <class Real>
struct PackOf;
template <>
struct PackOf<double> {
  using Type = Pack;
};
template <>
struct PackOf<Quad> {
  using Type = QuadPack;
};
template <class Real>
using Packed = typename PackOf<Real>::Type;

// The scalar that a type is made of: of a scalar itself, of a lane, of the value of a Dual
// (dual.hpp).
template <class T>
struct ScalarOf {
  using Type = T;
};
template <>
struct ScalarOf<Pack> {
  using Type = double;
};
template <>
struct ScalarOf<QuadPack> {
  using Type = Quad;
};
template <class T>
using Scalar = typename ScalarOf<T>::Type;

// True in lanes 0 to n-1 of a pack P.
template <class P>
TOMLIN_INLINE Mask<P> first_lanes_of(int n) {
  if constexpr (std::is_same_v<P, Pack>) {
    return first_lanes(n);
  } else {
    return Mask<P>::first(n);
  }
}

// 2 pi, rounded once to the scalar of T, as a T; of a Dual, a constant.
template <class T>
TOMLIN_INLINE constexpr T tau() {
  // Three doubles are 159 bits. The sum of the smaller two is exact in every type that shows them.
  constexpr double high = 0x1.921fb54442d18p+2;
  if constexpr (std::is_same_v<Scalar<T>, Quad>) {
    return T(Quad(high) + (Quad(0x1.1a62633145c07p-52) - Quad(0x1.f1976b7ed8fbcp-108)));
  } else {
    return T(static_cast<Scalar<T>>(high));
  }
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
