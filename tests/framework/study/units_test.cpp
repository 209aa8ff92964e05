#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "framework/run/results/observables.hpp"
#include "framework/scene/natural_units.hpp"
#include "framework/study/accuracy/accuracy.hpp"
#include "framework/study/tradeoff/tradeoff.hpp"
#include "tests/support/other_units.hpp"
#include "tests/support/scenes.hpp"

// A scene in other units is the same scene. Powers of two change no digit of any number, so that
// every result has the same bits but for the unit, with default tolerances too: nothing in the
// program knows the size of a unit.

namespace tomlin::test {
namespace {

const Units kPowersOfTwo[] = {
    {.mass = 0x1p-40, .length = 0x1p-32, .time = 0x1p-23},
    {.mass = 0x1p-3, .length = 0x1p21, .time = 0x1p17},
    {.mass = 0x1p9, .length = 0x1p-1, .time = 0x1p-5},
};

/// An atomic force microscope's: metres, kilograms, seconds.
constexpr Units kSi = {.mass = 1e-12, .length = 2.5e-10, .time = 1.3e-5};
/// Rounding in other units, grown along runs that stick and slip a few times.
constexpr double kRounding = 1e-7;

/// Draws the numbers that a scene is made of.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed) {}
  double between(double low, double high) {
    const double part = static_cast<double>(random_() >> 11) * 0x1p-53;
    return low + part * (high - low);
  }
  bool chance(double probability) { return between(0.0, 1.0) < probability; }

