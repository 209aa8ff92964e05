#include "forcefields/lattice_substrate.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <utility>

#include <fmt/format.h>

#include "framework/core/elements/site_force.hpp"
#include "framework/core/numbers/constants.hpp"
#include "framework/core/records/fetched_numbers.hpp"
#include "framework/core/records/force.hpp"
#include "framework/core/text/axis_names.hpp"
#include "framework/core/text/fault_code.hpp"

TOMLIN_DECLARE_KERNELS(LatticeFirst)
TOMLIN_DECLARE_KERNELS(LatticeHigher)
TOMLIN_DECLARE_KERNELS(LatticeFirstAtHeight)
TOMLIN_DECLARE_KERNELS(LatticeHigherAtHeight)
TOMLIN_DECLARE_KERNELS(LatticeStarsAtHeight)
TOMLIN_DECLARE_KERNELS(LatticeOfMap)
TOMLIN_DECLARE_KERNELS(LatticeOfMapAtHeight)

namespace tomlin {
namespace {

using Description = LatticeSubstrateDescription;

/// The highest harmonic along b1 and b2 that there is an evaluator for.
constexpr int kHighest = 3;
/// Reciprocal-lattice vectors are equally long when their squares differ by no more than this part:
/// rounding of the lattice vectors is far less.
constexpr double kSameLength = 1e-9;
/// Lattice vectors are parallel when their angle is no larger: the reciprocal lattice then has lost
/// half of its digits.
constexpr double kParallel = 1e-8;
/// Lattice vectors of the combinations that are searched for periods along the axes.
constexpr int kMostVectors = 4;
/// Points of a map along a lattice vector: with fewer there are none between its extremes, and with
/// more its error takes minutes to tell.
constexpr std::size_t kFewestPoints = 4;
constexpr std::size_t kMostPoints = 1000;
/// A box fits a lattice when its length is a lattice vector to this part of it; as box_checks.hpp.
constexpr double kFits = 1e-9;

// ---- the lattice

struct PlaneVector {
  double x = 0.0;
  double y = 0.0;
};

double largest(const PlaneVector& v) { return std::max(std::abs(v.x), std::abs(v.y)); }

PlaneVector turned(const PlaneVector& v, double angle) {
  double sine = 0.0;
  double cosine = 0.0;
  sincos_turns(angle / kTau, sine, cosine);
  return {v.x * cosine - v.y * sine, v.x * sine + v.y * cosine};
}

/// a1 and a2; a line has no second one.
std::array<PlaneVector, 2> lattice_vectors(const Description& d) {
  std::array<PlaneVector, 2> vectors{};
  switch (d.lattice) {
    case SurfaceLattice::square:
      vectors = {{{d.period, 0.0}, {0.0, d.period}}};
      break;
    case SurfaceLattice::hexagonal:
    case SurfaceLattice::honeycomb:
      vectors = {{{d.period, 0.0}, {0.5 * d.period, 0.5 * std::sqrt(3.0) * d.period}}};
      break;
    case SurfaceLattice::line:
      vectors = {{{d.period, 0.0}, {}}};
      break;
    case SurfaceLattice::given: {
      const auto& x = d.lattice_vectors.coordinates;
      vectors = {{{x[0], x[1]}, {x[2], x[3]}}};
      break;
    }
  }
  if (d.misfit == 0.0) return vectors;
  return {turned(vectors[0], d.misfit), turned(vectors[1], d.misfit)};
}

bool is_line(const Description& d) { return d.lattice == SurfaceLattice::line; }

/// Exponent of the largest component: squares in units of it are neither too large nor too small.
int exponent_of(const std::array<PlaneVector, 2>& a) {
  return std::ilogb(std::max(largest(a[0]), largest(a[1])));
}

std::array<PlaneVector, 2> scaled(std::array<PlaneVector, 2> a, int exponent) {
  for (PlaneVector& v : a) v = {std::ldexp(v.x, exponent), std::ldexp(v.y, exponent)};
  return a;
}

DoubleDouble quotient(const DoubleDouble& a, const DoubleDouble& b) {
  DoubleDouble rest = a;
  DoubleDouble result;
  for (int pass = 0; pass < 3; ++pass) {
    const double part = rest.hi / b.hi;
    result += part;
    rest -= b * part;
  }
  return result;
}

DoubleDouble dot_product(const std::array<DoubleDouble, 2>& a,
                         const std::array<DoubleDouble, 2>& b) {
  return a[0] * b[0] + a[1] * b[1];
}

using PlanePair = std::array<std::array<DoubleDouble, 2>, 2>;

/// b1 and b2 of lattice vectors; a line has no second one.
PlanePair reciprocal_of(const std::array<PlaneVector, 2>& a, bool line) {
  if (line) {
    const DoubleDouble square = two_prod(a[0].x, a[0].x) + two_prod(a[0].y, a[0].y);
    return {{{quotient(a[0].x, square), quotient(a[0].y, square)}, {}}};
  }
  const DoubleDouble area = two_prod(a[0].x, a[1].y) - two_prod(a[0].y, a[1].x);
  return {{{quotient(a[1].y, area), quotient(-a[1].x, area)},
           {quotient(-a[0].y, area), quotient(a[0].x, area)}}};
}

/// Reciprocal vectors in units of a power of two, in which all numbers are about 1.
PlanePair reciprocal_shape(const Description& d) {
  const auto a = lattice_vectors(d);
  return reciprocal_of(scaled(a, -exponent_of(a)), is_line(d));
}

/// Returns the lattice vector n1 a1 + n2 a2.
std::array<DoubleDouble, 2> combination(const std::array<PlaneVector, 2>& a, double n1, double n2) {
  return {two_prod(n1, a[0].x) + two_prod(n2, a[1].x), two_prod(n1, a[0].y) + two_prod(n2, a[1].y)};
}

// ---- its stars

struct ReciprocalVector {
  int m = 0;
  int n = 0;
  double square = 0.0;  ///< of its length, in some unit
};

using Star = std::vector<ReciprocalVector>;

/// One of each pair of vectors up to the highest harmonics, by length.
std::vector<ReciprocalVector> reciprocal_vectors(const Description& d) {
  const auto b = reciprocal_shape(d);
  std::vector<ReciprocalVector> vectors;
  const int across = is_line(d) ? 0 : kHighest;
  for (int m = 0; m <= kHighest; ++m) {
    for (int n = -across; n <= across; ++n) {
      if (m == 0 && n <= 0) continue;
      const double x = m * b[0][0].hi + n * b[1][0].hi;
      const double y = m * b[0][1].hi + n * b[1][1].hi;
      vectors.push_back({m, n, x * x + y * y});
    }
  }
  std::stable_sort(vectors.begin(), vectors.end(),
                   [](const auto& one, const auto& other) { return one.square < other.square; });
  return vectors;
}

/// Square of a length below which no vector with a higher harmonic lies: the shortest of the
/// vectors m b1 + n b2 with real m and n of which the larger is that of the first harmonic left
/// out.
double square_of_complete(const Description& d) {
  const auto b = reciprocal_shape(d);
  const double first = dot_product(b[0], b[0]).hi;
  if (is_line(d)) return (kHighest + 1) * (kHighest + 1) * first;
  const double second = dot_product(b[1], b[1]).hi;
  const double mixed = dot_product(b[0], b[1]).hi;
  const auto nearest = [mixed](double fixed, double along) {
    const double part = std::clamp(-mixed / along, -1.0, 1.0);
    return fixed + part * (2.0 * mixed + part * along);
  };
  return (kHighest + 1) * (kHighest + 1) * std::min(nearest(first, second), nearest(second, first));
}

/// All stars that are complete up to the highest harmonics.
std::vector<Star> stars_of(const Description& d) {
  const double complete = square_of_complete(d) * (1.0 - kSameLength);
  std::vector<Star> stars;
  for (const ReciprocalVector& vector : reciprocal_vectors(d)) {
    if (vector.square >= complete) break;
    if (stars.empty() || vector.square > stars.back().front().square * (1.0 + kSameLength)) {
      stars.emplace_back();
    }
    stars.back().push_back(vector);
  }
  return stars;
}

/// That makes atoms maxima.
double sign_of(const Description& d, const ReciprocalVector& vector) {
  return d.lattice == SurfaceLattice::honeycomb && (vector.m + vector.n) % 3 != 0 ? -1.0 : 1.0;
}

std::size_t harmonic_count(const Description& d) { return d.harmonics.count(); }

std::array<int, 2> harmonic_at(const Description& d, std::size_t k) {
  return {static_cast<int>(d.harmonics.coordinates[2 * k]),
          static_cast<int>(d.harmonics.coordinates[2 * k + 1])};
}

bool is_given(double number) { return !std::isnan(number); }

/// None of a map.
std::vector<double> amplitudes_of(const Description& d) {
  return is_given(d.amplitude) ? std::vector<double>{d.amplitude} : d.amplitudes.numbers;
}

bool fades(const Description& d) {
  const auto& decays = d.decay.numbers;
  return std::any_of(decays.begin(), decays.end(), [](double x) { return x != 0.0; });
}

LatticeHeight law_of(const Description& d) {
  const auto& decays = d.decay.numbers;
  if (!fades(d) && d.repulsion == 0.0) return LatticeHeight::none;
  const bool same = std::all_of(decays.begin(), decays.end(),
                                [&decays](double x) { return x == decays.front(); });
  return same ? LatticeHeight::common : LatticeHeight::each;
}

int order_of(const Description& d) {
  int order = 1;
  for (const LatticeHarmonic& harmonic : lattice_harmonics(d)) {
    order = std::max({order, harmonic.m, std::abs(harmonic.n)});
  }
  return order;
}

}  // namespace

inline namespace TOMLIN_TARGET {

std::array<std::array<DoubleDouble, 2>, 2> reciprocal_lattice(const Description& d) {
  const int exponent = -exponent_of(lattice_vectors(d));
  PlanePair b = reciprocal_shape(d);
  for (auto& vector : b) {
    for (DoubleDouble& x : vector) x = {std::ldexp(x.hi, exponent), std::ldexp(x.lo, exponent)};
  }
  return b;
}

std::array<DoubleDouble, 2> lattice_phases(const Description& d, const Origin& origin) {
  // Halves go one way, so that rounding does not decide between two vectors.
  constexpr double kHalf = 0x1p-30;
  const auto a = lattice_vectors(d);
  const auto b = reciprocal_lattice(d);
  std::array<DoubleDouble, 2> rest;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    rest[axis] = two_prod(static_cast<double>(origin.cells[axis]), origin.unit[axis]);
  }
  // The first numbers of vectors may be off by some when the origin is far away.
  for (int pass = 0; pass < 2; ++pass) {
    const double n1 = std::round(dot_product(b[0], rest).hi - kHalf);
    const double n2 = std::round(dot_product(b[1], rest).hi - kHalf);
    // One after the other: sums and differences of multiples of vectors are exact.
    const auto vector = combination(a, n1, n2);
    for (std::size_t axis = 0; axis < 2; ++axis) rest[axis] -= vector[axis];
  }
  return {dot_product(b[0], rest), dot_product(b[1], rest)};
}

}  // namespace TOMLIN_TARGET

