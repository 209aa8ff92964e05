#include "forcefields/sheet_field_table.hpp"

#include <algorithm>
#include <cmath>

#include "forcefields/sheet_field.hpp"
#include "framework/core/numbers/constants.hpp"
#include "framework/core/numbers/math.hpp"

namespace tomlin {
namespace {

/// Lengths of reciprocal vectors that differ by less than this part are equal.
constexpr double kSameLength = 1e-6;
/// Weights, of order 1, that differ by less are equal.
constexpr double kSameWeight = 1e-9;
constexpr std::size_t kMostStars = 64;
/// Points of a cell along a lattice vector at which sums over atoms are taken: harmonics up to
/// kMostOrder are distinct from their aliases, which begin at kCellPoints - kMostOrder.
constexpr int kCellPoints = 32;
/// In sigma, over which a star fades out.
constexpr double kFade = 0.3;
/// By how much of an interval a star is looked at beyond its reach: rounding is far less.
constexpr double kBeyondReach = 1e-3;
/// In heights of the well, where repulsion is as strong as the largest attraction or so.
constexpr double kDeepest = 0.9;

struct SheetStar {
  double square = 0.0;  ///< of |G|
  double weight = 0.0;
  std::vector<std::array<int, 2>> terms;  ///< m, n
  int order = 0;
};

/// By |G|, complete up to the longest, without those that are extinct.
std::vector<SheetStar> stars_of(const SheetLattice& lattice) {
  constexpr int kMost = SheetTable::kMostOrder;
  const SheetPoint b1 = lattice.reciprocal(0);
  const SheetPoint b2 = lattice.reciprocal(1);
  struct SheetWave {
    double square;
    int m;
    int n;
  };
  std::vector<SheetWave> waves;
  double complete = HUGE_VAL;
  for (int m = 0; m <= kMost + 1; ++m) {
    for (int n = -kMost - 1; n <= kMost + 1; ++n) {
      if (m == 0 && n <= 0) continue;
      const double x = m * b1[0] + n * b2[0];
      const double y = m * b1[1] + n * b2[1];
      const double square = x * x + y * y;
      if (m > kMost || std::abs(n) > kMost) {
        complete = std::min(complete, square);
      } else {
        waves.push_back({square, m, n});
      }
    }
  }
  std::stable_sort(waves.begin(), waves.end(),
                   [](const SheetWave& a, const SheetWave& b) { return a.square < b.square; });
  std::vector<SheetStar> stars;
  for (const SheetWave& wave : waves) {
    if (wave.square >= complete * (1.0 - kSameLength)) break;
    double weight = 0.0;
    for (const SheetPoint& u : lattice.atoms) {
      weight += 2.0 * cos_turns(wave.m * u[0] + wave.n * u[1]);
    }
    if (std::abs(weight) < kSameWeight) continue;  // extinct
    const auto same = [&](const SheetStar& star) {
      return wave.square <= star.square * (1.0 + kSameLength) &&
             std::abs(weight - star.weight) < kSameWeight;
    };
    auto star = std::find_if(stars.begin(), stars.end(), same);
    if (star == stars.end()) {
      star = stars.insert(star, {.square = wave.square, .weight = weight, .terms = {}});
    }
    star->terms.push_back({wave.m, wave.n});
    star->order = std::max({star->order, wave.m, std::abs(wave.n)});
  }
  if (stars.size() > kMostStars) stars.resize(kMostStars);
  return stars;
}

/// Value, slope and curvature along z.
using HeightJet = std::array<double, 3>;

/// Adds a pair whose squared distance is u, at the height z.
void add_pair(const SheetLaw& law, double u, double z, HeightJet& sum) {
  const double inverse = 1.0 / u;
  const double part = law.sigma_squared * inverse;
  const double cube = part * part * part;
  const double r = std::sqrt(u);
  const double over_r = r * inverse;
  const double value =
      law.four_epsilon * cube * (cube - 1.0) - law.at_cutoff - (r - law.cutoff) * law.slope;
  const double by_u =
      law.four_epsilon * inverse * cube * (3.0 - 6.0 * cube) - 0.5 * law.slope * over_r;
  const double by_uu = law.four_epsilon * inverse * inverse * cube * (42.0 * cube - 12.0) +
                       0.25 * law.slope * over_r * inverse;
  sum[0] += value;
  sum[1] += 2.0 * z * by_u;
  sum[2] += 2.0 * by_u + 4.0 * z * z * by_uu;
}

/// f_s and its first two derivatives, by sums over one sublattice at the points of a cell.
class SheetCoefficients {
 public:
  SheetCoefficients(const SheetLattice& lattice, const SheetLaw& law,
                    const std::vector<SheetStar>& stars)
      : law_(law) {
    const auto& [a1, a2] = lattice.vectors;
    std::array<double, kCellPoints> cosines{};
    for (int k = 0; k < kCellPoints; ++k) cosines[k] = cos_turns(double(k) / kCellPoints);
    for (int i = 0; i < kCellPoints; ++i) {
      for (int j = 0; j < kCellPoints; ++j) {
        // The sublattice is symmetric about its atoms: of (i, j) and (-i, -j) one is enough.
        const int opposite_i = (kCellPoints - i) % kCellPoints;
        const int opposite_j = (kCellPoints - j) % kCellPoints;
        if (std::pair(opposite_i, opposite_j) < std::pair(i, j)) continue;
        const bool alone = opposite_i == i && opposite_j == j;
        const double u = double(i) / kCellPoints;
        const double v = double(j) / kCellPoints;
        place(lattice, {u * a1[0] + v * a2[0], u * a1[1] + v * a2[1]});
        const double share = (alone ? 1.0 : 2.0) / (kCellPoints * kCellPoints);
        for (const SheetStar& star : stars) {
          const auto [m, n] = star.terms.front();
          const int turn = (m * i + n * j) % kCellPoints;
          weights_.push_back(share * cosines[(turn + kCellPoints) % kCellPoints]);
        }
      }
    }
  }

