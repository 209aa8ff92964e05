// Silicon carbide under Tersoff's potential of two species, 216 atoms in a periodic box, one
// evaluation of all forces: the engine, and a loop over lists as a one-off program would have it.
// Second neighbours of silicon are just beyond the cutoff.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "benchmarks/counters.hpp"
#include "benchmarks/evaluated_scene.hpp"

namespace {

using Point = std::array<double, 3>;

constexpr int kCells = 3;
constexpr double kLattice = 4.36;
constexpr double kBox = kCells * kLattice;

/// J. Tersoff, Phys. Rev. B 39, 5566 (1989); eV, Angstrom.
struct Element {
  double c, d, h, n, beta;
};
constexpr Element kElements[2] = {{38049.0, 4.3484, -0.57058, 0.72751, 1.5724e-7},
                                  {100390.0, 16.217, -0.59825, 0.78734, 1.1e-6}};
struct Bond {
  double lambda1, lambda2, a, b, inner, outer;
};
constexpr Bond kBonds[2][2] = {
    {{3.4879, 2.2119, 1393.6, 346.74, 1.8, 2.1}, {2.9839, 1.97205, 1597.311, 395.145, 2.21, 2.51}},
    {{2.9839, 1.97205, 1597.311, 395.145, 2.21, 2.51}, {2.4799, 1.7322, 1830.8, 471.18, 2.7, 3.0}}};

std::vector<Point> crystal_positions() {
  constexpr double kFace[4][3] = {
      {0.0, 0.0, 0.0}, {0.0, 0.5, 0.5}, {0.5, 0.0, 0.5}, {0.5, 0.5, 0.0}};
  std::vector<Point> all;
  for (int cell = 0; cell < kCells * kCells * kCells; ++cell) {
    const int at[3] = {cell % kCells, cell / kCells % kCells, cell / kCells / kCells};
    for (const auto& face : kFace) {
      for (const double quarter : {0.0, 0.25}) {
        Point position{};
        for (std::size_t d = 0; d < 3; ++d) {
          // Displacements are like those at a temperature of some hundred kelvin.
          const double moved = 0.08 * std::sin(12.9898 * static_cast<double>(3 * all.size() + d));
          position[d] = (at[d] + face[d] + quarter) * kLattice + moved;
        }
        all.push_back(position);
      }
    }
  }
  return all;
}

/// The elements of these atoms alternate: carbon, silicon and so on.
std::size_t element(std::size_t atom) { return atom % 2; }

std::string scene() {
  using tomlin::digits;
  std::string positions;
  std::string species;
  for (const Point& position : crystal_positions()) {
    positions += "[" + digits(position[0]) + ", " + digits(position[1]) + ", " +
                 digits(position[2]) + "],\n";
    species += species.size() % 10 == 0 ? "\"C\", " : "\"S\", ";
  }
  std::string entries;
  const char* const names[2] = {"C", "S"};
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t j = 0; j < 2; ++j) {
      for (std::size_t k = 0; k < 2; ++k) {
        const Element& e = kElements[i];
        const Bond& of_bond = kBonds[i][j];
        const Bond& third = kBonds[i][k];
        entries += std::string(names[i]) + " " + names[j] + " " + names[k] + " 3 1 0";
        for (const double x : {e.c, e.d, e.h, e.n, e.beta, of_bond.lambda2, of_bond.b,
                               0.5 * (third.inner + third.outer), 0.5 * (third.outer - third.inner),
                               of_bond.lambda1, of_bond.a}) {
          entries += " " + digits(x);
        }
        entries += "\n";
      }
    }
  }
  const std::string box = digits(kBox);
  return "[scene]\nunits = \"metal\"\n[box]\nlengths = [" + box + ", " + box + ", " + box +
         "]\nperiodic = [true, true, true]\n[[body]]\ntype = \"particles\"\nparticle_mass = "
         "20.0\npositions = [" +
         positions + "]\nspecies = [" + species +
         "]\n[[force]]\ntype = \"tersoff\"\nentries = \"\"\"\n" + entries +
         "\"\"\"\n[run]\nduration = 1.0\nintegrator = { type = \"velocity_verlet\", dt = 1e-3 }\n";
}

/// Numbers of atoms within reach are found once, as lists are kept for many steps.
class PlainCarbide {
 public:
  PlainCarbide()
      : position_(crystal_positions()), near_(position_.size()), force(position_.size()) {
    for (std::size_t i = 0; i < position_.size(); ++i) {
      for (std::size_t j = 0; j < position_.size(); ++j) {
        const double reach = kBonds[element(i)][element(j)].outer + 0.1;
        Point way{};
        if (j != i && distance(i, j, way) < reach) near_[i].push_back(j);
      }
    }
  }

  void evaluate() {
    std::fill(force.begin(), force.end(), Point{});
    for (std::size_t i = 0; i < position_.size(); ++i) forces_of(i);
  }

 private:
  struct Row {
    std::size_t atom;
    Point direction;
    double r, cutoff, slope;
    Point gradient;
  };

