#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "framework/core/numbers/constants.hpp"
#include "framework/run/results/observables.hpp"
#include "framework/study/accuracy/accuracy.hpp"
#include "framework/study/compare.hpp"
#include "tests/support/scenes.hpp"

// Scenes in eV, Angstrom, ps, u and K, against closed forms in SI units and against the same scenes
// in reduced units. The constants here are the test's own.

namespace tomlin::test {
namespace {

// CODATA 2018, SI units.
constexpr double kCharge = 1.602176634e-19;
constexpr double kPerKelvin = 1.380649e-23 / kCharge;  // eV/K
constexpr double kDalton = 1.66053906660e-27;
constexpr double kAngstrom = 1e-10;
constexpr double kPicosecond = 1e-12;

constexpr double kCarbon = 12.011;  // u

/// A carbon atom on a spring of 1 eV/A^2, from there on with what else the test needs.
std::string carbon(const std::string& body, const std::string& more, double mass = kCarbon) {
  return R"([scene]
units = "metal"
[[body]]
name = "atom"
type = "point"
particle_mass = )" +
         digits(mass) + "\n" + body + R"(
[[force]]
name = "spring"
type = "driving_spring"
stiffness = 1.0
velocity = [0.0]
start = [0.0]
)" + more;
}

/// Period of that oscillator, in ps.
double carbon_period() {
  const double stiffness = kCharge / (kAngstrom * kAngstrom);  // N/m
  return kTau * std::sqrt(kCarbon * kDalton / stiffness) / kPicosecond;
}

/// How far off the origin an atom let go at 1 A is after a quarter of that period.
double position_after_a_quarter(double mass) {
  const double quarter = 0.25 * carbon_period();
  const RunResult result = run_text(
      carbon("position = [1.0]",
             "[run]\nduration = " + digits(quarter) +
                 "\nintegrator = { type = \"rk4\", dt = " + digits(quarter / 4000.0) + " }\n",
             mass));
  return body_of(result, "atom")["centre_of_mass"][0];
}

/// rk4 is off by (2 pi/16000)^4 of the phase, 2e-14; the rest is the rounding of 4000 steps.
TEST(Metal, OscillatorHasItsPeriod) {
  constexpr double kRounding = 1e-12;
  EXPECT_NEAR(carbon_period(), 0.2217, 1e-4);
  EXPECT_NEAR(position_after_a_quarter(kCarbon), 0.0, kRounding);
  // A dalton that is off by 1e-9, sixty times less than the rounded one of LAMMPS: seen.
  EXPECT_GT(std::abs(position_after_a_quarter(kCarbon * (1.0 + 1e-9))), 100.0 * kRounding);
}

TEST(Metal, DampingHasItsRate) {
  constexpr double kCoefficient = 0.001;  // eV ps/A^2
  constexpr double kTime = 2.0;
  const double in_si = kCoefficient * kCharge * kPicosecond / (kAngstrom * kAngstrom);  // kg/s
  const double rate = in_si / (kCarbon * kDalton) * kPicosecond;                        // 1/ps
  const RunResult result = run_text(R"([scene]
units = "metal"
[[body]]
name = "atom"
type = "point"
position = [0.0]
velocity = [3.0]
particle_mass = 12.011
[[force]]
type = "viscous_damping"
coefficient = 0.001
[run]
duration = 2.0
integrator = { type = "rk4", dt = 1e-3 }
)");
  const ResultGroup& atom = body_of(result, "atom");
  EXPECT_NEAR(rate, 0.8033, 1e-4);
  constexpr double kRk4 = 1e-12;  // (dt rate)^4
  EXPECT_NEAR(atom["velocity"][0] / (3.0 * std::exp(-rate * kTime)), 1.0, kRk4);
  EXPECT_NEAR(atom["centre_of_mass"][0] / (3.0 / rate * (1.0 - std::exp(-rate * kTime))), 1.0,
              kRk4);
}

// ---- the same in reduced units

struct ReducedUnits {
  double length = 1.0;  // A
  double energy = 1.0;  // eV
  double mass = 1.0;    // u
  /// ps
  double time() const {
    const double joule = energy * kCharge;
    const double metre = length * kAngstrom;
    return std::sqrt(mass * kDalton * metre * metre / joule) / kPicosecond;
  }
};

/// The Prandtl-Tomlinson tip that sticks and slips, with numbers in metal units or reduced ones.
std::string stick_slip_tip(const std::string& system, const ReducedUnits& units) {
  const double time = system == "metal" ? units.time() : 1.0;
  const double length = units.length;
  const double energy = units.energy;
  return fmt::format(R"([scene]
units = "{}"
[[body]]
name = "tip"
type = "point"
position = [{:.17g}]
particle_mass = {:.17g}
[[force]]
name = "driver"
type = "driving_spring"
stiffness = {:.17g}
velocity = [{:.17g}]
[[force]]
type = "viscous_damping"
coefficient = {:.17g}
[[force]]
type = "sinusoidal_substrate"
amplitude = {:.17g}
period = {:.17g}
[run]
ledger = true
duration = {:.17g}
integrator = {{ type = "rk4", dt = {:.17g} }}
[measure]
in = "driver_periods"
from = 1
to = 3
)",
                     system, 0.5 * length, units.mass, 2.0 * energy / (length * length),
                     0.02 * length / time, 1.0 * energy * time / (length * length), 0.1 * energy,
                     length, 160.0 * time, 0.01 * time);
}