  std::vector<HeightJet> at(double z, std::size_t stars) const {
    std::vector<HeightJet> all(stars);
    for (std::size_t k = 0; k + 1 < first_.size(); ++k) {
      HeightJet sum{};
      for (std::size_t l = first_[k]; l < first_[k + 1]; ++l) {
        const double u = squares_[l] + z * z;
        if (u < law_.cutoff * law_.cutoff) add_pair(law_, u, z, sum);
      }
      for (std::size_t s = 0; s < stars; ++s) {
        for (std::size_t d = 0; d < 3; ++d) all[s][d] += weights_[k * stars + s] * sum[d];
      }
    }
    return all;
  }

 private:
  /// Squared distances of the sublattice's atoms in the plane.
  void place(const SheetLattice& lattice, const SheetPoint& from) {
    const auto& [a1, a2] = lattice.vectors;
    const double most = law_.cutoff * law_.cutoff;
    // Coordinates in lattice vectors are at most |b_j| times a length.
    std::array<int, 2> reach{};
    for (std::size_t j = 0; j < 2; ++j) {
      const SheetPoint b = lattice.reciprocal(j);
      reach[j] = static_cast<int>(law_.cutoff * std::sqrt(b[0] * b[0] + b[1] * b[1])) + 2;
    }
    if (first_.empty()) first_.push_back(0);
    for (int m = -reach[0]; m <= reach[0]; ++m) {
      for (int n = -reach[1]; n <= reach[1]; ++n) {
        const double x = m * a1[0] + n * a2[0] - from[0];
        const double y = m * a1[1] + n * a2[1] - from[1];
        if (x * x + y * y < most) squares_.push_back(x * x + y * y);
      }
    }
    first_.push_back(squares_.size());
  }

