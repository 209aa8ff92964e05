#pragma once

#include <cfenv>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace tomlin {

/// Keeps the modes of rounding and of flushing to zero through a call of a plugin's code: modes
/// that the call has changed are restored at the end of the scope.
class OwnArithmetic {
 public:
#if defined(__SSE2__)
  using Mode = unsigned;
#else
  using Mode = int;
#endif

  static Mode mode();

  /// `before`: the mode at the start. To read it takes as long as a small force; where it is known
  /// already, the mode is read only once, after the call.
  explicit OwnArithmetic(Mode before = mode()) : before_(before) {}
  ~OwnArithmetic() {
    if (mode() != before_) restore();
  }
  OwnArithmetic(const OwnArithmetic&) = delete;
  OwnArithmetic& operator=(const OwnArithmetic&) = delete;

 private:
#if defined(__SSE2__)
  static constexpr unsigned kFlags = 0x3FU;  // of exceptions that have been met
  static constexpr unsigned kRounding = 0x6000U;
  void restore() const {
    // The other unit has a mode of its own, which the library sets with this one.
    const unsigned rounding = before_ & kRounding;
    std::fesetround(rounding == 0U        ? FE_TONEAREST
                    : rounding == 0x2000U ? FE_DOWNWARD
                    : rounding == 0x4000U ? FE_UPWARD
                                          : FE_TOWARDZERO);
    _mm_setcsr(before_ | (_mm_getcsr() & kFlags));
  }
#else
  void restore() const { std::fesetround(before_); }
#endif
  Mode before_;
};

inline OwnArithmetic::Mode OwnArithmetic::mode() {
#if defined(__SSE2__)
  return _mm_getcsr() & ~kFlags;
#else
  return std::fegetround();
#endif
}

}  // namespace tomlin
