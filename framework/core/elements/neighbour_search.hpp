#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

/// Finds the particles near a position: cells are as long as the reach; that of the position and
/// those around it are searched. The work grows linearly with the number of particles.
namespace tomlin {

/// A particle within reach of a position x, and the image of it: its way from x is
/// (x_j - x) + shift, with whole lengths of the box.
struct Neighbour {
  std::uint32_t particle = 0;
  std::array<double, 3> shift{};

  bool operator==(const Neighbour&) const = default;
};

/// Searches particles in one, two or three dimensions. Lengths have one unit; along a periodic axis
/// the box is at least twice as long as the reach, so that a particle has one image within it.
class NeighbourSearch {
 public:
  NeighbourSearch(int dimension, double reach, const std::array<double, 3>& box);

  /// The particles that are found from now on: x of all, then y, then z. Those whose position is no
  /// finite number are near nothing.
  void sort(const std::vector<double>& positions, std::size_t count);

  /// All within the reach of a position, itself too where it is one of them, in ascending order.
  void find(const std::array<double, 3>& position, std::vector<Neighbour>& found) const;

  /// That its tables take.
  std::size_t bytes() const {
    return entries_.size() * sizeof(Entry) + positions_.size() * sizeof(positions_.front());
  }

 private:
  /// Cells along one axis, counted from 0; of an axis that is not periodic around a middle.
  std::int64_t cell_along(int axis, double x) const;
  /// The cells around one, each once; ranges of them that are consecutive.
  struct Range {
    std::int64_t first = 0;
    std::int64_t last = 0;
  };
  int ranges_around(int axis, double x, std::array<Range, 2>& ranges) const;

  int dimension_;
  double reach_;
  std::array<double, 3> box_;
  std::array<std::int64_t, 3> cells_{};  ///< of a periodic axis
  std::array<double, 3> length_{};       ///< of a cell

  struct Entry {
    std::uint64_t cell = 0;
    std::uint32_t particle = 0;
    bool operator<(const Entry& other) const {
      return cell != other.cell ? cell < other.cell : particle < other.particle;
    }
  };
  std::vector<Entry> entries_;                    ///< by cell, along x first
  std::vector<std::array<double, 3>> positions_;  ///< of the entries
};

}  // namespace tomlin