TEST(Metal, TipOfReducedUnitsIsTheSame) {
  const ReducedUnits units = {.length = 2.46, .energy = 0.35, .mass = 72.066};
  const RunResult reduced = run_text(stick_slip_tip("reduced", {}));
  const RunResult metal = run_text(stick_slip_tip("metal", units));
  ASSERT_EQ(metal.status, RunStatus::finished);
  // Rounding in other units, grown along two slips; as in units_test.cpp.
  constexpr double kRounding = 1e-7;
  const double force = units.energy / units.length;
  const double speed = units.length / units.time();
  const ResultGroup& a = driver_of(reduced, "driver");
  const ResultGroup& b = driver_of(metal, "driver");
  EXPECT_GT(*a["slips"], 0.0);
  EXPECT_EQ(*a["slips"], *b["slips"]);
  for (const char* key : {"mean_force", "max_force", "static_force"}) {
    EXPECT_NEAR(b[key][0] / (a[key][0] * force), 1.0, kRounding) << key;
  }
  for (const char* key : {"work_in", "heat_out"}) {
    EXPECT_NEAR(*metal.group("energy")[key] / (*reduced.group("energy")[key] * units.energy), 1.0,
                kRounding)
        << key;
  }
  EXPECT_NEAR(*body_of(metal, "tip")["max_speed"] / (*body_of(reduced, "tip")["max_speed"] * speed),
              1.0, kRounding);
  EXPECT_NEAR(metal.end_time / (reduced.end_time * units.time()), 1.0, 1e-15);
}

/// In the engine's own units it is one and the same scene, to the bit, noise included.
TEST(Metal, IsTheEnginesSceneToTheBit) {
  const auto chain = [](const std::string& units, double mass, double kelvin) {
    return fmt::format(R"([scene]
units = "{}"
[[body]]
name = "chain"
type = "chain"
count = 5
spacing = 2.46
particle_mass = [{:.17g}, {:.17g}, {:.17g}, {:.17g}, {:.17g}]
start_temperature = {:.17g}
[[force]]
name = "bonds"
type = "harmonic_bonds"
pairs = "neighbours"
stiffness = 3.0
[[force]]
name = "driver"
type = "driving_spring"
stiffness = 0.5
velocity = [0.5]
[[force]]
name = "bath"
type = "langevin"
coefficient = 0.004
temperature = {:.17g}
[[force]]
type = "sinusoidal_substrate"
amplitude = 0.05
period = 2.46
[run]
ledger = true
duration = 600.0
integrator = {{ type = "baoab", dt = 0.002 }}
[measure]
in = "time"
from = 5.0
to = 600.0
)",
                       units, 12.011 * mass, 28.0855 * mass, 12.011 * mass, 1.008 * mass,
                       12.011 * mass, 300.0 * kelvin, 150.0 * kelvin);
  };
  const RunResult metal = run_text(chain("metal", 1.0, 1.0));
  const RunResult engine = run_text(chain("reduced", kAtomicMassInMetal, kBoltzmannInMetal));
  ASSERT_EQ(metal.status, RunStatus::finished);
  const std::vector<Observable> found = observables(metal);
  const std::vector<Observable> expected = observables(engine);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (found[k].path.starts_with("performance")) continue;
    ASSERT_EQ(found[k].value.has_value(), expected[k].value.has_value()) << found[k].path;
    if (!found[k].value) continue;
    const double unit = scene_unit(UnitSystem::metal, found[k].quantity->dimension);
    EXPECT_EQ(*found[k].value, *expected[k].value / unit) << found[k].path;
  }
  ASSERT_EQ(metal.errors.size(), engine.errors.size());
  bool temperature = false;
  for (std::size_t k = 0; k < metal.errors.size(); ++k) {
    if (!metal.errors[k].error) continue;
    const bool in_kelvin = metal.errors[k].path.ends_with(".temperature");
    temperature = temperature || in_kelvin;
    EXPECT_EQ(*metal.errors[k].error,
              *engine.errors[k].error / (in_kelvin ? kBoltzmannInMetal : 1.0))
        << metal.errors[k].path;
  }
  EXPECT_TRUE(temperature);
}

// ---- temperature

/// Means over streams, which may be off by four standard errors.
struct StreamMean {
  std::vector<double> values;

  double mean() const {
    double sum = 0.0;
    for (const double x : values) sum += x;
    return sum / static_cast<double>(values.size());
  }
  double error() const {
    double squares = 0.0;
    for (const double x : values) squares += (x - mean()) * (x - mean());
    const auto n = static_cast<double>(values.size());
    return std::sqrt(squares / (n - 1.0) / n);
  }
  bool agrees(double exact) const { return std::abs(mean() - exact) <= 4.0 * error(); }
};

