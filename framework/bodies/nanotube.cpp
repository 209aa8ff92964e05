#include "framework/bodies/nanotube.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "framework/bodies/outline.hpp"
#include "framework/bodies/whole_cells.hpp"
#include "framework/core/numbers/math.hpp"

namespace tomlin {
namespace {

using Description = NanotubeDescription;

constexpr double kLargestIndex = 1e6;  // of a chirality: its squares have to be exact

/// The quotient of whole numbers, rounded down; the divisor is positive.
std::int64_t floor_of(std::int64_t n, std::int64_t by) { return n / by - (n % by < 0 ? 1 : 0); }
/// The remainder of that division, never negative.
std::int64_t rest_of(std::int64_t n, std::int64_t by) { return n - floor_of(n, by) * by; }

bool is_tube(const WordOrNumbers& chirality) {
  if (chirality.numbers.size() != 2) return false;
  const double n = chirality.numbers[0];
  const double m = chirality.numbers[1];
  return n == __builtin_floor(n) && m == __builtin_floor(m) && m >= 0.0 && n >= m && n > 0.0;
}

/// Whole numbers that follow from a chirality alone.
struct Chirality {
  explicit Chirality(const Description& d)
      : n(static_cast<std::int64_t>(d.chirality.numbers[0])),
        m(static_cast<std::int64_t>(d.chirality.numbers[1])),
        square(n * n + n * m + m * m),
        divisor(std::gcd(2 * n + m, 2 * m + n)),
        symmetry(std::gcd(n, m)) {}

  std::int64_t particles() const { return 4 * square / divisor; }  ///< of a cell

  std::int64_t n;
  std::int64_t m;
  std::int64_t square;    ///< L, of C in lattice constants
  std::int64_t divisor;   ///< D
  std::int64_t symmetry;  ///< a turn by 2 pi over this changes nothing
};

double radius_of(const Description& d) {
  return d.bond_length * (sqrt(3.0 * static_cast<double>(Chirality(d).square)) / kTau);
}

double cell_length(const Description& d) {
  const Chirality tube(d);
  return 3.0 * sqrt(static_cast<double>(tube.square)) / static_cast<double>(tube.divisor) *
         d.bond_length;
}

std::int64_t cells_of(const Description& d) {
  return d.cells > 0 ? d.cells : whole_cells(d.length, cell_length(d));
}

double length_of(const Description& d) { return static_cast<double>(cells_of(d)) * cell_length(d); }

int dimension_of(const Description&) { return 3; }

std::int64_t count(const Description& d) {
  if (!is_tube(d.chirality)) return 1;  // which complaints() reports
  if (d.cells == 0 && !(d.length > 0.0)) return 1;
  return particles_in(Chirality(d).particles(), cells_of(d), 1);
}

std::vector<Complaint> complaints(const Description& d, int dimension) {
  std::vector<Complaint> found = complaints_without_space("a nanotube", d.centre, dimension);
  for (Complaint& one : complaints_unless_one("cells", d.cells > 0, "length", d.length > 0.0)) {
    found.push_back(std::move(one));
  }
  if (!is_tube(d.chirality)) {
    found.push_back({.key = "chirality",
                     .why = "there is no such nanotube",
                     .admissible = "[n, m], whole numbers with n >= m >= 0 and n > 0",
                     .code = FaultCode::component_invalid});
  }
  return found;
}

/// A particle of a cell in whole numbers: its angle is 2 pi angle/(2L), and its height that of
/// height * b/(2 sqrt(L)).
struct TubeSite {
  std::int64_t height = 0;
  std::int64_t angle = 0;
  std::int64_t slab = 0;
  bool is_second = false;  ///< of the two particles of a lattice point
};

/// One cell of a tube, in whole numbers.
class TubeCell {
 public:
  explicit TubeCell(const Chirality& tube)
      : tube_(tube),
        turn_(2 * tube.square),
        level_(3 * tube.symmetry),
        height_(6 * tube.square / tube.divisor) {
    // The length of a cell in units of 3 b, to the nearest whole number.
    const double length =
        sqrt(static_cast<double>(tube.square)) / static_cast<double>(tube.divisor);
    slabs_ = std::max<std::int64_t>(1, (static_cast<std::int64_t>(2.0 * length) + 1) / 2);
    const std::int64_t apart = tube.n - tube.m;
    // Particles of the second kind are at these heights, too, but for their own distance, which is
    // taken between those of the first kind so that the longer gap is between cells.
    second_ = rest_of(apart, level_);
    if (second_ == 2 * tube.symmetry) second_ -= level_;
    const std::int64_t shift = (second_ - apart) / level_;
    const std::int64_t step = angle_of_level();
    for (std::int64_t k = 0; k < height_ / level_; ++k) {
      for (std::int64_t ring = 0; ring < tube.symmetry; ++ring) {
        const std::int64_t of_ring = ring * (turn_ / tube.symmetry);
        add(level_ * k, k * step + of_ring, false);
        add(level_ * k + second_, (k + shift) * step + of_ring + tube.n + tube.m, true);
      }
    }
    std::sort(sites_.begin(), sites_.end(), [](const TubeSite& one, const TubeSite& other) {
      return std::array{one.slab, one.angle, one.height} <
             std::array{other.slab, other.angle, other.height};
    });
  }

