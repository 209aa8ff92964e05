#include "forcefields/sheet_field_lattice.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/core/text/axis_names.hpp"

namespace tomlin {
namespace {

/// An atom is on its lattice site when it is no further away than this part of the spacing: far
/// more than rounding, and far less than would show in a force.
constexpr double kOnSite = 1e-7;
/// A box ends on the lattice within this part, a little more: a lattice vector's error adds up.
constexpr double kFits = 1e-6;
/// Displacements between atoms that are tried as lattice vectors, the shortest first.
constexpr std::size_t kMostCandidates = 48;
/// Two vectors are parallel when the sine of their angle is smaller.
constexpr double kParallel = 1e-3;
/// In spacings, how far apart atoms of neighbouring cells with at most two atoms may be looked for;
/// a lattice that is longer one way by more than this is not found.
constexpr double kReach = 6.0;

double cross(const SheetPoint& a, const SheetPoint& b) { return a[0] * b[1] - a[1] * b[0]; }
double square(const SheetPoint& a) { return a[0] * a[0] + a[1] * a[1]; }

SheetPoint moved(const SheetPoint& a, const SheetPoint& b, double sign) {
  return {a[0] + sign * b[0], a[1] + sign * b[1]};
}

/// Displacements from one atom to others, and to its own images, the shortest first; of each pair
/// of opposite ones both.
std::vector<SheetPoint> candidates(const SheetAtoms& atoms, std::size_t from) {
  std::vector<SheetPoint> found;
  const double least = 1e-3 * atoms.spacing();
  const auto add = [&](std::size_t, double x, double y) {
    if (x * x + y * y > least * least) found.push_back({x, y});
  };
  atoms.for_near(atoms[from], kReach * atoms.spacing(), add);
  found.push_back({atoms.box()[0], 0.0});
  found.push_back({0.0, atoms.box()[1]});
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return square(a) < square(b); });
  if (found.size() > kMostCandidates) {
    found.resize(kMostCandidates);
    found.push_back({atoms.box()[0], 0.0});
    found.push_back({0.0, atoms.box()[1]});
  }
  return found;
}

/// Whether most atoms have another where the vector leads.
bool repeats(const SheetAtoms& atoms, const SheetPoint& vector) {
  std::size_t missing = 0;
  for (std::size_t i = 0; i < atoms.count() && 4 * missing <= atoms.count(); ++i) {
    if (!atoms.at(moved(atoms[i], vector, 1.0), kOnSite * atoms.spacing())) ++missing;
  }
  return 4 * missing <= atoms.count();
}

/// The shortest two lattice vectors that are not parallel; they span a cell as small as can be.
std::optional<std::array<SheetPoint, 2>> shortest_vectors(const SheetAtoms& atoms,
                                                          std::size_t from) {
  std::vector<SheetPoint> vectors;
  for (const SheetPoint& candidate : candidates(atoms, from)) {
    if (!vectors.empty()) {
      const double size = std::sqrt(square(vectors.front()) * square(candidate));
      if (!(std::abs(cross(vectors.front(), candidate)) > kParallel * size)) continue;
    }
    if (repeats(atoms, candidate)) vectors.push_back(candidate);
    if (vectors.size() == 2) return std::array{vectors[0], vectors[1]};
  }
  return std::nullopt;
}

/// The atom that has the fewest others where lattice vectors lead; nothing where none is missing.
std::optional<std::size_t> displaced_atom(const SheetAtoms& atoms,
                                          const std::array<SheetPoint, 2>& vectors) {
  std::optional<std::size_t> worst;
  int most = 0;
  for (std::size_t i = 0; i < atoms.count(); ++i) {
    int missing = 0;
    for (const SheetPoint& vector : vectors) {
      for (const double sign : {-1.0, 1.0}) {
        missing += !atoms.at(moved(atoms[i], vector, sign), kOnSite * atoms.spacing());
      }
    }
    if (missing > most) worst = i;
    most = std::max(most, missing);
  }
  return worst;
}

/// How near to the origin lattice vectors bring a point, given in parts of them.
double shortest_image(const SheetLattice& lattice, const SheetPoint& point) {
  const auto& [a1, a2] = lattice.vectors;
  double shortest = HUGE_VAL;
  for (const int i : {-1, 0, 1}) {
    for (const int j : {-1, 0, 1}) {
      const double u = point[0] - std::round(point[0]) + i;
      const double v = point[1] - std::round(point[1]) + j;
      shortest = std::min(shortest, std::hypot(u * a1[0] + v * a2[0], u * a1[1] + v * a2[1]));
    }
  }
  return shortest;
}

}  // namespace

SheetAtoms::SheetAtoms(std::vector<SheetPoint> atoms, SheetPoint box)
    : atoms_(std::move(atoms)),
      box_(box),
      spacing_(std::sqrt(box[0] * box[1] / static_cast<double>(atoms_.size()))) {
  for (std::size_t axis = 0; axis < 2; ++axis) {
    bins_along_[axis] = std::max(1L, static_cast<long>(box_[axis] / spacing_));
  }
  bins_.resize(static_cast<std::size_t>(bins_along_[0] * bins_along_[1]));
  for (std::size_t i = 0; i < atoms_.size(); ++i) {
    std::array<long, 2> bin = bin_of(atoms_[i]);
    for (std::size_t axis = 0; axis < 2; ++axis) {
      // Rounding may make a whole box of what is just below zero.
      const auto [in_box, shift] = wrapped(bin[axis], axis);
      atoms_[i][axis] -= shift;
      bin[axis] = static_cast<long>(in_box);
    }
    bins_[static_cast<std::size_t>(bin[0] * bins_along_[1] + bin[1])].push_back(i);
  }
}

