// A (10,0) nanotube under Tersoff's potential, 800 atoms in a periodic box, one step of velocity
// Verlet: the engine, and a loop as a one-off program would have it, which knows that each atom has
// three neighbours for ever. With a fixed sheet of graphene below it: the engine, by pairs and by
// the field of the sheet, and the same loop with the harmonics of W. A. Steele, Surf. Sci. 36, 317
// (1973), in tables.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "benchmarks/counters.hpp"
#include "benchmarks/evaluated_scene.hpp"
#include "benchmarks/tersoff_twin.hpp"
#include "framework/core/system/thread_team.hpp"
#include "framework/run/engine.hpp"
#include "framework/scene/scene.hpp"
#include "framework/standard_registry.hpp"

namespace {

constexpr int kCells = 20;
constexpr double kBond = 1.4388;
constexpr double kStep = 1e-3;
constexpr double kMass = 12.011 * 1.0364269e-4;

using Point = std::array<double, 3>;

double length_of_box() { return kCells * 3.0 * kBond; }

std::vector<Point> tube() {
  constexpr int kAround = 10;
  const double radius = kAround * std::sqrt(3.0) * kBond / (2.0 * std::numbers::pi);
  struct Circle {
    double height;
    double turned;
  };
  constexpr std::array<Circle, 4> kCircles = {{{0.0, 0.0}, {0.5, 0.5}, {1.5, 0.5}, {2.0, 0.0}}};
  std::vector<Point> positions;
  for (int cell = 0; cell < kCells; ++cell) {
    for (const Circle& circle : kCircles) {
      for (int k = 0; k < kAround; ++k) {
        const double angle = 2.0 * std::numbers::pi * (k + circle.turned) / kAround;
        // Every atom off its position by some hundredths of a bond.
        const double off = 0.03 * std::sin(7.0 * static_cast<double>(positions.size()));
        positions.push_back({(3.0 * cell + circle.height) * kBond + off,
                             radius * std::cos(angle) - off, radius * std::sin(angle) + 0.5 * off});
      }
    }
  }
  return positions;
}

constexpr double kEpsilon = 0.002411;
constexpr double kSigma = 3.4;
constexpr double kSheetHeight = -7.2;

/// Steele's field of graphene whose hexagon is about the origin: five stars of harmonics, the
/// functions of the height in tables of fine steps.
class PlainSheet {
 public:
  PlainSheet() {
    for (std::size_t s = 0; s < kStars.size(); ++s) {
      for (int k = 0; k < kRows; ++k) {
        const double z = kLowest + k * kWidth;
        value_[s].push_back(coefficient(s, z));
        slope_[s].push_back((coefficient(s, z + 1e-4) - coefficient(s, z - 1e-4)) / 2e-4);
      }
    }
  }

  void add_force(const Point& x, Point& f) const {
    const double z = x[2] - kSheetHeight;
    const double part = (z - kLowest) / kWidth;
    const int row = static_cast<int>(part);
    if (row < 0 || row >= kRows - 1) return;
    const double t = part - row;
    const double q = std::pow(kSigma / z, 4);
    f[2] += 8.0 * std::numbers::pi * kEpsilon * kSigma * kSigma / kArea *
            (2.0 * q * q * kSigma * kSigma / (z * z) - 2.0 * q) / z;
    std::array<double, 4> c1{1.0}, s1{0.0}, c2{1.0}, s2{0.0};
    c1[1] = std::cos(kB1x * x[0] + kB1y * x[1]);
    s1[1] = std::sin(kB1x * x[0] + kB1y * x[1]);
    c2[1] = std::cos(kB1x * x[0] - kB1y * x[1]);
    s2[1] = std::sin(kB1x * x[0] - kB1y * x[1]);
    for (std::size_t k = 2; k < 4; ++k) {
      c1[k] = c1[k - 1] * c1[1] - s1[k - 1] * s1[1];
      s1[k] = s1[k - 1] * c1[1] + c1[k - 1] * s1[1];
      c2[k] = c2[k - 1] * c2[1] - s2[k - 1] * s2[1];
      s2[k] = s2[k - 1] * c2[1] + c2[k - 1] * s2[1];
    }
    for (std::size_t s = 0; s < kStars.size(); ++s) {
      double wave = 0.0;
      double pull1 = 0.0;
      double pull2 = 0.0;
      for (const auto& [m, n] : kStars[s].waves) {
        if (m == 0 && n == 0) continue;
        const auto j = static_cast<std::size_t>(m);
        const auto k = static_cast<std::size_t>(std::abs(n));
        const double sine2 = n < 0 ? -s2[k] : s2[k];
        wave += c1[j] * c2[k] - s1[j] * sine2;
        const double sine = s1[j] * c2[k] + c1[j] * sine2;
        pull1 += m * sine;
        pull2 += n * sine;
      }
      const auto at = static_cast<std::size_t>(row);
      const double value = value_[s][at] + t * (value_[s][at + 1] - value_[s][at]);
      const double slope = slope_[s][at] + t * (slope_[s][at + 1] - slope_[s][at]);
      f[0] += value * kB1x * (pull1 + pull2);
      f[1] += value * kB1y * (pull1 - pull2);
      f[2] -= slope * wave;
    }
  }