std::vector<LatticeHarmonic> lattice_harmonics(const Description& d) {
  const std::vector<double> amplitudes = amplitudes_of(d);
  std::vector<LatticeHarmonic> all;
  if (harmonic_count(d) > 0) {
    for (std::size_t k = 0; k < harmonic_count(d); ++k) {
      const auto [m, n] = harmonic_at(d, k);
      const bool turn = m < 0 || (m == 0 && n < 0);
      all.push_back({turn ? -m : m, turn ? -n : n, amplitudes[k], lattice_decay(d, k)});
    }
    return all;
  }
  const std::vector<Star> stars = stars_of(d);
  for (std::size_t k = 0; k < amplitudes.size(); ++k) {
    for (const ReciprocalVector& vector : stars[k]) {
      all.push_back({vector.m, vector.n, sign_of(d, vector) * amplitudes[k], lattice_decay(d, k)});
    }
  }
  return all;
}

double lattice_decay(const Description& d, std::size_t k) {
  if (d.decay.numbers.empty()) return 0.0;
  return d.decay.numbers.size() == 1 ? d.decay.numbers.front() : d.decay.numbers[k];
}

double lattice_period(const Description& d, int axis) {
  if (axis > 1) return 0.0;
  const auto a = lattice_vectors(d);
  const auto along = static_cast<std::size_t>(axis);
  double shortest = 0.0;
  for (int n1 = -kMostVectors; n1 <= kMostVectors; ++n1) {
    for (int n2 = -kMostVectors; n2 <= kMostVectors; ++n2) {
      const auto vector = combination(a, n1, n2);
      const double length = vector[along].hi;
      const bool exact = vector[along].lo == 0.0 && vector[1 - along] == DoubleDouble(0.0);
      if (exact && length > 0.0 && (shortest == 0.0 || length < shortest)) shortest = length;
    }
  }
  return shortest;
}

