#pragma once

#include <cfenv>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace tomlin {

/// Rounding and flushing to zero as they are now, whatever a call of somebody else's code makes of
/// them: put back at the end. Costs a few cycles where nothing was changed.
class OwnArithmetic {
 public:
  OwnArithmetic() : now_(control()) {}
  ~OwnArithmetic() {
    if (control() != now_) restore();
  }
  OwnArithmetic(const OwnArithmetic&) = delete;
  OwnArithmetic& operator=(const OwnArithmetic&) = delete;

 private:
#if defined(__SSE2__)
  static constexpr unsigned kFlags = 0x3FU;  // of exceptions that have been met
  static constexpr unsigned kRounding = 0x6000U;
  static unsigned control() { return _mm_getcsr() & ~kFlags; }
  void restore() const {
    // The other unit has a mode of its own, which the library sets with this one.
    const unsigned rounding = now_ & kRounding;
    std::fesetround(rounding == 0U        ? FE_TONEAREST
                    : rounding == 0x2000U ? FE_DOWNWARD
                    : rounding == 0x4000U ? FE_UPWARD
                                          : FE_TOWARDZERO);
    _mm_setcsr(now_ | (_mm_getcsr() & kFlags));
  }
  unsigned now_;
#else
  static int control() { return std::fegetround(); }
  void restore() const { std::fesetround(now_); }
  int now_;
#endif
};

}  // namespace tomlin