 private:
  std::mt19937_64 random_;
};

/// A tip, a chain, a flexible ring or a rigid one: each is driven over a corrugation.
std::string random_scene(std::uint64_t seed, const std::string& dynamics,
                         const std::string& integrator) {
  Draw draw(seed);
  const int kind = static_cast<int>(seed % 4);
  const bool planar = kind >= 2;
  const double period = draw.between(0.8, 1.3);
  const double velocity = draw.between(0.2, 0.5) * period;
  std::string text;
  const auto number = [&](const char* key, double value) {
    text += fmt::format("{} = {:.17g}\n", key, value);
  };
  text += "[[body]]\nname = \"body\"\n";
  if (kind == 0) {
    text += fmt::format("type = \"point\"\nposition = [{:.17g}]\n", draw.between(0.3, 0.7));
  } else if (kind == 1) {
    text += "type = \"chain\"\ncount = 4\n";
    number("spacing", draw.between(0.9, 1.2));
  } else {
    text += fmt::format("type = \"ring\"\ncount = 5\nradius = 1.0\ncentre = [{:.17g}, 1.0]\n",
                        draw.between(0.0, 0.5));
    if (kind == 3) text += "coordinates = \"rigid\"\n";
  }
  number("particle_mass", draw.between(0.5, 2.0));
  const auto force = [&](const char* type) {
    text += fmt::format("[[force]]\ntype = \"{}\"\n", type);
  };
  force("driving_spring");
  text += "name = \"driver\"\n";
  text += fmt::format("velocity = [{:.17g}{}]\n", velocity, planar ? ", 0.0" : "");
  number("stiffness", draw.between(0.5, 4.0));
  force("sinusoidal_substrate");
  number("amplitude", draw.between(0.05, 0.15));
  number("period", period);
  if (planar) number("decay", draw.between(0.3, 1.0));
  if (kind == 1 || kind == 2) {
    force("harmonic_bonds");
    text += kind == 2 ? "pairs = \"all\"\n" : "pairs = \"neighbours\"\n";
    number("stiffness", draw.between(20.0, 50.0));
  }
  if (integrator.find("blanes_moan") == std::string::npos) {
    force("viscous_damping");
    number("coefficient", draw.between(0.5, 2.0));
  }
  text += "[run]\ndynamics = \"" + dynamics + "\"\n" + integrator + "\n";
  number("duration", 3.3 * period / velocity);
  if (integrator.find("quadruple") == std::string::npos) text += "ledger = true\n";
  text += "[measure]\nin = \"driver_periods\"\nfrom = 1.0\nto = 3.0\n";
  return text;
}

/// Events too.
struct Seen {
  RunResult result;
  KeptSamples samples;
};

Seen seen_in(const std::string& text, const std::vector<Setting>& settings) {
  Seen seen;
  RunOptions options;
  options.sink = &seen.samples;
  seen.result = run(scene_of(text, settings), options);
  return seen;
}

/// `tolerance` 0: to the bit.
void expect_same(const Seen& one, const Seen& other, const Units& units, double tolerance) {
  ASSERT_EQ(one.result.status, other.result.status)
      << (other.result.failure ? to_string(*other.result.failure) : "");
  const auto mine = observables(one.result);
  const auto theirs = observables(other.result);
  ASSERT_EQ(mine.size(), theirs.size());
  double force = 0.0;
  for (const Observable& x : mine) {
    if (x.path.ends_with("max_force.x")) force = std::max(force, std::abs(x.value.value_or(0.0)));
  }
  for (std::size_t k = 0; k < mine.size(); ++k) {
    const std::string& path = mine[k].path;
    // A logarithm of units; and the clock.
    if (path.ends_with("log_determinant") || path.starts_with("performance")) continue;
    ASSERT_EQ(mine[k].value.has_value(), theirs[k].value.has_value()) << path;
    if (!mine[k].value) continue;
    const double expected = *mine[k].value * units.of(dimension_of_result(path));
    if (tolerance == 0.0) {
      EXPECT_EQ(expected, *theirs[k].value) << path;
    } else if (path != "energy.numerical_work" && !path.starts_with("time.")) {
      const double size = std::max(std::abs(*mine[k].value), 1e-2);
      EXPECT_NEAR(*mine[k].value, *theirs[k].value / units.of(dimension_of_result(path)),
                  tolerance * size)
          << path;
    }
  }
  EXPECT_EQ(briefs(one.result.warnings), briefs(other.result.warnings));
  ASSERT_EQ(one.samples.events.size(), other.samples.events.size());
  for (std::size_t k = 0; k < one.samples.events.size(); ++k) {
    const Event& a = one.samples.events[k];
    const Event& b = other.samples.events[k];
    EXPECT_EQ(a.kind, b.kind);
    if (tolerance == 0.0) {
      EXPECT_EQ(a.time * units.time, b.time);
      if (a.kind == EventKind::slip && !std::isnan(a.size)) {
        EXPECT_EQ(a.size * units.length, b.size);
        if (!std::isnan(a.energy_lost)) {
          EXPECT_EQ(a.energy_lost * units.of(dimension::energy), b.energy_lost);
        }
      }
    } else {
      EXPECT_NEAR(a.time, b.time / units.time, tolerance * a.time);
    }
  }
  ASSERT_EQ(one.result.errors.size(), other.result.errors.size());
  for (std::size_t k = 0; k < one.result.errors.size() && tolerance == 0.0; ++k) {
    const ErrorEstimate& a = one.result.errors[k];
    const ErrorEstimate& b = other.result.errors[k];
    ASSERT_EQ(a.error.has_value(), b.error.has_value()) << a.path;
    if (a.error) {
      EXPECT_EQ(*a.error * units.of(dimension_of_result(a.path)), *b.error) << a.path;
    }
  }
}

struct Way {
  const char* dynamics;
  const char* integrator;
  std::vector<std::string> given = {};  ///< keys of the integrator with a dimension
};

const std::vector<Way>& ways() {
  static const std::vector<Way> all = {
      {"inertial", "integrator = { type = \"dopri5\" }"},
      {"inertial", "integrator = { type = \"dop853\" }"},
      {"inertial", "integrator = { type = \"radau9\" }"},
      {"inertial", "integrator = { type = \"rk4\", dt = 0.01 }", {"dt"}},
      {"inertial", "integrator = { type = \"midpoint\", dt = 0.01 }", {"dt"}},
      {"inertial", "integrator = { type = \"velocity_verlet\", dt = 0.01 }", {"dt"}},
      {"inertial", "integrator = { type = \"exponential_verlet\", dt = 0.01 }", {"dt"}},
      {"inertial", "integrator = { type = \"blanes_moan\", dt = 0.01 }", {"dt"}},
      {"inertial",
       "integrator = { type = \"dopri5\", absolute_tolerance = 1e-7, relative_tolerance = 1e-4 }",
       {"absolute_tolerance"}},
      {"overdamped", "integrator = { type = \"dopri5\" }"},
      {"overdamped", "integrator = { type = \"dop853\" }"},
      {"overdamped", "integrator = { type = \"radau9\" }"},
      {"overdamped", "integrator = { type = \"rk4\", dt = 0.005 }", {"dt"}},
      {"quasistatic", "integrator = { type = \"continuation\" }"},
  };
  return all;
}

TEST(Units, PowersOfTwoGiveTheSameBits) {
  for (const Way& way : ways()) {
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
      SCOPED_TRACE(std::string(way.dynamics) + " " + way.integrator + ", seed " +
                   std::to_string(seed));
      const std::string text = random_scene(seed, way.dynamics, way.integrator);
      if (!refusal(text).empty()) continue;  // not every scheme takes every body
      const Seen here = seen_in(text, {});
      ASSERT_EQ(here.result.status, RunStatus::finished)
          << (here.result.failure ? to_string(*here.result.failure) : "");
      const Units& units = kPowersOfTwo[seed % std::size(kPowersOfTwo)];
      const Seen there = seen_in(text, in_units(*scene_of(text), units, way.given));
      expect_same(here, there, units, 0.0);
      if (HasFailure()) return;
    }
  }
}

