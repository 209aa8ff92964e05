#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/text/fault.hpp"
#include "framework/model/final_state.hpp"
#include "framework/run/results/observables.hpp"
#include "framework/study/sweep/line_run.hpp"
#include "framework/study/sweep/point_run.hpp"
#include "framework/study/sweep/runner.hpp"
#include "framework/study/sweep/sweep_plan.hpp"
#include "tests/framework/output/temporary_folder.hpp"
#include "tests/framework/study/sweep_fixture.hpp"
#include "tests/support/ring_scenes.hpp"
#include "tests/support/text.hpp"

/// Runs that start where another one has ended, and sweeps of them.
namespace tomlin::test {
namespace {

/// Numbers of doubles after some thousand steps.
constexpr double kRoundingOfRuns = 1e-10;
/// An adaptive scheme takes other steps, each within 1e-10, and slips enlarge what they differ by.
constexpr double kOtherSteps = 1e-6;

const std::string kContinuedTip = R"(
[parameters]
v = 0.140625
[[body]]
name = "tip"
type = "point"
position = [0.5]
particle_mass = 1.0
[[force]]
name = "driver"
type = "driving_spring"
stiffness = 1.0
velocity = ["v"]
[[force]]
name = "drag"
type = "viscous_damping"
coefficient = 2.0
[[force]]
type = "sinusoidal_substrate"
amplitude = 0.1
period = 1.0
[run]
duration = 16.0
integrator = { type = "rk4", dt = 0.015625 }
)";

const std::string kContinuedPusher = R"(
[[body]]
name = "tip"
type = "point"
position = [0.5]
particle_mass = 1.0
[[body]]
name = "pusher"
type = "point"
position = [0.0]
particle_mass = 1.0
coordinates = "prescribed"
motion = { velocity = ["0.05 * cos(2 * pi * t / 16) + 0.1"] }
[[force]]
type = "expression"
bodies = ["tip", "pusher"]
pairs = "all"
energy = "0.5 * (r - 0.5)^2"
[[force]]
name = "drag"
type = "viscous_damping"
body = "tip"
coefficient = 2.0
[run]
duration = 16.0
integrator = { type = "rk4", dt = 0.015625 }
)";

struct ContinuedRun {
  RunResult result;
  FinalState end;
};

ContinuedRun continued(const std::string& text, const std::vector<Setting>& settings = {},
                       const FinalState* from = nullptr) {
  ContinuedRun run;
  RunOptions options;
  options.start_from = from;
  options.final_state = &run.end;
  run.result = run_text(text, settings, options);
  return run;
}

void expect_near(const std::vector<Quad>& a, const std::vector<Quad>& b, double tolerance,
                 const std::string& what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_NEAR(static_cast<double>(a[k]), static_cast<double>(b[k]), tolerance)
        << what << ", number " << k;
  }
}

struct ContinuedCase {
  std::string name;
  std::string text;
  double tolerance = kRoundingOfRuns;
};

std::vector<ContinuedCase> continued_cases() {
  const std::string rk4 = "{ type = \"rk4\", dt = 0.015625 }";
  const auto with = [&](const std::string& more) { return kContinuedTip + more + "\n"; };
  RingScene rigid;
  rigid.coordinates = "rigid";
  return {
      {"fixed steps", kContinuedTip},
      {"adaptive", replaced(kContinuedTip, rk4, adaptive(1e-10)), kOtherSteps},
      {"overdamped", with("dynamics = \"overdamped\"")},
      {"quasistatic", replaced(with("dynamics = \"quasistatic\""), "integrator = " + rk4, ""),
       kOtherSteps},
      {"quadruple", with("number_type = \"quadruple\"")},
      {"far away", replaced(kContinuedTip, "position = [0.5]", "position = [-1000000.5]")},
      {"start of the driver",
       replaced(kContinuedTip, "stiffness = 1.0", "start = [0.25]\nstiffness = 1.0")},
      {"internal variables",
       replaced(kContinuedTip, "type = \"viscous_damping\"\ncoefficient = 2.0",
                "type = \"memory_damping\"\ncoefficient = 2.0\nmemory_time = 4.0")},
      {"particles", RingScene().text()},
      {"rigid", rigid.text()},
      {"prescribed in time", kContinuedPusher},
      {"prescribed", replaced(kContinuedPusher, "0.05 * cos(2 * pi * t / 16) + ", "")},
  };
}

