#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// The lattice of a flat sheet of equal atoms in a periodic box, found from where they are.
namespace tomlin {

using SheetPoint = std::array<double, 2>;

/// Atoms in the plane of a box that is periodic along x and y, sorted into square bins.
class SheetAtoms {
 public:
  SheetAtoms(std::vector<SheetPoint> atoms, SheetPoint box);

  std::size_t count() const { return atoms_.size(); }
  const SheetPoint& operator[](std::size_t i) const { return atoms_[i]; }
  const SheetPoint& box() const { return box_; }
  /// Side of a square as large as an atom's share of the box.
  double spacing() const { return spacing_; }

  /// use(i, x, y): all images of atoms i whose displacement (x, y) from a point may be as short as
  /// `reach`, in an order that depends on the point alone; some are further away.
  template <class Use>
  void for_near(const SheetPoint& point, double reach, Use&& use) const {
    const std::array<long, 2> low = bin_of({point[0] - reach, point[1] - reach});
    const std::array<long, 2> high = bin_of({point[0] + reach, point[1] + reach});
    for (long bx = low[0]; bx <= high[0]; ++bx) {
      for (long by = low[1]; by <= high[1]; ++by) {
        const auto [kx, shift_x] = wrapped(bx, 0);
        const auto [ky, shift_y] = wrapped(by, 1);
        for (const std::size_t i : bins_[kx * static_cast<std::size_t>(bins_along_[1]) + ky]) {
          use(i, (atoms_[i][0] - point[0]) + shift_x, (atoms_[i][1] - point[1]) + shift_y);
        }
      }
    }
  }

  /// The atom of which an image is within `reach` of a point.
  std::optional<std::size_t> at(const SheetPoint& point, double reach) const;

 private:
  std::array<long, 2> bin_of(const SheetPoint& point) const;
  /// Returns the bin in the box of which a bin is an image, and the shift of its atoms.
  std::pair<std::size_t, double> wrapped(long bin, std::size_t axis) const;

  std::vector<SheetPoint> atoms_;  ///< in the box, from 0 on
  SheetPoint box_;
  double spacing_;
  std::array<long, 2> bins_along_{};
  std::vector<std::vector<std::size_t>> bins_;
};

/// The lattice whose cell is as small as can be, with one atom or two in it. About `centre` it is
/// symmetric: of two atoms a cell that is the point furthest from them (in graphene the middle of a
/// hexagon), or else the atom.
///
/// Lengths of the box are whole numbers of lattice vectors, so that its reciprocal vectors are
/// b_j = (turns[j][0]/box[0], turns[j][1]/box[1]) with whole `turns`.
struct SheetLattice {
  SheetPoint box{};
  std::array<SheetPoint, 2> vectors{};           ///< a1, a2: the shortest two
  std::array<std::array<double, 2>, 2> turns{};  ///< b_j.a_k = delta_jk
  double area = 0.0;                             ///< of a cell
  std::vector<SheetPoint> atoms;                 ///< of a cell, from `centre`, in a1 and a2
  SheetPoint centre{};

  SheetPoint reciprocal(std::size_t j) const {
    return {turns[j][0] / box[0], turns[j][1] / box[1]};
  }
};

/// The lattice, or why there is none.
struct FoundLattice {
  SheetLattice lattice;
  std::string fault;
};
FoundLattice find_lattice(const SheetAtoms& atoms);

}  // namespace tomlin
