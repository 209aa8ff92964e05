#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/text/fault.hpp"
#include "framework/output/store_file.hpp"
#include "framework/output/sweep_files.hpp"
#include "framework/run/results/observables.hpp"
#include "framework/study/sweep/files.hpp"
#include "framework/study/sweep/part.hpp"
#include "framework/study/sweep/point_run.hpp"
#include "framework/study/sweep/runner.hpp"
#include "framework/study/sweep/sweep_journal.hpp"
#include "framework/study/sweep/sweep_plan.hpp"
#include "tests/framework/output/disk_limit.hpp"
#include "tests/framework/output/temporary_folder.hpp"
#include "tests/framework/study/sweep_fixture.hpp"
#include "tests/support/ring_scenes.hpp"
#include "tests/support/text.hpp"

/// Points of a sweep are runs: the same settings give the same bits.
namespace tomlin::test {
namespace {

constexpr const char* kSweptTip = R"(
[parameters]
v = 1e-2
k = 2.0
V0 = 0.1
seed = 1
[[body]]
name = "tip"
type = "point"
position = [0.5]
particle_mass = 1.0
[[force]]
name = "driver"
type = "driving_spring"
stiffness = "k"
velocity = ["v"]
[[force]]
type = "viscous_damping"
coefficient = 2.0
[[force]]
type = "sinusoidal_substrate"
amplitude = "V0"
period = 1.0
[run]
duration = 20.0
integrator = { type = "rk4", dt = 2e-2 }
)";

/// In a bath of temperature T.
std::string warm_tip() {
  std::string text =
      replaced(kSweptTip, "type = \"viscous_damping\"", "type = \"langevin\"\ntemperature = \"T\"");
  text = replaced(text, "seed = 1", "T = 0.02");
  return replaced(text, "\"rk4\"", "\"baoab\"");
}

struct SweptAxes {
  AxisTexts over;
  std::vector<std::vector<std::string>> zips = {};
};

SweepPlan plan_over(const std::string& text, const SweptAxes& axes,
                    std::vector<std::string> observables = {"driver.mean_force.x"},
                    const std::vector<Setting>& settings = {},
                    const std::string& version = "1.2.3") {
  SweepSettings sweep = sweep_over(axes.over, axes.zips);
  sweep.observables = std::move(observables);
  sweep.observables_location = {"--observable"};
  return plan_of(text, std::move(sweep), settings, version);
}

std::vector<std::string> faults_of_plan(const std::string& text, const SweptAxes& axes,
                                        const std::vector<std::string>& observables) {
  return briefs_of([&] { plan_over(text, axes, observables); });
}

/// The row of a point, run by itself; nothing when it was stopped.
std::optional<SweepRow> run_point(const SweepPlan& plan, std::size_t point,
                                  const std::atomic<bool>* stop = nullptr,
                                  const std::filesystem::path& checkpoints = {}) {
  try {
    return PointRun(plan, point, stop, checkpoints).run();
  } catch (const InputError& error) {
    return row_of_refused(plan, error);
  }
}

std::vector<std::uint64_t> bits_of(const std::vector<double>& numbers) {
  std::vector<std::uint64_t> bits;
  for (const double x : numbers) bits.push_back(std::bit_cast<std::uint64_t>(x));
  return bits;
}

// ---- points

TEST(SweepPlan, TheLastAxisRunsFastest) {
  const SweepPlan plan = plan_over(
      kSweptTip, {{{"v", "1e-2,2e-2"}, {"k", "1:3:3"}, {"V0", "0.1,0.2"}}, {{"v", "V0"}}});
  ASSERT_EQ(plan.points(), 6);
  std::string all;
  for (std::size_t point = 0; point < plan.points(); ++point) {
    for (const Setting& setting : plan.settings_at(point)) {
      all += setting.path + "=" + setting.value + " ";
    }
    all += "\n";
  }
  EXPECT_EQ(all,
            "v=1e-2 k=1 V0=0.1 \nv=1e-2 k=2 V0=0.1 \nv=1e-2 k=3 V0=0.1 \n"
            "v=2e-2 k=1 V0=0.2 \nv=2e-2 k=2 V0=0.2 \nv=2e-2 k=3 V0=0.2 \n");
  const auto parameters = plan.scene_at(4)->parameters;
  EXPECT_EQ(parameters[0].second, 2e-2);
  EXPECT_EQ(parameters[1].second, 2.0);
  EXPECT_EQ(parameters[2].second, 0.2);
}

TEST(SweepPlan, AllFaultsTogether) {
  EXPECT_EQ(
      faults_of_plan(kSweptTip,
                     {{{"lambda", "1,2"},
                       {"run.integrator.td", "1e-3,1e-4"},
                       {"run.dynamics", "inertial,overdmaped,quasistatic"},
                       {"v", "1,2"},
                       {"v", "3"}}},
                     {"driver.mean_forc.x", "driver.mean_force.x", "performance.wall_seconds"}),
      (std::vector<std::string>{
          "v = 3 [scene.duplicate_key]", "lambda = 1 [scene.unknown_key]",
          "run.integrator.td = 1e-3 [scene.unknown_key] did you mean dt",
          "run.dynamics = overdmaped [scene.unknown_choice] did you mean overdamped",
          "driver.mean_forc.x [observable.unknown] did you mean driver.mean_force.x",
          "performance.wall_seconds [command.invalid_value]"}));
}

/// A scene may lack the keys that its axes set.
TEST(SweepPlan, OnlyTheAxesNeedToMakeItAScene) {
  const std::string text = replaced(kSweptTip, "duration = 20.0\n", "");
  const SweepPlan plan = plan_over(text, {{{"run.duration", "-1,10,20"}, {"v", "1e-2,2e-2"}}});
  RowsInMemory rows;
  EXPECT_TRUE(run_sweep(plan, rows, {}).complete());
  EXPECT_EQ(rows.rows[0].status, SweepStatus::refused);
  for (const std::size_t point : {2, 5}) {
    EXPECT_EQ(rows.rows[point].status, SweepStatus::finished);
    const RunResult result = run_text(text, plan.settings_at(point));
    EXPECT_EQ(rows.rows[point].numbers[0], *observable(result, "driver.mean_force.x"));
  }
  // The scene that is written has the values of the first point, and is the same sweep.
  EXPECT_EQ(plan_in(plan.scene_text()).identity(), plan.identity());
}

/// A key may be one only with what another axis sets.
TEST(SweepPlan, AValueIsWrongWhereNoOtherAxisMakesItRight) {
  const std::string text =
      replaced(kSweptTip, "{ type = \"rk4\", dt = 2e-2 }", "{ type = \"dopri5\" }");
  const std::vector<std::string> work = {"driver.work"};
  EXPECT_EQ(faults_of_plan(text, {{{"run.integrator.dt", "1e-2,2e-2"}}}, work),
            std::vector<std::string>{"run.integrator.dt = 1e-2 [scene.unknown_key]"});
  EXPECT_TRUE(faults_of_plan(text,
                             {{{"run.integrator.type", "rk4"}, {"run.integrator.dt", "1e-2,2e-2"}}},
                             work)
                  .empty());
}

TEST(SweepPlan, FaultsOfTheSceneComeWithThoseOfAxes) {
  std::string text = replaced(kSweptTip, "particle_mass = 1.0", "particle_mas = 1.0");
  text = replaced(text, "duration = 20.0\n", "");
  EXPECT_EQ(faults_of_plan(text, {{{"run.duration", "1,2"}, {"lambda", "1,2"}}}, {"driver.work"}),
            (std::vector<std::string>{
                "lambda = 1 [scene.unknown_key]", "7:1 body.tip.particle_mass [scene.missing_key]",
                "11:1 body.tip.particle_mas [scene.unknown_key] did you mean particle_mass"}));
  // If an axis is wrong, nobody knows which keys the scene would lack with it.
  EXPECT_EQ(faults_of_plan(text, {{{"run.duration", "1,2"}, {"v", "1"}, {"v", "2"}}}, {}),
            (std::vector<std::string>{
                "v = 2 [scene.duplicate_key]",
                "11:1 body.tip.particle_mas [scene.unknown_key] did you mean particle_mass"}));
  // Refused at every point, and for nothing but what the axis says.
  text = replaced(text, "particle_mas =", "particle_mass =");
  EXPECT_EQ(faults_of_plan(text, {{{"run.duration", "-1,-2"}}}, {"driver.work"}),
            std::vector<std::string>{"run.duration = -1 [scene.out_of_range]"});
}

/// A parameter has two names, and a table is more than its keys.
TEST(SweepPlan, TwoAxesThatSetTheSameAreAFault) {
  for (const auto& [one, other] : {std::pair{"v", "parameters.v"}, {"parameters.v", "v"}}) {
    EXPECT_EQ(faults_of_plan(kSweptTip, {{{one, "1,2"}, {other, "3,4"}}}, {"driver.work"}),
              std::vector<std::string>{std::string(other) + " = 3,4 [scene.duplicate_key]"});
  }
  EXPECT_EQ(faults_of_plan(kSweptTip,
                           {{{"run.integrator", "{ type = \"rk4\", dt = 1e-2 }"},
                             {"run.integrator.dt", "1e-2"}}},
                           {"driver.work"}),
            std::vector<std::string>{"run.integrator.dt = 1e-2 [scene.duplicate_key]"});
  SweptAxes many;
  for (int k = 0; k < 32; ++k) many.over.push_back({"body.tip.name" + std::to_string(k), "1"});
  const auto faults = faults_of_plan(kSweptTip, many, {"driver.work"});
  EXPECT_NE(std::find(faults.begin(), faults.end(), "[scene.too_large]"), faults.end())
      << fmt::format("{}", fmt::join(faults, "\n"));
}

/// Values that only conflict with each other concern their own point alone.
TEST(SweepPlan, RefusedAndFailingPointsAreRows) {
  const SweepPlan plan =
      plan_over(kSweptTip, {{{"run.integrator.dt", "1e-2,-1,50,2e-2"}}}, {"driver.mean_force.x"});
  RowsInMemory rows;
  const SweepProgress progress = run_sweep(plan, rows, {});
  EXPECT_TRUE(progress.complete());
  ASSERT_EQ(rows.rows.size(), 4);
  EXPECT_EQ(rows.rows[0].status, SweepStatus::finished);
  EXPECT_EQ(rows.rows[1].status, SweepStatus::refused);
  EXPECT_NE(rows.rows[1].reason, "");
  EXPECT_NE(rows.rows[2].status, SweepStatus::finished);
  EXPECT_NE(rows.rows[2].reason, "");
  EXPECT_TRUE(std::isnan(rows.rows[2].numbers[0]));
  EXPECT_EQ(rows.rows[3].status, SweepStatus::finished);
  EXPECT_EQ(progress.done[0], 2);
}

TEST(SweepPlan, AnotherSweepHasAnotherIdentity) {
  const auto identity = [](const SweptAxes& axes, const std::vector<std::string>& observables,
                           const std::vector<Setting>& settings = {}) {
    return plan_over(kSweptTip, axes, observables, settings).identity();
  };
  const std::vector<std::string> force = {"driver.mean_force.x"};
  const auto first = identity({{{"v", "1,2"}}}, force);
  EXPECT_EQ(first, identity({{{"v", "1,2"}}}, {"drivers.driver.mean_force.x"}));
  const std::set<std::uint64_t> all = {
      first,
      identity({{{"v", "1,3"}}}, force),
      identity({{{"v", "1:2:2"}}}, force),
      identity({{{"k", "1,2"}}}, force),
      identity({{{"v", "1,2"}}}, {"driver.max_force.x"}),
      identity({{{"v", "1,2"}}}, force, {{"V0", "0.2"}}),
      identity({{{"v", "1,2"}, {"k", "1,2"}}}, force),
      identity({{{"k", "1,2"}, {"v", "1,2"}}}, force),
      identity({{{"k", "1,2"}, {"v", "1,2"}}, {{"k", "v"}}}, force)};
  EXPECT_EQ(all.size(), 9);
}

/// scene.toml means the same sweep.
TEST(SweepPlan, TheSceneWithItsTableIsTheSameSweep) {
  const SweepPlan plan = plan_over(
      kSweptTip,
      {{{"v", "1e-3:1e-1:5:log"},
        {"run.dynamics", "inertial,overdamped"},
        {"run.integrator", "{ type = \"rk4\", dt = 1e-2 },{ type = \"midpoint\", dt = 1e-3 }"},
        {"V0", "0.1,k/20"}},
       {{"run.dynamics", "V0"}}},
      {"driver.mean_force.x", "events.slips"}, {{"k", "3"}});
  const SweepPlan other = plan_in(plan.scene_text());
  EXPECT_EQ(other.scene_text(), plan.scene_text());
  EXPECT_EQ(other.identity(), plan.identity());
}

// ---- the same bits as single runs

struct SweptCase {
  const char* name;
  std::string text;
  SweptAxes axes;
  std::vector<std::string> observables;
};

std::vector<SweptCase> cases() {
  const std::string tip = kSweptTip;
  const auto with = [&tip](const std::string& integrator, const std::string& more = "") {
    return replaced(tip, "{ type = \"rk4\", dt = 2e-2 }", integrator) + more;
  };
  const std::vector<std::string> force = {"driver.mean_force.x", "driver.max_force.x",
                                          "tip.centre_of_mass.x", "events.slips", "time.steps"};
  RingScene ring;
  return {
      {"tip", tip, {{{"v", "1e-2,5e-2"}, {"k", "1:3:3"}}}, force},
      {"adaptive", with(adaptive(1e-8)), {{{"v", "1e-2,5e-2"}, {"V0", "0.05:0.2:3"}}}, force},
      {"window",
       with(adaptive(1e-8), "[measure]\nfrom = 3.0\nto = 15.0\nin = \"time\"\n"),
       {{{"v", "5e-2,0.1"}}},
       force},
      {"until",
       tip.substr(0, tip.find("[run]")) +
           "[run]\nintegrator = { type = \"rk4\", dt = 1e-2 }\n"
           "until = { steady = \"driver.mean_force.x\", tolerance = 1e-3, max = 200.0 }\n",
       {{{"v", "0.1,0.2"}, {"k", "2,3"}}},
       force},
      {"number types", tip, {{{"run.number_type", "double,quadruple"}, {"v", "1e-2,5e-2"}}}, force},
      {"dynamics",
       tip,
       {{{"run.dynamics", "inertial,overdamped,quasistatic"}, {"v", "1e-2,5e-2"}}},
       {"driver.mean_force.x", "time.steps"}},
      {"accuracy",
       tip.substr(0, tip.find("[run]")) + "[run]\nduration = 30.0\naccuracy = 1e-3\n",
       {{{"v", "5e-2,0.1"}}},
       {"driver.mean_force.x", "driver.work"}},
      {"perturb",
       with("{ type = \"rk4\", dt = 2e-2 }\nperturb = { size = 1e-9, repeats = 2 }"),
       {{{"v", "5e-2,0.1"}, {"run.seed", "0,1"}}},
       {"driver.mean_force.x"}},
      {"ring",
       ring.text(),
       {{{"body.ring.coordinates", "particles,rigid"}, {"force.driver.stiffness", "1,2"}}},
       {"driver.mean_force.x", "ring.rotation"}},
      {"noise",
       warm_tip(),
       {{{"T", "0.01,0.05"}, {"run.seed", "3,4"}, {"run.stream", "0:2:3"}}},
       {"driver.mean_force.x", "tip.temperature"}},
  };
}

TEST(Sweep, RowsHaveTheBitsOfSingleRuns) {
  for (const SweptCase& one : cases()) {
    const SweepPlan plan = plan_over(one.text, one.axes, one.observables);
    RowsInMemory rows;
    ASSERT_TRUE(run_sweep(plan, rows, {.threads = 3}).complete()) << one.name;
    std::set<std::vector<std::uint64_t>> different;
    for (std::size_t point = 0; point < plan.points(); ++point) {
      const SweepRow& row = rows.rows[point];
      ASSERT_EQ(row.status, SweepStatus::finished) << one.name << " " << row.reason;
      const RunResult result = run_text(one.text, plan.settings_at(point));
      std::vector<double> numbers;
      for (const SweepColumn& column : plan.columns()) {
        const std::string& path = plan.paths()[column.observable];
        std::optional<double> number;
        if (column.kind == SweepColumn::Kind::value) number = observable(result, path);
        for (const ErrorEstimate& error : result.errors) {
          if (column.kind == SweepColumn::Kind::error && error.path == path) number = error.error;
        }
        for (const DeterminedResult& found : result.determined) {
          if (column.kind == SweepColumn::Kind::spread && found.path == path) number = found.spread;
        }
        numbers.push_back(number.value_or(std::numeric_limits<double>::quiet_NaN()));
      }
      EXPECT_EQ(bits_of(row.numbers), bits_of(numbers)) << one.name << ", point " << point;
      EXPECT_FALSE(std::isnan(row.numbers[0])) << one.name;
      different.insert(bits_of(row.numbers));
    }
    // A parameter that does not arrive would not be noticed where all rows are the same.
    EXPECT_GT(different.size(), 1) << one.name;
  }
}

TEST(Sweep, EstimatesAreColumns) {
  const auto all = cases();
  const auto plan_of_case = [&all](const std::string& name) {
    const auto found = std::find_if(all.begin(), all.end(),
                                    [&](const SweptCase& one) { return one.name == name; });
    return plan_over(found->text, found->axes, found->observables);
  };
  const SweepPlan accuracy = plan_of_case("accuracy");
  ASSERT_EQ(accuracy.columns().size(), 4);
  EXPECT_EQ(accuracy.columns()[2].name, "error.driver.mean_force.x");
  const auto row = run_point(accuracy, 0);
  ASSERT_TRUE(row);
  EXPECT_GT(row->numbers[2], 0.0);
  const SweepPlan perturb = plan_of_case("perturb");
  ASSERT_EQ(perturb.columns().size(), 2);
  EXPECT_EQ(perturb.columns()[1].name, "spread.driver.mean_force.x");
  const auto other = run_point(perturb, 0);
  ASSERT_TRUE(other);
  EXPECT_GT(other->numbers[1], 0.0);
}

/// Structures that alternate, several steps, refused points and failing ones: what goes into lanes
/// together is no matter of the rows, and neither are threads.
TEST(Sweep, BatchesOfAllKindsGiveTheRowsOfSingleRuns) {
  RingScene ring;
  ring.duration = 1.0;
  ring.integrator = "{ type = \"rk4\", dt = \"h\" }";
  const std::string text = "[parameters]\nh = 2e-3\n" + ring.text();
  const SweepPlan plan = plan_over(text, {{{"force.driver.stiffness", "1,2,3"},
                                           {"h", "2e-3,-1,1e-3"},
                                           {"body.ring.count", "5,8,6,8,11"}}});
  std::map<std::size_t, SweepRow> expected;
  std::set<SweepStatus> statuses;
  for (std::size_t k = 0; k < plan.points(); ++k) {
    expected[k] = *run_point(plan, k);
    statuses.insert(expected[k].status);
  }
  EXPECT_EQ(statuses.size(), 2);
  for (const std::size_t threads : {1, 2, 3}) {
    RowsInMemory rows;
    ASSERT_TRUE(run_sweep(plan, rows, {.threads = threads}).complete());
    for (std::size_t k = 0; k < plan.points(); ++k) {
      EXPECT_EQ(rows.rows[k].status, expected[k].status) << k;
      EXPECT_EQ(bits_of(rows.rows[k].numbers), bits_of(expected[k].numbers)) << k;
      EXPECT_EQ(rows.rows[k].reason, expected[k].reason) << k;
      EXPECT_EQ(rows.rows[k].warnings, expected[k].warnings) << k;
    }
  }
}

/// The attachment of a spring belongs to the structure: the first of its values decides nothing
/// about the others.
TEST(Sweep, SpringsOfOtherPointsShareNoLanes) {
  std::string text = replaced(kSweptTip, "type = \"point\"\nposition = [0.5]",
                              "type = \"chain\"\nspacing = 1.2\ncount = 4");
  text = replaced(
      text, "[[force]]",
      "[[force]]\ntype = \"harmonic_bonds\"\npairs = \"neighbours\"\nstiffness = 1.0\n[[force]]");
  const SweepPlan plan =
      plan_over(text,
                {{{"force.driver.attach", "{ particle = 0 },centre_of_mass,{ particle = 2 }"},
                  {"v", "5e-2:9e-2:4"}}},
                {"driver.mean_force.x"}, {{"run.duration", "100"}});
  RowsInMemory rows;
  ASSERT_TRUE(run_sweep(plan, rows, {}).complete());
  std::set<std::uint64_t> different;
  for (std::size_t k = 0; k < plan.points(); ++k) {
    const SweepRow expected = *run_point(plan, k);
    ASSERT_EQ(expected.status, SweepStatus::finished) << expected.reason;
    EXPECT_EQ(bits_of(rows.rows[k].numbers), bits_of(expected.numbers)) << k;
    different.insert(std::bit_cast<std::uint64_t>(expected.numbers[0]));
  }
  EXPECT_EQ(different.size(), plan.points());
}

/// A point whose scene has no such observable is refused, in lanes too.
TEST(Sweep, AnObservableThatSomePointsLackRefusesThem) {
  const SweepPlan plan =
      plan_over(kSweptTip, {{{"force.driver.name", "driver,other"}, {"v", "1e-2:4e-2:5"}}});
  RowsInMemory rows;
  ASSERT_TRUE(run_sweep(plan, rows, {}).complete());
  for (std::size_t k = 0; k < plan.points(); ++k) {
    EXPECT_EQ(rows.rows[k].status, k < 5 ? SweepStatus::finished : SweepStatus::refused) << k;
  }
}

/// A stop at any time, in lanes: points resume from where they were, and no row has another bit.
TEST(Sweep, LanesResumeFromTheirCheckpoints) {
  struct Stopped {
    std::string text;
    std::string integrator;
    std::string duration;
  };
  const std::vector<Stopped> cases = {{kSweptTip, "{ type = \"rk4\", dt = 1e-3 }", "3000"},
                                      {kSweptTip, "{ type = \"dopri5\" }", "30000"},
                                      {warm_tip(), "{ type = \"baoab\", dt = 1e-3 }", "3000"}};
  for (const auto& [text, integrator, duration] : cases) {
    const SweepPlan plan = plan_over(text, {{{"v", "1e-2:5e-2:12"}}}, {"driver.mean_force.x"},
                                     {{"run.integrator", integrator}, {"run.duration", duration}});
    RowsInMemory expected;
    ASSERT_TRUE(run_sweep(plan, expected, {}).complete());
    const TemporaryFolder folder;
    std::map<std::size_t, SweepRow> rows;
    int stops = 0;
    for (bool complete = false; !complete;) {
      RowsInMemory now;
      for (const auto& [point, row] : rows) now.before.insert(point);
      const StopAfter stop(std::chrono::milliseconds(60));
      complete = run_sweep(plan, now, {.stop = stop.flag(), .folder = folder.path()}).complete();
      rows.insert(now.rows.begin(), now.rows.end());
      if (!complete) ++stops;
    }
    EXPECT_GT(stops, 0) << integrator;
    for (const auto& [point, row] : expected.rows) {
      EXPECT_EQ(bits_of(rows[point].numbers), bits_of(row.numbers)) << integrator << ", " << point;
    }
  }
}

TEST(Sweep, StopsWithoutARow) {
  const SweepPlan plan = plan_over(kSweptTip, {{{"v", "1e-2,5e-2"}}}, {"driver.mean_force.x"},
                                   {{"run.duration", "1e7"}});
  RowsInMemory rows;
  const std::atomic<bool> stop = true;
  const SweepProgress progress = run_sweep(plan, rows, {.threads = 2, .stop = &stop});
  EXPECT_TRUE(rows.rows.empty());
  EXPECT_EQ(progress.with_row(), 0);
}

/// A point that is stopped half-way resumes, whatever its run consists of, and its row has the same
/// bits.
TEST(Sweep, PointsResumeFromTheirCheckpoint) {
  for (const SweptCase& one : cases()) {
    const TemporaryFolder folder;
    const SweepPlan plan =
        plan_over(one.text, one.axes, one.observables, {{"run.checkpoint_every", "1e-9"}});
    const SweepRow expected = *run_point(plan, 0);
    const std::filesystem::path file = folder / "0.store";
    std::optional<SweepRow> row;
    int stops = 0;
    for (; !row && stops < 40; ++stops) {
      const StopAfter stop(std::chrono::microseconds(300 * (stops + 1)));
      row = run_point(plan, 0, stop.flag(), folder.path());
    }
    if (!row) row = run_point(plan, 0, nullptr, folder.path());
    ASSERT_TRUE(row) << one.name;
    EXPECT_EQ(bits_of(row->numbers), bits_of(expected.numbers)) << one.name << ", stops: " << stops;
    // It is of use until the row is kept, and no longer.
    EXPECT_TRUE(std::filesystem::exists(file)) << one.name;
    RowsInMemory rows;
    run_sweep(plan, rows, {.folder = folder.path()});
    EXPECT_EQ(bits_of(rows.rows[0].numbers), bits_of(expected.numbers)) << one.name;
    EXPECT_FALSE(std::filesystem::exists(file)) << one.name;
  }
}

/// A long run goes on rather than starting again.
TEST(Sweep, WhatWasDoneOfAPointIsNotDoneAgain) {
  const TemporaryFolder folder;
  const SweepPlan plan =
      plan_over(kSweptTip, {{{"v", "1e-2,2e-2"}}}, {"time.end"}, {{"run.duration", "1e9"}});
  std::vector<double> times;
  for (int k = 0; k < 2; ++k) {
    {
      const StopAfter stop(std::chrono::milliseconds(50));
      EXPECT_FALSE(run_point(plan, 0, stop.flag(), folder.path()));
    }
    const auto kept = [&](int point) {
      const std::string owner = fmt::format("sweep {:x}, point {}", plan.identity(), point);
      return StoreFile(folder / "0.store", owner, 60.0).kept("run");
    };
    const std::vector<std::byte> state = kept(0);
    ASSERT_FALSE(state.empty());
    RunOptions options;
    options.resume_from = &state;
    options.observables = plan.paths();
    times.push_back(Engine(plan.scene_at(0), options).time());
    // It is of no use to another point.
    EXPECT_TRUE(kept(1).empty());
  }
  EXPECT_GT(times[0], 0.0);
  EXPECT_GT(times[1], times[0]);
}

/// Each point is of one part, parts differ by one point at most, and each has points of every value
/// of an axis, also where the number of its values is a multiple of that of the parts.
TEST(Sweep, PartsShareThePoints) {
  for (const std::size_t parts : {1, 2, 3, 4, 7, 40}) {
    for (const std::size_t points : {1, 2, 3, 12, 36, 37}) {
      std::vector<int> owners(points, 0);
      for (std::size_t k = 0; k < parts; ++k) {
        const SweepPart part{k, parts};
        std::size_t count = 0;
        for (std::size_t point = 0; point < points; ++point) {
          if (!part.has(point)) continue;
          ++count;
          ++owners[point];
        }
        EXPECT_EQ(count, part.size(points)) << k << " of " << parts << ", " << points;
        EXPECT_TRUE(count == points / parts || count == points / parts + 1);
      }
      EXPECT_EQ(owners, std::vector<int>(points, 1)) << parts << ", " << points;
    }
  }
  constexpr std::size_t kValues = 4;  // of the innermost axis
  for (std::size_t k = 0; k < kValues; ++k) {
    std::set<std::size_t> values;
    for (std::size_t point = 0; point < kValues * kValues; ++point) {
      if (SweepPart{k, kValues}.has(point)) values.insert(point % kValues);
    }
    EXPECT_EQ(values.size(), kValues);
  }
}

TEST(Sweep, APartRunsItsPointsAlone) {
  const SweepPlan plan = plan_over(kSweptTip, {{{"v", "0.01:0.1:10"}}});
  RowsInMemory rows;
  rows.before = {0, 1};
  const SweepProgress progress = run_sweep(plan, rows, {.threads = 2, .part = {1, 3}});  // 1, 3, 8
  EXPECT_TRUE(progress.complete());
  EXPECT_EQ(progress.points, 3);
  EXPECT_EQ(progress.before, 1);
  EXPECT_EQ(rows.rows.size(), 2) << "those that had a row are not run again";
  EXPECT_TRUE(rows.rows.contains(3));
  EXPECT_TRUE(rows.rows.contains(8));
}

TEST(Sweep, WhatCannotBeKeptEndsIt) {
  class FullRows : public RowsInMemory {
    void keep(std::size_t point, const SweepRow& row) override {
      if (point == 4) throw OutputError("no room");
      RowsInMemory::keep(point, row);
    }
  };
  const SweepPlan plan = plan_over(kSweptTip, {{{"v", "0.01:0.1:40"}}});
  FullRows rows;
  EXPECT_THROW(run_sweep(plan, rows, {.threads = 2}), OutputError);
  EXPECT_LT(rows.rows.size(), 39);
}

// ---- the journal

class SweepFiles : public testing::Test {
 protected:
  std::filesystem::path journal() const { return folder_ / kSweepJournalFile; }