/// The second half of a run of twice the duration.
TEST(Continued, TwoRunsAreOneOfTwiceTheDuration) {
  for (const ContinuedCase& one : continued_cases()) {
    SCOPED_TRACE(one.name);
    const double duration = scene_of(one.text)->run.duration;
    const std::string whole = digits(2.0 * duration);
    const ContinuedRun first = continued(one.text);
    ASSERT_EQ(first.result.status, RunStatus::finished);
    const ContinuedRun second = continued(one.text, {}, &first.end);
    ASSERT_EQ(second.result.status, RunStatus::finished);
    const ContinuedRun both = continued(
        one.text,
        {{"run.duration", whole}, {"measure.from", digits(duration)}, {"measure.to", whole}});
    EXPECT_EQ(second.result.end_time, duration);
    EXPECT_EQ(second.end.structure, both.end.structure);
    expect_near(second.end.velocity, both.end.velocity, one.tolerance, "velocity");
    for (const ResultGroup& body : both.result.family("bodies")) {
      const std::string path = "bodies." + body.name + ".centre_of_mass.x";
      EXPECT_NEAR(*observable(second.result, path), *observable(both.result, path), one.tolerance);
    }
    if (second.end.origin.cells == both.end.origin.cells) {
      expect_near(second.end.position, both.end.position, one.tolerance, "position");
      expect_near(second.end.own, both.end.own, one.tolerance, "internal variable");
    }
    ASSERT_EQ(second.end.supports.size(), both.end.supports.size());
    for (std::size_t k = 0; k < both.end.supports.size(); ++k) {
      EXPECT_EQ(second.end.supports[k].name, both.end.supports[k].name);
      expect_near(second.end.supports[k].position, both.end.supports[k].position, kRoundingOfRuns,
                  "support");
    }
    const std::string force = "drivers." + second.result.driver(0).name + ".mean_force.x";
    EXPECT_NEAR(*observable(second.result, force), *observable(both.result, force), one.tolerance);
    for (const Warning& warning : second.result.warnings) {
      EXPECT_NE(warning.code, FaultCode::run_energy_balance) << warning.text;
    }
    // Another start is another run.
    EXPECT_GT(std::abs(*observable(first.result, force) - *observable(both.result, force)),
              10.0 * one.tolerance);
  }
}

/// If every number is a sum of few powers of two, a scene that states these positions gives the
/// same to the last bit.
TEST(Continued, HasTheBitsOfASceneThatStartsThere) {
  std::string text = replaced(kContinuedTip, "amplitude = 0.1", "amplitude = -0.1");
  text = replaced(text, "position = [0.5]", "position = [0.125]");
  const ContinuedRun first = continued(text, {{"v", "0.015625"}});
  const std::vector<Setting> slower = {{"v", "0.0078125"}};
  const ContinuedRun second = continued(text, slower, &first.end);
  ASSERT_EQ(first.end.origin.cells[0], 0);
  const double support = 0.125 + 16.0 * 0.015625;
  std::vector<Setting> there = slower;
  there.push_back({"force.driver.start", "[" + digits(support) + "]"});
  there.push_back(
      {"body.tip.position", "[" + digits(static_cast<double>(first.end.position[0])) + "]"});
  there.push_back(
      {"body.tip.velocity", "[" + digits(static_cast<double>(first.end.velocity[0])) + "]"});
  const RunResult other = run_text(text, there);
  for (const char* path : {"driver.mean_force.x", "driver.work", "driver.max_force.x",
                           "tip.centre_of_mass.x", "tip.velocity.x", "time.force_evaluations"}) {
    EXPECT_EQ(*observable(second.result, path), *observable(other, path)) << path;
  }
}

/// Cells of another length hold the same positions.
TEST(Continued, PeriodsMayDiffer) {
  const ContinuedRun first = continued(kContinuedTip, {{"v", "0.5"}});
  ASSERT_NE(first.end.origin.cells[0], 0);
  const std::vector<Setting> other = {
      {"v", "0"}, {"force.sinusoidal_substrate.period", "0.7"}, {"run.duration", "1e-3"}};
  const ContinuedRun second = continued(kContinuedTip, other, &first.end);
  const double moved = 1e-3 * 2.0;  // no faster than twice the driver
  const auto position = [](const FinalState& state) {
    return static_cast<double>(absolute_position(state.origin, 0, state.position[0]));
  };
  EXPECT_NEAR(position(second.end), position(first.end), moved);
  EXPECT_NEAR(static_cast<double>(second.end.supports[0].position[0]), 0.5 + 8.0, kRoundingOfRuns);
}