  double distance(std::size_t i, std::size_t j, Point& way) const {
    double squared = 0.0;
    for (std::size_t d = 0; d < 3; ++d) {
      way[d] = position_[j][d] - position_[i][d];
      way[d] -= kBox * std::floor(way[d] / kBox + 0.5);
      squared += way[d] * way[d];
    }
    return std::sqrt(squared);
  }

  void forces_of(std::size_t i) {
    constexpr double kHalfTurn = 3.14159265358979323846;
    const Element& e = kElements[element(i)];
    rows_.clear();
    for (const std::size_t j : near_[i]) {
      Row row{};
      row.atom = j;
      const Bond& bond = kBonds[element(i)][element(j)];
      row.r = distance(i, j, row.direction);
      if (row.r >= bond.outer) continue;
      for (double& x : row.direction) x /= row.r;
      row.cutoff = 1.0;
      if (row.r > bond.inner) {
        const double turn = kHalfTurn / (bond.outer - bond.inner);
        const double phase = turn * (row.r - 0.5 * (bond.inner + bond.outer));
        row.cutoff = 0.5 - 0.5 * std::sin(phase);
        row.slope = -0.5 * turn * std::cos(phase);
      }
      rows_.push_back(row);
    }
    const double c2 = e.c * e.c;
    const double d2 = e.d * e.d;
    for (Row& one : rows_) {
      double zeta = 0.0;
      terms_.clear();
      for (const Row& other : rows_) {
        double cosine = 0.0;
        for (std::size_t d = 0; d < 3; ++d) cosine += one.direction[d] * other.direction[d];
        const double apart = e.h - cosine;
        const double part = c2 / (d2 + apart * apart);
        terms_.push_back(
            {cosine, 1.0 + apart * apart * part / d2, -2.0 * apart * part * part / c2});
        if (&other != &one) zeta += other.cutoff * terms_.back()[1];
      }
      const Bond& bond = kBonds[element(i)][element(one.atom)];
      double order = 1.0;
      double order_slope = 0.0;
      if (zeta > 0.0) {
        const double power = std::pow(e.beta * zeta, e.n);
        order = std::pow(1.0 + power, -0.5 / e.n);
        order_slope = -0.5 * order * power / ((1.0 + power) * zeta);
      }
      const double repulsion = bond.a * std::exp(-bond.lambda1 * one.r);
      const double attraction = -bond.b * std::exp(-bond.lambda2 * one.r);
      const double radial =
          0.5 * (one.slope * (repulsion + order * attraction) -
                 one.cutoff * (bond.lambda1 * repulsion + bond.lambda2 * order * attraction));
      const double by_zeta = 0.5 * one.cutoff * attraction * order_slope;
      for (std::size_t d = 0; d < 3; ++d) one.gradient[d] += radial * one.direction[d];
      for (std::size_t k = 0; k < rows_.size(); ++k) {
        Row& other = rows_[k];
        if (&other == &one) continue;
        const auto& [cosine, angle, angle_slope] = terms_[k];
        const double by_cosine = by_zeta * other.cutoff * angle_slope;
        const double by_distance = by_zeta * other.slope * angle;
        for (std::size_t d = 0; d < 3; ++d) {
          one.gradient[d] += by_cosine * (other.direction[d] - cosine * one.direction[d]) / one.r;
          other.gradient[d] +=
              by_distance * other.direction[d] +
              by_cosine * (one.direction[d] - cosine * other.direction[d]) / other.r;
        }
      }
    }
    for (const Row& row : rows_) {
      for (std::size_t d = 0; d < 3; ++d) {
        force[row.atom][d] -= row.gradient[d];
        force[i][d] += row.gradient[d];
      }
    }
  }

  std::vector<Point> position_;
  std::vector<std::vector<std::size_t>> near_;
  std::vector<Row> rows_;
  std::vector<std::array<double, 3>> terms_;

 public:
  std::vector<Point> force;
};

void BM_carbide(benchmark::State& state) {
  // Leaked on purpose, as in engine_benchmark.cpp.
  auto& crystal = *new tomlin::EvaluatedScene(scene());
  for (auto _ : state) crystal.evaluate();
  tomlin::count_steps(state);
}
BENCHMARK(BM_carbide)->Name("carbide_216/tomlin")->Unit(benchmark::kMicrosecond);

void BM_carbide_plain(benchmark::State& state) {
  tomlin::EvaluatedScene crystal(scene());
  crystal.evaluate();
  PlainCarbide plain;
  plain.evaluate();
  double most = 0.0;
  for (std::size_t i = 0; i < plain.force.size(); ++i) {
    for (std::size_t d = 0; d < 3; ++d) {
      most = std::max(most, std::abs(plain.force[i][d] - crystal.force(i, d)));
    }
  }
  if (!(most < 1e-9)) state.SkipWithError("the forces of the loop differ from the engine's");
  for (auto _ : state) plain.evaluate();
  tomlin::count_steps(state);
}
BENCHMARK(BM_carbide_plain)->Name("carbide_216/plain")->Unit(benchmark::kMicrosecond);

}  // namespace
