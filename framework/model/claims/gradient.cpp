#include <algorithm>
#include <array>
#include <cmath>

#include "framework/model/claims/examination.hpp"

/// Forces against their energies, and second derivatives against forces.
namespace tomlin::claims {
namespace {

/// The longest difference in parts of the shortest length. Errors fall as (2 pi/50)^2 = 0.016 from
/// one order to the next.
constexpr double kLongestDifference = 0.02;
/// Central differences at h, h/2, h/4, h/8 leave an error of order h^8.
constexpr int kDifferences = 4;
/// The last two orders of the extrapolation differ by more than the last one is off.
constexpr double kTrust = 10.0;
/// An energy whose slope has not settled to this is not smooth enough to have one.
constexpr double kSettled = 1e-3;
/// In quadruple numbers, in parts of the shortest length: what two orders leave is below 1e-20 of
/// the slope even a millionth of a length apart, and so is what rounding to 1e-34 leaves.
constexpr double kTinyDifference = 1e-12;
/// How far paths lead: shifts in shortest lengths, and by how much everything grows.
constexpr double kPathLengths = 4.0;
constexpr double kDilation = 3.0;
/// Pieces of a path, and how often a piece is halved: to where only rounding is left.
constexpr int kPieces = 64;
constexpr int kDeepest = 40;
constexpr std::size_t kPaths = 3;
/// Variables that are looked at one by one to find where a slope is wrong.
constexpr std::size_t kMostSearched = 2000;

struct Slope {
  double best = 0.0;
  double unsettled = 0.0;
  double shortest = 0.0;  ///< difference
};

/// Slope at 0 by central differences, extrapolated to h = 0: row by row, each column an order of
/// h^2 better (Romberg).
template <class Function>
Slope slope_of(Function&& f, double longest) {
  std::array<std::array<double, kDifferences>, kDifferences> slope{};
  double h = longest;
  for (int row = 0; row < kDifferences; ++row, h *= 0.5) {
    slope[row][0] = (f(h) - f(-h)) / (2.0 * h);
    double gain = 4.0;
    for (int column = 1; column <= row; ++column, gain *= 4.0) {
      slope[row][column] =
          (gain * slope[row][column - 1] - slope[row - 1][column - 1]) / (gain - 1.0);
    }
  }
  const double best = slope[kDifferences - 1][kDifferences - 1];
  return {best, std::abs(best - slope[kDifferences - 1][kDifferences - 2]), 2.0 * h};
}

/// The same in quadruple numbers, to all digits of a double.
template <class Function>
double exact_slope(Function&& f, double length) {
  const Quad h = Quad(kTinyDifference) * Quad(length);
  const Quad near = (f(h) - f(-h)) / (Quad(2.0) * h);
  const Quad far = (f(h + h) - f(-(h + h))) / (Quad(4.0) * h);
  return static_cast<double>((Quad(4.0) * near - far) / Quad(3.0));
}

double work(const std::vector<double>& forces, const Direction& direction) {
  double sum = 0.0;
  for (std::size_t i = 0; i < forces.size(); ++i) sum += forces[i] * direction[i];
  return sum;
}

double effort(const std::vector<double>& forces, const Direction& direction) {
  double sum = 0.0;
  for (std::size_t i = 0; i < forces.size(); ++i) sum += std::abs(forces[i] * direction[i]);
  return sum;
}

/// Differences of the energy along a direction against the force.
void compare_by_differences(Examination& e, const State& state, const Direction& direction,
                            std::size_t variable) {
  const double longest = kLongestDifference * e.length();
  double rounding = 0.0;  // of an energy
  double most = 0.0;      // effort along the way
  e.put(state);
  for (const double h : {longest, -longest}) {
    e.put_moved(state, direction, h);
    const double* force = e.alone().forces(state.time);
    double size = 0.0;
    double sum = 0.0;
    for (std::size_t i = 0; i < e.count(); ++i) {
      const double f = std::abs(force[e.variable(i).at]);
      size += f * (std::abs(state.x[i]) + e.length() * e.variable(i).unit);
      sum += f * std::abs(direction[i]);
    }
    const double energy = std::abs(e.alone().energy(state.time));
    rounding = std::max(rounding, kRounding * (size + energy));
    most = std::max(most, sum);
  }
  const Slope slope = slope_of(
      [&](double h) {
        e.put_moved(state, direction, h);
        return e.alone().energy(state.time);
      },
      longest);
  const double floor = rounding / slope.shortest;
  const bool smooth = slope.unsettled <= kSettled * most + floor;
  const double force = work(e.forces(state), direction);
  e.note(force, -slope.best, most, smooth ? floor + kTrust * slope.unsettled : -1.0, state,
         variable);
}

/// The energy in quadruple numbers, differentiated, against the force in double ones.
bool compare_exactly(Examination& e, const State& state, const Direction& direction,
                     const std::vector<double>& forces, double sensitivity, std::size_t variable) {
  ForceTwin<Quad>& twin = *e.exact();
  e.put(state);
  e.put(state, twin);
  const double slope = exact_slope(
      [&](const Quad& h) {
        for (std::size_t i = 0; i < e.count(); ++i) {
          twin.position(e.variable(i).at) = Quad(state.x[i]) + h * Quad(direction[i]);
        }
        twin.evaluate(state.time);
        return twin.energy();
      },
      e.length());
  double length = 0.0;  // of the direction
  for (std::size_t i = 0; i < e.count(); ++i) {
    length += std::abs(direction[i]) / e.variable(i).unit;
  }
  const double size = effort(forces, direction);
  const double energy = std::abs(e.alone().energy(state.time));
  const double allowed = kRounding * (size + sensitivity * length) + kSmallest * length +
                         kExactRounding * energy / (kTinyDifference * e.length());
  const double force = work(forces, direction);
  e.note(force, -slope, size, allowed, state, variable);
  return std::abs(force + slope) <= allowed;
}

/// Second derivatives times a direction, along another: translations for bodies that move as one.
class Curvature : public HessianSink {
 public:
  Curvature(const Examination& e, const Direction& one, const Direction& other, const Model& model)
      : model_(model), one_(by_coordinate(e, one)), other_(by_coordinate(e, other)) {}