  SheetLaw law_;
  std::vector<std::size_t> first_;  ///< [point] of its squares
  std::vector<double> squares_;
  std::vector<double> weights_;  ///< [point][star]
};

/// Energy and force of V_0.
std::array<double, 2> mean_at(const SheetTable& table, double z) {
  const SheetLaw& law = table.law;
  const double sheet = kTau * table.density;
  const auto pairs = [&](double q) {
    return law.four_epsilon * law.sigma_squared * q * q * (0.1 * q * q * q - 0.25);
  };
  const double squared = law.cutoff * law.cutoff;
  const double linear = law.cutoff * law.slope - law.at_cutoff;
  const double energy = pairs(law.sigma_squared / (z * z)) - pairs(law.sigma_squared / squared) +
                        0.5 * linear * (squared - z * z) -
                        law.slope * (squared * law.cutoff - z * z * z) / 3.0;
  const double part = law.sigma_squared / (z * z);
  const double cube = part * part * part;
  const double pair =
      law.four_epsilon * cube * (cube - 1.0) - law.at_cutoff - (z - law.cutoff) * law.slope;
  return {sheet * energy, sheet * z * pair};
}

/// Finds the height and the depth of the well of V_0 and its largest attraction.
void describe_mean(SheetTable& table) {
  constexpr int kSteps = 1000;
  const double step = (table.law.cutoff - table.nearest) / kSteps;
  table.equilibrium = table.nearest;
  for (int k = 0; k < kSteps; ++k) {
    const double z = table.nearest + k * step;
    const auto [energy, force] = mean_at(table, z);
    if (-energy > table.depth) table.equilibrium = z;
    table.depth = std::max(table.depth, -energy);
    table.pull = std::max(table.pull, -force);
  }
  // The force, repulsive before the well, passes zero.
  double low = table.equilibrium - step;
  double high = table.equilibrium + step;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (mean_at(table, middle)[1] > 0.0 ? low : high) = middle;
  }
  table.equilibrium = low;
}

/// From 1 to 0 over t = 0..1, twice continuously differentiable.
HeightJet fading(double t) {
  if (t <= 0.0) return {1.0, 0.0, 0.0};
  if (t >= 1.0) return {0.0, 0.0, 0.0};
  return {1.0 - t * t * t * (10.0 - t * (15.0 - 6.0 * t)), -30.0 * t * t * (1.0 - t) * (1.0 - t),
          -60.0 * t * (1.0 - t) * (1.0 - 2.0 * t)};
}

/// Returns the last point of the table at which each star is needed, so that those left out add up
/// to at most `share` of what is allowed; 0 for a star that is needed at none.
std::vector<std::size_t> last_needed(const SheetTable& table, const std::vector<SheetStar>& stars,
                                     const std::vector<std::vector<HeightJet>>& jets,
                                     double tolerance, double share) {
  const double step = (table.law.cutoff - table.nearest) / double(table.intervals);
  std::vector<std::size_t> last(stars.size(), 0);
  std::size_t needed = 0;
  for (std::size_t k = table.intervals; k-- > 0;) {
    const auto [energy, force] = mean_at(table, table.nearest + double(k) * step);
    const double energy_allowed = tolerance * std::max(table.depth, std::abs(energy));
    const double force_allowed = tolerance * std::max(table.pull, std::abs(force));
    double left_out = 0.0;
    std::size_t s = stars.size();
    for (; s > needed; --s) {
      const SheetStar& star = stars[s - 1];
      const HeightJet& f = jets[k][s - 1];
      const double lateral = kTau * std::sqrt(star.square) * std::abs(f[0]);
      left_out += std::abs(star.weight) * double(star.terms.size()) *
                  std::max(std::abs(f[0]) / energy_allowed,
                           std::max(lateral, std::abs(f[1])) / force_allowed);
      if (left_out > share) break;
    }
    for (; needed < s; ++needed) last[needed] = k + 1;
  }
  return last;
}

}  // namespace

SheetTable make_sheet_table(const SheetLattice& lattice, const SheetLaw& law, double sigma,
                            double tolerance, int attempt) {
  SheetTable table;
  table.centre = {lattice.centre[0], lattice.centre[1], 0.0};
  table.lattice = lattice;
  table.law = law;
  table.density = static_cast<double>(lattice.atoms.size()) / lattice.area;
  table.nearest = kNearestSheet * sigma;
  describe_mean(table);
  const std::vector<SheetStar> stars = stars_of(lattice);
  const SheetCoefficients coefficients(lattice, law, stars);

  // Errors of a force by splines of this order fall with the fifth power of the width.
  double width = 0.04 * sigma * pow(tolerance / 1e-4, 0.2);
  double share = 2.0;
  for (int k = 0; k < attempt; ++k) {
    width /= 1.2;
    share /= 2.0;
  }
  const double range = law.cutoff - table.nearest;
  table.intervals = static_cast<std::size_t>(range / width) + 4;
  width = range / static_cast<double>(table.intervals);

  std::vector<std::vector<HeightJet>> jets;
  for (std::size_t k = 0; k < table.intervals; ++k) {
    jets.push_back(coefficients.at(table.nearest + double(k) * width, stars.size()));
  }
  jets.emplace_back(stars.size());  // at the cutoff
  const std::vector<std::size_t> last = last_needed(table, stars, jets, tolerance, share);
  const auto used = static_cast<std::size_t>(
      std::count_if(last.begin(), last.end(), [](std::size_t k) { return k > 0; }));

  table.numbers = {static_cast<double>(used), 0.0};
  const auto fade = static_cast<std::size_t>(kFade * sigma / width) + 1;
  std::vector<std::size_t> ends;
  for (std::size_t s = 0; s < used; ++s) {
    // Reaches never grow, since the stars left out at a height are the last ones.
    ends.push_back(std::min(last[s] + fade, table.intervals));
    const double reach = table.nearest + (static_cast<double>(ends[s]) + kBeyondReach) * width;
    table.numbers.insert(table.numbers.end(), {reach, static_cast<double>(stars[s].order),
                                               static_cast<double>(stars[s].terms.size())});
    for (const auto& [m, n] : stars[s].terms) {
      table.numbers.insert(table.numbers.end(), {double(m), double(n)});
    }
  }
  table.numbers[1] = static_cast<double>(table.numbers.size());
  const auto faded = [&](std::size_t k, std::size_t s) {
    const HeightJet& f = jets[k][s];
    if (last[s] + fade > table.intervals) return f;  // ends at the cutoff by itself
    const double length = static_cast<double>(fade);
    const HeightJet part = fading((static_cast<double>(k) - static_cast<double>(last[s])) / length);
    const double first = part[1] / (length * width);
    const double second = part[2] / (length * width * length * width);
    return HeightJet{f[0] * part[0], f[1] * part[0] + f[0] * first,
                     f[2] * part[0] + 2.0 * f[1] * first + f[0] * second};
  };
  for (std::size_t k = 0; k <= table.intervals; ++k) {
    for (std::size_t s = 0; s < used; ++s) {
      const HeightJet f = k < ends[s] ? faded(k, s) : HeightJet{};
      const double weight = stars[s].weight;
      table.numbers.insert(table.numbers.end(), {weight * f[0], weight * f[1] * width,
                                                 weight * 0.5 * f[2] * width * width});
    }
  }
  if (!stars.empty()) {
    const HeightJet f = coefficients.at(table.equilibrium, stars.size()).front();
    table.first = stars.front().weight * f[0];
    table.first_decay = -f[1] / f[0];
  }
  return table;
}

