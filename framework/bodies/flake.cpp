#include "framework/bodies/flake.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "framework/bodies/outline.hpp"
#include "framework/core/numbers/math.hpp"

namespace tomlin {
namespace {

using Description = FlakeDescription;

/// A particle in whole numbers: x = u / 2, and y = v / 2 in a square lattice, v / (2 sqrt(3)) in
/// the others, in lattice constants from the middle of the shape.
struct LatticeSite {
  std::int64_t u = 0;
  std::int64_t v = 0;
};

constexpr double kHalfOverRoot3 = 0.288675134594812882254574390251;

/// By so much, relatively, sizes are widened: far more than rounding, and so little that it takes
/// 1e9 particles to meet one that is outside for certain.
constexpr double kSizeTolerance = 1e-9;

std::int64_t whole_below(double x) { return static_cast<std::int64_t>(x * (1.0 + kSizeTolerance)); }

/// The largest whole number whose square is at most n; -1 where n is negative.
std::int64_t whole_root(std::int64_t n) {
  if (n < 0) return -1;
  auto root = static_cast<std::int64_t>(sqrt(static_cast<double>(n)));
  while (root * root > n) --root;
  while ((root + 1) * (root + 1) <= n) ++root;
  return root;
}

/// Remainder of a whole number by a positive one, never negative.
std::int64_t modulo(std::int64_t n, std::int64_t by) { return ((n % by) + by) % by; }

bool is_square(const Description& d) { return d.lattice == FlakeLattice::square; }
bool is_honeycomb(const Description& d) { return d.lattice == FlakeLattice::honeycomb; }

double width_of(const Description& d) { return d.size.numbers.front(); }
double height_of(const Description& d) { return d.size.numbers.back(); }

/// The rows of a flake, and how far each reaches to both sides.
class FlakeRows {
 public:
  explicit FlakeRows(const Description& d) : lattice_(d.lattice), shape_(d.shape) {
    const double width = width_of(d);
    const double height = height_of(d);
    const std::int64_t n = whole_below(width);
    switch (shape_) {
      case FlakeShape::hexagon:
        lowest_ = -3 * n;
        limit_ = 6 * n;
        break;
      case FlakeShape::circle:
        limit_ = whole_below((is_square(d) ? 4.0 : 12.0) * width * width);
        lowest_ = -whole_root(limit_);
        break;
      case FlakeShape::square:
      case FlakeShape::rectangle:
        limit_ = n;
        lowest_ =
            is_square(d) ? -whole_below(height) : -whole_root(whole_below(3.0 * height * height));
        if (is_square(d)) shift_u_ = n;
        if (is_square(d)) shift_ = -lowest_;
        break;
      case FlakeShape::triangle:
        // In a honeycomb the middles of the outermost hexagons form a triangle smaller by one, and
        // the edges pass through particles outside of these.
        shift_ = is_honeycomb(d) ? n - 1 : n;
        limit_ = is_honeycomb(d) ? 2 * shift_ + 4 : 2 * shift_;
        lowest_ = -limit_ / 2;
        // A particle in a corner would have one bond alone.
        highest_ = is_honeycomb(d) ? limit_ - 1 : limit_;
        return;
    }
    highest_ = -lowest_;
  }

  std::int64_t lowest() const { return lowest_; }
  std::int64_t highest() const { return highest_; }

  /// In a row of a honeycomb: above the middles of hexagons, so that a bond goes up; or below them.
  bool is_above_middles(std::int64_t v) const { return modulo(v + shift_, 3) == 2; }

  /// The sites of a row are at u = -end(v), -end(v) + 2, .., end(v); none where it is negative.
  std::int64_t end(std::int64_t v) const {
    if (v < lowest_ || v > highest_) return -1;
    std::int64_t parity = 0;
    if (!has_sites(v, parity)) return -1;
    const std::int64_t reach = reach_of(v);
    return reach - modulo(reach - parity, 2);
  }

