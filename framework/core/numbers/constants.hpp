#pragma once

namespace tomlin {

/// 2 pi.
inline constexpr double kTau = 6.283185307179586476925286766559;

/// A bound or a length of this size or above stands for none.
inline constexpr double kNoBound = 1e300;

}  // namespace tomlin
