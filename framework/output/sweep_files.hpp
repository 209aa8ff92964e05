#pragma once

namespace tomlin {

// Files of a sweep in its folder, besides kSceneFile.
inline constexpr const char* kSweepTableFile = "sweep.csv";
inline constexpr const char* kSweepArraysFile = "sweep.h5";
inline constexpr const char* kSweepSummaryFile = "sweep.json";
inline constexpr const char* kSweepJournalFile = "sweep.journal";

}  // namespace tomlin