std::array<double, 3> lattice_curvatures(const Description& d) {
  const auto b = reciprocal_lattice(d);
  double xx = 0.0;
  double yy = 0.0;
  double xy = 0.0;
  if (d.map) {
    const double uu = d.map->curvatures()[0];
    const double vv = d.map->curvatures()[1];
    const double uv = d.map->curvatures()[2];
    const auto bound = [&](std::size_t one, std::size_t other) {
      const auto size = [&](std::size_t j, std::size_t axis) { return std::abs(b[j][axis].hi); };
      return uu * size(0, one) * size(0, other) + vv * size(1, one) * size(1, other) +
             uv * (size(0, one) * size(1, other) + size(1, one) * size(0, other));
    };
    const double scale = std::abs(d.energy_scale);
    xx = scale * bound(0, 0);
    yy = scale * bound(1, 1);
    xy = scale * bound(0, 1);
  }
  const auto harmonics = d.map ? std::vector<LatticeHarmonic>() : lattice_harmonics(d);
  for (const LatticeHarmonic& harmonic : harmonics) {
    const double x = kTau * (harmonic.m * b[0][0].hi + harmonic.n * b[1][0].hi);
    const double y = kTau * (harmonic.m * b[0][1].hi + harmonic.n * b[1][1].hi);
    const double size = std::abs(harmonic.amplitude);
    xx += size * x * x;
    yy += size * y * y;
    xy += size * x * y;
  }
  const double half = 0.5 * (xx - yy);
  return {xx, yy, 0.5 * (xx + yy) + std::sqrt(half * half + xy * xy)};
}