  const std::vector<TubeSite>& sites() const { return sites_; }
  std::int64_t turn() const { return turn_; }
  std::int64_t height() const { return height_; }
  /// Height of the particles of the second kind less that of the first.
  std::int64_t second() const { return second_; }
  /// Twice the mean height of the particles of so many cells.
  std::int64_t twice_middle(std::int64_t cells) const { return height_ * cells - level_ + second_; }

  /// The three nearest neighbours of a particle of the first kind, which are of the second; their
  /// heights may be those of other cells.
  std::array<TubeSite, 3> neighbours(const TubeSite& site) const {
    const std::int64_t n = tube_.n;
    const std::int64_t m = tube_.m;
    const auto at = [&](std::int64_t up, std::int64_t around) {
      return TubeSite{site.height + up, rest_of(site.angle + around, turn_)};
    };
    return {at(n - m, n + m), at(n + 2 * m, -n), at(-2 * n - m, -m)};
  }

 private:
  /// Angle from a lattice point to one whose height above it is the least.
  std::int64_t angle_of_level() const {
    // n j - m i = symmetry, by Euclid's algorithm.
    std::array<std::int64_t, 2> rest = {tube_.n, tube_.m};
    std::array<std::int64_t, 2> times = {1, 0};  // of n
    while (rest[1] != 0) {
      const std::int64_t quotient = rest[0] / rest[1];
      rest = {rest[1], rest[0] - quotient * rest[1]};
      times = {times[1], times[0] - quotient * times[1]};
    }
    const std::int64_t j = times[0];
    const std::int64_t i = tube_.m == 0 ? 0 : (tube_.n * j - tube_.symmetry) / tube_.m;
    return rest_of(i * (2 * tube_.n + tube_.m) + j * (2 * tube_.m + tube_.n), turn_);
  }

  void add(std::int64_t height, std::int64_t angle, bool is_second) {
    const std::int64_t above = height - std::min<std::int64_t>(second_, 0);
    sites_.push_back({height, rest_of(angle, turn_), above * slabs_ / height_, is_second});
  }

