#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/numbers/random.hpp"
#include "tests/support/scenes.hpp"

// Bonds as modes of a shape hold while the shape does: over random bodies, exponential_verlet is
// refused, fails, or agrees with a scheme that knows nothing of modes.

namespace tomlin::test {
namespace {

/// Relative error of forces, and so of results: what may be lost before a run fails, twice over,
/// and the step's own second order.
constexpr double kAllowed = 0.03;

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : seed_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * 0.5 * (1.0 + uniform_symmetric({seed_, 0}, {next_++, 0, 0, 0}));
  }
  double power(double low, double high) { return std::exp(between(std::log(low), std::log(high))); }
  int whole(int low, int high) { return static_cast<int>(between(low, high + 1 - 1e-9)); }

 private:
  std::uint64_t seed_;
  std::uint64_t next_ = 0;
};

enum class Shape { ring, chain, strip, network, line, space };

struct Network {
  std::vector<std::vector<double>> positions;
  std::vector<std::pair<int, int>> bonds;
};

Network network_of(Shape shape, Draw& draw) {
  Network made;
  const int n = draw.whole(4, 7);
  const auto join_all = [&](int i, int j) { made.bonds.emplace_back(i, j); };
  for (int i = 0; i < n; ++i) {
    const double angle = 2.0 * 3.14159265358979 * i / n;
    switch (shape) {
      case Shape::ring:
      case Shape::network:
        made.positions.push_back({0.7 * std::cos(angle) + draw.between(-0.05, 0.05),
                                  0.7 + 0.7 * std::sin(angle) + draw.between(-0.05, 0.05)});
        break;
      case Shape::chain:
        made.positions.push_back({0.6 * i, 0.3 + draw.between(0.0, 0.1)});
        break;
      case Shape::strip:
        made.positions.push_back({0.4 * i, i % 2 == 0 ? 0.1 : 0.7});
        break;
      case Shape::line:
        made.positions.push_back({0.6 * i});
        break;
      case Shape::space:
        made.positions.push_back({0.6 * i, 0.2 * (i % 2), 0.1 * i});
        break;
    }
    if (i > 0) join_all(i - 1, i);
    if (shape == Shape::strip && i > 1) join_all(i - 2, i);
  }
  if (shape == Shape::ring || shape == Shape::network) join_all(0, n - 1);
  if (shape == Shape::network) {
    for (int i = 0; i < n; ++i) {
      for (int j = i + 2; j < n; ++j) {
        if (!(i == 0 && j == n - 1) && draw.between(0.0, 1.0) < 0.6) join_all(i, j);
      }
    }
  }
  return made;
}

std::string list_of(const std::vector<double>& numbers) {
  std::string text = "[";
  for (const double x : numbers) text += (text.size() > 1 ? ", " : "") + digits(x);
  return text + "]";
}

struct Drawn {
  std::string body;  ///< and everything but the integrator
  double dt = 0.0;
};

Drawn scene_drawn(Shape shape, Draw& draw) {
  const Network network = network_of(shape, draw);
  std::vector<double> rests;
  std::string pairs;
  const bool rests_at_zero = draw.between(0.0, 1.0) < 0.15;
  const double strain = draw.between(0.0, 1.0) < 0.5 ? 0.0 : draw.between(-0.05, 0.05);
  for (const auto& [i, j] : network.bonds) {
    double square = 0.0;
    for (std::size_t d = 0; d < network.positions[i].size(); ++d) {
      square += std::pow(network.positions[j][d] - network.positions[i][d], 2);
    }
    rests.push_back(rests_at_zero ? 0.0 : std::sqrt(square) * (1.0 - strain));
    pairs += (pairs.empty() ? "[" : ", [") + std::to_string(i) + ", " + std::to_string(j) + "]";
  }
  std::string positions;
  for (const auto& position : network.positions) {
    positions += (positions.empty() ? "" : ", ") + list_of(position);
  }
  const std::size_t axes = network.positions.front().size();
  std::vector<double> velocity(axes, 0.0);
  velocity[0] = draw.between(0.1, 0.3);
  const std::string n = std::to_string(network.positions.size());
  Drawn drawn;
  drawn.dt = draw.power(1e-3, 1e-2);
  drawn.body =
      "[[body]]\nname = \"body\"\ntype = \"particles\"\npositions = [" + positions +
      "]\nparticle_mass = \"1 / " + n + "\"\n[[force]]\ntype = \"harmonic_bonds\"\npairs = [" +
      pairs + "]\nstiffness = " + digits(draw.power(1e2, 1e5)) +
      "\nrest_lengths = " + list_of(rests) +
      "\n[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = 1.5\n"
      "velocity = " +
      list_of(velocity) + "\n[[force]]\ntype = \"viscous_damping\"\ncoefficient = \"1.1 / " + n +
      "\"\n[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = \"0.2 / " + n +
      "\"\nperiod = 0.9\n" + (axes > 1 ? "decay = 0.7\n" : "") +
      "[run]\nduration = 4.0\nledger = true\nintegrator = ";
  return drawn;
}

/// Counts of a shape's scenes: all, and those that gave numbers.
struct Tally {
  int drawn = 0;
  int ran = 0;
};