 private:
  static constexpr double kRoot3 = std::numbers::sqrt3;
  static constexpr double kArea = 1.5 * kRoot3 * kBond * kBond;
  static constexpr double kB1x = 2.0 * std::numbers::pi / (3.0 * kBond);
  static constexpr double kB1y = 2.0 * std::numbers::pi / (kRoot3 * kBond);
  static constexpr double kLowest = 2.0;
  static constexpr double kWidth = 0.005;
  static constexpr int kRows = 1600;
  /// One wave of each pair of opposite vectors, followed by zeros where there are fewer than
  /// six; and the sum over the two atoms of a cell.
  struct StarOfWaves {
    double length;  ///< in units of the first
    double atoms;
    std::array<std::array<int, 2>, 6> waves;
  };
  static constexpr std::array<StarOfWaves, 5> kStars = {{
      {1.0, -1.0, {{{1, 0}, {0, 1}, {1, 1}}}},
      {1.7320508075688772, 2.0, {{{1, -1}, {2, 1}, {1, 2}}}},
      {2.0, -1.0, {{{2, 0}, {0, 2}, {2, 2}}}},
      {2.6457513110645906, -1.0, {{{3, 1}, {3, 2}, {1, 3}, {2, 3}, {2, -1}, {1, -2}}}},
      {3.0, 2.0, {{{3, 0}, {0, 3}, {3, 3}}}},
  }};

  static double coefficient(std::size_t s, double z) {
    const double g = kStars[s].length * 4.0 * std::numbers::pi / (3.0 * kBond);
    const double half = g / (2.0 * z);
    return 2.0 * kStars[s].atoms * 8.0 * std::numbers::pi * kEpsilon / kArea *
           (std::pow(kSigma, 12) / 120.0 * std::pow(half, 5) * std::cyl_bessel_k(5.0, g * z) -
            std::pow(kSigma, 6) / 2.0 * half * half * std::cyl_bessel_k(2.0, g * z));
  }

  std::array<std::vector<double>, 5> value_;
  std::array<std::vector<double>, 5> slope_;
};

/// Three neighbours each, by hand.
class PlainTube {
 public:
  explicit PlainTube(bool on_sheet)
      : on_sheet_(on_sheet), x_(tube()), v_(x_.size()), f_(x_.size()), near_(x_.size()) {
    for (std::size_t i = 0; i < x_.size(); ++i) {
      int found = 0;
      for (std::size_t j = 0; j < x_.size(); ++j) {
        const Point way = way_to(i, j);
        const double r = std::sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
        if (j != i && r < 1.9) near_[i][static_cast<std::size_t>(found++)] = j;
      }
    }
    forces();
  }

  void step() {
    for (std::size_t i = 0; i < x_.size(); ++i) {
      for (std::size_t d = 0; d < 3; ++d) {
        v_[i][d] += 0.5 * kStep / kMass * f_[i][d];
        x_[i][d] += kStep * v_[i][d];
      }
    }
    forces();
    for (std::size_t i = 0; i < x_.size(); ++i) {
      for (std::size_t d = 0; d < 3; ++d) v_[i][d] += 0.5 * kStep / kMass * f_[i][d];
    }
  }

