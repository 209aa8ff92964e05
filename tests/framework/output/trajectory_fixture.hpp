#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "framework/output/trajectory.hpp"

namespace tomlin::test {

/// A ring of three and a tip in the plane, in a box that is periodic along x.
inline RunLayout two_bodies() {
  RunLayout layout;
  layout.columns = {{"time", "time"}, {"driver.force.x", "force"}};
  layout.bodies = {{"ring", {0.25, 0.5, 0.125}}, {"tip", {2.0}}};
  layout.dimension = 2;
  layout.box = {7.5, 3.0};
  layout.periodic = {true, false};
  return layout;
}

/// The layout of two_bodies() with atoms in the ring.
inline RunLayout with_species() {
  RunLayout layout = two_bodies();
  layout.species = {"C", "H"};
  layout.bodies.front().species = {1, 0, 0};
  return layout;
}

/// Particles on a line, one body, no box.
inline RunLayout line_of(std::size_t particles) {
  RunLayout layout;
  layout.columns = {{"time", "time"}};
  layout.bodies = {{"chain", std::vector<double>(particles, 1.0)}};
  layout.dimension = 1;
  return layout;
}

inline TrajectoryFacts some_facts() {
  return {"a \"test\"", "none", UnitSystem::reduced, "[run]\nduration = 1.0\n", "0.1.0"};
}

/// Numbers with all their digits, different everywhere.
inline double position_of(std::size_t frame, std::size_t k) {
  return 1e9 / 3.0 + 0.1 * static_cast<double>(frame) - static_cast<double>(k) / 7.0;
}

inline double time_of(std::size_t frame) { return 0.1 * static_cast<double>(frame); }

inline std::vector<double> row_of(const RunLayout& layout, std::size_t frame) {
  std::vector<double> row(layout.row(), -1.0);
  row[0] = time_of(frame);
  for (std::size_t k = layout.columns.size(); k < row.size(); ++k) {
    row[k] = position_of(frame, k - layout.columns.size());
  }
  return row;
}

inline void write_frames(TrajectoryWriter& writer, const RunLayout& layout, std::size_t frames) {
  for (std::size_t f = 0; f < frames; ++f) writer.frame(row_of(layout, f));
}

}  // namespace tomlin::test
