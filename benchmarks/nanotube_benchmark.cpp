// A (10,0) nanotube under Tersoff's potential, 800 atoms in a periodic box, one step of velocity
// Verlet: the engine, and a loop as a one-off program would have it, which knows that each atom has
// three neighbours for ever. With a fixed sheet of graphene below it: the engine alone.
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "framework/run/engine.hpp"
#include "framework/scene/scene.hpp"
#include "framework/standard_registry.hpp"

namespace {

constexpr int kCells = 20;
constexpr double kBond = 1.4388;
constexpr double kStep = 1e-3;
constexpr double kMass = 12.011 * 1.0364269e-4;

using Place = std::array<double, 3>;

double length_of_box() { return kCells * 3.0 * kBond; }

std::vector<Place> tube() {
  constexpr int kAround = 10;
  const double radius = kAround * std::sqrt(3.0) * kBond / (2.0 * std::numbers::pi);
  struct Circle {
    double height;
    double turned;
  };
  constexpr std::array<Circle, 4> kCircles = {{{0.0, 0.0}, {0.5, 0.5}, {1.5, 0.5}, {2.0, 0.0}}};
  std::vector<Place> places;
  for (int cell = 0; cell < kCells; ++cell) {
    for (const Circle& circle : kCircles) {
      for (int k = 0; k < kAround; ++k) {
        const double angle = 2.0 * std::numbers::pi * (k + circle.turned) / kAround;
        // Every atom off its place by some hundredths of a bond.
        const double off = 0.03 * std::sin(7.0 * static_cast<double>(places.size()));
        places.push_back({(3.0 * cell + circle.height) * kBond + off,
                          radius * std::cos(angle) - off, radius * std::sin(angle) + 0.5 * off});
      }
    }
  }
  return places;
}

/// Three neighbours each, by hand.
class PlainTube {
 public:
  PlainTube() : x_(tube()), v_(x_.size()), f_(x_.size()), near_(x_.size()) {
    for (std::size_t i = 0; i < x_.size(); ++i) {
      int found = 0;
      for (std::size_t j = 0; j < x_.size(); ++j) {
        const Place way = way_to(i, j);
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
  Place way_to(std::size_t i, std::size_t j) const {
    Place way = {x_[j][0] - x_[i][0], x_[j][1] - x_[i][1], x_[j][2] - x_[i][2]};
    way[0] -= length_of_box() * std::floor(way[0] / length_of_box() + 0.5);
    return way;
  }

  void forces() {
    constexpr double kA = 1393.6;
    constexpr double kB = 430.0;
    constexpr double kLambda1 = 3.4879;
    constexpr double kLambda2 = 2.2119;
    constexpr double kBeta = 1.5724e-7;
    constexpr double kN = 0.72751;
    constexpr double kC2 = 38049.0 * 38049.0;
    constexpr double kD2 = 4.3484 * 4.3484;
    constexpr double kH = -0.930;
    for (Place& f : f_) f = {0.0, 0.0, 0.0};
    for (std::size_t i = 0; i < x_.size(); ++i) {
      std::array<Place, 3> e{};
      std::array<double, 3> r{};
      for (std::size_t j = 0; j < 3; ++j) {
        e[j] = way_to(i, near_[i][j]);
        r[j] = std::sqrt(e[j][0] * e[j][0] + e[j][1] * e[j][1] + e[j][2] * e[j][2]);
        for (double& x : e[j]) x /= r[j];
      }
      std::array<Place, 3> gradient{};
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
  }

  std::vector<Place> x_;
  std::vector<Place> v_;
  std::vector<Place> f_;
  std::vector<std::array<std::size_t, 3>> near_;
};

std::string scene(bool on_sheet) {
  std::string positions;
  for (const Place& x : tube()) {
    positions += "[" + std::to_string(x[0]) + ", " + std::to_string(x[1]) + ", " +
                 std::to_string(x[2]) + "], ";
  }
  const std::string length = std::to_string(length_of_box());
  std::string text = "[scene]\nunits = \"metal\"\n[box]\nlengths = [" + length +
                     ", 99.68, 60.0]\nperiodic = [true, true, false]\n[[body]]\nname = \"tube\"\n"
                     "type = \"particles\"\nparticle_mass = 12.011\npositions = [" +
                     positions +
                     "]\n[[force]]\ntype = \"tersoff\"\nbody = \"tube\"\nparameters = "
                     "\"lindsay_broido_2010\"\n[run]\nduration = 1e6\nintegrator = { type = "
                     "\"velocity_verlet\", dt = 1e-3 }\n";
  if (on_sheet) {
    text += "[[body]]\nname = \"sheet\"\ntype = \"graphene\"\nbond_length = 1.4388\ncells = [" +
            std::to_string(kCells) +
            ", 40]\ncentre = [0.0, 0.0, -7.2]\nparticle_mass = 12.011\ncoordinates = "
            "\"fixed\"\n[[force]]\ntype = \"lennard_jones\"\nbodies = [\"tube\", "
            "\"sheet\"]\nepsilon = 0.002411\nsigma = 3.4\ncutoff = 10.0\n";
  }
  return text;
}

void count_steps(benchmark::State& state) {
  state.counters["s_per_step"] =
      benchmark::Counter(static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void run(benchmark::State& state, const std::string& text) {
  static const tomlin::Registry components = tomlin::standard_registry();
  // Leaked on purpose, as in engine_benchmark.cpp.
  auto& engine =
      *new tomlin::Engine(tomlin::parse_scene(text, "benchmark.toml", components, {}), {});
  for (auto _ : state) engine.advance(1);
  count_steps(state);
}

void BM_nanotube(benchmark::State& state) { run(state, scene(false)); }
BENCHMARK(BM_nanotube)->Name("nanotube_800/tomlin")->Unit(benchmark::kMicrosecond);

void BM_nanotube_on_graphene(benchmark::State& state) { run(state, scene(true)); }
BENCHMARK(BM_nanotube_on_graphene)
    ->Name("nanotube_800 on graphene/tomlin")
    ->Unit(benchmark::kMicrosecond);

void BM_plain_nanotube(benchmark::State& state) {
  static PlainTube plain;
  for (auto _ : state) plain.step();
  count_steps(state);
}
BENCHMARK(BM_plain_nanotube)->Name("nanotube_800/plain")->Unit(benchmark::kMicrosecond);

}  // namespace