Tally compare(Shape shape, int scenes) {
  Tally tally;
  for (int seed = 0; seed < scenes; ++seed) {
    Draw draw(1000 * static_cast<int>(shape) + seed);
    const Drawn drawn = scene_drawn(shape, draw);
    const std::string text =
        drawn.body + "{ type = \"exponential_verlet\", dt = " + digits(drawn.dt) + " }\n";
    ++tally.drawn;
    if (!refusal(text).empty()) continue;
    const RunResult found = run_text(text);
    if (found.status != RunStatus::finished) continue;
    ++tally.ran;
    const RunResult exact = run_text(drawn.body + adaptive(1e-9, "dop853") + "\n");
    if (exact.status != RunStatus::finished) continue;
    SCOPED_TRACE(text);
    const auto near = [](double a, double b, double scale) { EXPECT_NEAR(a, b, kAllowed * scale); };
    const double force = 1.1 * 0.1 + 0.2;  // friction's and the substrate's, about
    near(found.driver(0)["mean_force"][0], exact.driver(0)["mean_force"][0], force);
    near(found.body(0)["centre_of_mass"][0], exact.body(0)["centre_of_mass"][0], 0.3);
    near(*found.group("energy")["heat_out"], *exact.group("energy")["heat_out"],
         0.1 + *exact.group("energy")["heat_out"]);
  }
  return tally;
}

TEST(ExponentialShape, LooseRingsAndChainsInThePlaneAreRefused) {
  EXPECT_LE(compare(Shape::ring, 20).ran, 0);
  EXPECT_LE(compare(Shape::chain, 20).ran, 0);
}

TEST(ExponentialShape, WhatIsLooseIsRefused) {
  const auto ring = [](const std::string& pairs, const std::string& rests) {
    return tables(R"([[body]] | name = "ring" | type = "ring" | count = 5 | radius = 0.7
centre = [0.0, 0.7] | particle_mass = 0.2
[[force]] | type = "harmonic_bonds" | pairs = )") +
           pairs + "\nstiffness = 1e4\n" + rests + tables(R"(
[[force]] | name = "driver" | type = "driving_spring" | stiffness = 1.5 | velocity = [0.2, 0.0]
[[force]] | type = "sinusoidal_substrate" | amplitude = 0.06 | period = 0.9 | decay = 0.7
[run] | duration = 20.0 | integrator = { type = "exponential_verlet", dt = 5e-3 }
)");
  };
  const std::string open = "[[0, 1], [1, 2], [2, 3], [3, 4], [4, 0]]";
  // It bends freely in two ways, or buckles.
  for (const auto& [rests, ways] : {std::pair("", true), std::pair("rest_lengths = 0.9", false)}) {
    const std::string text = ring(open, rests);
    EXPECT_EQ(brief_refusal(text),
              "25:14 run.integrator.type = \"exponential_verlet\" [integrator.unsuitable]");
    EXPECT_EQ(refusal(text).find(" 2 ") != std::string::npos, ways) << refusal(text);
  }
  EXPECT_EQ(refusal(ring("\"all\"", "")), "");
  EXPECT_EQ(run_text(ring("\"all\"", "")).status, RunStatus::finished);
  // Held by its tension alone, which is soft across the bonds.
  const RunResult tense = run_text(ring(open, "rest_lengths = 0.82"));
  EXPECT_EQ(tense.status, RunStatus::failed);
  if (tense.failure) {
    EXPECT_EQ(tense.failure->body, "ring");
    EXPECT_NE(tense.failure->what.find("left the shape"), std::string::npos) << tense.failure->what;
    EXPECT_NE(tense.failure->cause.find("velocity_verlet"), std::string::npos);
  }
}

/// When shapes are looked at, and against what, goes on with a run.
TEST(ExponentialShape, ARunThatGoesOnHasTheSameBits) {
  int ran = 0;
  for (int seed = 0; seed < 8; ++seed) {
    Draw draw(1000 * static_cast<int>(Shape::strip) + seed);
    const Drawn drawn = scene_drawn(Shape::strip, draw);
    const std::string text = drawn.body + "{ type = \"exponential_verlet\", dt = 2e-3 }\n";
    if (!refusal(text).empty()) continue;
    Engine whole(scene_of(text), {});
    whole.advance(1000);
    if (whole.context().outcome.failure) continue;
    ++ran;
    Engine first(scene_of(text), {});
    first.advance(333);
    Engine second(scene_of(text), {});
    second.resume(first.state().to_bytes());
    second.advance(667);
    EXPECT_EQ(second.state().to_bytes(), whole.state().to_bytes()) << text;
  }
  EXPECT_GT(ran, 2);
}

TEST(ExponentialShape, BodiesInSpaceAreRefused) { EXPECT_EQ(compare(Shape::space, 3).ran, 0); }

TEST(ExponentialShape, ChainsOnALineRun) {
  const Tally tally = compare(Shape::line, 20);
  EXPECT_GT(tally.ran, tally.drawn / 2);
}

TEST(ExponentialShape, StripsAndNetworksAgreeOrFail) {
  const Tally strips = compare(Shape::strip, 40);
  EXPECT_GT(strips.ran, strips.drawn / 3);
  const Tally networks = compare(Shape::network, 40);
  EXPECT_GT(networks.ran, networks.drawn / 4);
}

}  // namespace
}  // namespace tomlin::test
