#include <algorithm>
#include <cmath>

#include "framework/model/properties/slopes.hpp"

/// Energies against forces along paths, where an energy may jump.
namespace tomlin::properties {
namespace {

/// How far paths lead: shifts in shortest lengths, and by how much everything grows.
constexpr double kPathLengths = 4.0;
constexpr double kDilation = 3.0;
/// Pieces of a path, and how often a piece is halved: to where only rounding is left.
constexpr int kPieces = 64;
constexpr int kMostHalvings = 40;

/// From a state to where everything is dilated about its centre and shifted.
struct Path {
  State from;
  Direction way;

  State at(double part) const {
    State state = from;
    for (std::size_t i = 0; i < way.size(); ++i) state.x[i] += part * way[i];
    return state;
  }
};

Path path_of(const ForceUnderTest& e, const State& from, Random& random) {
  Path path{from, Direction(e.count(), 0.0)};
  for (int axis = 0; axis < 3; ++axis) {
    double centre = 0.0;
    double n = 0.0;
    for (std::size_t i = 0; i < e.count(); ++i) {
      if (e.variable(i).axis != axis) continue;
      centre += from.x[i];
      n += 1.0;
    }
    if (n == 0.0) continue;
    const double shift = kPathLengths * e.length() * random.symmetric();
    for (std::size_t i = 0; i < e.count(); ++i) {
      if (e.variable(i).axis != axis) continue;
      path.way[i] = kDilation * (from.x[i] - centre / n) + shift;
    }
  }
  return path;
}

/// Work of the force on a piece of a path, by Gauss's rule of five points, and what it can be off
/// by: where the force jumps, too, it stays between the smallest and the largest seen.
struct Piece {
  double work = 0.0;
  double variation = 0.0;
  double size = 0.0;
};
Piece piece_of(ForceUnderTest& e, const Path& path, double from, double to) {
  constexpr double kPoint[] = {0.0, 0.538469310105683091, 0.906179845938663993, 1.0};
  constexpr double kWeight[] = {0.568888888888888889, 0.478628670499366468, 0.236926885056189088,
                                0.0};
  const double half = 0.5 * (to - from);
  double least = 0.0;
  double most = 0.0;
  Piece piece;
  for (int k = -3; k <= 3; ++k) {
    const auto at = static_cast<std::size_t>(std::abs(k));
    const double offset = k < 0 ? -kPoint[at] : kPoint[at];
    const std::vector<double> forces = e.forces(path.at(from + half + half * offset));
    const double power = work(forces, path.way);
    piece.work += half * kWeight[at] * power;
    piece.size += half * kWeight[at] * effort(forces, path.way);
    least = k == -3 ? power : std::min(least, power);
    most = k == -3 ? power : std::max(most, power);
  }
  piece.variation = (most - least) * (to - from);
  return piece;
}

/// A piece against the change of its energy.
struct Comparison {
  double gained = 0.0;
  double work = 0.0;
  double size = 0.0;
  double allowed = 0.0;

  double difference() const { return std::abs(gained + work); }
  bool holds() const { return difference() <= allowed; }
};

Comparison compare_piece(ForceUnderTest& e, const Path& path, double from, double to) {
  const auto energy_at = [&](double part) {
    const State state = path.at(part);
    e.put(state);
    return e.alone().energy(state.time);
  };
  const Piece piece = piece_of(e, path, from, to);
  const double before = energy_at(from);
  const double after = energy_at(to);
  const double size =
      piece.size + effort(e.forces(path.at(to)), path.way) + std::abs(before) + std::abs(after);
  const double least = kSmallest * (1.0 + e.length() * static_cast<double>(e.count()));
  return {after - before, piece.work, size, kRounding * size + piece.variation + least};
}

/// A piece that does not come right is looked at more closely, in the worse of its halves: what is
/// merely narrow comes right in the end, a jump does not.
/// False where that is beyond where the force is defined, and there is nothing to compare.
bool compare_along(ForceUnderTest& e, const Path& path, double from, double to) {
  Comparison now = compare_piece(e, path, from, to);
  for (int halving = 0; halving < kMostHalvings && !now.holds(); ++halving) {
    const double middle = 0.5 * (from + to);
    const Comparison first = compare_piece(e, path, from, middle);
    const Comparison second = compare_piece(e, path, middle, to);
    const bool in_first = first.difference() > second.difference();
    (in_first ? to : from) = middle;
    now = in_first ? first : second;
  }
  // The rest may be the rounding of what the force reads. It is looked for last: that takes
  // long, in quadruple precision.
  if (!now.holds()) {
    const double way = e.length() * static_cast<double>(e.count());
    now.allowed += kRounding * e.sensitivity(path.at(to)) * way;
  }
  // `finite` says whether it may be so.
  if (!std::isfinite(now.gained) || !std::isfinite(now.work)) return false;
  e.note(-now.gained, now.work, now.size, now.allowed, path.at(to));
  return true;
}

}  // namespace

/// An energy that jumps at a cut-off has the right slope on both sides of it.
bool path(ForceUnderTest& e, const State& state) {
  const int pieces = e.takes_long() ? kPieces / 8 : kPieces;
  const Path path = path_of(e, state, e.memory().random);
  const double width = 1.0 / pieces;
  bool compared = false;
  for (int piece = 0; piece < pieces && e.holds(); ++piece) {
    compared = compare_along(e, path, piece * width, (piece + 1) * width) || compared;
  }
  return compared;
}

}  // namespace tomlin::properties
