#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "framework/plot/sample_table.hpp"
#include "framework/plot/stored_run.hpp"
#include "framework/scene/sweep_settings.hpp"

namespace tomlin {

/// A finished sweep as it lies in its folder: the axes of scene.toml and the table sweep.csv.
/// Points are numbered in the order of its rows. Those of a sweep that was refined make no grid:
/// the refined axis has all values that occur, and not each of them stands with all of the others.
struct StoredSweep {
  StoredRun run;  ///< what all points share: folder, scene and names of units
  std::vector<SweepAxis> axes;
  std::vector<SweepDimension> dimensions;
  std::vector<std::size_t> dimension_of;  ///< [axis]
  std::vector<std::size_t> stride;  ///< [dimension]: points from one of its values to the next
  std::size_t points = 1;
  std::optional<std::size_t> refined = {};  ///< axis
  /// Where there is a refined one, [point][dimension]: which value the point has.
  std::vector<std::vector<std::size_t>> indices = {};
  std::vector<bool> logarithmic = {};  ///< [axis]: its grid is spaced so
  SampleTable table;

  /// Which of its values a dimension has at a point.
  std::size_t index(std::size_t dimension, std::size_t point) const {
    return refined ? indices[point][dimension]
                   : point / stride[dimension] % dimensions[dimension].count;
  }
  /// The points that differ from this one along a dimension alone, and itself.
  std::vector<std::size_t> line(std::size_t dimension, std::size_t point) const;
  /// Columns of the table that are numbers of each point, and not axes.
  std::vector<std::string> observables() const;
  /// Throws InputError unless the table has a row for each point.
  std::vector<std::vector<double>> read(const std::vector<std::size_t>& columns) const;
};

/// Is this the folder of a sweep, finished or not?
bool holds_sweep(const std::string& folder);

/// Throws InputError when the sweep is not finished, or its files do not belong together.
StoredSweep read_stored_sweep(const std::string& folder);

}  // namespace tomlin