TEST(Continued, NoiseIsAddedToWhereItStarts) {
  const ContinuedRun first = continued(kContinuedTip);
  RunOptions options;
  options.start_from = &first.end;
  const RunResult result =
      run_text(kContinuedTip, {{"run.perturb", "{ size = 1e-6, repeats = 2 }"}}, options);
  ASSERT_FALSE(result.determined.empty());
  const auto alone = continued(kContinuedTip, {}, &first.end);
  EXPECT_EQ(result.determined[0].value, observable(alone.result, "driver.mean_force.x"));
  EXPECT_GT(result.determined[0].spread, 0.0);
  EXPECT_LT(result.determined[0].spread,
            1e-5);  // forces differ by no more than stiffness times noise
}

/// Errors are estimated with runs that start there, too: those from elsewhere differ by far more.
TEST(Continued, ErrorsAreThoseOfTheRunItself) {
  const std::string text = kContinuedTip.substr(0, kContinuedTip.find("[run]")) +
                           "[run]\nduration = 16.0\naccuracy = 1e-6\n";
  const ContinuedRun first = continued(text);
  const ContinuedRun second = continued(text, {}, &first.end);
  for (const ErrorEstimate& estimate : second.result.errors) {
    if (estimate.path != "drivers.driver.mean_force.x") continue;
    EXPECT_LT(*estimate.error, 1e-4);
    return;
  }
  ADD_FAILURE() << "no error";
}

TEST(Continued, WhatHasOtherPartsIsRefused) {
  const ContinuedRun ring = continued(RingScene().text());
  RingScene more;
  more.count = 9;
  RingScene rigid;
  rigid.coordinates = "rigid";
  for (const std::string& other : {more.text(), rigid.text(), kContinuedTip}) {
    try {
      continued(other, {}, &ring.end);
      ADD_FAILURE() << other;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("another run has ended"), std::string::npos)
          << error.what();
    }
  }
  // A driver that is a formula of the time would jump back.
  const std::string formula =
      replaced(kContinuedTip, "type = \"driving_spring\"\nstiffness = 1.0\nvelocity = [\"v\"]",
               "type = \"expression\"\ndriver = true\nenergy = \"0.5 * (xc - v * t)^2\"");
  const ContinuedRun first = continued(formula);
  EXPECT_THROW(continued(formula, {}, &first.end), InputError);
}

/// Checkpoints of a run that started elsewhere are its own.
TEST(Continued, ResumesToTheSameBits) {
  class Kept : public RunSink {
   public:
    void begin(const RunLayout&) override {}
    void sample(const std::vector<double>&) override {}
    void checkpoint(const RunState& state) override { last = state.to_bytes(); }
    bool wants_samples() const override { return false; }
    std::vector<std::byte> last;
  };
  const ContinuedRun first = continued(kContinuedTip);
  const auto scene = scene_of(kContinuedTip);
  RunOptions options;
  options.start_from = &first.end;
  Kept kept;
  options.sink = &kept;
  options.most_cost = 1000;
  ASSERT_EQ(run(scene, options).status, RunStatus::interrupted);
  const std::vector<std::byte> half = kept.last;
  options.sink = nullptr;
  options.most_cost = std::numeric_limits<std::uint64_t>::max();
  const RunResult whole = run(scene, options);
  options.resume_from = &half;
  const RunResult resumed = run(scene, options);
  EXPECT_EQ(*observable(resumed, "driver.mean_force.x"), *observable(whole, "driver.mean_force.x"));
  EXPECT_EQ(resumed.steps, whole.steps);
  options.start_from = nullptr;
  EXPECT_THROW(run(scene, options), std::invalid_argument);
}

// ---- sweeps

SweepPlan continued_plan(const std::string& text, const AxisTexts& over,
                         const std::vector<std::string>& observables,
                         const std::vector<Setting>& settings = {}) {
  SweepSettings sweep = sweep_over(over);
  sweep.observables = observables;
  sweep.continues = true;
  return plan_of(text, std::move(sweep), settings);
}

/// A tip in a soft trap over a substrate, pushed to and fro: between two folds there are two
/// equilibria, and it stays in the one that it came from.
const std::string kPushedTip = R"(
[parameters]
F = 0.0
[[body]]
name = "tip"
type = "point"
position = [0.0]
particle_mass = 1.0
[[force]]
name = "push"
type = "constant_force"
force = ["F"]
[[force]]
name = "trap"
type = "driving_spring"
stiffness = 0.4
velocity = [0.0]
[[force]]
type = "viscous_damping"
coefficient = 4.0
[[force]]
type = "sinusoidal_substrate"
amplitude = -0.1
period = 1.0
[run]
dynamics = "overdamped"
duration = 200.0
integrator = { type = "dopri5", relative_tolerance = 1e-10, absolute_tolerance = 1e-10 }
)";