namespace {

// ---- binding

template <class Real>
std::unique_ptr<BoundForce<Real>> bind(const Description& d, const Binding<Real>& binding) {
  constexpr int kRank = kRankTranscendental;
  if (d.map && law_of(d) == LatticeHeight::none) {
    return bind_on_particles<LatticeOfMap, kernels::LatticeOfMap, kRank>(d, binding);
  }
  if (d.map) {
    return bind_on_particles<LatticeOfMapAtHeight, kernels::LatticeOfMapAtHeight, kRank>(d,
                                                                                         binding);
  }
  const bool first = order_of(d) == 1;
  switch (law_of(d)) {
    case LatticeHeight::none:
      return first ? bind_on_particles<LatticeFirst, kernels::LatticeFirst, kRank>(d, binding)
                   : bind_on_particles<LatticeHigher, kernels::LatticeHigher, kRank>(d, binding);
    case LatticeHeight::common:
      return first
                 ? bind_on_particles<LatticeFirstAtHeight, kernels::LatticeFirstAtHeight, kRank>(
                       d, binding)
                 : bind_on_particles<LatticeHigherAtHeight, kernels::LatticeHigherAtHeight, kRank>(
                       d, binding);
    case LatticeHeight::each:
      break;
  }
  return bind_on_particles<LatticeStarsAtHeight, kernels::LatticeStarsAtHeight, kRank>(d, binding);
}

Traits traits(const Description& d) {
  Traits traits = traits_of_sites<LatticeFirst>();
  traits.periodic = lattice_period(d, 0) > 0.0 || lattice_period(d, 1) > 0.0;
  return traits;
}

/// Along an axis without a period phases follow the origin all the same: it moves by about a
/// lattice vector.
double origin_cell(const Description& d, int axis) {
  const auto a = lattice_vectors(d);
  const bool constant = axis > 1 || (is_line(d) && (axis == 0 ? a[0].x : a[0].y) == 0.0);
  return constant ? 0.0 : largest(a[0]);
}

// ---- the map

const std::filesystem::path& read_from(const Description& d) { return d.read_from; }

void assign_energies(void* description, ParameterValue value) {
  auto energies = std::get<NumberTable>(std::move(value));
  auto& d = *static_cast<Description*>(description);
  d.map = energies.numbers.empty()
              ? nullptr
              : std::make_shared<PeriodicSpline>(energies.columns, std::move(energies.numbers));
}

ParameterValue read_energies(const void* description) {
  const auto& d = *static_cast<const Description*>(description);
  return d.map ? NumberTable{d.map->columns(), d.map->values()} : NumberTable{};
}

std::vector<Complaint> prepare(Description& d, const std::filesystem::path& folder) {
  if (d.energy_map.empty()) return {};
  if (d.map) {
    return {{.key = "energy_map",
             .why = "energies are given too",
             .admissible = "one of the two",
             .code = FaultCode::scene_conflict}};
  }
  FetchedNumbers fetched = fetch_numbers(d.energy_map, folder, "energy_map", kMostPoints,
                                         fmt::format(", but a map has at most {}", kMostPoints));
  if (fetched.complaints.empty()) {
    d.map = std::make_shared<PeriodicSpline>(fetched.file.columns, std::move(fetched.file.numbers));
  }
  d.read_from = std::move(fetched.path);
  d.energy_map.clear();
  return std::move(fetched.complaints);
}

/// How far the spline may be from the function whose values the map has.
std::string note(const Description& d) {
  if (!d.map) return {};
  const auto& energies = d.map->values();
  const auto [lowest, highest] = std::minmax_element(energies.begin(), energies.end());
  const double scale = std::abs(d.energy_scale);
  const double corrugation = scale * (*highest - *lowest);
  const PeriodicSpline::Error error = d.map->error();
  const auto b = reciprocal_lattice(d);
  double force = 0.0;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    force = std::max(
        force, std::abs(b[0][axis].hi) * error.slope_u + std::abs(b[1][axis].hi) * error.slope_v);
  }
  return fmt::format(
      "energy map of {} x {} points, corrugation {:.4g}; its spline differs from trigonometric "
      "interpolation by up to {:.2g} in energy and {:.2g} in a component of the force",
      d.map->rows(), d.map->columns(), corrugation, scale * error.value, scale * force);
}