TEST(Units, SiGivesTheSameToRounding) {
  for (const Way& way : ways()) {
    for (const std::uint64_t seed : {4, 7}) {
      SCOPED_TRACE(std::string(way.dynamics) + " " + way.integrator + ", seed " +
                   std::to_string(seed));
      const std::string text = random_scene(seed, way.dynamics, way.integrator);
      if (!refusal(text).empty()) continue;  // not every scheme takes every body
      const Seen here = seen_in(text, {});
      const Seen there = seen_in(text, in_units(*scene_of(text), kSi, way.given));
      expect_same(here, there, kSi, kRounding);
      if (HasFailure()) return;
    }
  }
}

TEST(Units, AccuracyGivesTheSameBits) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    SCOPED_TRACE(seed);
    const std::string text = random_scene(seed, "inertial", "accuracy = 1e-4");
    const Units& units = kPowersOfTwo[seed % std::size(kPowersOfTwo)];
    const Seen here = seen_in(text, {});
    const Seen there = seen_in(text, in_units(*scene_of(text), units));
    expect_same(here, there, units, 0.0);
    EXPECT_EQ(here.result.accuracy->scheme, there.result.accuracy->scheme);
    EXPECT_EQ(here.result.accuracy->pilot_cost, there.result.accuracy->pilot_cost);
  }
}

TEST(Units, UntilGivesTheSameBits) {
  std::string text = random_scene(4, "overdamped", "integrator = { type = \"dopri5\" }");
  text.resize(text.find("[measure]"));
  text += "until = { steady = \"driver.mean_force.x\", tolerance = 1e-3, max = 200.0 }\n";
  for (const Units& units : kPowersOfTwo) {
    const Seen here = seen_in(text, {});
    const Seen there = seen_in(text, in_units(*scene_of(text), units));
    ASSERT_TRUE(here.result.steady && there.result.steady);
    EXPECT_EQ(here.result.steady->periods, there.result.steady->periods);
    expect_same(here, there, units, 0.0);
  }
}

Tradeoff tradeoff_in(const std::string& text, const std::vector<Setting>& settings) {
  constexpr double kSeconds = 60.0;  // far more than it takes: what is left out is not for time
  constexpr double kPace = 1e6;      // evaluations a second, on every machine
  return measure_tradeoff(
      scene_of(text, settings), standard(),
      {.observable = "driver.mean_force.x", .tolerance = 1e-3, .budget = kSeconds, .pace = kPace});
}

