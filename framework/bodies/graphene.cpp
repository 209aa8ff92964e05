#include "framework/bodies/graphene.hpp"

#include <array>
#include <cstddef>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "framework/bodies/whole_cells.hpp"
#include "framework/core/numbers/math.hpp"

namespace tomlin {
namespace {

using Description = GrapheneDescription;

constexpr double kRoot3 = 1.73205080756887729352744634151;
constexpr double kQuarterRoot3 = 0.433012701892219323381861585376;
constexpr std::int64_t kPerCell = 4;
/// Positions of a cell's particles along the armchair direction, in b/2; and their row out of two.
constexpr std::array<std::int64_t, kPerCell> kAlong = {0, 1, 3, 4};
constexpr std::array<std::int64_t, kPerCell> kRow = {0, 1, 1, 0};

std::size_t armchair_axis(const Description& d) { return static_cast<std::size_t>(d.armchair); }

double cell_length(const Description& d, std::size_t axis) {
  return (axis == armchair_axis(d) ? 3.0 : kRoot3) * d.bond_length;
}

bool is_valid(const WordOrNumbers& given) { return given.numbers.size() == 2; }

/// Along x and y.
std::array<std::int64_t, 2> cells_of(const Description& d) {
  if (is_valid(d.cells))
    return {whole_cells(d.cells.numbers[0], 1.0), whole_cells(d.cells.numbers[1], 1.0)};
  return {whole_cells(d.size.numbers[0], cell_length(d, 0)),
          whole_cells(d.size.numbers[1], cell_length(d, 1))};
}

double length_of(const Description& d, std::size_t axis) {
  return static_cast<double>(cells_of(d)[axis]) * cell_length(d, axis);
}

int dimension_of(const Description&) { return 3; }

std::int64_t count(const Description& d) {
  if (!is_valid(d.cells) && !is_valid(d.size)) return 1;  // which complaints() reports
  const auto [along_x, along_y] = cells_of(d);
  return particles_in(kPerCell, along_x, along_y);
}

std::vector<Complaint> complaints(const Description& d, int dimension) {
  const bool by_cells = !d.cells.numbers.empty();
  const bool by_size = !d.size.numbers.empty();
  std::vector<Complaint> found = complaints_without_space("graphene", d.centre, dimension);
  for (Complaint& one : complaints_unless_one("cells", by_cells, "size", by_size)) {
    found.push_back(std::move(one));
  }
  const auto check = [&](const char* key, const WordOrNumbers& given, const char* admissible) {
    if (given.numbers.empty() || is_valid(given)) return;
    found.push_back({.key = key,
                     .why = fmt::format("found {} numbers", given.numbers.size()),
                     .admissible = admissible,
                     .code = FaultCode::scene_wrong_count});
  };
  check("cells", d.cells, "two, along x and y");
  check("size", d.size, "two, along x and y");
  for (const double cells : d.cells.numbers) {
    if (cells == __builtin_floor(cells)) continue;
    found.push_back({.key = "cells",
                     .why = "a number of cells is not whole",
                     .admissible = "two whole numbers >= 1",
                     .code = FaultCode::scene_out_of_range});
    break;
  }
  return found;
}

/// The cells of a sheet by row of cells and by index in the row.
class SheetCells {
 public:
  explicit SheetCells(const Description& d)
      : rows_(cells_of(d)[armchair_axis(d)]), in_row_(cells_of(d)[1 - armchair_axis(d)]) {}

  std::int64_t rows() const { return rows_; }
  std::int64_t in_row() const { return in_row_; }

  /// Rows are numbered there and back.
  std::int64_t particle(std::int64_t row, std::int64_t index, std::int64_t k) const {
    const std::int64_t way = row % 2 == 0 ? index : in_row_ - 1 - index;
    return (row * in_row_ + way) * kPerCell + k;
  }