// ---- faults

class Check {
 public:
  Check(const Description& d, const SceneOutline& scene) : d_(d), scene_(scene) {}

  std::vector<Complaint> complaints() {
    check_lattice();
    lattice_is_known_ = found_.empty();
    check_dimension();
    if (d_.map) {
      check_map();
    } else {
      check_amplitudes();
    }
    check_height();
    if (found_.empty()) check_box();
    return std::move(found_);
  }

 private:
  void add(FaultCode code, std::string key, std::string why, std::string admissible = "") {
    found_.push_back({.key = std::move(key),
                      .why = std::move(why),
                      .admissible = std::move(admissible),
                      .code = code});
  }

  bool has_vectors() const { return !d_.lattice_vectors.coordinates.empty(); }
  bool has_amplitudes() const { return !d_.amplitudes.numbers.empty(); }
  bool is_side_view() const { return scene_.dimension == 2 && d_.height == HeightAxis::y; }
  bool has_height() const { return scene_.dimension == 3 || is_side_view(); }

  void check_lattice() {
    const bool named = d_.lattice != SurfaceLattice::given;
    if (named && has_vectors()) {
      add(FaultCode::scene_conflict, "lattice_vectors", "lattice is given too", "one of the two");
    } else if (named && !is_given(d_.period)) {
      add(FaultCode::scene_missing_key, "period", "missing: the length of the lattice vectors");
    } else if (!named && !has_vectors()) {
      add(FaultCode::scene_missing_key, "lattice", "missing",
          "lattice and period, or lattice_vectors");
    } else if (has_vectors()) {
      check_vectors();
    }
  }

  void check_vectors() {
    if (is_given(d_.period)) {
      add(FaultCode::scene_conflict, "period", "lattice_vectors are given too", "one of the two");
    }
    if (d_.lattice_vectors.dimension != 2 || d_.lattice_vectors.count() != 2) {
      add(FaultCode::scene_wrong_count, "lattice_vectors", "not two vectors of the plane",
          "[[a1x, a1y], [a2x, a2y]]");
      return;
    }
    // Each in units of its own.
    const auto of_length_one = [](const PlaneVector& v) {
      return PlaneVector{v.x / largest(v), v.y / largest(v)};
    };
    const auto& x = d_.lattice_vectors.coordinates;
    const PlaneVector one = of_length_one({x[0], x[1]});
    const PlaneVector other = of_length_one({x[2], x[3]});
    if (!(std::abs(one.x * other.y - one.y * other.x) > kParallel)) {
      add(FaultCode::component_invalid, "lattice_vectors",
          "they span no lattice: they are parallel", "two vectors in different directions");
    }
  }