TEST(Units, TheTradeIsTheSame) {
  const std::string text = random_scene(0, "overdamped", "integrator = { type = \"dopri5\" }");
  const Units& units = kPowersOfTwo[0];
  const Tradeoff here = tradeoff_in(text, {});
  const Tradeoff there = tradeoff_in(text, in_units(*scene_of(text), units));
  ASSERT_TRUE(here.recommendation) << here.why_none;
  ASSERT_TRUE(there.recommendation) << there.why_none;
  EXPECT_EQ(here.reference->value * units.of(dimension::force), there.reference->value);
  EXPECT_EQ(here.reference->error * units.of(dimension::force), there.reference->error);
  const TradeoffPoint& one = here.points[here.recommendation->point];
  const TradeoffPoint& other = there.points[there.recommendation->point];
  EXPECT_EQ(here.methods[one.method].name, there.methods[other.method].name);
  const bool step = here.methods[one.method].resolution == Resolution::step;
  EXPECT_EQ(one.resolution * (step ? units.time : 1.0), other.resolution);
  EXPECT_EQ(one.value * units.of(dimension::force), other.value);
  EXPECT_EQ(one.evaluations, other.evaluations);
}

/// A tip of an atomic force microscope in metres, kilograms and seconds, without inertia.
constexpr const char* kSiTip = R"(
[[body]]
name = "tip"
type = "point"
position = [1.25e-10]
particle_mass = 1e-12
[[force]]
name = "driver"
type = "driving_spring"
stiffness = 12.8
velocity = [8.944271909999158e-06]
[[force]]
type = "viscous_damping"
coefficient = 7.155417527999326e-06
[[force]]
type = "sinusoidal_substrate"
amplitude = 8e-20
period = 2.5e-10
[run]
duration = 8.385254915624212e-05
ledger = true
dynamics = "overdamped"
integrator = { type = "dopri5" }
[measure]
from = 1
to = 3
in = "driver_periods"
)";

TEST(Units, DefaultTolerancesSeeTheLatticeOfATipInMetres) {
  // Three slips, so that its window is not warned of.
  const RunResult result = run_text(kSiTip, {{"run.duration", "1.12e-4"}, {"measure.to", "4"}});
  ASSERT_EQ(result.status, RunStatus::finished);
  EXPECT_EQ(briefs(result.warnings), std::vector<std::string>{});
  EXPECT_LT(std::abs(*result.group("energy")["numerical_work"]),
            1e-6 * *result.group("energy")["work_in"]);
  const RunResult finer = run_text(
      kSiTip,
      {{"run.integrator",
        "{ type = \"dop853\", absolute_tolerance = 2.5e-22, relative_tolerance = 1e-12 }"}});
  const double exact = finer.driver(0)["mean_force"][0];
  EXPECT_NEAR(result.driver(0)["mean_force"][0], exact, 1e-6 * std::abs(exact));
}

TEST(Units, TheTradeOfATipInMetresIsRelative) {
  constexpr double kPace = 1e6;  // evaluations a second, on every machine
  const Tradeoff found = measure_tradeoff(
      scene_of(kSiTip), standard(),
      {.observable = "driver.mean_force.x", .tolerance = 1e-4, .budget = 20.0, .pace = kPace});
  ASSERT_TRUE(found.reference);
  EXPECT_TRUE(found.scale.relative);
  ASSERT_TRUE(found.recommendation) << found.why_none;
  EXPECT_LT(found.error_of(found.points[found.recommendation->point]), 1e-4);
}

TEST(Units, ToleranceThatSeesNothingIsAnError) {
  const RunResult result = run_text(
      kSiTip, {{"run.integrator",
                "{ type = \"dopri5\", absolute_tolerance = 1e-9, relative_tolerance = 1e-9 }"}});
  ASSERT_EQ(result.status, RunStatus::failed);
  EXPECT_NE(result.failure->what.find("does not resolve the scene's shortest length"),
            std::string::npos);
  // One that hardly does is warned of.
  const RunResult coarse = run_text(
      kSiTip, {{"run.integrator",
                "{ type = \"dopri5\", absolute_tolerance = 1e-11, relative_tolerance = 1e-9 }"}});
  EXPECT_EQ(coarse.status, RunStatus::finished);
  ASSERT_FALSE(coarse.warnings.empty());
  EXPECT_EQ(brief(coarse.warnings[0]), "run.integrator [integrator.coarse_tolerance]");
}