  void site(std::size_t body, std::size_t particle, int a, int b, double value) override {
    add(value * of(one_, body, particle, a), of(other_, body, particle, b));
  }
  void pair(std::size_t body1, std::size_t i, std::size_t body2, std::size_t j, int a, int b,
            double value) override {
    add(value * (of(one_, body2, j, a) - of(one_, body1, i, a)),
        of(other_, body2, j, b) - of(other_, body1, i, b));
  }
  void centre(std::size_t body, const double* weight, int a, int b, double value) override {
    double one = 0.0;
    double other = 0.0;
    for (std::size_t i = 0; i < model_.bodies()[body].bound.slot.count; ++i) {
      one += weight[i] * of(one_, body, i, a);
      other += weight[i] * of(other_, body, i, b);
    }
    add(value * one, other);
  }

  double sum = 0.0;
  double size = 0.0;
  bool given = false;

 private:
  std::vector<double> by_coordinate(const Examination& e, const Direction& direction) const {
    std::vector<double> moves(model_.system().view.dofs, 0.0);
    for (std::size_t i = 0; i < e.count(); ++i) moves[e.variable(i).at] = direction[i];
    return moves;
  }
  double of(const std::vector<double>& moves, std::size_t body, std::size_t particle,
            int axis) const {
    const BodySlot<double>& slot = model_.bodies()[body].bound.slot;
    if (slot.rigid) return moves[slot.centre + axis];
    return slot.mapped ? 0.0 : moves[slot.offset + axis * slot.stride + particle];
  }
  void add(double left, double right) {
    given = true;
    sum += left * right;
    size += std::abs(left * right);
  }

