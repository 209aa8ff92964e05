#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/run/results/observables.hpp"
#include "tests/support/order.hpp"
#include "tests/support/resumed.hpp"
#include "tests/support/ring_scenes.hpp"

// trace, retrace, half_difference, loop_area and loops of drivers that reverse.

namespace tomlin::test {
namespace {

constexpr double kPi = 3.14159265358979323846;

std::string between(double below, double above, const std::string& when = "driver.position.x") {
  return "{ when = \"" + when + "\", above = " + digits(above) + ", below = " + digits(below) +
         " }";
}

std::string window(double from, double to, const std::string& more = "") {
  return "[measure]\nin = \"time\"\nfrom = " + digits(from) + "\nto = " + digits(to) + "\n" + more;
}

double value(const RunResult& result, const std::string& key) { return *result.driver(0)[key]; }

// A damped particle, mass 1, without a substrate. Where strokes outlast its swings it moves with
// the driver at the end of each, a lag of c v / k behind. So its momentum changes by 2 v over a
// stroke of length L, in which it comes L - 2 c v / k far: the spring's impulse is the sum of
// 2 m v and of c times that distance.
constexpr double kStiffness = 2.0;
constexpr double kDamping = 0.7;
constexpr double kVelocity = 0.25;
constexpr double kStart = 0.1;
constexpr double kLength = 20.0;
constexpr double kStroke = kLength / kVelocity;  // swings decay to exp(-28)

TipScene dragged(const std::string& integrator, const std::string& more = "",
                 double duration = 5.4 * kStroke) {
  return {.velocity = kVelocity,
          .stiffness = kStiffness,
          .damping = kDamping,
          .amplitude = 0.0,
          .position = kStart,
          .duration = duration,
          .integrator = integrator,
          .more = more};
}

const std::vector<Setting> kReversing = {
    {"force.driver.reverse", between(kStart, kStart + kLength)}};

double trace_of_dragged(double mass) {
  const double moved = kLength - 2.0 * kDamping * kVelocity / kStiffness;
  return (kDamping * moved + 2.0 * mass * kVelocity) / kStroke;
}

/// The run's rows against the closed form; strokes 2 to 4 are inside of the window.
void expect_dragged(const RunResult& result, double trace, double tolerance,
                    const std::string& what) {
  EXPECT_NEAR(value(result, "trace"), trace, tolerance) << what;
  EXPECT_NEAR(value(result, "retrace"), -trace, tolerance) << what;
  EXPECT_NEAR(value(result, "half_difference"), trace, tolerance) << what;
  EXPECT_NEAR(value(result, "loop_area"), 2.0 * kLength * trace, 2.0 * kLength * tolerance) << what;
  EXPECT_EQ(result.driver(0)["loops"], 1.0) << what;
}

TEST(FrictionLoop, OfADampedParticle) {
  // The window begins and ends within strokes: at 1.3, in the second one, and 5.2 of them.
  const std::string more = window(1.3 * kStroke, 5.2 * kStroke);
  const double trace = trace_of_dragged(1.0);
  for (const auto& [integrator, tolerance] : {std::pair(fixed_step(0.05), 1e-8),
                                              {verlet(0.02), 1e-5},
                                              {adaptive(1e-10), 1e-8},
                                              {adaptive(1e-10, "radau9"), 1e-8}}) {
    const RunResult result = run(scene_of(dragged(integrator, more).text(), kReversing));
    expect_dragged(result, trace, tolerance, integrator);
    // The control: incomplete strokes would tell, as would a trace without the inertia.
    EXPECT_GT(std::abs(*result.driver(0)["mean_force_along"]), 1e-3);
    EXPECT_GT(std::abs(trace - trace_of_dragged(0.0)), 1e-3);
  }
}

TEST(FrictionLoop, InQuadruplePrecisionAndWithoutInertia) {
  const std::string more = window(1.3 * kStroke, 5.2 * kStroke);
  const auto run_with = [&](double dt, const Setting& setting) {
    return run(scene_of(dragged(fixed_step(dt), more).text(), {kReversing.front(), setting}));
  };
  expect_dragged(run_with(0.1, {"run.number_type", "\"quadruple\""}), trace_of_dragged(1.0), 1e-7,
                 "quadruple");
  expect_dragged(run_with(0.05, {"run.dynamics", "\"overdamped\""}), trace_of_dragged(0.0), 1e-8,
                 "overdamped");
}

TEST(FrictionLoop, HasTheOrderOfTheScheme) {
  // Strokes end within steps; were integrals taken where steps end, errors would be of first order.
  const std::vector<Setting> settings = {{"force.driver.reverse", between(0.0, 0.777)}};
  const auto scene = [&](const std::string& integrator) {
    return run(scene_of(dragged(integrator, window(0.0, 30.0), 30.0).text(), settings));
  };
  const RunResult exact = scene(adaptive(1e-13, "dop853"));
  ASSERT_GT(*exact.driver(0)["loops"], 2.0);
  for (const auto& [integrator, order] :
       {std::pair(&fixed_step, Window{3.4, 4.9}), {&verlet, Window{1.6, 2.6}}}) {
    for (const char* key : {"trace", "retrace", "loop_area"}) {
      const std::vector<double> steps = {0.16, 0.08, 0.04, 0.02};
      std::vector<double> errors;
      for (const double dt : steps) {
        errors.push_back(std::abs(value(scene(integrator(dt)), key) - value(exact, key)));
      }
      const double found = fitted_order(steps, errors);
      EXPECT_TRUE(order.holds(found)) << key << " " << found;
    }
  }
}

TEST(FrictionLoop, OfOneStrokeIsNone) {
  // A stroke alone has a mean force; the first, from the start, and the last, to the end, have
  // none.
  const RunResult one =
      run(scene_of(dragged(fixed_step(0.05), "", 2.5 * kStroke).text(), kReversing));
  EXPECT_FALSE(one.driver(0)["trace"]);
  EXPECT_NEAR(value(one, "retrace"), -trace_of_dragged(1.0), 1e-8);
  EXPECT_FALSE(one.driver(0)["half_difference"]);
  EXPECT_FALSE(one.driver(0)["loop_area"]);
  EXPECT_EQ(one.driver(0)["loops"], 0.0);
  const RunResult none =
      run(scene_of(dragged(fixed_step(0.05), "", 1.9 * kStroke).text(), kReversing));
  EXPECT_FALSE(none.driver(0)["retrace"]);
  EXPECT_EQ(none.driver(0)["loops"], 0.0);
  // Nor has a driver that does not reverse.
  const RunResult straight = run(scene_of(dragged(fixed_step(0.05), "", kStroke).text()));
  EXPECT_EQ(straight.driver(0).find("loops"), nullptr);
}

/// Overdamped, by the stick-slip parameter s.
TipScene tip(double s, double velocity, double duration, const std::string& more) {
  const double stiffness = 2.0;
  return {.velocity = velocity,
          .stiffness = stiffness,
          .damping = 1.0,
          .amplitude = s * stiffness / (4.0 * kPi * kPi),
          .position = 0.5,  // a minimum
          .duration = duration,
          .integrator = fixed_step(0.02),
          .more = more};
}

TEST(FrictionLoop, OfSmoothSliding) {
  // Without instabilities a slow tip follows its equilibrium, whose velocity is v / (1 + s cos):
  // the friction force is c <x'^2> / v = c v / sqrt(1 - s^2). Where it reverses the tip lags by
  // c v / k over 1 - s, a part of 1e-3 of the stroke.
  const double velocity = 0.001;
  const double length = 4.0;
  for (const double s : {0.0, 0.5, 0.8}) {
    TipScene scene = tip(s, velocity, 3.0 * length / velocity, "");
    scene.integrator = fixed_step(0.1);
    const RunResult result = run(scene_of(
        scene.text(), {{"force.driver.reverse", between(0.5 - 0.5 * length, 0.5 + 0.5 * length)},
                       {"run.dynamics", "\"overdamped\""}}));
    const double closed = velocity / std::sqrt(1.0 - s * s);
    EXPECT_NEAR(value(result, "half_difference") / closed, 1.0, 0.01) << s;
    EXPECT_NEAR(value(result, "trace"), -value(result, "retrace"), 1e-6 * closed) << s;
    EXPECT_EQ(result.driver(0)["loops"], 1.0);
  }
}

TEST(FrictionLoop, AreaIsTheHeatOfACycle) {
  // Stick-slip: from one reversal to the same one later, in the steady cycle, nothing is stored.
  // What rk4 itself adds in slips is 1e-6 of the work.
  const double velocity = 0.01;
  const double length = 6.0;
  const double stroke = length / velocity;
  const double from = 1.5 * stroke;  // where the driver reverses at the lower limit
  const std::vector<Setting> settings = {
      {"force.driver.reverse", between(0.5 - 0.5 * length, 0.5 + 0.5 * length)},
      {"run.dynamics", "\"overdamped\""},
      {"run.ledger", "true"}};
  const double margin = 1e-6;  // rounding of the times of reversals
  const RunResult result = run(scene_of(
      tip(4.0, velocity, 4.0 * stroke, window(from - margin, from + 2.0 * stroke + margin)).text(),
      settings));
  EXPECT_EQ(result.driver(0)["loops"], 1.0);
  EXPECT_NEAR(value(result, "loop_area"), *observable(result, "energy.heat_out"), 3e-5);
  EXPECT_NEAR(value(result, "loop_area"), value(result, "work"), 1e-6);
  EXPECT_NEAR(value(result, "loop_area"), 2.0 * length * value(result, "half_difference"), 1e-9);
  EXPECT_NEAR(value(result, "trace"), -value(result, "retrace"), 1e-6);
  // Friction of slips, not of viscous sliding.
  EXPECT_GT(value(result, "half_difference"), 10.0 * velocity);
}

TEST(FrictionLoop, ResumesFromAnyStep) {
  const std::vector<Setting> settings = {{"force.driver.reverse", between(0.0, 0.777)}};
  for (const std::string& integrator : {fixed_step(0.1), verlet(0.05), adaptive(1e-7)}) {
    const auto scene = scene_of(dragged(integrator, window(4.321, 27.0), 30.0).text(), settings);
    const RunResult expected = run_as_bound(scene);
    ASSERT_GT(*expected.driver(0)["loops"], 2.0);
    expect_same_driver_from(scene, expected, 1, 7);
  }
}

/// A tip without inertia in a bath, back and forth over six periods: so many loops.
std::string noisy_loops(int stream, double loops) {
  constexpr double kNoisyVelocity = 0.02;
  constexpr double kLoop = 2.0 * 6.0 / kNoisyVelocity;
  return tables(R"([[body]] | name = "tip" | type = "point" | position = [0.5]
particle_mass = 1.0
[[force]] | name = "driver" | type = "driving_spring" | stiffness = 0.8 | velocity = [)") +
         digits(kNoisyVelocity) + "]\nreverse = " + between(0.5, 6.5) + tables(R"(
[[force]] | name = "bath" | type = "langevin" | coefficient = 1.0 | temperature = 0.02
[[force]] | type = "sinusoidal_substrate" | amplitude = 0.1 | period = 1.0
[run] | dynamics = "overdamped" | integrator = { type = "euler_maruyama", dt = 0.04 }
stream = )") +
         std::to_string(stream) + "\nduration = " + digits((loops + 0.75) * kLoop) + "\n";
}

/// Standard errors from strokes and loops agree with the scatter of means over streams.
TEST(FrictionLoop, HasStandardErrorsInNoise) {
  constexpr int kStreams = 24;
  // The scatter of 24 streams has a standard deviation of 1 in 7, that of 12 loops 1 in 5 each.
  constexpr double kLeastRatio = 0.6;
  constexpr double kMostRatio = 1.7;
  std::vector<RunResult> results;
  for (int stream = 0; stream < kStreams; ++stream) {
    results.push_back(run_text(noisy_loops(stream, 12.0)));
    EXPECT_GE(value(results.back(), "loops"), 11.0);
  }
  for (const std::string key : {"trace", "retrace", "half_difference", "loop_area"}) {
    double mean = 0.0;
    double squares = 0.0;
    double stated = 0.0;
    for (const RunResult& result : results) {
      const double x = value(result, key);
      mean += x / kStreams;
      squares += x * x / kStreams;
      stated += std::pow(stated_error(result, "drivers.driver." + key).value(), 2) / kStreams;
    }
    const double scatter = (squares - mean * mean) * kStreams / (kStreams - 1.0);
    const double ratio = std::sqrt(stated / scatter);
    EXPECT_GT(ratio, kLeastRatio) << key;
    EXPECT_LT(ratio, kMostRatio) << key;
  }
}

TEST(FrictionLoop, OfFewLoopsHasNoStandardError) {
  const RunResult few = run_text(noisy_loops(0, 5.0));
  ASSERT_TRUE(few.driver(0)["half_difference"]);
  EXPECT_FALSE(stated_error(few, "drivers.driver.half_difference"));
  EXPECT_EQ(count_of(FaultCode::run_error_not_estimated, few.warnings), 1U);
}

TEST(FrictionLoop, EndsAtTheErrorThatIsAskedFor) {
  constexpr double kError = 4e-3;
  const RunResult result = run_text(
      noisy_loops(0, 200.0),
      {{"run.until", "{ error = " + digits(kError) + ", of = \"driver.half_difference\" }"}});
  ASSERT_TRUE(result.until_error);
  EXPECT_TRUE(result.until_error->reached);
  EXPECT_LE(stated_error(result, "drivers.driver.half_difference").value(), kError);
  EXPECT_LT(value(result, "loops"), 150.0);
  EXPECT_GE(value(result, "loops"), 8.0);
}

// `reverse` with two limits.

TEST(FrictionLoop, GoesOnAsLongAsTheRun) {
  const auto reversals = [](const std::string& more) {
    std::string reverse = between(kStart, kStart + 1.0);
    reverse.replace(reverse.find(" }"), 2, more + " }");
    const RunResult result = run(
        scene_of(dragged(fixed_step(0.05), "", 200.0).text(), {{"force.driver.reverse", reverse}}));
    return *result.group("events")["driver_reversals"];
  };
  // Every four units of time; the last at the end of the run may fall to either side.
  EXPECT_NEAR(reversals(""), 50.0, 1.0);
  EXPECT_EQ(reversals(", times = 7"), 7.0);
  EXPECT_EQ(reversals(", times = 1"), 1.0);
  const RunResult once =
      run(scene_of(dragged(fixed_step(0.05), "", 200.0).text(),
                   {{"force.driver.reverse", "{ when = \"driver.position.x\", above = 1.0 }"}}));
  EXPECT_EQ(once.group("events")["driver_reversals"], 1u);
}

/// How far the driver gets from its limits, where what it pulls swings about one of them.
double farthest(const std::string& times) {
  // A slip of an underdamped tip: it swings about the bottom of a well, which is the limit.
  TipScene scene{.velocity = 0.05,
                 .stiffness = 1.0,
                 .damping = 0.3,
                 .amplitude = 0.2,
                 .position = 0.5,
                 .duration = 600.0,
                 .integrator = fixed_step(0.02),
                 .more = "[output]\nevery = 1.0\n"};
  std::string reverse = between(0.5, 3.5, "tip.centre_of_mass.x");
  reverse.replace(reverse.find(" }"), 2, times + " }");
  KeptSamples kept;
  run(scene_of(scene.text(), {{"force.driver.reverse", reverse}}), watched_by(kept));
  const std::size_t column = kept.column("driver.position.x");
  double most = 0.0;
  for (const auto& row : kept.rows) most = std::max(most, std::abs(row[column] - 2.0) - 1.5);
  return most;
}

TEST(FrictionLoop, LimitsCountAlternately) {
  EXPECT_LT(farthest(""), 3.0);
  // The control: where each passage counts the driver leaves for good.
  EXPECT_GT(farthest(", times = 1000"), 6.0);
}

/// A body that first swings back through the limit behind the driver does not turn it round.
TEST(FrictionLoop, TheLimitBehindTheDriverCountsSecond) {
  for (const double way : {1.0, -1.0}) {
    const double above = way > 0.0 ? 2.0 : 0.1;
    const double below = way > 0.0 ? -0.1 : -2.0;
    const RunResult result =
        run_text(tables(R"([[body]] | name = "tip" | type = "point"
position = [0.0] | velocity = [)") +
                 digits(-0.5 * way) + tables(R"(]
particle_mass = 1.0
[[force]] | name = "driver" | type = "driving_spring" | stiffness = 2.0 | velocity = [)") +
                 digits(0.05 * way) +
                 "]\nreverse = " + between(below, above, "bodies.tip.centre_of_mass.x") + tables(R"(
[[force]] | type = "viscous_damping" | coefficient = 1.0
[run] | duration = 400.0 | integrator = )") +
                 fixed_step(0.02) + "\n");
    // Nine strokes of 2.15 at 0.05, and two turns of the tip when it begins.
    EXPECT_EQ(observable(result, "events.reversals").value(), 11.0);
  }
}

TEST(FrictionLoop, LimitsOfTheEffectiveScene) {
  const auto effective = [](const std::string& reverse) {
    const auto scene =
        scene_of(dragged(fixed_step(0.05)).text(), {{"force.driver.reverse", reverse}});
    const std::string text = scene->effective_toml;
    EXPECT_EQ(scene_of(text)->effective_toml, text);
    const std::size_t line = text.find("reverse");
    return text.substr(line, text.find('\n', line) - line);
  };
  const std::string when = "{ when = \"driver.position.x\", ";
  EXPECT_EQ(effective(when + "above = 1.0, below = 0.0 }"),
            "reverse = " + when + "above = 1.0, below = 0.0 }");
  EXPECT_EQ(effective(when + "above = 1.0, below = 0.0, times = 1 }"),
            "reverse = " + when + "above = 1.0, below = 0.0, times = 1 }");
  EXPECT_EQ(effective(when + "above = 1.0 }"), "reverse = " + when + "above = 1.0 }");
}

}  // namespace
}  // namespace tomlin::test