/// Equilibria obey F = k x + F_c sin(2 pi x); the tip jumps where that has its extremes.
TEST(ContinuedSweep, ShowsHysteresis) {
  const std::string up = "0,0.2,0.4,0.6,0.8,1.0";
  const std::string there_and_back = up + ",0.8,0.6,0.4,0.2,0";
  const std::vector<double> forces = {0, 0.2, 0.4, 0.6, 0.8, 1.0, 0.8, 0.6, 0.4, 0.2, 0};
  const SweepPlan plan =
      continued_plan(kPushedTip, {{"F", there_and_back}}, {"tip.centre_of_mass.x"});
  RowsInMemory rows;
  ASSERT_TRUE(run_sweep(plan, rows, {.threads = 2}).complete());
  const std::vector<double> x = rows.numbers();
  constexpr double kTwoPi = 6.283185307179586;
  constexpr double kAtRest = 1e-8;  // the slowest decay is exp(-200 k / 4 ...) and the tolerance
  const auto force_at = [](double position) {
    return 0.4 * position + 0.1 * kTwoPi * std::sin(kTwoPi * position);
  };
  for (std::size_t k = 0; k < x.size(); ++k) {
    EXPECT_NEAR(force_at(x[k]), forces[k], kAtRest) << k;
  }
  // Up it passes the fold near x = 1/4, F = 0.73; on its way back it is in the next well until
  // F = k x - F_c < 0.
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_LT(x[k], 0.25) << k;
    EXPECT_GT(x[10 - k], 0.75) << k;
  }
  EXPECT_NEAR(x[4], x[6], kAtRest);
  // Each alone does not know where it came from.
  EXPECT_NEAR(*observable(run_text(kPushedTip, {{"F", "0"}}), "tip.centre_of_mass.x"), 0.0,
              kAtRest);
}

TEST(ContinuedSweep, EachPointStartsFromTheOneBefore) {
  const SweepPlan plan =
      continued_plan(kContinuedTip, {{"force.driver.stiffness", "1,2"}, {"v", "0.1,0.2,0.3"}},
                     {"driver.mean_force.x"});
  EXPECT_EQ(plan.line(), 3);
  RowsInMemory rows;
  ASSERT_TRUE(run_sweep(plan, rows, {.threads = 2}).complete());
  for (std::size_t line = 0; line < 2; ++line) {
    FinalState before;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t point = 3 * line + k;
      ContinuedRun run =
          continued(kContinuedTip, plan.settings_at(point), k == 0 ? nullptr : &before);
      EXPECT_EQ(rows.rows[point].numbers[0], *observable(run.result, "driver.mean_force.x"));
      before = std::move(run.end);
    }
  }
  // It is another sweep.
  SweepSettings alone;
  alone.over = plan.axes();
  alone.observables = {"driver.mean_force.x"};
  const SweepPlan other = plan_of(kContinuedTip, alone);
  EXPECT_NE(other.identity(), plan.identity());
  EXPECT_EQ(other.line(), 1);
  EXPECT_EQ(plan_in(plan.scene_text()).identity(), plan.identity());
}

/// Nothing is passed over without a word.
TEST(ContinuedSweep, APointWithoutANeighbourIsRefused) {
  const SweepPlan plan =
      continued_plan(kContinuedTip, {{"v", "0.1,0.2"}, {"run.integrator.dt", "0.01,-1,0.02,0.01"}},
                     {"driver.work"});
  RowsInMemory rows;
  EXPECT_TRUE(run_sweep(plan, rows, {}).complete());
  for (std::size_t point = 0; point < 8; ++point) {
    const SweepRow& row = rows.rows[point];
    const bool finished = point % 4 == 0;
    EXPECT_EQ(row.status, finished ? SweepStatus::finished : SweepStatus::refused) << point;
    const bool left_out = row.reason.find("has not finished") != std::string::npos;
    EXPECT_EQ(left_out, point % 4 >= 2) << row.reason;
  }
  // A point with other particles is refused, with the reason.
  const SweepPlan counts = continued_plan(RingScene().text(), {{"body.ring.count", "8,9"}},
                                          {"driver.work"}, {{"run.duration", "1"}});
  RowsInMemory other;
  EXPECT_TRUE(run_sweep(counts, other, {}).complete());
  EXPECT_EQ(other.rows[1].status, SweepStatus::refused);
  EXPECT_NE(other.rows[1].reason.find("8 particles"), std::string::npos) << other.rows[1].reason;
}