  /// Both tables.
  std::string results(const SweepPlan& plan) {
    const SweepJournal rows(journal(), plan);
    write_sweep_table(folder_ / kSweepTableFile, plan, rows);
    write_sweep_arrays(folder_ / kSweepArraysFile, plan, rows);
    return content(folder_ / kSweepTableFile) + content(folder_ / kSweepArraysFile);
  }

  std::string swept(const SweepPlan& plan, std::size_t threads) {
    std::filesystem::remove(journal());
    SweepJournal rows(journal(), plan);
    EXPECT_TRUE(run_sweep(plan, rows, {.threads = threads}).complete());
    return results(plan);
  }

  std::size_t rows_of(const SweepPlan& plan) {
    const SweepJournal rows(journal(), plan);
    std::size_t count = 0;
    for (std::size_t k = 0; k < plan.points(); ++k) count += rows.has(k) ? 1 : 0;
    return count;
  }

  TemporaryFolder folder_;
};

const SweptAxes kGrid = {{{"v", "0.02:0.1:5"}, {"run.integrator.dt", "2e-2,-1,1e-2"}}};

TEST_F(SweepFiles, TheSameBytesInAnyNumberOfThreads) {
  const SweepPlan plan = plan_over(kSweptTip, kGrid, {"driver.mean_force.x", "events.slips"});
  const std::string alone = swept(plan, 1);
  for (const std::size_t threads : {1, 2, 3}) EXPECT_EQ(swept(plan, threads), alone) << threads;
  // In whatever order points end.
  std::filesystem::remove(journal());
  SweepJournal rows(journal(), plan);
  for (std::size_t k = plan.points(); k-- > 0;) rows.keep(k, *run_point(plan, k));
  EXPECT_EQ(results(plan), alone);
}

TEST_F(SweepFiles, TheTableIsInTheOrderOfTheAxes) {
  const SweepPlan plan = plan_over(kSweptTip,
                                   {{{"v", "0.1,0.2"},
                                     {"run.dynamics", "inertial,overdamped"},
                                     {"run.integrator.dt", "1e-2,-1"}}},
                                   {"events.slips"});
  swept(plan, 2);
  const std::string table = content(folder_ / kSweepTableFile);
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < table.size();) {
    const std::size_t end = table.find('\n', at);
    lines.push_back(table.substr(at, end - at));
    at = end + 1;
  }
  ASSERT_EQ(lines.size(), 9);
  EXPECT_EQ(lines[0], "v,run.dynamics,run.integrator.dt,events.slips [1],status,reason");
  EXPECT_TRUE(lines[1].starts_with("0.10000000000000001,\"inertial\",0.01,")) << lines[1];
  EXPECT_TRUE(lines[1].ends_with(",finished,")) << lines[1];
  EXPECT_TRUE(lines[2].starts_with("0.10000000000000001,\"inertial\",-1,,refused,\"")) << lines[2];
  EXPECT_TRUE(lines[3].starts_with("0.10000000000000001,\"overdamped\",0.01,")) << lines[3];
  EXPECT_TRUE(lines[5].starts_with("0.20000000000000001,\"inertial\",0.01,")) << lines[5];
}