  Chirality tube_;
  std::int64_t turn_;        ///< angle of a whole turn
  std::int64_t level_;       ///< height from one level of particles of a kind to the next
  std::int64_t height_;      ///< of a cell
  std::int64_t slabs_ = 1;   ///< of a cell
  std::int64_t second_ = 0;  ///< height of the particles of the second kind above the first
  std::vector<TubeSite> sites_;
};

std::vector<IndexPair> neighbours(const Description& d, const std::array<double, 3>& box) {
  const TubeCell cell{Chirality(d)};
  const auto per_cell = static_cast<std::int64_t>(cell.sites().size());
  const std::int64_t cells = cells_of(d);
  const bool closed = fills_box(length_of(d), box[static_cast<std::size_t>(d.axis)]);
  std::map<std::array<std::int64_t, 2>, std::int64_t> indices;  // by height and angle
  for (const TubeSite& site : cell.sites()) {
    const auto index = static_cast<std::int64_t>(indices.size());
    indices.emplace(std::array{site.height, site.angle}, index);
  }
  std::vector<IndexPair> pairs;
  for (std::int64_t k = 0; k < per_cell; ++k) {
    const TubeSite& site = cell.sites()[static_cast<std::size_t>(k)];
    if (site.is_second) continue;
    for (const TubeSite& near : cell.neighbours(site)) {
      const std::int64_t cells_on = floor_of(near.height - cell.second(), cell.height());
      const std::int64_t other = indices.at({near.height - cells_on * cell.height(), near.angle});
      for (std::int64_t c = 0; c < cells; ++c) {
        const std::int64_t there = c + cells_on;
        if (!closed && (there < 0 || there >= cells)) continue;
        pairs.push_back({c * per_cell + k, rest_of(there, cells) * per_cell + other});
      }
    }
  }
  return each_pair_once(std::move(pairs));
}

std::string note(const Description& d) {
  return fmt::format(
      "radius {:.6g}; {} cells of {:.6g} with {} particles each; a periodic box repeats it with "
      "the "
      "length {:.12g} along {}",
      radius_of(d), cells_of(d), cell_length(d), Chirality(d).particles(), length_of(d),
      to_string(d.axis));
}

BodyGeometry build(const Description& d, int) {
  const Chirality tube(d);
  const TubeCell cell(tube);
  const std::int64_t cells = cells_of(d);
  const double radius = radius_of(d);
  const double per_height = 4.0 * sqrt(static_cast<double>(tube.square));
  double roll_sine = 0.0;
  double roll_cosine = 1.0;
  sincos_turns(d.roll / kTau, roll_sine, roll_cosine);
  const auto axis = static_cast<std::size_t>(d.axis);
  BodyGeometry geometry;
  geometry.anchor = centre_or_origin(d.centre);
  geometry.rolling_radius = radius;
  geometry.rolling_axis = static_cast<int>(d.axis);
  geometry.relative.reserve(static_cast<std::size_t>(count(d)));
  for (std::int64_t c = 0; c < cells; ++c) {
    for (const TubeSite& site : cell.sites()) {
      double sine = 0.0;
      double cosine = 1.0;
      sincos_turns(static_cast<double>(site.angle) / static_cast<double>(cell.turn()), sine,
                   cosine);
      const std::int64_t twice_height =
          2 * (site.height + c * cell.height()) - cell.twice_middle(cells);
      std::vector<double> x(3, 0.0);
      x[axis] = static_cast<double>(twice_height) / per_height * d.bond_length;
      x[(axis + 1) % 3] = radius * fma(roll_cosine, cosine, -(roll_sine * sine));
      x[(axis + 2) % 3] = radius * fma(roll_sine, cosine, roll_cosine * sine);
      geometry.relative.push_back(std::move(x));
    }
  }
  return geometry;
}

}  // namespace

BodyRecord nanotube_record() {
  constexpr Interval kIndices{
      .low = 0.0, .high = kLargestIndex, .low_open = false, .high_open = false};
  auto record = body_record<Description>(
      {parameter(
           "chirality", &Description::chirality, dimension::none,
           "[n, m], whole numbers with n >= m >= 0: [n, 0] is a zigzag tube, [n, n] an armchair "
           "tube")
           .in(kIndices),
       parameter("bond_length", &Description::bond_length, dimension::length,
                 "b, of the sheet that is rolled up: 1.42 Angstrom in carbon")
           .in(positive),
       parameter("cells", &Description::cells, dimension::none,
                 "number of cells along the axis, each as long as the lattice takes to repeat")
           .in(positive)
           .or_absent(),
       parameter("length", &Description::length, dimension::length,
                 "in place of cells: a length that as many cells fill as fit")
           .in(positive)
           .or_absent(),
       parameter("axis", &Description::axis, dimension::none,
                 "along which the tube lies: x by default, as the armchair direction of graphene, "
                 "along which the bonds of a zigzag tube are")
           .by_default(Axis::x),
       parameter(
           "roll", &Description::roll, dimension::none,
           "angle by which the tube is turned at the start, in rad, counter-clockwise about its "
           "axis; without it a particle is in the direction of the next axis, x after z")
           .in(kWithinOneTurn)
           .by_default(0.0),
       parameter("centre", &Description::centre, dimension::length,
                 "mean of the particles; the origin by default")
           .or_absent()});
  record.name = "nanotube";
  record.summary =
      "a single-walled carbon nanotube of any chirality in space, of whole cells, for a periodic "
      "box "
      "or with ends";
  record.equation =
      "R = sqrt(3 L) b/(2 pi), cell T = 3 sqrt(L) b/D with 4 L/D particles, L = n^2 + n m + m^2, D "
      "= "
      "gcd(2n + m, 2m + n); angle 2 pi (i (2n + m) + j (2m + n))/(2L) and height (n j - m i) T "
      "D/(2L) "
      "of each lattice point i a1 + j a2, and of a second particle at (a1 + a2)/3 from it; box "
      "length "
      "that continues it: cells * T";
  record.source =
      "R. Saito, G. Dresselhaus and M. S. Dresselhaus, Physical Properties of Carbon Nanotubes "
      "(Imperial College Press, 1998), doi:10.1142/p080, chapter 3";
  record.dimension = of_description<&dimension_of>;
  record.count = of_description<&count>;
  record.complaints = of_description<&complaints>;
  record.neighbours = of_description<&neighbours>;
  record.note = of_description<&note>;
  record.build = of_description<&build>;
  record.example = R"(# A zigzag tube of springs, pulled across its axis.
[[body]]
type = "nanotube"
chirality = [10, 0]
bond_length = 1.42
length = 10.0
species = "C"
particle_mass = 12.011

[[force]]
type = "harmonic_bonds"
pairs = "neighbours"
stiffness = 30.0

[[force]]
type = "driving_spring"
stiffness = 1.0
velocity = [0.0, 0.1, 0.0]

[run]
duration = 1.0
integrator = { type = "rk4", dt = 1e-2 }
)";
  return record;
}

}  // namespace tomlin
