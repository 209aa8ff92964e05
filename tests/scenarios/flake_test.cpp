// scenarios/flake: a flake that cannot turn is a tip in two dimensions; one that can turn locks in.

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "framework/run/results/observables.hpp"
#include "tests/scenarios/scenario_fixture.hpp"

namespace tomlin::test {
namespace {

struct Atom {
  double x = 0.0;
  double y = 0.0;
};

/// A hexagon of 6 n^2 atoms, built from its hexagons of carbon: corners of all cells within n - 1
/// steps from the middle one, each once.
std::vector<Atom> hexagon(int n, double phi) {
  std::vector<Atom> atoms;
  const double bond = 1.0 / std::sqrt(3.0);
  for (int i = 1 - n; i < n; ++i) {
    for (int j = 1 - n; j < n; ++j) {
      if (std::abs(i + j) >= n) continue;
      for (int corner = 0; corner < 6; ++corner) {
        const double angle = kPi / 6.0 + corner * kPi / 3.0;
        const Atom atom{i + 0.5 * j + bond * std::cos(angle),
                        0.5 * std::sqrt(3.0) * j + bond * std::sin(angle)};
        bool is_new = true;
        for (const Atom& known : atoms) {
          is_new = is_new && std::hypot(known.x - atom.x, known.y - atom.y) > 0.1;
        }
        if (is_new) atoms.push_back(atom);
      }
    }
  }
  for (Atom& atom : atoms) {
    atom = {atom.x * std::cos(phi) - atom.y * std::sin(phi),
            atom.x * std::sin(phi) + atom.y * std::cos(phi)};
  }
  return atoms;
}

/// The sum over atoms of cos(2 pi G.r), G = (0, 2/sqrt 3).
double form_factor(const std::vector<Atom>& atoms) {
  double sum = 0.0;
  for (const Atom& atom : atoms) sum += std::cos(4.0 * kPi * atom.y / std::sqrt(3.0));
  return sum;
}

const std::string kHeldFlake = "flake/held.toml";
const std::string kFreeFlake = "flake/free.toml";

double mean_pull(const RunResult& result, const char* axis) {
  return observable(result, std::string("driver.mean_force.") + axis).value();
}

/// The scene of the held flake with a tip of another amplitude in its place.
std::string tip_of(double amplitude) {
  return R"(
[[body]]
type = "point"
position = [0.5, )" +
         text_of(0.5 / std::sqrt(3.0)) + tables(R"(]
particle_mass = 1.0
[[force]] | name = "driver" | type = "driving_spring" | stiffness = 1.0 | velocity = [1e-3, 0.0]
[[force]] | type = "lattice_substrate" | lattice = "honeycomb" | period = 1.0 | amplitude = )") +
         text_of(amplitude) + tables(R"(
[run] | dynamics = "quasistatic" | duration = 6000.0
[measure] | from = 3 | to = 6 | in = "driver_periods"
)");
}

/// Equilibria are followed to this part of a force of order 1, slips included.
constexpr double kFollowed = 1e-7;

TEST(Flake, ThatCannotTurnIsATip) {
  for (const int n : {2, 4}) {
    for (const double phi : {0.0, 0.04, 0.08}) {
      const auto atoms = hexagon(n, phi);
      ASSERT_EQ(atoms.size(), static_cast<std::size_t>(6 * n * n));
      const RunResult flake =
          run_shipped(kHeldFlake, {{"n", std::to_string(n)}, {"phi", text_of(phi)}});
      const RunResult tip = run_text(tip_of(5e-3 * form_factor(atoms)));
      EXPECT_GT(mean_pull(flake, "x"), 1e-2);
      EXPECT_NEAR(mean_pull(flake, "x"), mean_pull(tip, "x"), kFollowed) << n << ", " << phi;
      EXPECT_NEAR(mean_pull(flake, "y"), mean_pull(tip, "y"), kFollowed) << n << ", " << phi;
      // The control: an amplitude that is off by a thousandth shows.
      const RunResult other = run_text(tip_of(1.001 * 5e-3 * form_factor(atoms)));
      EXPECT_GT(std::abs(mean_pull(other, "x") - mean_pull(tip, "x")), 1e2 * kFollowed);
    }
  }
}

TEST(Flake, InStepHalfOfTheAtomsCancel) {
  for (const int n : {1, 2, 3, 5}) {
    EXPECT_NEAR(form_factor(hexagon(n, 0.0)), -3.0 * n * n, 1e-9);  // -N/2
  }
}

/// The table of the page: the amplitude of a flake out of step does not grow with its size.
TEST(Flake, OutOfStepTheRimIsLeft) {
  constexpr double kOfTable = 5e-4;
  constexpr int kAngles = 100;
  const std::vector<std::pair<int, double>> at_30_degrees = {
      {2, 0.985}, {3, 0.915}, {4, 0.392}, {6, 1.990}, {10, 1.172}};
  for (const auto& [n, amplitude] : at_30_degrees) {
    EXPECT_NEAR(std::abs(form_factor(hexagon(n, kPi / 6.0))), amplitude, kOfTable) << n;
    double most = 0.0;
    for (int k = 0; k <= kAngles; ++k) {
      const double phi = 0.2 + (kPi / 6.0 - 0.2) * k / kAngles;
      most = std::max(most, std::abs(form_factor(hexagon(n, phi))));
    }
    EXPECT_LT(most, 6.4) << n;
  }
}

TEST(Flake, SixtyDegreesChangeNothing) {
  for (const double phi : {0.0, 0.05, -0.08}) {
    const RunResult one = run_shipped(kHeldFlake, {{"phi", text_of(phi)}});
    const RunResult other = run_shipped(kHeldFlake, {{"phi", "pi/3 + " + text_of(phi)}});
    EXPECT_NEAR(mean_pull(one, "x"), mean_pull(other, "x"), kFollowed) << phi;
  }
}

TEST(Flake, OutOfStepItSlidesWithoutLoss) {
  for (const int n : {2, 3, 4, 6}) {
    const RunResult result = run_shipped(kHeldFlake, {{"phi", "pi/6"}, {"n", std::to_string(n)}});
    EXPECT_EQ(observable(result, "events.slips").value(), 0.0) << n;
    EXPECT_NEAR(mean_pull(result, "x"), 0.0, 1e-9) << n;
  }
}

TEST(Flake, ThatMayTurnLocksIn) {
  const RunResult in_step = run_shipped(kFreeFlake, {{"phi", "0.0"}});
  EXPECT_NEAR(mean_pull(in_step, "x"), 0.549, 1e-3);
  for (const double phi : {0.1, 0.2}) {
    const RunResult result = run_shipped(kFreeFlake, {{"phi", text_of(phi)}});
    EXPECT_NEAR(observable(result, "flake.rotation").value(), -phi, 1e-6);
    EXPECT_NEAR(mean_pull(result, "x"), mean_pull(in_step, "x"), 1e-4);
  }
  const RunResult lubricated = run_shipped(kFreeFlake, {{"phi", "0.3"}});
  EXPECT_NEAR(mean_pull(lubricated, "x"), 0.01, 1e-5);  // the drag
}

}  // namespace
}  // namespace tomlin::test