  const Model& model_;
  std::vector<double> one_, other_;
};

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

Path path_of(const Examination& e, const State& from, Random& random) {
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
Piece piece_of(Examination& e, const Path& path, double from, double to) {
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

Comparison compare_piece(Examination& e, const Path& path, double from, double to) {
  const auto energy_at = [&](double part) {
    const State state = path.at(part);
    e.put(state);
    return e.alone().energy(state.time);
  };
  const Piece piece = piece_of(e, path, from, to);
  const double before = energy_at(from);
  const double after = energy_at(to);
  const State end = path.at(to);
  const double size =
      piece.size + effort(e.forces(end), path.way) + std::abs(before) + std::abs(after);
  const double sensitive = e.sensitivity(end) * e.length() * static_cast<double>(e.count());
  return {after - before, piece.work, size, kRounding * (size + sensitive) + piece.variation};
}

/// A piece that does not come right is looked at more closely, in the worse of its halves: what is
/// merely narrow comes right in the end, a jump does not.
void compare_along(Examination& e, const Path& path, double from, double to) {
  Comparison now = compare_piece(e, path, from, to);
  for (int halving = 0; halving < kDeepest && !now.holds(); ++halving) {
    const double middle = 0.5 * (from + to);
    const Comparison first = compare_piece(e, path, from, middle);
    const Comparison second = compare_piece(e, path, middle, to);
    const bool in_first = first.difference() > second.difference();
    (in_first ? to : from) = middle;
    now = in_first ? first : second;
  }
  e.note(-now.gained, now.work, now.size, now.allowed, path.at(to));
}

Direction translation(const Examination& e, Random& random) {
  Direction direction = e.random_direction(random);
  for (std::size_t i = 0; i < e.count(); ++i) {
    if (e.variable(i).axis < 0) direction[i] = 0.0;
  }
  return direction;
}

}  // namespace

/// All coordinates at once, where a fault of any part shows, and one alone, where it shows best.
std::optional<ClaimResult> conservative(Examination& e) {
  if (!e.traits().conservative) return std::nullopt;
  e.begin("conservative", "force = -gradient of its energy, by differences");
  Random random(e.seed());
  for (const State& state : e.near()) {
    compare_by_differences(e, state, e.random_direction(random), kNone);
    const std::size_t chosen = random.below(e.count());
    compare_by_differences(e, state, e.along(chosen), chosen);
    e.looked();
  }
  return e.end();
}

std::optional<ClaimResult> exact(Examination& e) {
  if (!e.traits().conservative || e.exact() == nullptr) return std::nullopt;
  e.begin("exact", "force = -gradient of its energy, differentiated in quadruple numbers");
  Random random(e.seed());
  bool searched = false;
  for (const State* state : e.everywhere()) {
    const std::vector<double> forces = e.forces(*state);
    const double sensitivity = e.sensitivity(*state);
    const bool numbers = std::isfinite(e.largest(forces)) && std::isfinite(sensitivity);
    e.looked();
    if (!numbers && state->place != Place::near && state->place != Place::start) continue;
    const bool together =
        compare_exactly(e, *state, e.random_direction(random), forces, sensitivity, kNone);
    const std::size_t chosen = random.below(e.count());
    compare_exactly(e, *state, e.along(chosen), forces, sensitivity, chosen);
    if (together || searched) continue;
    searched = true;
    for (std::size_t i = 0; i < std::min(e.count(), kMostSearched); ++i) {
      compare_exactly(e, *state, e.along(i), forces, sensitivity, i);
    }
  }
  return e.end();
}

/// An energy that jumps at a cut-off has the right slope on both sides of it.
std::optional<ClaimResult> path(Examination& e) {
  if (!e.traits().conservative) return std::nullopt;
  e.begin("path", "work along a path of some lengths = minus the change of energy");
  Random random(e.seed());
  const int pieces = e.takes_long() ? kPieces / 8 : kPieces;
  for (std::size_t k = 0; k < kPaths; ++k) {
    const Path path = path_of(e, e.near()[k % e.near().size()], random);
    const double width = 1.0 / pieces;
    for (int piece = 0; piece < pieces && e.holds(); ++piece) {
      compare_along(e, path, piece * width, (piece + 1) * width);
    }
    e.looked();
  }
  return e.end();
}

std::optional<ClaimResult> hessian(Examination& e) {
  if (!e.traits().conservative) return std::nullopt;
  e.begin("hessian", "second derivatives = slopes of the force");
  Random random(e.seed());
  const auto twin = e.twin();
  for (const State& state : e.near()) {
    const Direction along = translation(e, random);
    const Direction seen = translation(e, random);
    const double longest = kLongestDifference * e.length();
    double most = 0.0;
    const Slope slope = slope_of(
        [&](double h) {
          State moved = state;
          for (std::size_t i = 0; i < e.count(); ++i) moved.x[i] += h * along[i];
          const std::vector<double> forces = e.forces(moved);
          most = std::max(most, effort(forces, seen));
          return work(forces, seen);
        },
        longest);
    e.put(state, *twin);
    twin->evaluate(state.time);
    Curvature curvature(e, seen, along, e.alone().model());
    twin->bound().hessian(twin->stage(), curvature);
    if (!curvature.given) return std::nullopt;
    const double rounding =
        kRounding * (most + e.sensitivity(state) * static_cast<double>(e.count())) / slope.shortest;
    const double size = curvature.size + std::abs(slope.best);
    const bool smooth = slope.unsettled <= kSettled * size + rounding;
    e.note(curvature.sum, -slope.best, size,
           smooth ? kRounding * size + rounding + kTrust * slope.unsettled : -1.0, state);
    e.looked();
  }
  return e.end();
}

/// Near the start there must be numbers. Far away, too, unless they are too large to be written; a
/// NaN there must be a NaN in quadruple numbers as well (the logarithm of a negative number). Where
/// particles touch no number is as good as one, since a run stops there, but not where quadruple
/// numbers say that there is one.
std::optional<ClaimResult> finite(Examination& e) {
  e.begin("finite", "forces and energies are numbers, near, far, high and touching");
  for (const State* state : e.everywhere()) {
    const std::vector<double> forces = e.forces(*state);
    const double energy = e.alone().energy(state->time);
    e.looked();
    std::size_t lost = kNone;
    for (std::size_t i = e.count(); i-- > 0;) {
      if (!std::isfinite(forces[i])) lost = i;
    }
    if (lost == kNone && std::isfinite(energy)) {
      e.note(0.0, 0.0, 0.0, 0.0, *state);
      continue;
    }
    const double found = lost == kNone ? energy : forces[lost];
    const bool close = state->place == Place::near || state->place == Place::start;
    double due = 0.0;  // what it says where it can be told
    bool broken =
        close || (std::isnan(found) && state->place != Place::contact) ||
        (lost != kNone && std::isnan(found) && std::isfinite(energy) && e.traits().conservative);
    if (ForceTwin<Quad>* twin = e.exact(); !close && twin != nullptr) {
      e.put(*state, *twin);
      twin->evaluate(state->time);
      due =
          static_cast<double>(lost == kNone ? twin->energy() : twin->force_at(e.variable(lost).at));
      constexpr double kNearOverflow = 1e150;  // squares of it are too large
      broken = std::abs(due) < kNearOverflow;
    }
    if (broken) {
      e.note(found, due, std::abs(due), -1.0, *state, lost);
    } else {
      e.note(0.0, 0.0, 0.0, 0.0, *state);
    }
  }
  return e.end();
}

}  // namespace tomlin::claims