 private:
  std::int64_t rows_;
  std::int64_t in_row_;
};

std::vector<IndexPair> neighbours(const Description& d, const std::array<double, 3>& box) {
  const SheetCells cells(d);
  const std::size_t along = armchair_axis(d);
  const bool closed_along = fills_box(length_of(d, along), box[along]);
  const bool closed_across = fills_box(length_of(d, 1 - along), box[1 - along]);
  std::vector<IndexPair> pairs;
  for (std::int64_t row = 0; row < cells.rows(); ++row) {
    for (std::int64_t index = 0; index < cells.in_row(); ++index) {
      const auto here = [&](std::int64_t k) { return cells.particle(row, index, k); };
      pairs.push_back({here(0), here(1)});
      pairs.push_back({here(1), here(2)});
      pairs.push_back({here(2), here(3)});
      if (closed_along || row + 1 < cells.rows()) {
        pairs.push_back({here(3), cells.particle((row + 1) % cells.rows(), index, 0)});
      }
      if (closed_across || index + 1 < cells.in_row()) {
        const std::int64_t next = (index + 1) % cells.in_row();
        pairs.push_back({here(1), cells.particle(row, next, 0)});
        pairs.push_back({here(2), cells.particle(row, next, 3)});
      }
    }
  }
  return each_pair_once(std::move(pairs));
}

std::string note(const Description& d) {
  const auto cells = cells_of(d);
  return fmt::format(
      "{} x {} cells of {:.6g} x {:.6g}; a periodic box repeats it with the lengths {:.12g} along "
      "x and "
      "{:.12g} along y",
      cells[0], cells[1], cell_length(d, 0), cell_length(d, 1), length_of(d, 0), length_of(d, 1));
}

BodyGeometry build(const Description& d, int) {
  const SheetCells cells(d);
  const std::size_t along = armchair_axis(d);
  BodyGeometry geometry;
  geometry.anchor = centre_or_origin(d.centre);
  geometry.relative.assign(static_cast<std::size_t>(count(d)), std::vector<double>(3, 0.0));
  for (std::int64_t row = 0; row < cells.rows(); ++row) {
    for (std::int64_t index = 0; index < cells.in_row(); ++index) {
      for (std::int64_t k = 0; k < kPerCell; ++k) {
        const auto atom = static_cast<std::size_t>(k);
        const std::int64_t s = kAlong[atom] - 2 + 6 * row - 3 * (cells.rows() - 1);
        const std::int64_t t = 2 * kRow[atom] - 1 + 4 * index - 2 * (cells.in_row() - 1);
        std::vector<double>& x =
            geometry.relative[static_cast<std::size_t>(cells.particle(row, index, k))];
        x[along] = 0.5 * static_cast<double>(s) * d.bond_length;
        x[1 - along] = kQuarterRoot3 * static_cast<double>(t) * d.bond_length;
      }
    }
  }
  return geometry;
}

}  // namespace

BodyRecord graphene_record() {
  constexpr Interval kOneOrMore{.low = 1.0, .low_open = false};
  auto record = body_record<Description>(
      {parameter("bond_length", &Description::bond_length, dimension::length,
                 "b, between nearest neighbours: 1.42 Angstrom in graphene")
           .in(positive),
       parameter(
           "cells", &Description::cells, dimension::none,
           "number of rectangular cells along x and y, of four particles each: 3 b long along "
           "the armchair direction and sqrt(3) b along the other")
           .in(kOneOrMore)
           .or_absent(),
       parameter("size", &Description::size, dimension::length,
                 "in place of cells: lengths along x and y that as many cells fill as fit")
           .in(positive)
           .or_absent(),
       parameter("armchair", &Description::armchair, dimension::none,
                 "axis of the armchair direction; zigzag rows are along the other")
           .one_of({"x", "y"})
           .by_default(Axis::x),
       parameter("centre", &Description::centre, dimension::length,
                 "mean of the particles; the origin by default")
           .or_absent()});
  record.name = "graphene";
  record.summary =
      "a flat sheet of graphene across z in space, of whole cells, for a periodic box or with "
      "edges";
  record.equation =
      "(s, t) = (0, 0), (1/2, sqrt(3)/2) b, (3/2, sqrt(3)/2) b, (2, 0) b in each cell of 3 b x "
      "sqrt(3) b, s along armchair; box lengths that continue it: cells * 3 b and cells * sqrt(3) "
      "b";
  record.source =
      "A. H. Castro Neto, F. Guinea, N. M. R. Peres, K. S. Novoselov and A. K. Geim, Rev. Mod. "
      "Phys. "
      "81 (2009) 109, doi:10.1103/RevModPhys.81.109";
  record.dimension = of_description<&dimension_of>;
  record.count = of_description<&count>;
  record.complaints = of_description<&complaints>;
  record.neighbours = of_description<&neighbours>;
  record.note = of_description<&note>;
  record.build = of_description<&build>;
  record.example = R"(# A sheet without edges, held by springs, under a tip that pulls at one atom.
[parameters]
b = 1.42                             # length of a bond

[box]
lengths = ["4 * 3 * b", "6 * sqrt(3) * b", 20.0]
periodic = [true, true, false]

[[body]]
type = "graphene"
bond_length = "b"
cells = [4, 6]
species = "C"
particle_mass = 12.011

[[force]]
type = "harmonic_bonds"
pairs = "neighbours"
stiffness = 30.0

[[force]]
type = "driving_spring"
stiffness = 1.0
velocity = [0.0, 0.0, 0.1]
attach = { particle = 40 }

[run]
duration = 1.0
integrator = { type = "rk4", dt = 1e-2 }
)";
  return record;
}

}  // namespace tomlin
