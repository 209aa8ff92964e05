#pragma once
#include "framework/core/math.hpp"
#include "framework/core/number_types.hpp"
namespace tomlin { inline namespace TOMLIN_TARGET {
template <class T> TOMLIN_INLINE T tan_turns(T x) { T s, c; sincos_turns(x, s, c); return s / c; }
template <class T> TOMLIN_INLINE T asin(T x) { return x; }
template <class T> TOMLIN_INLINE T acos(T x) { return x; }
template <class T> TOMLIN_INLINE T atan(T x) { return x; }
template <class T> TOMLIN_INLINE T atan2(T x, T) { return x; }
template <class T> TOMLIN_INLINE T floor(T x) { T r = round(x); return select(x < r, r - T(1.0), r); }
}}
