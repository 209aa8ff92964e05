#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "framework/run/run.hpp"
#include "framework/scene/scene.hpp"

/// How much a run will write, before it writes anything.
namespace tomlin {

/// A table of it has some hundred gigabytes of text, of the time and a few columns alone: more than
/// any program reads, and a sampling interval that was mistyped.
inline constexpr double kMostRows = 1e9;

/// How many events a run can have is not known beforehand: so many are kept, some 200 MB, and the
/// rest is counted. A driver takes a million periods for as many slips.
inline constexpr std::uint64_t kMostEvents = 1'000'000;

/// Bytes at most; a run that lasts until it is steady, or is stopped, leaves less.
struct OutputSize {
  double rows = 0.0;        ///< of observables.csv, and frames of the trajectory
  double table = 0.0;       ///< observables.csv
  double trajectory = 0.0;  ///< trajectory.h5 or .xyz
  double journal = 0.0;     ///< run.journal: all samples, until the run has ended
  double checkpoint = 0.0;  ///< run.checkpoint: one, beside which the next is written
  double store = 0.0;       ///< run.store: states of runs beside it; the next beside it, too
  double per_row = 0.0;     ///< of table, trajectory and journal

  /// All that stands on the disk at the same time.
  double together() const { return table + trajectory + journal + 2.0 * (checkpoint + store); }
};

OutputSize output_size(const Scene& scene, const RunLayout& layout);

/// Bytes that a run can fill in a folder, or where it is going to be made: what is free, and what
/// the run that stands there has filled, which is replaced or gone on with. Infinite where the
/// file system does not say.
double room_in(const std::filesystem::path& folder);

/// The shortest `output.every` that fits, rounded up to three digits; 0 where none does.
double shortest_every(const Scene& scene, const OutputSize& size, double room);

/// Throws InputError, at `output.every`, when a run would leave too many rows or does not fit.
void require_room(const Scene& scene, const OutputSize& size, double room);

/// "4.5 GB".
std::string bytes_text(double bytes);

}  // namespace tomlin