  void check_dimension() {
    if (d_.height == HeightAxis::y && scene_.dimension != 2) {
      add(FaultCode::component_unsuitable, "height",
          scene_.dimension == 3 ? "in three dimensions z is the height"
                                : "in one dimension there is no height",
          "\"z\"");
    }
    if (scene_.dimension > 1 && !is_side_view()) return;
    const std::string scene =
        scene_.dimension == 1 ? "one dimension" : "a side view, with height = \"y\",";
    if (has_vectors() || (d_.lattice != SurfaceLattice::given && !is_line(d_))) {
      add(FaultCode::component_unsuitable, has_vectors() ? "lattice_vectors" : "lattice",
          scene + " shows a single lattice vector", "lattice = \"line\"");
    }
    if (d_.misfit != 0.0) {
      add(FaultCode::component_unsuitable, "misfit",
          scene + " has no other direction to turn the lattice to", "0");
    }
  }

  void check_amplitudes() {
    if (d_.energy_scale != 1.0) {
      add(FaultCode::scene_conflict, "energy_scale", "there is no map that it would scale",
          "energies or energy_map");
    }
    if (is_given(d_.amplitude) && has_amplitudes()) {
      add(FaultCode::scene_conflict, "amplitudes", "amplitude is given too", "one of the two");
      return;
    }
    if (!is_given(d_.amplitude) && !has_amplitudes()) {
      add(FaultCode::scene_missing_key, "amplitude", "missing",
          "amplitude of the first star, amplitudes, energies or energy_map");
      return;
    }
    const std::size_t given = amplitudes_of(d_).size();
    if (!d_.harmonics.coordinates.empty()) {
      if (!check_harmonics()) return;
      if (given != harmonic_count(d_)) {
        add(FaultCode::scene_wrong_count, has_amplitudes() ? "amplitudes" : "amplitude",
            fmt::format("{} for {} harmonics", given, harmonic_count(d_)), "one for each");
      }
    } else if (lattice_is_known_) {
      check_stars(given);
    }
    const std::size_t decays = d_.decay.numbers.size();
    if (decays > 1 && decays != given) {
      add(FaultCode::scene_wrong_count, "decay",
          fmt::format("{} entries for {} amplitudes", decays, given), "one for all, or one each");
    }
  }

  void check_map() {
    const char* key = d_.read_from.empty() ? "energies" : "energy_map";
    if (lattice_is_known_ && !std::isfinite(lattice_curvatures(d_)[2])) {
      add(FaultCode::scene_not_finite, key, "the curvature of the map is not finite");
    }
    const std::pair<const char*, bool> others[] = {
        {"amplitude", is_given(d_.amplitude)},
        {"amplitudes", has_amplitudes()},
        {"harmonics", !d_.harmonics.coordinates.empty()}};
    for (const auto& [other, given] : others) {
      if (given)
        add(FaultCode::scene_conflict, other, "a map gives the energies", "one of the two");
    }
    if (d_.decay.numbers.size() > 1) {
      add(FaultCode::scene_wrong_count, "decay",
          fmt::format("{} entries for a map", d_.decay.numbers.size()), "one number");
    }
    const std::size_t rows = d_.map->rows();
    const std::size_t columns = d_.map->columns();
    const auto fits = [](std::size_t points) {
      return points >= kFewestPoints && points <= kMostPoints;
    };
    if (is_line(d_) && columns != 1) {
      add(FaultCode::scene_wrong_count, key,
          fmt::format("{} columns, but the energy depends on x alone", columns),
          "one column; or a lattice in the plane");
    } else if (!fits(rows) || !(is_line(d_) || fits(columns))) {
      add(FaultCode::scene_wrong_count, key, fmt::format("a grid of {} x {} points", rows, columns),
          fmt::format("{} to {} rows along the first lattice vector, {}", kFewestPoints,
                      kMostPoints,
                      is_line(d_) ? "of one column" : "as many columns along the second"));
    }
  }

  void check_stars(std::size_t given) {
    if (const std::size_t stars = stars_of(d_).size(); given > stars) {
      add(FaultCode::scene_wrong_count, "amplitudes",
          fmt::format("{} stars, but harmonics up to the order {} make up {} whole stars of this "
                      "lattice",
                      given, kHighest, stars),
          "fewer amplitudes, or harmonics");
    }
  }