/// Rows that are there are not kept again; what is needed of them is computed again.
TEST(ContinuedSweep, WhatIsMissingOfALineIsTheSame) {
  const SweepPlan plan = continued_plan(
      kContinuedTip, {{"force.driver.stiffness", "1,2"}, {"v", "0.1:0.4:4"}}, {"driver.work"});
  RowsInMemory all;
  ASSERT_TRUE(run_sweep(plan, all, {}).complete());
  for (const std::set<std::size_t>& before :
       {std::set<std::size_t>{0, 1}, {2, 3, 4}, {0, 2, 4, 6}, {1, 3, 5, 7}, {0, 1, 2, 3}}) {
    RowsInMemory rows;
    rows.before = before;
    EXPECT_TRUE(run_sweep(plan, rows, {.threads = 3}).complete());
    EXPECT_EQ(rows.rows.size(), 8 - before.size());
    for (const auto& [point, row] : rows.rows) {
      EXPECT_EQ(row.numbers[0], all.rows[point].numbers[0]) << point;
    }
  }
}

/// The end that is kept of a line is used, and only by its own sweep.
TEST(ContinuedSweep, TheEndOfALineIsKept) {
  const TemporaryFolder folder;
  const SweepPlan plan = continued_plan(kContinuedTip, {{"v", "0.1:0.4:4"}}, {"driver.work"},
                                        {{"run.checkpoint_every", "1e-9"}});
  const ContinuedRun first = continued(kContinuedTip, plan.settings_at(0));
  {
    LineEnd end(plan, 0, 3, folder.path());
    EXPECT_EQ(end.next(), 0);
    EXPECT_EQ(end.before(), nullptr);
    end.pass(first.end);
  }
  LineEnd found(plan, 0, 3, folder.path());
  ASSERT_EQ(found.next(), 1);
  ASSERT_NE(found.before(), nullptr);
  EXPECT_EQ(found.before()->structure, first.end.structure);
  EXPECT_EQ(found.before()->origin.cells, first.end.origin.cells);
  const auto same = [&](const FinalState& other) {
    return other.position == first.end.position && other.velocity == first.end.velocity &&
           other.own == first.end.own && other.supports.size() == first.end.supports.size() &&
           other.supports[0].name == "driver" &&
           other.supports[0].position == first.end.supports[0].position;
  };
  EXPECT_TRUE(same(*found.before()));
  // It is of no use to a point before it, to another line and to another sweep.
  EXPECT_EQ(LineEnd(plan, 0, 0, folder.path()).next(), 0);
  const SweepPlan other = continued_plan(kContinuedTip, {{"v", "0.1:0.5:4"}}, {"driver.work"});
  EXPECT_EQ(LineEnd(other, 0, 3, folder.path()).next(), 0);
  // A state that is planted there is what the next point starts from.
  FinalState moved = first.end;
  moved.position[0] += Quad(0.25);
  LineEnd(plan, 0, 3, folder.path()).pass(moved);
  RowsInMemory rows;
  rows.before = {0, 1};
  run_sweep(plan, rows, {.folder = folder.path()});
  const ContinuedRun from_there = continued(kContinuedTip, plan.settings_at(2), &moved);
  EXPECT_EQ(rows.rows[2].numbers[0], *observable(from_there.result, "driver.work"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

/// Stopped again and again, in the midst of points and between them.
TEST(ContinuedSweep, StoppedAndContinuedItHasTheSameBits) {
  const SweepPlan plan =
      continued_plan(kContinuedTip, {{"force.driver.stiffness", "1,2,3"}, {"v", "0.1:0.4:4"}},
                     {"driver.work", "tip.centre_of_mass.x"},
                     {{"run.duration", "4096"}, {"run.checkpoint_every", "1e-3"}});
  RowsInMemory all;
  ASSERT_TRUE(run_sweep(plan, all, {.threads = 1}).complete());
  const TemporaryFolder folder;
  RowsInMemory rows;
  int stops = 0;
  for (bool complete = false; !complete && stops < 200; ++stops) {
    RowsInMemory more;
    for (const auto& [point, row] : rows.rows) more.before.insert(point);
    const StopAfter stop(std::chrono::milliseconds(2 + stops % 7));
    SweepOptions options;
    options.threads = 1 + stops % 3;
    options.folder = folder.path();
    options.stop = stop.flag();
    complete = run_sweep(plan, more, options).complete();
    rows.rows.merge(more.rows);
  }
  EXPECT_GT(stops, 2);
  EXPECT_EQ(rows.numbers(0), all.numbers(0));
  EXPECT_EQ(rows.numbers(1), all.numbers(1));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace tomlin::test