TEST_F(SweepFiles, RecordsAreFoundAgain) {
  const SweepPlan plan = plan_over(kSweptTip, kGrid);
  {
    SweepJournal rows(journal(), plan);
    for (const std::size_t k : {1, 4, 5, 14}) rows.keep(k, *run_point(plan, k));
  }
  const SweepJournal rows(journal(), plan);
  EXPECT_EQ(rows_of(plan), 4);
  EXPECT_TRUE(rows.has(4));
  EXPECT_FALSE(rows.has(3));
  for (const std::size_t k : {1, 5, 14}) {
    const SweepRow expected = *run_point(plan, k);
    SweepRow row;
    rows.read(k, {&row, 1});
    EXPECT_EQ(bits_of(row.numbers), bits_of(expected.numbers));
    EXPECT_EQ(row.status, expected.status);
    EXPECT_EQ(row.reason, expected.reason);
    EXPECT_EQ(row.warnings, expected.warnings);
  }
}

/// A record at the position of another point, one of another sweep, and one with any byte changed
/// are no records.
TEST_F(SweepFiles, WhatIsNoRecordOfThePointIsRunAgain) {
  const SweepPlan plan = plan_over(kSweptTip, {{{"v", "0.02:0.1:5"}}});
  swept(plan, 1);
  const std::string whole = content(journal());
  // The file: a header and five records of one size.
  std::filesystem::remove(journal());
  { const SweepJournal rows(journal(), plan); }
  const std::size_t header = content(journal()).size();
  const std::size_t record = (whole.size() - header) / 5;
  ASSERT_EQ(header + 5 * record, whole.size());

  // Two that have changed places.
  std::string changed = whole;
  std::swap_ranges(changed.begin() + header, changed.begin() + header + record,
                   changed.begin() + header + 2 * record);
  write(journal(), changed);
  EXPECT_EQ(rows_of(plan), 3);
  // One over another.
  changed = whole;
  std::copy_n(whole.begin() + header + record, record, changed.begin() + header + 3 * record);
  write(journal(), changed);
  EXPECT_EQ(rows_of(plan), 4);
  // Any byte.
  for (std::size_t k = header; k < header + record; ++k) {
    changed = whole;
    changed[k] = static_cast<char>(changed[k] ^ 4);
    write(journal(), changed);
    EXPECT_EQ(rows_of(plan), 4) << k;
  }
  // A file that was cut off.
  write(journal(), whole.substr(0, header + 2 * record + 7));
  EXPECT_EQ(rows_of(plan), 2);
  write(journal(), whole.substr(0, header / 2));
  EXPECT_EQ(rows_of(plan), 0);

  // Records of another sweep behind this one's header.
  write(journal(), whole);
  const std::string header_of_this = whole.substr(0, header);
  const SweepPlan other = plan_over(kSweptTip, {{{"v", "0.02:0.2:5"}}});
  EXPECT_EQ(SweepJournal::look(journal(), other), SweepJournal::Found::other_sweep);
  EXPECT_THROW(SweepJournal(journal(), other), OutputError);  // it is never begun anew
  EXPECT_EQ(content(journal()), whole);
  std::filesystem::remove(journal());
  swept(other, 1);
  const std::string whole_of_other = content(journal());
  ASSERT_EQ(whole_of_other.size(), whole.size());
  write(journal(), header_of_this + whole_of_other.substr(header));
  EXPECT_EQ(SweepJournal::look(journal(), plan), SweepJournal::Found::same_sweep);
  EXPECT_EQ(rows_of(plan), 0);
}