TEST(Units, TheDefaultStandsResolvedInTheEffectiveScene) {
  const auto scene = scene_of(kSiTip);
  EXPECT_NE(scene->effective_toml.find("absolute_tolerance = 2.5e-19"), std::string::npos)
      << scene->effective_toml;
  const auto again = scene_of(scene->effective_toml);
  EXPECT_EQ(again->effective_toml, scene->effective_toml);
  const RunResult one = run(scene);
  const RunResult other = run(again);
  EXPECT_EQ(one.steps, other.steps);
  EXPECT_EQ(one.driver(0)["mean_force"], other.driver(0)["mean_force"]);
}

TEST(NaturalUnits, AreTheShortestPeriodAndTheSwingInItsWells) {
  const NaturalUnits units = natural_units(*scene_of(kSiTip, {{"run.dynamics", "\"inertial\""}}));
  EXPECT_EQ(units.length, 2.5e-10);
  const double stiffness = 8e-20 * std::pow(2.0 * 3.141592653589793 / 2.5e-10, 2.0);
  EXPECT_NEAR(units.time, std::sqrt(1e-12 / stiffness), 1e-12 * units.time);
  EXPECT_NEAR(units.of(dimension::stiffness), stiffness, 1e-12 * stiffness);
  // The driver has no say, however soft or stiff.
  for (const char* other : {"1e-12", "1e12"}) {
    const NaturalUnits found = natural_units(
        *scene_of(kSiTip, {{"run.dynamics", "\"inertial\""}, {"force.driver.stiffness", other}}));
    EXPECT_NEAR(found.time, std::sqrt(1e-12 / stiffness), 1e-12 * found.time) << other;
  }
  // It has where the corrugation is next to nothing.
  const NaturalUnits flat =
      natural_units(*scene_of(kSiTip, {{"run.dynamics", "\"inertial\""},
                                       {"force.sinusoidal_substrate.amplitude", "1e-40"}}));
  EXPECT_NEAR(flat.time, std::sqrt(1e-12 / 12.8), 1e-12 * flat.time);
}

TEST(NaturalUnits, ComeFromSomethingElseWhereNothingIsPeriodic) {
  const char* const oscillator = R"(
[[body]]
type = "point"
position = [3e-9]
particle_mass = 2.0
[[force]]
type = "driving_spring"
stiffness = 8.0
velocity = [0.0]
start = [0.0]
[run]
duration = 10.0
integrator = { type = "dopri5" }
)";
  const NaturalUnits units = natural_units(*scene_of(oscillator));
  EXPECT_EQ(units.time, 0.5);
  EXPECT_EQ(units.length, 3e-9);
  const NaturalUnits driven =
      natural_units(*scene_of(oscillator, {{"force.driving_spring.velocity", "[0.25]"}}));
  EXPECT_EQ(driven.length, 0.125);
}

/// No parameter says the length of a formula: the formula does.
TEST(NaturalUnits, OfAFormulaAreItsOwn) {
  const auto length = [](const std::string& energy) {
    return natural_units(
               *scene_of("body = [{ name = \"tip\", type = \"point\", position = [0.0], "
                         "particle_mass = 1.0 }]\nforce = [{ type = \"expression\", energy = \"" +
                         energy +
                         "\" }]\nrun = { duration = 1.0, integrator = { type = "
                         "\"rk4\", dt = 0.01 } }\n"))
        .length;
  };
  for (const char* period : {"1", "3e-10", "7e5"}) {
    SCOPED_TRACE(period);
    const double expected = std::stod(period);
    for (const char* law : {"cos(2*pi*x/A)", "3e-21*cos(2*pi*x/A)", "5*x^2 + cos(2*pi*x/A)",
                            "exp(-(x/A)^2)", "sin(0.3*t)*cos(2*pi*x/A)"}) {
      std::string energy = law;
      energy.replace(energy.find('A'), 1, period);
      const double found = length(energy);
      EXPECT_GT(found, 0.05 * expected) << energy;
      EXPECT_LT(found, 2.0 * expected) << energy;
    }
  }
  EXPECT_EQ(length("cos(x)") * 1024.0, length("cos(x/1024)"));
  EXPECT_EQ(length("0.5*x^2"), 1.0);
  EXPECT_EQ(length("x^4 - x^2"), 1.0);
}

}  // namespace
}  // namespace tomlin::test
