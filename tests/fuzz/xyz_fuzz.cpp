#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "framework/core/text/xyz_file.hpp"

/// Any bytes are a file of extended XYZ or have faults. What is read has as many numbers as it has
/// particles, all of them finite.
namespace tomlin {
namespace {

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "%s\n", what);
  std::abort();
}

void read(std::string_view text, std::int64_t wanted) {
  const XyzFrame frame = parse_xyz(text, "fuzz.xyz", wanted);
  if (!frame.faults.empty()) return;
  const std::size_t axes = frame.dimension;
  const std::size_t count = frame.positions.size() / axes;
  require(axes >= 1 && axes <= 3 && count > 0, "there are no particles");
  require(frame.positions.size() == count * axes, "coordinates are missing");
  require(frame.velocities.empty() || frame.velocities.size() == count * axes, "velocities");
  require(frame.masses.empty() || frame.masses.size() == count, "masses");
  require(frame.species.empty() || frame.species.size() == count, "species");
  for (const double x : frame.positions) require(std::isfinite(x), "a number is not finite");
}

}  // namespace
}  // namespace tomlin

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  for (const std::int64_t frame : {0, 1, -1}) tomlin::read(text, frame);
  return 0;
}
