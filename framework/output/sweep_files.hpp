#pragma once

namespace tomlin {

// Files of a sweep in its folder, besides kSceneFile.
inline constexpr const char* kSweepTableFile = "sweep.csv";
inline constexpr const char* kSweepArraysFile = "sweep.h5";
inline constexpr const char* kSweepSummaryFile = "sweep.json";
inline constexpr const char* kSweepJournalFile = "sweep.journal";

// Files of points and of lines that have been stopped: NUMBER.store, and NUMBER.line with the
// number of the line's first point.
inline constexpr const char* kPointSuffix = ".store";
inline constexpr const char* kLineSuffix = ".line";

}  // namespace tomlin