 private:
  Point way_to(std::size_t i, std::size_t j) const {
    Point way = {x_[j][0] - x_[i][0], x_[j][1] - x_[i][1], x_[j][2] - x_[i][2]};
    way[0] -= length_of_box() * std::floor(way[0] / length_of_box() + 0.5);
    return way;
  }

  void forces() {
    using namespace tomlin::plain::carbon;
    for (Point& f : f_) f = {0.0, 0.0, 0.0};
    for (std::size_t i = 0; i < x_.size(); ++i) {
      std::array<Point, 3> e{};
      std::array<double, 3> r{};
      for (std::size_t j = 0; j < 3; ++j) {
        e[j] = way_to(i, near_[i][j]);
        r[j] = std::sqrt(e[j][0] * e[j][0] + e[j][1] * e[j][1] + e[j][2] * e[j][2]);
        for (double& x : e[j]) x /= r[j];
      }
      std::array<Point, 3> gradient{};
      for (std::size_t j = 0; j < 3; ++j) {
        double zeta = 0.0;
        std::array<double, 3> cosine{};
        std::array<double, 3> slope{};
        for (std::size_t k = 0; k < 3; ++k) {
          if (k == j) continue;
          cosine[k] = e[j][0] * e[k][0] + e[j][1] * e[k][1] + e[j][2] * e[k][2];
          const double apart = kH - cosine[k];
          const double part = 1.0 / (kD2 + apart * apart);
          zeta += 1.0 + kC2 / kD2 - kC2 * part;
          slope[k] = -2.0 * kC2 * apart * part * part;
        }
        const double power = std::pow(kBeta * zeta, kN);
        const double order = std::pow(1.0 + power, -0.5 / kN);
        const double repulsion = kA * std::exp(-kLambda1 * r[j]);
        const double attraction = -kB * std::exp(-kLambda2 * r[j]);
        const double radial = 0.5 * (-kLambda1 * repulsion - kLambda2 * order * attraction);
        const double by_zeta = -0.25 * attraction * order * power / ((1.0 + power) * zeta);
        for (std::size_t d = 0; d < 3; ++d) gradient[j][d] += radial * e[j][d];
        for (std::size_t k = 0; k < 3; ++k) {
          if (k == j) continue;
          const double s = by_zeta * slope[k];
          for (std::size_t d = 0; d < 3; ++d) {
            gradient[j][d] += s / r[j] * (e[k][d] - cosine[k] * e[j][d]);
            gradient[k][d] += s / r[k] * (e[j][d] - cosine[k] * e[k][d]);
          }
        }
      }
      for (std::size_t j = 0; j < 3; ++j) {
        for (std::size_t d = 0; d < 3; ++d) {
          f_[i][d] += gradient[j][d];
          f_[near_[i][j]][d] -= gradient[j][d];
        }
      }
    }
    for (std::size_t i = 0; on_sheet_ && i < x_.size(); ++i) sheet_.add_force(x_[i], f_[i]);
  }