  /// True when valid.
  bool check_harmonics() {
    const auto& numbers = d_.harmonics.coordinates;
    const auto is_order = [](double x) { return x == std::round(x) && std::abs(x) <= kHighest; };
    const std::string admissible =
        fmt::format("[[m, n], ...], integers from -{0} to {0}", kHighest);
    const auto refuse = [&](const std::string& why) {
      add(FaultCode::component_invalid, "harmonics", why, admissible);
      return false;
    };
    if (d_.harmonics.dimension != 2) return refuse("not a list of pairs");
    if (!std::all_of(numbers.begin(), numbers.end(), is_order)) {
      return refuse("an entry is no such integer");
    }
    for (std::size_t k = 0; k < harmonic_count(d_); ++k) {
      const auto [m, n] = harmonic_at(d_, k);
      const std::string name = fmt::format("[{}, {}]", m, n);
      if (m == 0 && n == 0) return refuse(name + " is constant");
      if (is_line(d_) && n != 0) return refuse(name + ": on a line n is 0");
      for (std::size_t before = 0; before < k; ++before) {
        const auto [p, q] = harmonic_at(d_, before);
        if ((p == m && q == n) || (p == -m && q == -n)) {
          return refuse(name + " is given twice: a harmonic and its opposite are the same");
        }
      }
    }
    return true;
  }

  void check_height() {
    if (!has_height()) {
      const std::string why = scene_.dimension == 2
                                  ? "there is no height in the plane of the surface"
                                  : "there is no height in one dimension";
      const std::string admissible = scene_.dimension == 2 ? "0, or height = \"y\"" : "0";
      if (fades(d_)) add(FaultCode::component_unsuitable, "decay", why, admissible);
      if (d_.repulsion != 0.0) {
        add(FaultCode::component_unsuitable, "repulsion", why, admissible);
      }
    } else if (d_.repulsion != 0.0 && d_.repulsion_decay == 0.0) {
      add(FaultCode::scene_missing_key, "repulsion_decay",
          "missing: repulsion does not depend on the height without it", "a number > 0");
    }
  }

  /// Skips an axis with a period: the box is compared with it as for any force.
  void check_box() {
    const auto b = reciprocal_lattice(d_);
    for (int axis = 0; axis < scene_.dimension; ++axis) {
      const auto at = static_cast<std::size_t>(axis);
      const double length = scene_.box[at];
      if (!(length > 0.0) || lattice_period(d_, axis) > 0.0) continue;
      const bool is_height = has_height() && axis == scene_.dimension - 1;
      if (is_height && law_of(d_) != LatticeHeight::none) {
        add(FaultCode::box_invalid, d_.repulsion != 0.0 ? "repulsion" : "decay",
            fmt::format("the box is periodic along {}, the height above the surface",
                        kAxisNames[at]));
      }
      if (is_height || origin_cell(d_, axis) == 0.0) continue;
      const auto is_whole = [length](const DoubleDouble& wave) {
        const double turns = wave.hi * length;
        return std::abs(turns - std::round(turns)) <= kFits * std::max(1.0, std::abs(turns));
      };
      if (is_whole(b[0][at]) && is_whole(b[1][at])) continue;
      add(FaultCode::box_invalid, d_.misfit != 0.0 ? "misfit" : "lattice_vectors",
          fmt::format("the box is periodic along {}, but its length {} is no lattice vector",
                      kAxisNames[at], length),
          "a lattice vector along the axis, or no periodic box along it");
    }
  }

  const Description& d_;
  const SceneOutline& scene_;
  bool lattice_is_known_ = false;
  std::vector<Complaint> found_;
};

std::vector<Complaint> complaints(const Description& d, const SceneOutline& scene) {
  return Check(d, scene).complaints();
}

}  // namespace