void expect_stream_mean(const StreamMean& found, double exact, const std::string& what) {
  EXPECT_TRUE(found.agrees(exact))
      << what << ": " << found.mean() << " +- " << found.error() << ", not " << exact;
  // A constant that is off by a twentieth, once, is seen.
  EXPECT_FALSE(found.agrees(exact * 1.05)) << what;
  EXPECT_FALSE(found.agrees(exact / 1.05)) << what;
}

constexpr double kBath = 300.0;  // K
constexpr double kStep = 0.02;   // ps

std::string bath_of_atom(const std::string& force, std::uint64_t stream) {
  return "[[force]]\nname = \"bath\"\n" + force + "temperature = " + digits(kBath) +
         "\n[run]\nseed = 3\nstream = " + std::to_string(stream) +
         "\nduration = 1000.0\nintegrator = { type = \"baoab\", dt = " + digits(kStep) +
         " }\n[measure]\nin = \"time\"\nfrom = 10.0\nto = 1000.0\n[output]\nevery = " +
         digits(kStep) + "\n";
}

/// The scheme's equilibrium in a harmonic well is exact at any step: positions have k_B T/k,
/// velocities in the middle of steps k_B T/m, and at their ends less by 1 - (dt omega)^2/4
/// (B. Leimkuhler and C. Matthews, J. Chem. Phys. 138 (2013) 174102, doi:10.1063/1.4802990).
TEST(Metal, BathOf300Kelvin) {
  StreamMean temperature;
  StreamMean positions;
  StreamMean speeds;
  for (std::uint64_t stream = 0; stream < 16; ++stream) {
    KeptSamples samples;
    RunOptions options;
    options.sink = &samples;
    const RunResult result =
        run_text(carbon("position = [0.0]\nstart_temperature = 300.0",
                        bath_of_atom("type = \"langevin\"\ncoefficient = 0.03\n", stream)),
                 {}, options);
    ASSERT_EQ(result.status, RunStatus::finished);
    temperature.values.push_back(*body_of(result, "atom")["temperature"]);
    const auto mean_square = [&](const std::string& column) {
      const auto at = static_cast<std::size_t>(
          std::find(samples.names.begin(), samples.names.end(), column) - samples.names.begin());
      double sum = 0.0;
      for (const auto& row : samples.rows) sum += row[at] * row[at];
      return sum / static_cast<double>(samples.rows.size());
    };
    positions.values.push_back(mean_square("atom.centre_of_mass.x"));
    speeds.values.push_back(mean_square("atom.velocity.x"));
  }
  const double energy = kPerKelvin * kBath;  // eV; the well has 1 eV/A^2
  const double mass = kCarbon * kDalton * std::pow(kAngstrom / kPicosecond, 2) / kCharge;
  const double phase = kTau * kStep / carbon_period();
  EXPECT_NEAR(energy, 0.02585, 1e-5);
  expect_stream_mean(temperature, kBath, "temperature, K");
  expect_stream_mean(positions, energy, "mean square of positions, A^2");
  expect_stream_mean(speeds, energy / mass * (1.0 - 0.25 * phase * phase),
                     "mean square of velocities, A^2/ps^2");
}

TEST(Metal, MemoryAt300Kelvin) {
  StreamMean temperature;
  for (std::uint64_t stream = 0; stream < 16; ++stream) {
    const RunResult result = run_text(
        carbon("position = [0.0]",
               bath_of_atom("type = \"memory_damping\"\ncoefficient = 0.03\nmemory_time = 0.05\n",
                            stream)));
    ASSERT_EQ(result.status, RunStatus::finished);
    temperature.values.push_back(*body_of(result, "atom")["temperature"]);
  }
  expect_stream_mean(temperature, kBath, "temperature, K");
}

/// Kinetic energies of velocities as they are drawn, in eV.
TEST(Metal, StartAt300Kelvin) {
  constexpr double kCount = 10000.0;
  StreamMean kinetic;
  for (int stream = 0; stream < 16; ++stream) {
    const RunResult result = run_text(fmt::format(R"([scene]
units = "metal"
[[body]]
name = "gas"
type = "chain"
count = {}
spacing = 1.0
particle_mass = 39.95
start_temperature = 300.0
[[force]]
type = "viscous_damping"
coefficient = 1e-12
[run]
seed = 8
stream = {}
ledger = true
duration = 1e-6
integrator = {{ type = "rk4", dt = 1e-6 }}
)",
                                                  kCount, stream));
    kinetic.values.push_back(*result.group("energy")["kinetic"]);
  }
  expect_stream_mean(kinetic, 0.5 * kCount * kPerKelvin * kBath, "kinetic energy, eV");
}

// ---- between systems

TEST(Metal, IsNotComparedWithReducedUnits) {
  const std::vector<std::shared_ptr<const Scene>> scenes = {
      scene_of(stick_slip_tip("reduced", {})), scene_of(stick_slip_tip("metal", {.mass = 1.0}))};
  CompareRequest request;
  request.observable = "driver.mean_force.x";
  const auto faults = briefs_of([&] { compare_models(scenes, request); });
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_NE(faults[0].find("compare.different_setups"), std::string::npos) << faults[0];
}

}  // namespace
}  // namespace tomlin::test