  bool on_sheet_;
  PlainSheet sheet_;
  std::vector<Point> x_;
  std::vector<Point> v_;
  std::vector<Point> f_;
  std::vector<std::array<std::size_t, 3>> near_;
};

/// `contact`: the type of the force of the sheet, with keys of its own; empty: there is none.
std::string scene(const std::string& contact) {
  std::string positions;
  for (const Point& x : tube()) {
    positions += "[" + std::to_string(x[0]) + ", " + std::to_string(x[1]) + ", " +
                 std::to_string(x[2]) + "], ";
  }
  using tomlin::digits;
  const std::string length = digits(length_of_box());
  const std::string width = digits(40 * std::numbers::sqrt3 * kBond);
  std::string text = "[scene]\nunits = \"metal\"\n[box]\nlengths = [" + length + ", " + width +
                     ", 60.0]\nperiodic = [true, true, false]\n[[body]]\nname = \"tube\"\n"
                     "type = \"particles\"\nparticle_mass = 12.011\npositions = [" +
                     positions +
                     "]\n[[force]]\ntype = \"tersoff\"\nbody = \"tube\"\nparameters = "
                     "\"lindsay_broido_2010\"\n[run]\nduration = 1e6\nintegrator = { type = "
                     "\"velocity_verlet\", dt = 1e-3 }\n";
  if (!contact.empty()) {
    text += "[[body]]\nname = \"sheet\"\ntype = \"graphene\"\nbond_length = 1.4388\ncells = [" +
            std::to_string(kCells) +
            ", 40]\ncentre = [0.0, 0.0, -7.2]\nparticle_mass = 12.011\ncoordinates = "
            "\"fixed\"\n[[force]]\nbodies = [\"tube\", \"sheet\"]\nepsilon = 0.002411\nsigma = "
            "3.4\ncutoff = 10.0\ntype = " +
            contact + "\n";
  }
  return text;
}

void BM_nanotube(benchmark::State& state, const std::string& contact) {
  static const tomlin::Registry components = tomlin::standard_registry();
  // Leaked on purpose, as in engine_benchmark.cpp.
  auto& engine = *new tomlin::Engine(
      tomlin::parse_scene(scene(contact), "benchmark.toml", components, {}), {});
  for (auto _ : state) engine.advance(1);
  tomlin::count_steps(state);
}

BENCHMARK_CAPTURE(BM_nanotube, alone, "")
    ->Name("nanotube_800/tomlin")
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(BM_nanotube, on_graphene, "\"lennard_jones\"")
    ->Name("nanotube_800 on graphene/tomlin")
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(BM_nanotube, on_field, "\"sheet_field\"\ntolerance = 1e-4")
    ->Name("nanotube_800 on field of graphene/tomlin")
    ->Unit(benchmark::kMicrosecond);

void BM_plain_nanotube(benchmark::State& state, bool on_sheet) {
  PlainTube plain(on_sheet);
  for (auto _ : state) plain.step();
  tomlin::count_steps(state);
}
BENCHMARK_CAPTURE(BM_plain_nanotube, on_field, true)
    ->Name("nanotube_800 on field of graphene/plain")
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(BM_plain_nanotube, alone, false)
    ->Name("nanotube_800/plain")
    ->Unit(benchmark::kMicrosecond);

// ---- one evaluation of Tersoff's potential, beside a twin in vectors ----------------------------

tomlin::plain::TersoffTwin twin(const std::vector<Point>& positions) {
  tomlin::plain::TersoffTwin made;
  made.count = positions.size();
  std::vector<std::vector<std::size_t>> near(made.count);
  for (std::size_t j = 0; j < 3; ++j) {
    made.x[j].resize(made.count);
    made.force[j].resize(made.count);
    made.near[j].resize(made.count);
    made.back[j].resize(made.count);
    made.shift[j].resize(made.count);
    made.gradient[j].resize(3 * made.count);
    for (std::size_t i = 0; i < made.count; ++i) made.x[j][i] = positions[i][j];
  }
  for (std::size_t i = 0; i < made.count; ++i) {
    for (std::size_t j = 0; j < made.count; ++j) {
      double way = positions[j][0] - positions[i][0];
      const double shift = -length_of_box() * std::floor(way / length_of_box() + 0.5);
      way += shift;
      const double r =
          std::hypot(way, positions[j][1] - positions[i][1], positions[j][2] - positions[i][2]);
      if (j == i || r > 1.9) continue;
      const std::size_t k = near[i].size();
      if (k == 3) throw std::logic_error("an atom has more than three neighbours");
      near[i].push_back(j);
      made.near[k][i] = static_cast<std::int64_t>(j);
      made.shift[k][i] = shift;
    }
    if (near[i].size() != 3) throw std::logic_error("an atom has fewer than three neighbours");
  }
  for (std::size_t i = 0; i < made.count; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::vector<std::size_t>& of_it = near[near[i][k]];
      const auto me = std::find(of_it.begin(), of_it.end(), i) - of_it.begin();
      made.back[k][i] =
          me * static_cast<std::int64_t>(made.count) + static_cast<std::int64_t>(near[i][k]);
    }
  }
  return made;
}

tomlin::plain::TersoffTwinKernel twin_kernel() {
  switch (tomlin::chosen_instruction_set()) {
#if defined(TOMLIN_KERNELS_AVX512)
    case tomlin::InstructionSet::avx512:
      return &tomlin::plain::tersoff_twin_avx512;
#endif
#if defined(TOMLIN_KERNELS_AVX2)
    case tomlin::InstructionSet::avx2:
      return &tomlin::plain::tersoff_twin_avx2;
#endif
    default:
      return &tomlin::plain::tersoff_twin_baseline;
  }
}

