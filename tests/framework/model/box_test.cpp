#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "forcefields/morse_bonds.hpp"
#include "framework/core/elements/bonds.hpp"
#include "framework/core/elements/kernel_tables.hpp"
#include "framework/core/elements/pair_force.hpp"
#include "framework/core/numbers/constants.hpp"
#include "tests/support/ring_scenes.hpp"
#include "tests/support/spoilt_registry.hpp"

TOMLIN_DECLARE_KERNELS(MorseBonds)

// A chain that the box closes: minimum images, phonons, translations.

namespace tomlin::test {
namespace {

constexpr double kSpacing = 1.25;
constexpr double kStiffness = 3.0;
constexpr double kMass = 0.7;

struct Chain {
  int count = 6;
  double origin = 0.0;
  std::vector<double> velocity = {};
  bool closed = true;
  double amplitude = 0.0;
  double duration = 1.0;
  std::string more = "";

  std::string text(const std::string& integrator) const {
    std::string speeds;
    for (const double v : velocity) speeds += (speeds.empty() ? "[" : ", [") + digits(v) + "]";
    std::string all =
        closed ? "[box]\nlengths = [" + digits(count * kSpacing) + "]\nperiodic = [true]\n" : "";
    all += "[[body]]\nname = \"chain\"\ntype = \"chain\"\ncount = " + std::to_string(count) +
           "\nspacing = " + digits(kSpacing) + "\norigin = [" + digits(origin) +
           "]\nparticle_mass = " + digits(kMass) + "\n";
    if (!speeds.empty()) all += "velocity = [" + speeds + "]\n";
    all += "[[force]]\ntype = \"harmonic_bonds\"\npairs = \"neighbours\"\nstiffness = " +
           digits(kStiffness) + "\n";
    if (amplitude != 0.0) {
      all += "[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = " + digits(amplitude) +
             "\nperiod = " + digits(kSpacing) + "\n";
    }
    return all + "[run]\nduration = " + digits(duration) + "\nintegrator = " + integrator + "\n" +
           more;
  }
};

std::vector<double> numbers(Engine& engine, const char* field) {
  const BodySlot<double>& slot = engine.model().bodies()[0].bound.slot;
  const double* from = engine.state().reals(field) + slot.offset;
  return std::vector<double>(from, from + slot.count);
}

/// Mode number n of N: omega^2 = (4 k / m) sin^2(pi n / N). Started with the mode's velocities, a
/// particle moves as v0 sin(omega t) / omega.
TEST(Box, PhononsHaveTheirFrequencies) {
  constexpr int kCount = 6;
  constexpr double kSpeed = 0.01;
  for (int n = 1; n <= kCount / 2; ++n) {
    for (const double phase : {0.0, 0.9}) {
      Chain chain{.count = kCount, .duration = 5.0};
      for (int i = 0; i < kCount; ++i) {
        chain.velocity.push_back(kSpeed * std::cos(kTau * n * i / kCount + phase));
      }
      const double omega =
          2.0 * std::sqrt(kStiffness / kMass) * std::abs(std::sin(0.5 * kTau * n / kCount));
      Engine engine(scene_of(chain.text(adaptive(1e-12))), {});
      engine.run();
      const auto x = numbers(engine, "position");
      const auto v = numbers(engine, "velocity");
      for (int i = 0; i < kCount; ++i) {
        // Bonds never turn over here, so a line of them is linear.
        EXPECT_NEAR(x[i] - i * kSpacing,
                    chain.velocity[i] * std::sin(omega * chain.duration) / omega, 1e-10)
            << n;
        EXPECT_NEAR(v[i], chain.velocity[i] * std::cos(omega * chain.duration), 1e-10) << n;
      }
    }
  }
}

/// An open chain has other frequencies: the test sees the closing bond.
TEST(Box, TheClosingBondIsSeen) {
  Chain chain{.duration = 5.0, .more = "ledger = true\n"};
  for (int i = 0; i < 6; ++i) chain.velocity.push_back(0.01 * std::cos(kTau * i / 6));
  Chain open = chain;
  open.closed = false;
  Engine a(scene_of(chain.text(adaptive(1e-12))), {});
  Engine b(scene_of(open.text(adaptive(1e-12))), {});
  a.run();
  b.run();
  EXPECT_GT(std::abs(numbers(a, "position")[0] - numbers(b, "position")[0]), 1e-3);
}

TEST(Box, ForcesSumToZeroAndStartAtRest) {
  // Also where images of the start are far from the box.
  for (const double origin : {0.0, -2.0, 1e6}) {
    for (const int count : {2, 3, 6}) {
      Chain chain{.count = count, .origin = origin, .duration = 3.0};
      for (int i = 0; i < count; ++i) chain.velocity.push_back(i == 0 ? 0.2 : 0.0);
      Engine engine(scene_of(chain.text(fixed_step(0.01))), {});
      Model& model = engine.model();
      const SystemView<double>& view = model.system().view;
      std::vector<double> rates(view.rates + 2 * kGroup);
      const auto total = [&](double& largest) {
        model.evaluate_at(DoubleDouble(engine.time()), view.position, view.velocity, view.integrals,
                          rates.data());
        double sum = 0.0;
        largest = 0.0;
        for (int i = 0; i < count; ++i) {
          sum += view.force[i];
          largest = std::max(largest, std::abs(view.force[i]));
        }
        return sum;
      };
      double largest = 0.0;
      total(largest);
      EXPECT_LT(largest, 1e-8) << "rest lengths are those of the start";
      engine.run();
      EXPECT_NEAR(total(largest), 0.0, 1e-14);
      EXPECT_GT(largest, 1e-3);
      double momentum = 0.0;
      for (const double v : numbers(engine, "velocity")) momentum += kMass * v;
      EXPECT_NEAR(momentum, kMass * 0.2, 1e-14);
    }
  }
}

/// Two particles in a box have two bonds: omega^2 = 4 k / m for their one vibration.
TEST(Box, OfTwoParticlesHoldsTwoBonds) {
  const double omega = 2.0 * std::sqrt(kStiffness / kMass);
  Chain chain{.count = 2, .velocity = {0.02, -0.02}, .duration = 2.1};
  Engine engine(scene_of(chain.text(adaptive(1e-12))), {});
  engine.run();
  EXPECT_NEAR(numbers(engine, "velocity")[0], 0.02 * std::cos(omega * 2.1), 1e-10);
}

/// On a corrugation of its own period only the position within a period at which a closed chain
/// starts counts: moved by a period, or renumbered, it does the same.
TEST(Box, ATranslationByAPeriodChangesNothing) {
  Chain chain{.origin = 0.3,
              .velocity = {0.5, 0.1, -0.2, 0.0, 0.3, 0.4},
              .amplitude = 0.05,
              .duration = 6.0};
  Chain moved = chain;
  moved.origin += 4.0 * kSpacing;
  Chain renumbered = chain;
  renumbered.velocity = {0.4, 0.5, 0.1, -0.2, 0.0, 0.3};
  Engine a(scene_of(chain.text(fixed_step(0.01))), {});
  Engine b(scene_of(moved.text(fixed_step(0.01))), {});
  Engine c(scene_of(renumbered.text(fixed_step(0.01))), {});
  a.run();
  b.run();
  c.run();
  const auto at = numbers(a, "velocity");
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(numbers(b, "velocity")[i], at[i], 1e-12);
    EXPECT_NEAR(numbers(c, "velocity")[(i + 1) % 6], at[i], 1e-12);
  }
}

/// A ring is closed by its shape; a box wide enough changes nothing.
TEST(Box, LeavesARingAlone) {
  const RingScene ring{.duration = 2.0};
  const std::string box = "[box]\nlengths = [8.0, 8.0]\nperiodic = [true, false]\n";
  const RunResult alone = run_text(ring.text());
  const RunResult boxed = run_text(box + ring.text());
  for (int d = 0; d < 2; ++d) {
    EXPECT_NEAR(boxed.body(0)["centre_of_mass"][d], alone.body(0)["centre_of_mass"][d], 1e-12);
    EXPECT_NEAR(boxed.driver(0)["mean_force"][d], alone.driver(0)["mean_force"][d], 1e-12);
  }
}

// ---- which images

/// Two atoms a distance of 1 apart in a box of 6, tied by springs without rest length.
TEST(Box, ClosesNoBodyButAChain) {
  const auto energy_of = [](const std::string& body) {
    const RunResult result =
        run_text("[box]\nlengths = [6.0]\nperiodic = [true]\n[[body]]\n" + body +
                 "particle_mass = 1.0\n[[force]]\ntype = \"harmonic_bonds\"\n"
                 "pairs = \"neighbours\"\nstiffness = 2.0\nrest_lengths = 0.0\n"
                 "[run]\nduration = 1e-6\nledger = true\nintegrator = " +
                 fixed_step(1e-6) + "\n");
    return result.group("energy")["potential"].value();
  };
  EXPECT_NEAR(energy_of("type = \"particles\"\npositions = [0.5, 1.5]\n"), 1.0, 1e-9);
  EXPECT_NEAR(energy_of("type = \"chain\"\ncount = 2\nspacing = 1.0\norigin = [0.5]\n"), 1.0 + 25.0,
              1e-9);
}

/// A row of atoms that is drawn over another, round a periodic box and more.
std::string drawn_over(const std::string& force) {
  return tables(R"([box] | lengths = [6.0] | periodic = [true]
[[body]] | name = "slider" | type = "particles" | positions = [0.2, 1.7, 2.9]
particle_mass = 1.0 | coordinates = "prescribed" | motion = { velocity = [1.0] }
[[body]] | name = "row" | type = "particles" | positions = [0.0, 2.0, 4.0] | particle_mass = 1.0
coordinates = "fixed"
[[force]] | name = "pull" | bodies = ["slider", "row"]
)") + force +
         "[run]\nduration = 20.0\nintegrator = " + fixed_step(1e-2) + "\n";
}

const std::string kWell =
    "type = \"morse_bonds\"\npairs = \"all\"\ndepth = 0.5\ninverse_width = 3.0\n"
    "rest_lengths = 0.4\n";
const std::string kWellAsFormula =
    "type = \"expression\"\nenergy = \"0.5*(1 - exp(-3*(r - 0.4)))^2\"\n";

/// The potential is bound as a plugin's is.
const ForceFactories kByNearestImages = pair_potential<MorseBonds, kernels::MorseBonds>().bind;

/// Atoms that pass through each other have forces that jump, so that the energy balance is warned
/// of as well.
std::vector<std::string> warnings_of_bonds(const RunResult& result) {
  std::vector<std::string> all = briefs(result.warnings);
  std::erase(all, "[run.energy_balance]");
  return all;
}

/// The most that a force reaches is reached in every period of the way.
TEST(Box, PotentialsOfPluginsTakeTheNearestImages) {
  const SpoiltRegistry plugin("morse_bonds", kByNearestImages);
  const RunResult formula = run_text(drawn_over(kWellAsFormula));
  const RunResult potential =
      run(parse_scene(drawn_over(kWell), "test.toml", plugin.registry()), {});
  const ResultGroup& expected = driver_of(formula, "slider");
  const ResultGroup& found = driver_of(potential, "slider");
  constexpr double kSame = 1e-10;  // of rounding, over 2000 steps
  EXPECT_NEAR(found["mean_force"][0], expected["mean_force"][0], kSame);
  EXPECT_NEAR(*found["work"], *expected["work"], kSame);
  EXPECT_NEAR(found["final_force"][0], expected["final_force"][0], kSame);
  EXPECT_EQ(count_of(FaultCode::run_bond_beyond_half_box, potential.warnings), 0U);
  // Bonds are left behind, and that is said.
  const RunResult bonds = run_text(drawn_over(kWell));
  EXPECT_GT(std::abs(driver_of(bonds, "slider")["final_force"][0] - expected["final_force"][0]),
            1e-3);
  EXPECT_EQ(warnings_of_bonds(bonds),
            std::vector<std::string>{"force.pull [run.bond_beyond_half_box]"});
}

/// Energies and second derivatives are of the same images as forces.
TEST(Box, PotentialsOfPluginsKeepTheirProperties) {
  std::string scene = drawn_over(kWell);
  const std::string prescribed = "coordinates = \"prescribed\"\nmotion = { velocity = [1.0] }\n";
  scene.erase(scene.find(prescribed), prescribed.size());
  for (const std::uint64_t seed : {1, 2, 3}) {
    EXPECT_EQ(SpoiltRegistry("morse_bonds", kByNearestImages).broken_in(scene, seed),
              std::set<std::string>{});
  }
}

TEST(Box, BondsThatStayShortAreNotWarnedOf) {
  const RunResult result = run_text(tables(R"([box] | lengths = [6.0] | periodic = [true]
[[body]] | name = "pair" | type = "particles" | positions = [5.8, 0.4]
velocity = [[3.0], [3.2]] | particle_mass = 1.0
[[force]] | type = "harmonic_bonds" | pairs = "all" | stiffness = 2.0
[run] | duration = 20.0 | integrator = )") +
                                    fixed_step(1e-2) + "\n");
  EXPECT_EQ(result.status, RunStatus::finished);
  EXPECT_TRUE(result.warnings.empty());
}

// ---- bonds without rest lengths

struct BareMorseDescription {
  PairSelection pairs;
  double depth = 0.0;
  double inverse_width = 0.0;
};

/// Morse bonds whose description has no rest lengths, on the kernels of those that have.
struct BareMorse : MorseBonds {
  using Description = BareMorseDescription;
  template <class T, int D>
  static Parameters<T, D> parameters(const Description& d) {
    return {T(d.depth), T(d.inverse_width)};
  }
};

ForceRecord bare_morse_record() {
  using Description = BareMorseDescription;
  ForceRecord record = bond_force<BareMorse, kernels::MorseBonds>();
  record.name = "bare_morse";
  record.summary = "bonds that are at rest where their ends meet";
  record.equation = "V = depth * (1 - exp(-inverse_width * r))^2";
  record.source = "a test";
  record.example = "a test";
  record.parameters = {bonded_pairs<Description>(),
                       parameter("depth", &Description::depth, dimension::energy, "of the well"),
                       parameter("inverse_width", &Description::inverse_width,
                                 Dimension{.length = -1}, "of the well")};
  return record;
}

TEST(Bonds, WithoutRestLengthsTheirDatumIsZero) {
  Registry registry = standard_registry();
  registry.add(bare_morse_record());
  const auto end_of = [&](const std::string& type, const std::string& more) {
    const std::string scene =
        "[[body]]\nname = \"row\"\ntype = \"particles\"\npositions = [[0.0, 0.1], [0.8, 0.0], "
        "[1.1, 0.9]]\nparticle_mass = 1.0\n[[force]]\ntype = \"" +
        type + "\"\npairs = \"all\"\ndepth = 0.5\ninverse_width = 2.0\n" + more +
        "[run]\nduration = 2.0\nintegrator = " + fixed_step(1e-2) + "\n";
    Engine engine(parse_scene(scene, "test.toml", registry), {});
    engine.run();
    return numbers(engine, "position");
  };
  const std::vector<double> bare = end_of("bare_morse", "");
  EXPECT_EQ(bare, end_of("morse_bonds", "rest_lengths = 0.0\n"));
  EXPECT_NE(bare, end_of("morse_bonds", "rest_lengths = 0.1\n"));
}

// ---- where positions are counted from

/// An energy that is not periodic is that of the scene's own coordinates, whatever else declares a
/// period: at the start, and cells later.
TEST(Origin, IsAddedBackToEnergiesWithoutAPeriod) {
  const auto energy_of = [](double duration, bool period) {
    const RunResult result = run_text(
        "[[body]]\ntype = \"point\"\nposition = [2.3]\nvelocity = [4.0]\nparticle_mass = 1.0\n"
        "[[force]]\ntype = \"constant_force\"\nforce = [0.5]\n" +
        std::string(period ? "[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = 0.0\n"
                             "period = 1.0\n"
                           : "") +
        "[run]\nduration = " + digits(duration) +
        "\nledger = true\nintegrator = " + fixed_step(duration / 64.0) + "\n");
    return result.group("energy")["potential"].value();
  };
  for (const bool period : {false, true}) {
    EXPECT_NEAR(energy_of(1e-9, period), -0.5 * 2.3, 1e-8);
    EXPECT_NEAR(energy_of(5.0, period), -0.5 * (2.3 + 4.0 * 5.0 + 0.25 * 25.0), 1e-12);
  }
}

}  // namespace
}  // namespace tomlin::test