std::array<long, 2> SheetAtoms::bin_of(const SheetPoint& point) const {
  std::array<long, 2> bin{};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double width = box_[axis] / static_cast<double>(bins_along_[axis]);
    bin[axis] = static_cast<long>(std::floor(point[axis] / width));
  }
  return bin;
}

std::pair<std::size_t, double> SheetAtoms::wrapped(long bin, std::size_t axis) const {
  const long count = bins_along_[axis];
  const long boxes = bin >= 0 ? bin / count : -((count - 1 - bin) / count);
  return {static_cast<std::size_t>(bin - boxes * count), static_cast<double>(boxes) * box_[axis]};
}

std::optional<std::size_t> SheetAtoms::at(const SheetPoint& point, double reach) const {
  std::optional<std::size_t> found;
  for_near(point, reach, [&](std::size_t i, double x, double y) {
    if (x * x + y * y <= reach * reach) found = i;
  });
  return found;
}

FoundLattice find_lattice(const SheetAtoms& atoms) {
  FoundLattice found;
  // If the first atom is displaced, another one is not: two are tried.
  const std::size_t count = atoms.count();
  auto vectors = shortest_vectors(atoms, 0);
  if (!vectors && count > 1) vectors = shortest_vectors(atoms, count / 2);
  if (!vectors) {
    found.fault = "its particles are on no lattice that the box repeats";
    return found;
  }
  SheetLattice& lattice = found.lattice;
  lattice.box = atoms.box();
  lattice.vectors = *vectors;
  if (cross(lattice.vectors[0], lattice.vectors[1]) < 0.0) {
    for (double& x : lattice.vectors[1]) x = -x;
  }
  const auto& [a1, a2] = lattice.vectors;
  lattice.area = cross(a1, a2);
  const std::array<SheetPoint, 2> reciprocal = {{{a2[1] / lattice.area, -a2[0] / lattice.area},
                                                 {-a1[1] / lattice.area, a1[0] / lattice.area}}};
  for (std::size_t j = 0; j < 2; ++j) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const double length = lattice.box[axis];
      const double turns = reciprocal[j][axis] * length;
      const double whole = std::round(turns);
      lattice.turns[j][axis] = whole;
      const double allowed = kFits * atoms.spacing() * std::max(1.0, std::abs(whole));
      if (whole == 0.0 || !(std::abs(turns - whole) * length > allowed)) continue;
      found.fault = fmt::format(
          "the box is {:.10g} long along {}, but the lattice of its particles continues at {:.10g}",
          length, kAxisNames[axis], length * whole / turns);
      return found;
    }
  }
  if (const auto displaced = displaced_atom(atoms, *vectors)) {
    found.fault = fmt::format("particle {} is off the lattice of the others", *displaced);
    return found;
  }
  const double in_cell =
      static_cast<double>(count) * lattice.area / (lattice.box[0] * lattice.box[1]);
  if (std::round(in_cell) > 2.0) {
    found.fault = fmt::format("its smallest cell has {:.0f} particles", in_cell);
    return found;
  }
  lattice.centre = atoms[0];
  lattice.atoms = {{0.0, 0.0}};
  if (std::round(in_cell) < 2.0) return found;
  // The nearest atom that no lattice vector leads to.
  for (const SheetPoint& to : candidates(atoms, 0)) {
    SheetPoint half{};
    double off = 0.0;
    for (std::size_t j = 0; j < 2; ++j) {
      const SheetPoint b = lattice.reciprocal(j);
      half[j] = 0.5 * (b[0] * to[0] + b[1] * to[1]);
      off = std::max(off, std::abs(2.0 * half[j] - std::round(2.0 * half[j])));
    }
    if (off < kParallel) continue;
    // The middle between the two and those half a lattice vector from there.
    double furthest = -1.0;
    for (const SheetPoint& shift :
         {SheetPoint{0.0, 0.0}, SheetPoint{0.5, 0.0}, SheetPoint{0.0, 0.5}, SheetPoint{0.5, 0.5}}) {
      const SheetPoint atom = {half[0] - shift[0], half[1] - shift[1]};
      const double distance = shortest_image(lattice, atom);
      // The first of equal distances is taken, whatever the rounding.
      if (!(distance > furthest * (1.0 + kParallel))) continue;
      furthest = distance;
      lattice.centre = {atoms[0][0] + 0.5 * to[0] + shift[0] * a1[0] + shift[1] * a2[0],
                        atoms[0][1] + 0.5 * to[1] + shift[0] * a1[1] + shift[1] * a2[1]};
      lattice.atoms = {{-atom[0], -atom[1]}, atom};
    }
    break;
  }
  return found;
}

}  // namespace tomlin