ForceRecord lattice_substrate_record() {
  constexpr Dimension kInverseLength{.length = -1};
  Parameter energies;
  energies.key = "energies";
  energies.doc =
      "in place of amplitude: a map of the energy per particle, evenly over a cell; rows along the "
      "first lattice vector, columns along the second, the first of each at x = y = 0; on a line, "
      "one list";
  energies.dimension = dimension::energy;
  energies.prototype = NumberTable{};
  energies.optional = true;
  energies.assign = &assign_energies;
  energies.read = &read_energies;
  ForceRecord record = record_of<Description>();
  record.element = Element::site;
  record.varies = true;
  record.traits = traits_of_sites<LatticeFirst>();
  record.traits_of = of_description<&traits>;
  record.period = of_description<&lattice_period>;
  record.origin_cell = of_description<&origin_cell>;
  record.complaints = of_description<&complaints>;
  record.prepare = of_description<&prepare>;
  record.read_from = of_description<&read_from>;
  record.note = of_description<&note>;
  record.bind = {of_description<&bind<double>>, of_description<&bind<Quad>>};
  record.name = "lattice_substrate";
  record.summary = "a crystalline surface that each particle feels";
  record.equation =
      "V = repulsion exp(-repulsion_decay z) + sum over stars s of amplitudes[s] exp(-decay[s] z) "
      "times the sum of cos(2 pi (m b1 + n b2).(x, y)) over the star, all reciprocal-lattice "
      "vectors of one length, one of each pair with opposite signs; stars in order of length";
  record.source =
      "G. S. Verhoeven, M. Dienwiebel and J. W. M. Frenken, Phys. Rev. B 70 (2004) 165418, "
      "doi:10.1103/PhysRevB.70.165418, the first star of honeycomb; W. A. Steele, Surf. Sci. 36 "
      "(1973) 317, doi:10.1016/0039-6028(73)90264-1, dependence on height, in the exponential "
      "form far from the surface";
  record.parameters = {
      parameter("lattice", &Description::lattice, dimension::none,
                "by name; x = y = 0 is an atom, of honeycomb the centre of a hexagon; line: atoms "
                "along x only")
          .or_absent(),
      parameter("period", &Description::period, dimension::length,
                "lattice constant: the length of the lattice vectors of a lattice with a name")
          .in(positive)
          .or_absent()
          .one_for_all_particles(),
      parameter("lattice_vectors", &Description::lattice_vectors, dimension::length,
                "in place of lattice and period: [[a1x, a1y], [a2x, a2y]]")
          .or_absent(),
      parameter("misfit", &Description::misfit, dimension::none,
                "angle by which the lattice is turned counter-clockwise, in radians; without it a "
                "lattice with a name has a vector along x")
          .by_default(0.0)
          .one_for_all_particles(),
      parameter("amplitude", &Description::amplitude, dimension::energy,
                "of the first star, per particle; atoms are maxima when positive")
          .or_absent(),
      parameter("amplitudes", &Description::amplitudes, dimension::energy,
                "in place of amplitude: one for each star in order of its length, or for each of "
                "harmonics; of a lattice with a name atoms are maxima when positive")
          .or_absent(),
      parameter("harmonics", &Description::harmonics, dimension::none,
                "in place of the stars: pairs [m, n] of integers from -3 to 3, each a term "
                "amplitude cos(2 pi (m b1 + n b2).(x, y)), whatever the lattice")
          .or_absent(),
      std::move(energies),
      parameter("energy_map", &Description::energy_map, dimension::none,
                "in place of energies: a file of them, a row per line, columns apart by spaces or "
                "commas, # comments; its path is relative to the scene's folder")
          .or_absent(),
      parameter("energy_scale", &Description::energy_scale, dimension::none,
                "factor on the energies of a map")
          .by_default(1.0),
      parameter("height", &Description::height, dimension::none,
                "the axis that is the height above the surface: z in three dimensions; in two "
                "dimensions with y the scene is a side view, else there is none")
          .by_default(HeightAxis::z),
      parameter("decay", &Description::decay, kInverseLength,
                "of the amplitudes with height, one for all or one each; without it they do not "
                "depend on the height")
          .in(non_negative)
          .or_absent(),
      parameter("repulsion", &Description::repulsion, dimension::energy,
                "of the flat surface at the height 0, per particle")
          .in(non_negative)
          .by_default(0.0),
      parameter("repulsion_decay", &Description::repulsion_decay, kInverseLength,
                "decay of the repulsion with height")
          .in(non_negative)
          .by_default(0.0)
          .one_for_all_particles()};
  record.example = R"(# A tip is pulled over a hexagonal surface, at an angle to its rows of atoms.
[[body]]
name = "tip"
type = "point"
position = [0.5, 0.2]
particle_mass = 1.0

[[force]]
name = "driver"
type = "driving_spring"
stiffness = 2.0
velocity = [0.08, 0.06]

[[force]]
type = "viscous_damping"
coefficient = 2.0

[[force]]
name = "surface"
type = "lattice_substrate"
lattice = "hexagonal"
period = 1.0
amplitude = 0.1

[run]
duration = 50.0
integrator = { type = "rk4", dt = 1e-2 }
)";
  return record;
}

}  // namespace tomlin