/// A reason that is not what the record says makes it none.
TEST_F(SweepFiles, ReasonsAreCheckedToo) {
  const SweepPlan plan = plan_over(kSweptTip, {{{"run.integrator.dt", "-1,1e-2"}}});
  swept(plan, 1);
  std::string changed = content(journal());
  changed.back() = static_cast<char>(changed.back() ^ 1);
  write(journal(), changed);
  EXPECT_EQ(rows_of(plan), 1);
}

TEST_F(SweepFiles, AnotherVersionIsAnotherFile) {
  const SweepPlan plan = plan_over(kSweptTip, {{{"v", "1,2"}}});
  { const SweepJournal rows(journal(), plan); }
  const SweepPlan newer =
      plan_over(kSweptTip, {{{"v", "1,2"}}}, {"driver.mean_force.x"}, {}, "1.2.4");
  EXPECT_EQ(SweepJournal::look(journal(), newer), SweepJournal::Found::other_version);
  EXPECT_EQ(SweepJournal::look(folder_ / "none", newer), SweepJournal::Found::nothing);
}

TEST_F(SweepFiles, AFullDiskIsAnError) {
  const SweepPlan plan = plan_over(kSweptTip, {{{"v", "0.01:0.1:40"}}});
  SweepJournal rows(journal(), plan);
  // Records stand at the positions of their points, and points end in no order.
  constexpr int kBefore = 4;
  for (int k = 0; k < kBefore; ++k) rows.keep(k, *run_point(plan, k));
  {
    const DiskLimit limit(1000);
    EXPECT_THROW(run_sweep(plan, rows, {.threads = 2}), OutputError);
  }
  // Rows that were kept before are not lost.
  EXPECT_GE(rows_of(plan), kBefore);
  EXPECT_LT(rows_of(plan), 40);
}

}  // namespace
}  // namespace tomlin::test
