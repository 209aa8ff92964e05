#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/order.hpp"
#include "tests/support/oscillator.hpp"
#include "tests/support/resumed.hpp"
#include "tests/support/ring_scenes.hpp"

// A driver that turns round when an observable passes a value, against the closed form of a damped
// particle on a spring whose end goes forth and back.

namespace tomlin::test {
namespace {

constexpr double kStiffness = 2.0;
constexpr double kDamping = 0.7;
constexpr double kVelocity = 0.25;
constexpr double kValue = 1.3;
constexpr double kDuration = 12.0;

/// The particle, of mass 1, and the spring's support.
struct Pulled {
  double x = 0.0, v = 0.0, end = 0.0, velocity = kVelocity;

  /// After a time: m x'' + c x' + k x = k (end + velocity t).
  Pulled after(double t) const {
    const Oscillator about_the_end{
        .m = 1.0, .k = kStiffness, .c = kDamping, .pull = velocity, .x0 = x - end, .v0 = v};
    const State later = about_the_end.at(t);
    return {end + later.x, later.v, end + velocity * t, velocity};
  }

  /// When x first passes a value, upwards.
  double when(double value) const {
    double low = 0.0;
    while (after(low + 1e-2).x <= value) low += 1e-2;
    double high = low + 1e-2;
    for (int k = 0; k < 80; ++k) {
      const double middle = 0.5 * (low + high);
      (after(middle).x <= value ? low : high) = middle;
    }
    return low;
  }
};

double event_time() { return Pulled{.x = 0.1, .end = 0.1}.when(kValue); }

/// The end of the run, turned round at a time.
Pulled end_of(double turned, double duration = kDuration) {
  Pulled there = Pulled{.x = 0.1, .end = 0.1}.after(turned);
  there.velocity = -there.velocity;
  return there.after(duration - turned);
}

TipScene tip(const std::string& integrator, const std::string& more = "") {
  return {.velocity = kVelocity,
          .stiffness = kStiffness,
          .damping = kDamping,
          .amplitude = 0.0,
          .position = 0.1,
          .duration = kDuration,
          .integrator = integrator,
          .more = more};
}

std::string passing(const std::string& what) { return "{ when = " + what + " }"; }
const std::string kWhen = "\"bodies.tip.centre_of_mass.x\"";
const std::vector<Setting> kTurned = {
    {"force.driver.reverse", passing(kWhen + ", above = " + digits(kValue))}};

struct Turned {
  double time = 0.0;
  double x = 0.0;
  RunResult result;
  KeptSamples kept;
};

Turned run_turned(const TipScene& scene, const std::vector<Setting>& settings = kTurned) {
  Turned turned;
  turned.result = run(scene_of(scene.text(), settings), watched_by(turned.kept));
  const auto events = turned.kept.of(EventKind::driver_reversal);
  if (!events.empty()) turned.time = events.front().time;
  turned.x = turned.result.family("bodies").front()["centre_of_mass"].front();
  return turned;
}

/// Orders of the time of the event and of the position at the end.
void expect_orders(std::string (*integrator)(double), Window window) {
  const std::vector<double> steps = {0.16, 0.08, 0.04, 0.02};
  std::vector<double> time_errors;
  std::vector<double> position_errors;
  const double exact = event_time();
  for (const double dt : steps) {
    const Turned turned = run_turned(tip(integrator(dt)));
    ASSERT_EQ(turned.result.status, RunStatus::finished);
    EXPECT_EQ(turned.result.group("events")["driver_reversals"], 1u);
    time_errors.push_back(std::abs(turned.time - exact));
    position_errors.push_back(std::abs(turned.x - end_of(exact).x));
    // The control: were the event put at the end of its step, the position would be off by far
    // more.
    const double late = std::ceil(exact / dt) * dt;
    EXPECT_GT(std::abs(end_of(late).x - end_of(exact).x), 20.0 * position_errors.back()) << dt;
  }
  EXPECT_TRUE(window.holds(fitted_order(steps, time_errors))) << fitted_order(steps, time_errors);
  EXPECT_TRUE(window.holds(fitted_order(steps, position_errors)))
      << fitted_order(steps, position_errors);
}

TEST(DriverReversal, IsFoundToTheOrderOfTheScheme) {
  // A step is cut where the event falls, so errors are less regular than without it.
  expect_orders(&fixed_step, {3.5, 4.8});
  expect_orders(&verlet, {1.7, 2.5});
}

TEST(DriverReversal, IsFoundByAdaptiveStepsAndInQuadruplePrecision) {
  constexpr double kTolerance = 1e-8;  // at 1e-11 a step, a few dozen steps, dense output; of rk4
  auto settings = kTurned;
  settings.push_back({"run.number_type", "\"quadruple\""});
  for (const Turned& turned :
       {run_turned(tip(adaptive(1e-11))), run_turned(tip(fixed_step(0.01)), settings)}) {
    EXPECT_NEAR(turned.time, event_time(), kTolerance);
    EXPECT_NEAR(turned.x, end_of(event_time()).x, kTolerance);
  }
}

TEST(DriverReversal, WithoutInertiaToo) {
  // c x' = k (X - x): the particle lags by V c/k once started.
  auto settings = kTurned;
  settings.push_back({"run.dynamics", "\"overdamped\""});
  const Turned turned = run_turned(tip(fixed_step(0.01)), settings);
  const double tau = kDamping / kStiffness;
  double low = 0.0;
  double high = kDuration;
  const auto position = [&](double t) {
    return 0.1 + kVelocity * (t - tau * (1.0 - std::exp(-t / tau)));
  };
  for (int k = 0; k < 80; ++k) {
    const double middle = 0.5 * (low + high);
    (position(middle) <= kValue ? low : high) = middle;
  }
  const double end = 0.1 + kVelocity * low;
  const double s = kDuration - low;
  const double exact =
      end - kVelocity * s + kVelocity * tau + (kValue - end - kVelocity * tau) * std::exp(-s / tau);
  EXPECT_NEAR(turned.time, low, 1e-9);
  EXPECT_NEAR(turned.x, exact, 1e-9);
}

TEST(DriverReversal, StepsReturnToTheGrid) {
  const Turned turned = run_turned(tip(fixed_step(0.01)));
  EXPECT_EQ(turned.result.steps, 1201u);
  EXPECT_EQ(turned.result.end_time, kDuration);
  // A support that turns where a step ends anyway splits nothing.
  const std::vector<Setting> at_step = {
      {"force.driver.reverse",
       passing("\"driver.position.x\", above = " + digits(0.1 + 0.25 * 2.0))}};
  EXPECT_LE(run_turned(tip(fixed_step(0.01)), at_step).result.steps, 1201u);
}

TEST(DriverReversal, ThePulledEndGoesBackTheWayItCame) {
  const Turned turned = run_turned(tip(fixed_step(0.01), "[output]\nevery = 0.037\n"));
  const std::size_t time = turned.kept.column("time");
  const std::size_t position = turned.kept.column("driver.position.x");
  ASSERT_GT(static_cast<double>(turned.kept.rows.size()), kDuration / 0.037);
  for (const auto& row : turned.kept.rows) {
    const double t = row[time];
    const double way = t <= turned.time ? t : 2.0 * turned.time - t;
    ASSERT_NEAR(row[position], 0.1 + kVelocity * way, 1e-14) << t;
  }
}

TEST(DriverReversal, SamplesDoNotAlterIt) {
  for (const std::string& integrator : {fixed_step(0.01), verlet(0.01), adaptive(1e-8)}) {
    const Motion alone = motion_at_end(tip(integrator).text(), kTurned);
    KeptSamples kept;
    const std::string more = "[output]\nevery = 0.0077\n[measure]\nin = \"time\"\nfrom = 3.3\n";
    EXPECT_TRUE(motion_at_end(tip(integrator, more).text(), kTurned, watched_by(kept)) == alone);
    EXPECT_GT(kept.rows.size(), 1000u);
  }
}

TEST(DriverReversal, ForthAndBackBetweenTwoValues) {
  const std::vector<Setting> cycle = {
      {"force.driver.reverse", passing(kWhen + ", above = 1.0, below = 0.0, times = 3")},
      {"run.duration", "40.0"}};
  const Turned turned = run_turned(tip(fixed_step(0.01), "[output]\nevery = 0.01\n"), cycle);
  const auto events = turned.kept.of(EventKind::driver_reversal);
  ASSERT_EQ(events.size(), 3u);
  const std::size_t x = turned.kept.column("tip.centre_of_mass.x");
  const double values[] = {1.0, 0.0, 1.0};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto before = static_cast<std::size_t>(events[k].time / 0.01);
    const double low = std::min(turned.kept.rows[before][x], turned.kept.rows[before + 1][x]);
    const double high = std::max(turned.kept.rows[before][x], turned.kept.rows[before + 1][x]);
    EXPECT_LE(low, values[k]);
    EXPECT_GE(high, values[k]);
  }
  // No more than asked for: the fourth time it goes on.
  EXPECT_LT(turned.x, -0.5);
}

TEST(DriverReversal, OnWhateverHasAValueAtEachMoment) {
  struct Case {
    std::string when, column;
    double value;
  };
  for (const Case& one : {Case{"drivers.driver.force.x", "driver.force.x", 0.06},
                          Case{"driver.position.x", "driver.position.x", 0.83},
                          Case{"tip.velocity.x", "tip.velocity.x", 0.29}}) {
    const std::vector<Setting> settings = {
        {"force.driver.reverse", passing("\"" + one.when + "\", above = " + digits(one.value))}};
    const Turned turned = run_turned(tip(fixed_step(0.01), "[output]\nevery = 0.01\n"), settings);
    const auto events = turned.kept.of(EventKind::driver_reversal);
    ASSERT_EQ(events.size(), 1u) << one.when;
    const std::size_t column = turned.kept.column(one.column);
    const auto before = static_cast<std::size_t>(events[0].time / 0.01);
    EXPECT_LE(turned.kept.rows[before][column], one.value) << one.when;
    for (std::size_t k = 0; k < before; ++k) {
      ASSERT_LE(turned.kept.rows[k][column], one.value) << one.when;
    }
  }
}

TEST(DriverReversal, ARingMayTurnItsDriverByItsRotation) {
  RingScene ring{.coordinates = "rigid",
                 .velocity = 0.02,
                 .duration = 200.0,
                 .integrator = adaptive(1e-9),
                 .more = "[output]\nevery = 0.5\n"};
  const std::vector<Setting> settings = {
      {"force.driver.reverse", passing("\"ring.rotation\", below = -0.5")}};
  KeptSamples kept;
  const RunResult result = run(scene_of(ring.text(), settings), watched_by(kept));
  const auto events = kept.of(EventKind::driver_reversal);
  ASSERT_EQ(events.size(), 1u);
  const std::size_t rotation = kept.column("ring.rotation");
  const auto before = static_cast<std::size_t>(events[0].time / 0.5);
  EXPECT_GE(kept.rows[before][rotation], -0.5);
  EXPECT_LE(kept.rows[before + 1][rotation], -0.5 + 0.02);
  EXPECT_LT(result.driver(0)["final_force"][0], 0.0);
}

TEST(DriverReversal, WhatCannotBeIsRefused) {
  const auto said = [](const std::string& reverse) {
    try {
      Engine engine(scene_of(tip(fixed_step(0.01)).text(), {{"force.driver.reverse", reverse}}),
                    {});
    } catch (const InputError& error) {
      Fault fault = error.faults().at(0);
      fault.value.clear();  // mostly the beginning of what is given
      return brief(fault);
    }
    return std::string();
  };
  const std::string key = "force.driver.reverse";
  EXPECT_EQ(said(passing("\"tip.centre_of_mas.x\", above = 1.0")),
            key + ".when [observable.unknown] did you mean tip.centre_of_mass.x");
  EXPECT_EQ(said(passing("\"driver.mean_force.x\", above = 1.0")),
            key + ".when [observable.unknown]");
  EXPECT_EQ(said(passing(kWhen)), key + " [scene.missing_key]");
  EXPECT_EQ(said("{ above = 1.0 }"), key + " [scene.missing_key]");
  EXPECT_EQ(said(passing(kWhen + ", above = 0.0, below = 1.0")), key + " [scene.conflict]");
  EXPECT_EQ(said(passing(kWhen + ", above = 0.0, times = 0")), key + ".times [scene.out_of_range]");
  EXPECT_EQ(said(passing(kWhen + ", abov = 0.0")), key + " [scene.unknown_key]");
  EXPECT_EQ(said(passing(kWhen + ", above = \"2 * 3\"")), "");
}

TEST(DriverReversal, BeyondItsValueFromTheStartIsWarnedOf) {
  const std::vector<Setting> settings = {
      {"force.driver.reverse", passing(kWhen + ", above = 0.05")}};
  const Turned turned = run_turned(tip(fixed_step(0.01)), settings);
  EXPECT_EQ(briefs(turned.result.warnings),
            std::vector<std::string>{"force.driver.reverse [run.reverse_passed]"});
  EXPECT_EQ(turned.result.group("events")["driver_reversals"], 0u);
}

/// Gone on with from the bytes of any step, before, at and after the event, the run ends the same.
TEST(DriverReversal, GoesOnFromAnyStep) {
  for (const std::string& integrator : {fixed_step(0.05), verlet(0.05), adaptive(1e-7)}) {
    SCOPED_TRACE(integrator);
    expect_same_from_any_step(scene_of(tip(integrator, "[output]\nevery = 0.21\n").text(), kTurned),
                              [](const RunResult& whole, const RunResult& resumed) {
                                EXPECT_GT(whole.group("events")["driver_reversals"].value(), 0.0);
                                EXPECT_EQ(resumed.group("events")["driver_reversals"],
                                          whole.group("events")["driver_reversals"]);
                              });
  }
}

/// A sample within a step makes the next one's first evaluation; whoever goes on from a checkpoint
/// right after it makes it again, and counts it once.
TEST(Checkpoint, CountsNoEvaluationTwice) {
  class Keeper : public KeptSamples {
   public:
    void checkpoint(const RunState& state) override { states.push_back(state.to_bytes()); }
    std::vector<std::vector<std::byte>> states;
  };
  const auto scene = scene_of(tip(fixed_step(0.01), "[output]\nevery = 0.0077\n").text(),
                              {{"run.checkpoint_every", "1e-9"}});
  Keeper whole;
  const RunResult expected = run(scene, watched_by(whole));
  ASSERT_GT(whole.states.size(), 50u);
  for (const auto& bytes : whole.states) {
    Keeper rest;
    RunOptions resumed;
    resumed.sink = &rest;
    resumed.resume_from = &bytes;
    EXPECT_EQ(run(scene, resumed).force_evaluations, expected.force_evaluations);
  }
}

}  // namespace
}  // namespace tomlin::test