/// Positions of the engine's tube; the force of Tersoff's potential is its only one.
std::vector<Point> positions_of(tomlin::EvaluatedScene& evaluated) {
  std::vector<Point> all(tube().size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t d = 0; d < 3; ++d) all[i][d] = evaluated.position(i, d);
  }
  return all;
}

void BM_tersoff(benchmark::State& state) {
  // Leaked on purpose, as above.
  auto& evaluated = *new tomlin::EvaluatedScene(scene(""));
  for (auto _ : state) evaluated.evaluate();
  tomlin::count_steps(state);
}
BENCHMARK(BM_tersoff)->Name("tersoff_800/tomlin")->Unit(benchmark::kMicrosecond);

void BM_tersoff_twin(benchmark::State& state) {
  tomlin::EvaluatedScene evaluated(scene(""));
  evaluated.evaluate();
  tomlin::plain::TersoffTwin made = twin(positions_of(evaluated));
  const tomlin::plain::TersoffTwinKernel kernel = twin_kernel();
  kernel(made);
  double most = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < made.count; ++i) {
      most = std::max(most, std::abs(made.force[axis][i] - evaluated.force(i, axis)));
    }
  }
  if (!(most < 1e-9)) state.SkipWithError("the forces of the twin differ from the engine's");
  for (auto _ : state) kernel(made);
  tomlin::count_steps(state);
}
BENCHMARK(BM_tersoff_twin)->Name("tersoff_800/plain")->Unit(benchmark::kMicrosecond);

// ---- threads ------------------------------------------------------------------------------------

/// A free layer of graphene at 300 K over a fixed one, `cells` along each side: 4 cells^2 atoms.
std::string layers(int cells) {
  const std::string length = std::to_string(cells);
  return "[scene]\nunits = \"metal\"\n[parameters]\nb = 1.4388\n[box]\nlengths = [\"" + length +
         " * 3 * b\", \"" + length +
         " * sqrt(3) * b\", 60.0]\nperiodic = [true, true, false]\n[[body]]\nname = "
         "\"layer\"\ntype = \"graphene\"\nbond_length = \"b\"\ncells = [" +
         length + ", " + length +
         "]\ncentre = [0.4, 0.3, 3.4]\nparticle_mass = 12.011\nstart_temperature = "
         "300.0\n[[body]]\nname = \"sheet\"\ntype = \"graphene\"\nbond_length = \"b\"\ncells = [" +
         length + ", " + length +
         "]\nparticle_mass = 12.011\ncoordinates = \"fixed\"\n[[force]]\ntype = "
         "\"tersoff\"\nbody = \"layer\"\nparameters = \"lindsay_broido_2010\"\n[[force]]\ntype "
         "= \"lennard_jones\"\nbodies = [\"layer\", \"sheet\"]\nepsilon = 0.002411\nsigma = "
         "3.4\ncutoff = 10.0\n[run]\nseed = 1\nduration = 1e6\nintegrator = { type = "
         "\"velocity_verlet\", dt = 1e-3 }\n";
}

void BM_layers(benchmark::State& state) {
  static const tomlin::Registry components = tomlin::standard_registry();
  const std::unique_ptr<tomlin::ThreadTeam> team =
      tomlin::team_of(static_cast<std::size_t>(state.range(1)));
  tomlin::RunOptions options;
  options.watches_energy = false;
  if (team) options.team = &team->team();
  tomlin::Engine engine(tomlin::parse_scene(layers(static_cast<int>(state.range(0))),
                                            "benchmark.toml", components, {}),
                        options);
  for (auto _ : state) engine.advance(1);
  tomlin::count_steps(state);
}
BENCHMARK(BM_layers)
    ->Name("graphene on graphene (cells, threads)")
    ->Args({16, 1})
    ->Args({16, 2})
    ->Args({50, 1})
    ->Args({50, 2})
    ->UseRealTime()
    ->Unit(benchmark::kMicrosecond);

}  // namespace