 private:
  /// Whether the lattice has particles in a row, and whether their u are odd.
  bool has_sites(std::int64_t v, std::int64_t& parity) const {
    const std::int64_t above = v + shift_;  // a corner of the cells, whose u has the parity of j
    switch (lattice_) {
      case FlakeLattice::square:
        parity = modulo(shift_u_, 2);
        return modulo(above, 2) == 0;
      case FlakeLattice::hexagonal:
        parity = modulo(above / 3 - shift_, 2);
        return modulo(above, 3) == 0;
      case FlakeLattice::honeycomb: {
        const std::int64_t j = is_above_middles(v) ? (above - 2) / 3 : (above + 2) / 3;
        parity = modulo(j - shift_, 2);
        return modulo(above, 3) != 0;
      }
    }
    return false;
  }

  std::int64_t reach_of(std::int64_t v) const {
    switch (shape_) {
      case FlakeShape::hexagon:
        return (limit_ - (v < 0 ? -v : v)) / 3;
      case FlakeShape::circle:
        if (lattice_ == FlakeLattice::square) return whole_root(limit_ - v * v);
        return whole_root((limit_ - v * v) / 3);
      case FlakeShape::square:
      case FlakeShape::rectangle:
        return limit_;
      case FlakeShape::triangle:
        return (limit_ - v) / 3 - (lattice_ == FlakeLattice::honeycomb && v == lowest_ ? 1 : 0);
    }
    return -1;
  }

