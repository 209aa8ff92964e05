#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/text/words.hpp"
#include "framework/plot/figure.hpp"
#include "framework/plot/quantities.hpp"
#include "framework/plot/stored_run.hpp"

namespace tomlin {

/// The samples of a scan that are shown: those at which x rises, or falls.
enum class ScanDirection { both, forward, backward };

constexpr auto word_table(ScanDirection) {
  using enum ScanDirection;
  return std::to_array<Word<ScanDirection>>(
      {{both, "both"}, {forward, "forward"}, {backward, "backward"}});
}

struct PixelGrid {
  std::size_t columns = 0;
  std::size_t rows = 0;
};

/// A column as colours over two others.
struct RasterRequest {
  std::string x;
  std::string y;
  std::string value;
  Owners owners;
  ScanDirection direction = ScanDirection::both;
  std::optional<PixelGrid> pixels;  ///< by the samples unless given
};

inline constexpr std::size_t kMostPixels = 1000;  ///< along an axis

/// The samples of all runs on a grid; a pixel has the mean of the samples in it, and one without a
/// sample stays white, which `notes` then says. Unless the grid is given it has a row for each
/// value of y, where there are few (scan lines), or else for each stroke along x, and as many
/// columns as have two samples in each pixel on average. Both axes have one scale where both are of
/// one unit.
Figure raster_figure(const std::vector<StoredRun>& runs, const RasterRequest& request,
                     std::vector<std::string>& notes);

}  // namespace tomlin
