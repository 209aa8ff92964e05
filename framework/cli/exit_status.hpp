#pragma once

/// Meanings of the program's exit status.
namespace tomlin {

inline constexpr int kExitDone = 0;
inline constexpr int kExitFailed = 1;    ///< a run failed, or its results could not be written
inline constexpr int kExitBadInput = 2;  ///< nothing was run, nothing was made
inline constexpr int kExitSignal = 128;  ///< plus the signal's number

}  // namespace tomlin