  FlakeLattice lattice_;
  FlakeShape shape_;
  std::int64_t limit_ = 0;   ///< of the shape's own inequality
  std::int64_t lowest_ = 0;  ///< v of the lowest row
  std::int64_t highest_ = 0;
  std::int64_t shift_ = 0;    ///< from the middle of the shape down to a corner of the cells, in v
  std::int64_t shift_u_ = 0;  ///< of a square lattice the same in u
};

int dimension_of(const Description& d) { return static_cast<int>(d.centre.components.size()); }

bool has_sizes(const Description& d) {
  const std::size_t given = d.size.numbers.size();
  return given == 1 || (given == 2 && d.shape == FlakeShape::rectangle);
}

/// Beyond a number that no scene may have about as many as there are.
std::int64_t count(const Description& d) {
  constexpr double kMostExactlyCounted = 1e8;
  constexpr double kMostReported = 1e18;
  if (!has_sizes(d)) return 1;  // which complaints() reports
  const double about = (width_of(d) + 1.0) * (height_of(d) + 1.0);
  if (about > kMostExactlyCounted) return static_cast<std::int64_t>(min(about, kMostReported));
  const FlakeRows rows(d);
  std::int64_t total = 0;
  for (std::int64_t v = rows.lowest(); v <= rows.highest(); ++v) total += rows.end(v) + 1;
  return total;
}

std::vector<Complaint> complaints(const Description& d, int dimension) {
  std::vector<Complaint> found = complaints_without_plane("a flake", dimension);
  const bool cornered = d.shape == FlakeShape::hexagon || d.shape == FlakeShape::triangle;
  if (cornered && is_square(d)) {
    found.push_back({.key = "shape",
                     .why = "a square lattice has no edges in these directions",
                     .admissible = "\"circle\", \"square\" or \"rectangle\"",
                     .code = FaultCode::scene_conflict});
  }
  if (!has_sizes(d)) {
    found.push_back({.key = "size",
                     .why = fmt::format("{} numbers for this shape", d.size.numbers.size()),
                     .admissible = "one number, or two of a rectangle",
                     .code = FaultCode::scene_wrong_count});
  } else if (cornered && width_of(d) != static_cast<double>(whole_below(width_of(d)))) {
    found.push_back({.key = "size",
                     .why = "the edges of this shape are a whole number of lattice constants",
                     .admissible = "a whole number",
                     .code = FaultCode::component_invalid});
  }
  return found;
}

std::vector<LatticeSite> sites_of(const FlakeRows& rows) {
  std::vector<LatticeSite> sites;
  for (std::int64_t v = rows.lowest(); v <= rows.highest(); ++v) {
    const std::int64_t end = rows.end(v);
    for (std::int64_t u = -end; u <= end; u += 2) sites.push_back({u, v});
  }
  return sites;
}

/// From a particle to those of its nearest neighbours that come later.
std::vector<LatticeSite> later_neighbours(FlakeLattice lattice, bool above_middles) {
  switch (lattice) {
    case FlakeLattice::hexagonal:
      return {{2, 0}, {-1, 3}, {1, 3}};
    case FlakeLattice::square:
      return {{2, 0}, {0, 2}};
    case FlakeLattice::honeycomb:
      if (above_middles) return {{0, 2}};
      return {{-1, 1}, {1, 1}};
  }
  return {};
}

std::vector<IndexPair> neighbours(const Description& d, const std::array<double, 3>&) {
  const FlakeRows rows(d);
  std::vector<std::int64_t> first;  // particle of each row
  std::int64_t total = 0;
  for (std::int64_t v = rows.lowest(); v <= rows.highest(); ++v) {
    first.push_back(total);
    total += rows.end(v) + 1;
  }
  const auto index = [&](LatticeSite site) {
    const std::int64_t end = rows.end(site.v);
    if (site.u < -end || site.u > end) return std::int64_t{-1};
    return first[static_cast<std::size_t>(site.v - rows.lowest())] + (site.u + end) / 2;
  };
  std::vector<IndexPair> pairs;
  for (const LatticeSite& site : sites_of(rows)) {
    for (const LatticeSite& step : later_neighbours(d.lattice, rows.is_above_middles(site.v))) {
      const std::int64_t other = index({site.u + step.u, site.v + step.v});
      if (other >= 0) pairs.push_back({index(site), other});
    }
  }
  return pairs;
}

BodyGeometry build(const Description& d, int dimension) {
  const double height = is_square(d) ? 0.5 : kHalfOverRoot3;
  std::vector<PlanePoint> points;
  for (const LatticeSite& site : sites_of(FlakeRows(d))) {
    points.push_back({0.5 * static_cast<double>(site.u) * d.lattice_constant,
                      height * static_cast<double>(site.v) * d.lattice_constant});
  }
  return placed_in_plane(points, d.misfit, d.centre, dimension);
}

}  // namespace

BodyRecord flake_record() {
  auto record = body_record<Description>(
      {parameter("lattice", &Description::lattice, dimension::none,
                 "one particle a cell, but two of a honeycomb (graphene)"),
       parameter("lattice_constant", &Description::lattice_constant, dimension::length,
                 "length of the lattice vectors; of a honeycomb sqrt(3) times that of a bond")
           .in(positive),
       parameter("shape", &Description::shape, dimension::none,
                 "which particles: those within, its border included. A square lattice takes no "
                 "hexagon and no triangle"),
       parameter("size", &Description::size, dimension::none,
                 "in lattice constants: the edge of a hexagon or triangle (whole numbers; n "
                 "hexagons of a honeycomb along an edge), of a square, both edges of a rectangle, "
                 "or the radius of a circle")
           .in(non_negative),
       parameter("misfit", &Description::misfit, dimension::none,
                 "angle by which the flake is turned, in rad, counter-clockwise; without it a "
                 "lattice vector is along x")
           .in(kWithinOneTurn)
           .by_default(0.0),
       parameter("centre", &Description::centre, dimension::length, "of the shape")});
  record.name = "flake";
  record.summary =
      "particles of a hexagonal, honeycomb or square lattice within a shape, in the x-y plane";
  record.equation = "x = centre + R(misfit) (i a1 + j a2 + basis) within the shape";
  record.source =
      "G. S. Verhoeven, M. Dienwiebel and J. W. M. Frenken, Phys. Rev. B 70 (2004) 165418, "
      "doi:10.1103/PhysRevB.70.165418";
  record.dimension = of_description<&dimension_of>;
  record.count = of_description<&count>;
  record.complaints = of_description<&complaints>;
  record.neighbours = of_description<&neighbours>;
  record.build = of_description<&build>;
  record.example = R"(# A flexible flake of 24 atoms, like coronene, whose first atom moves.
[parameters]
b = 0.142                            # length of a bond

[[body]]
type = "flake"
lattice = "honeycomb"
lattice_constant = "sqrt(3) * b"
shape = "hexagon"
size = 2
centre = [0.0, 0.0]
particle_mass = 1.0

[[force]]
type = "harmonic_bonds"
pairs = "neighbours"
stiffness = 10.0

[[force]]
type = "driving_spring"
stiffness = 1.0
velocity = [0.01, 0.0]
attach = { particle = 0 }

[run]
duration = 1.0
integrator = { type = "rk4", dt = 1e-2 }
)";
  return record;
}

}  // namespace tomlin