SheetError measure_sheet_error(const SheetTable& table, const SheetAtoms& atoms) {
  constexpr int kPoints = 800;
  SheetFieldDescription description;
  description.sheet = std::make_shared<SheetTable>(table);
  auto p = SheetField::parameters<double, 3>(description);
  SheetField::rebase<double, 3>(p, description, description.first_origin);
  const LennardJonesSmooth::Parameters<double, 3> law = {
      table.law.four_epsilon, table.law.sigma_squared, table.law.at_cutoff, table.law.slope,
      table.law.cutoff};
  const double range = table.law.cutoff - table.nearest;
  SheetError worst;
  for (int k = 0; k < kPoints; ++k) {
    // Points that fill space evenly, by multiples of irrational numbers.
    const auto part = [k](double number) {
      const double x = (k + 0.5) * number;
      return x - std::floor(x);
    };
    const SheetPoint point = {part(0.8191725133961645) * atoms.box()[0],
                              part(0.6710436067037893) * atoms.box()[1]};
    const double depth = part(0.5497004779019703);
    const double z = table.nearest + range * depth * depth;
    const double side = k % 2 == 0 ? 1.0 : -1.0;

    double energy = 0.0;
    Vec<double, 3> force{};
    atoms.for_near(point, table.law.cutoff, [&](std::size_t, double x, double y) {
      Pair<double, 3> pair{};
      pair.separation[0] = x;
      pair.separation[1] = y;
      pair.separation[2] = -side * z;
      if (!(norm_squared(pair.separation) < law.cutoff * law.cutoff)) return;
      energy += LennardJonesSmooth::energy(law, pair);
      force = force + LennardJonesSmooth::force(law, pair);
    });

    Site<double, 3> site{};
    site.position[0] = point[0];
    site.position[1] = point[1];
    site.position[2] = table.centre[2] + side * z;
    site.table = table.numbers.data();
    const auto [mean, normal] = mean_at(table, z);
    const double energy_error = std::abs(SheetField::energy(p, site) - energy);
    const Vec<double, 3> found = SheetField::force(p, site);
    double force_error = 0.0;
    for (int d = 0; d < 3; ++d) force_error = std::max(force_error, std::abs(found[d] - force[d]));
    const double energy_scale = std::max(table.depth, std::abs(mean));
    const double force_scale = std::max(table.pull, std::abs(normal));
    const double relative = std::max(energy_error / energy_scale, force_error / force_scale);
    worst.relative = std::max(worst.relative, relative);
    // Deeper in the repulsion all numbers are larger.
    if (z >= kDeepest * table.equilibrium) {
      worst.energy = std::max(worst.energy, energy_error);
      worst.force = std::max(worst.force, force_error);
    }
  }
  return worst;
}

}  // namespace tomlin
