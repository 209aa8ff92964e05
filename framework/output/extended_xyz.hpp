#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "framework/output/output_file.hpp"
#include "framework/output/trajectory.hpp"

namespace tomlin {

/// Bytes of the longest frame.
std::size_t xyz_bytes_per_frame(const RunLayout& layout, const TrajectoryFacts& facts);

/// A trajectory as text, in extended XYZ (as ASE and OVITO read it): for each frame the number of
/// particles, a line of facts, and a line per particle with 17 digits, which read back as the same
/// bits. Columns are species (X, "not an element", where a body has none), three axes of position,
/// the missing ones zero, and the index of the particle's body; the bodies' names stand in the
/// line of facts, and `dimension` where axes are missing. `Lattice` comes with a periodic box only;
/// it has no length along other axes. The body `particles` reads such files.
class ExtendedXyzWriter : public TrajectoryWriter {
 public:
  ExtendedXyzWriter(const std::filesystem::path& file, const RunLayout& layout,
                    const TrajectoryFacts& facts);

  void finish() override;

 private:
  void write(double time, std::span<const double> positions) override;

  OutputFile output_;
  std::string head_;  ///< of each frame, as far as it is always the same
  std::string buffer_;
};

}  // namespace tomlin
