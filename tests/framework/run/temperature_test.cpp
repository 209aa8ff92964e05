#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/numbers/constants.hpp"
#include "tests/support/scenes.hpp"

// Temperatures of bodies in a bath, of starts, and the heat that a bath takes. Over fixed streams
// of random numbers; means may be off by four standard errors, which follow from their scatter.

namespace tomlin::test {
namespace {

constexpr double kFourStandardErrors = 4.0;

struct ScatteredMean {
  double sum = 0.0;
  double squares = 0.0;
  double count = 0.0;

  void add(double x) {
    sum += x;
    squares += x * x;
    count += 1.0;
  }
  double mean() const { return sum / count; }
  double variance() const { return (squares - sum * mean()) / (count - 1.0); }
  double error() const { return std::sqrt(variance() / count); }
};

void expect_mean(const ScatteredMean& found, double exact, double largest_error,
                 const std::string& what) {
  EXPECT_NEAR(found.mean(), exact, kFourStandardErrors * found.error()) << what;
  EXPECT_LT(found.error(), largest_error * std::abs(exact)) << what << " shows nothing";
}

// ---- equipartition

constexpr double kChainBath = 0.3;

std::string bath_of(double temperature, const std::string& coefficient) {
  return "[[force]]\nname = \"bath\"\ntype = \"langevin\"\ncoefficient = " + coefficient +
         "\ntemperature = " + digits(temperature) + "\n";
}

const std::string kBondedChain = tables(R"([[body]] | name = "chain" | type = "chain"
count = 7 | origin = [0.0] | spacing = 1.0 | particle_mass = [1.0, 0.4, 2.0, 1.0, 0.7, 1.0, 1.5]
[[force]] | type = "harmonic_bonds" | pairs = "neighbours" | stiffness = 20.0
[[force]] | name = "driver" | type = "driving_spring" | stiffness = 1.0 | velocity = [0.0]
[[force]] | type = "sinusoidal_substrate" | amplitude = 0.4 | period = 1.3
)");

std::string bath_ring(const std::string& coordinates) {
  return tables(R"([[body]] | name = "ring" | type = "ring" | count = 8 | radius = 1.0
centre = [0.0, 1.2] | particle_mass = [0.1, 0.7, 0.3, 0.2, 0.4, 0.5, 0.2, 0.3]
coordinates = ")") +
         coordinates + tables(R"("
[[force]] | type = "harmonic_bonds" | pairs = "all" | stiffness = 2.0
[[force]] | name = "driver" | type = "driving_spring" | stiffness = 2.0 | velocity = [0.0, 0.0]
[[force]] | type = "sinusoidal_substrate" | amplitude = 0.05 | period = 1.0 | decay = 1.0
)");
}

std::string bath_run(const std::string& scheme, double dt, double duration, std::uint64_t stream,
                     const std::string& more = "") {
  return "[run]\nseed = 4\nstream = " + std::to_string(stream) +
         "\nduration = " + digits(duration) + "\nintegrator = { type = \"" + scheme +
         "\", dt = " + digits(dt) + " }\n" + more;
}

void expect_temperature(const std::string& what, const std::string& scene,
                        const std::string& body) {
  for (const std::string scheme : {"baoab", "gjf"}) {
    ScatteredMean found;
    for (std::uint64_t stream = 0; stream < 16; ++stream) {
      const RunResult result =
          run_text(scene + bath_run(scheme, 0.05, 600.0, stream,
                                    "[measure]\nin = \"time\"\nfrom = 100.0\nto = 600.0\n"));
      ASSERT_EQ(result.status, RunStatus::finished);
      found.add(body_of(result, body)["temperature"][0]);
    }
    expect_mean(found, kChainBath, 0.02, what + ", " + scheme);
  }
}

TEST(BathTemperature, OfABondedChain) {
  expect_temperature("chain", kBondedChain + bath_of(kChainBath, "0.5"), "chain");
}

TEST(BathTemperature, OfAFlexibleRing) {
  expect_temperature("ring", bath_ring("particles") + bath_of(kChainBath, "0.2"), "ring");
}

/// Centre and rotation, which unequal friction couples.
TEST(BathTemperature, OfARigidRing) {
  expect_temperature(
      "rigid ring",
      bath_ring("rigid") + bath_of(kChainBath, "[0.1, 0.02, 0.3, 0.2, 0.1, 0.05, 0.4, 0.1]"),
      "ring");
}

/// Friction without noise on the same body is a bath of temperature 0.
TEST(BathTemperature, OfTwoBathsIsTheirMean) {
  expect_temperature("chain",
                     kBondedChain + bath_of(2.0 * kChainBath, "0.25") +
                         "[[force]]\ntype = \"viscous_damping\"\ncoefficient = 0.25\n",
                     "chain");
}

// ---- the start

/// Kinetic energy over streams; of f coordinates its mean is f T/2, its variance f T^2/2.
void expect_start(const std::string& text, int moving, double temperature) {
  constexpr int kStreams = 1000;
  ScatteredMean found;
  for (int stream = 0; stream < kStreams; ++stream) {
    Engine engine(scene_of(text, {{"run.stream", std::to_string(stream)}}), {});
    found.add(engine.model().kinetic_energy(engine.model().system().view.position,
                                            engine.model().system().view.velocity));
  }
  const double error = temperature * std::sqrt(0.5 * moving / kStreams);
  EXPECT_NEAR(found.mean(), 0.5 * moving * temperature, kFourStandardErrors * error);
  // The variance of a sum of squares has a relative error of (2 + 12/f)^1/2 / n^1/2.
  const double of_variance = std::sqrt((2.0 + 12.0 / moving) / kStreams);
  EXPECT_NEAR(found.variance() / (0.5 * moving * temperature * temperature), 1.0,
              kFourStandardErrors * of_variance);
}

const std::string kFreeRun =
    "[run]\nseed = 2\nduration = 1.0\nintegrator = { type = \"velocity_verlet\", dt = 0.01 }\n";

std::string warm_ring(const std::string& more) {
  return "[[body]]\nname = \"ring\"\ntype = \"ring\"\nradius = 1.0\ncount = 5\n"
         "centre = [0.0, 1.0]\nparticle_mass = [0.1, 0.7, 0.3, 0.2, 0.4]\n"
         "start_temperature = 0.7\n" +
         more + "\n" + kFreeRun;
}

TEST(StartTemperature, KineticEnergyAtTheStart) {
  expect_start(warm_ring(""), 10, 0.7);
  expect_start(warm_ring("hold = [\"y\"]"), 5, 0.7);
  expect_start(warm_ring("coordinates = \"rigid\""), 3, 0.7);
  expect_start(warm_ring("coordinates = \"rigid\"\nhold = [\"rotation\"]"), 2, 0.7);
  expect_start(warm_ring("coordinates = \"rigid\"\nhold = [\"x\"]"), 2, 0.7);
  expect_start(
      "[[body]]\ntype = \"point\"\nposition = [0.0, 0.0, 0.0]\nparticle_mass = 1.7\n"
      "start_temperature = 0.7\n" +
          kFreeRun,
      3, 0.7);
}

TEST(StartTemperature, AddsToVelocities) {
  const std::string text =
      "[[body]]\ntype = \"point\"\nposition = [0.0]\nparticle_mass = 4.0\nvelocity = [3.0]\n"
      "start_temperature = 0.7\n" +
      kFreeRun;
  ScatteredMean found;
  for (int stream = 0; stream < 1000; ++stream) {
    Engine engine(scene_of(text, {{"run.stream", std::to_string(stream)}}), {});
    found.add(engine.model().system().view.velocity[0]);
  }
  expect_mean(found, 3.0, 0.01, "velocity");
  EXPECT_NEAR(found.variance() / (0.7 / 4.0), 1.0, kFourStandardErrors * std::sqrt(2.0 / 1000.0));
}

/// Not those of a bath, nor of another body.
TEST(StartTemperature, HasNumbersOfItsOwn) {
  const std::string point =
      "type = \"point\"\nposition = [0.0]\nparticle_mass = 1.0\nstart_temperature = 1.0\n";
  Engine engine(
      scene_of("[[body]]\nname = \"a\"\n" + point + "[[body]]\nname = \"b\"\n" + point + kFreeRun),
      {});
  const SystemView<double>& view = engine.model().system().view;
  const double a = view.velocity[engine.model().bodies()[0].bound.slot.offset];
  const double b = view.velocity[engine.model().bodies()[1].bound.slot.offset];
  EXPECT_NE(a, 0.0);
  EXPECT_NE(a, b);
}

// ---- heat

std::string pulled_tip(const std::string& substrate) {
  return tables(R"([[body]] | name = "tip" | type = "point" | position = [0.0]
particle_mass = 1.0
[[force]] | name = "driver" | type = "driving_spring" | stiffness = 2.0 | velocity = [0.5]
)") + bath_of(0.2, "1.0") +
         substrate;
}

const std::string kCorrugation =
    "[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = 0.3\nperiod = 1.0\n";

/// The bath takes what the driver gives; what is left is the error of the scheme.
TEST(BathHeat, LedgerOfAPulledTip) {
  for (const std::string scheme : {"baoab", "gjf", "velocity_verlet"}) {
    const RunResult result =
        run_text(pulled_tip(kCorrugation) + bath_run(scheme, 0.02, 2000.0, 0, "ledger = true\n"));
    ASSERT_EQ(result.status, RunStatus::finished);
    const ResultGroup& energy = result.group("energy");
    const double heat = energy["heat_out"][0];
    const double work = energy["work_in"][0];
    // The error is of the order (h omega)^2, omega^2 = 14 at the bottom of the corrugation.
    constexpr double kOfScheme = 5e-3;
    EXPECT_GT(heat, 0.0);
    EXPECT_LT(std::abs(energy["numerical_work"][0]), kOfScheme * heat) << scheme;
    EXPECT_NEAR(energy["stored_change"][0] + heat - work, energy["numerical_work"][0],
                1e-12 * work);
  }
}

/// In a spring alone the trapezoidal rule along the displacement is the change of its energy.
TEST(BathHeat, WithoutInertiaTheLedgerCloses) {
  constexpr double kRounding = 1e-11;  // of 1e5 steps, each of some 1e-16
  for (const std::string scheme : {"leimkuhler_matthews", "euler_maruyama"}) {
    const std::string run =
        bath_run(scheme, 0.01, 1000.0, 0, "dynamics = \"overdamped\"\nledger = true\n");
    const RunResult result = run_text(pulled_tip("") + run);
    ASSERT_EQ(result.status, RunStatus::finished);
    const ResultGroup& energy = result.group("energy");
    EXPECT_GT(energy["heat_out"][0], 0.0);
    EXPECT_LT(std::abs(energy["numerical_work"][0]), kRounding * energy["heat_out"][0]) << scheme;
    // A corrugation's energy is no parabola: third order in displacements of (2 T h/c)^1/2.
    const RunResult corrugated = run_text(pulled_tip(kCorrugation) + run);
    const ResultGroup& other = corrugated.group("energy");
    constexpr double kOfDisplacements = 5e-3;
    EXPECT_LT(std::abs(other["numerical_work"][0]), kOfDisplacements * other["heat_out"][0])
        << scheme;
  }
}

// ---- heat that flows through the bath

/// A particle dragged at its terminal velocity 1 through a cold bath: m v^2 = 1. Velocities before
/// and after friction differ by h, so that the mean of their squares is 1 + h^2/4 and a little
/// more; that of either alone would be off by h.
TEST(BathTemperature, IsThatOfBothSidesOfTheFriction) {
  constexpr double kStep = 0.1;
  constexpr double kSecondOrder = 0.5 * kStep * kStep;
  for (const std::string scheme : {"baoab", "gjf"}) {
    const RunResult result = run_text(
        "[[body]]\ntype = \"point\"\nposition = [0.0]\nvelocity = [1.0]\nparticle_mass = 1.0\n"
        "[[force]]\ntype = \"constant_force\"\nforce = [1.0]\n" +
        bath_of(1e-12, "1.0") +
        "[run]\nduration = 50.0\nallow_unstable = true\nintegrator = { type = \"" + scheme +
        "\", dt = " + digits(kStep) + " }\n[measure]\nfrom = 10.0\n");
    EXPECT_NEAR(*result.body(0)["temperature"], 1.0, kSecondOrder) << scheme;
  }
}

// ---- the energy balance

/// In equilibrium the heat in sum is next to nothing: it is no scale for what the scheme adds.
TEST(BathHeat, EquilibriumIsNoReasonToDoubtTheBalance) {
  for (int stream = 0; stream < 20; ++stream) {
    const RunResult result = run_text(
        "[[body]]\ntype = \"point\"\nposition = [0.0]\nparticle_mass = 1.0\n[[force]]\ntype = "
        "\"driving_spring\"\nstiffness = 1.0\nvelocity = [0.0]\n" +
        bath_of(0.1, "1.0") + "[run]\nduration = 2000.0\nallow_unstable = true\nstream = " +
        std::to_string(stream) + "\nintegrator = { type = \"baoab\", dt = 0.5 }\n");
    for (const Warning& warning : result.warnings) {
      EXPECT_NE(warning.code, FaultCode::run_energy_balance) << stream << ": " << warning.text;
    }
  }
}

}  // namespace
}  // namespace tomlin::test
