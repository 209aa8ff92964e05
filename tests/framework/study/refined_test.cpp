#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/numbers/constants.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/output/output_file.hpp"
#include "framework/run/results/observables.hpp"
#include "framework/study/sweep/bisection.hpp"
#include "framework/study/sweep/files.hpp"
#include "framework/study/sweep/runner.hpp"
#include "framework/study/sweep/sweep_journal.hpp"
#include "tests/framework/output/temporary_folder.hpp"
#include "tests/framework/study/sweep_fixture.hpp"
#include "tests/support/ring_scenes.hpp"

/// Points that bisection adds to a sweep.
namespace tomlin::test {
namespace {

/// A particle that stays where a formula of p and q puts it: observables of known shape.
constexpr const char* kPlacedParticle = R"(
[parameters]
p = 1.0
q = 0.0
f = "p"
[[body]]
name = "tip"
type = "point"
position = ["f"]
particle_mass = 1.0
[run]
duration = 1.0
integrator = { type = "rk4", dt = 0.5 }
)";
constexpr const char* kPositionOfIt = "tip.centre_of_mass.x";

/// A tip in the limit of slow driving: it slips as long as k < 4 pi^2 V0/a^2.
constexpr const char* kSlowTip = R"(
[parameters]
k = 3.0
V0 = 0.1
[[body]]
name = "tip"
type = "point"
position = [0.5]
particle_mass = 1.0
[[force]]
name = "driver"
type = "driving_spring"
stiffness = "k"
velocity = [1.0]
[[force]]
type = "sinusoidal_substrate"
amplitude = "V0"
period = 1.0
[run]
dynamics = "quasistatic"
duration = 3.0
)";

struct RefinedAxes {
  AxisTexts over;
  std::string refine;
  std::string along = "";
  std::string to = "";
  std::vector<std::vector<std::string>> zips = {};
  bool continues = false;
};

SweepPlan refined_plan(const std::string& text, const RefinedAxes& axes,
                       const std::vector<Setting>& settings = {}) {
  SweepSettings sweep = sweep_over(axes.over, axes.zips);
  sweep.continues = axes.continues;
  sweep.refine.what = {axes.refine, {"--refine"}, ""};
  if (!axes.along.empty()) sweep.refine.along = {axes.along, {"--refine-along"}, ""};
  if (!axes.to.empty()) sweep.refine.to = {axes.to, {"--refine-to"}, ""};
  return plan_of(text, std::move(sweep), settings);
}

/// A journal that takes so many rows, as if the process was killed then.
class RowsUntilTheKill : public SweepRows {
 public:
  RowsUntilTheKill(SweepJournal& journal, std::size_t most) : journal_(journal), most_(most) {}
  bool has(std::size_t point) const override { return journal_.has(point); }
  void keep(std::size_t point, const SweepRow& row) override {
    const std::lock_guard lock(mutex_);
    if (kept.size() == most_) throw OutputError("killed");
    EXPECT_TRUE(kept.insert(point).second) << "twice: " << point;
    journal_.keep(point, row);
  }
  std::set<std::size_t> kept;

 private:
  std::mutex mutex_;
  SweepJournal& journal_;
  std::size_t most_;
};

/// A refined sweep in a folder.
class RefinedSweep {
 public:
  RefinedSweep(SweepPlan plan, const std::filesystem::path& folder)
      : plan_(std::move(plan)), folder_(folder), journal_(folder / "journal", plan_) {}

  /// The points that were run, until so many rows are kept.
  std::set<std::size_t> run(std::size_t threads = 1, std::size_t most = ~std::size_t{0}) {
    RowsUntilTheKill rows(journal_, most);
    SweepOptions options;
    options.threads = threads;
    options.add_points = [this] { return bisection_.add_points(); };
    try {
      progress_ = run_sweep(plan_, rows, options);
    } catch (const OutputError&) {
    }
    return rows.kept;
  }

  /// The bytes of its table and of its arrays.
  std::string results() const {
    write_sweep_table(folder_ / "table", plan_, journal_);
    write_sweep_arrays(folder_ / "arrays", plan_, journal_);
    return content(folder_ / "table") + content(folder_ / "arrays");
  }

  /// "found 3 .. 3.1: 8 0", with the last digits cut.
  std::vector<std::string> found() const {
    std::vector<std::string> all;
    for (const Bisection& one : bisection_.all()) {
      all.push_back(to_string(*one.status));
      if (*one.status == BisectionStatus::none) continue;
      all.back() += fmt::format(" {:.4g} .. {:.4g}: {:.4g} {:.4g}", one.ends[0].at, one.ends[1].at,
                                one.ends[0].number, one.ends[1].number);
    }
    return all;
  }

  SweepPlan& plan() { return plan_; }
  const SweepJournal& journal() const { return journal_; }
  const std::vector<Bisection>& bisections() const { return bisection_.all(); }
  const SweepProgress& progress() const { return progress_; }

 private:
  SweepPlan plan_;
  std::filesystem::path folder_;
  SweepJournal journal_;
  SweepBisection bisection_{plan_, journal_};
  SweepProgress progress_;
};

std::vector<std::string> found_by(const std::string& text, const RefinedAxes& axes,
                                  const std::vector<Setting>& settings = {}) {
  const TemporaryFolder folder;
  RefinedSweep sweep(refined_plan(text, axes, settings), folder.path());
  sweep.run();
  EXPECT_TRUE(sweep.progress().complete());
  return sweep.found();
}

std::vector<std::string> found_of(const std::string& formula, const RefinedAxes& axes) {
  return found_by(kPlacedParticle, axes, {{"f", formula}});
}

using Found = std::vector<std::string>;

const std::string kPositionAt3 = std::string(kPositionOfIt) + "=3";

TEST(RefinedSweep, BracketsALevel) {
  EXPECT_EQ(found_of("p", {{{"p", "0:8:3"}}, kPositionAt3, "", "0.25"}),
            Found{"found 2.75 .. 3: 2.75 3"});
  // Falling axes and falling observables.
  EXPECT_EQ(found_of("p", {{{"p", "8:0:3"}}, kPositionAt3, "", "0.25"}),
            Found{"found 3 .. 2.75: 3 2.75"});
  EXPECT_EQ(found_of("6 - p", {{{"p", "0:8:3"}}, kPositionAt3, "", "0.25"}),
            Found{"found 3 .. 3.25: 3 2.75"});
  // Each pair of neighbours on either side, and lines where there is none.
  EXPECT_EQ(found_of("(p - 4)^2 + q", {{{"q", "0,5"}, {"p", "0:8:3"}}, kPositionAt3, "", "0.5"}),
            (Found{"found 2 .. 2.5: 4 2.25", "found 5.5 .. 6: 2.25 4", "none"}));
  // In the logarithm, and a list has its middles where it is.
  EXPECT_EQ(found_of("p", {{{"p", "1:1e4:3:log"}}, std::string(kPositionOfIt) + "=7", "", "1.2"}),
            Found{"found 3.162 .. 10: 3.162 10"});
  EXPECT_EQ(found_of("p", {{{"p", "1,2,4"}}, kPositionAt3, "", "0.5"}),
            Found{"found 2.5 .. 3: 2.5 3"});
  // An interval that is narrow already is found without a point.
  EXPECT_EQ(found_of("p", {{{"p", "0:8:3"}}, kPositionAt3, "", "4"}), Found{"found 0 .. 4: 0 4"});
}

/// The width is 1e-4 of the axis unless it is given, and of its logarithm.
TEST(RefinedSweep, IsAsNarrowAsItIsToBe) {
  for (const bool logarithmic : {false, true}) {
    const TemporaryFolder folder;
    const std::string values = logarithmic ? "0.5:50:3:log" : "0.5:50:3";
    RefinedSweep sweep(refined_plan(kPlacedParticle, {{{"p", values}}, kPositionAt3}),
                       folder.path());
    sweep.run();
    const auto& [low, high] = sweep.bisections().at(0).ends;
    EXPECT_LT(low.at, 3.0);
    EXPECT_GE(high.at, 3.0);
    const double width = logarithmic ? std::log(high.at / low.at) : high.at - low.at;
    const double whole = logarithmic ? std::log(50.0 / 0.5) : 49.5;
    EXPECT_LE(width, 1.0001e-4 * whole);
    EXPECT_GT(width, 0.49e-4 * whole);
  }
}

TEST(RefinedSweep, FollowsAJumpAndKnowsASmoothCurve) {
  EXPECT_EQ(
      found_of("floor(p / 3 + q)", {{{"q", "0,0.5"}, {"p", "0:4:3"}}, kPositionOfIt, "", "1e-3"}),
      (Found{"found 2.999 .. 3: 0 1", "found 1.499 .. 1.5: 0 1"}));
  // A jump on top of a slope, and slopes of any steepness, with a corner and of a root.
  EXPECT_EQ(found_of("floor(p / 3) + 0.2 * p", {{{"p", "0:4:3"}}, kPositionOfIt, "", "1e-3"}),
            Found{"found 2.999 .. 3: 0.5998 1.6"});
  for (const std::string smooth : {"p", "1e6 * p^3", "max(p, 3)", "sqrt(p)"}) {
    const Found found = found_of(smooth, {{{"p", "0:4:3"}}, kPositionOfIt, "", "1e-3"});
    ASSERT_EQ(found.size(), 1) << smooth;
    EXPECT_TRUE(found[0].starts_with("smooth")) << smooth << ": " << found[0];
  }
  // One halving of a wide interval would call a slope a jump.
  EXPECT_TRUE(found_of("p", {{{"p", "0:4:3"}}, kPositionOfIt, "", "1.9"})[0].starts_with("smooth"));
  EXPECT_EQ(found_of("0 * p", {{{"p", "0:4:3"}}, kPositionOfIt}), Found{"none"});
}

/// Points without a number end a bisection, and are on no side of a level.
TEST(RefinedSweep, PointsWithoutANumber) {
  // Refused between 2 and 4 but at the ends, that is sqrt of less than 0.
  const std::string hole = "p + 0 * sqrt((p - 2.1) * (p - 3.9))";
  EXPECT_EQ(found_of(hole, {{{"p", "0:8:5"}}, kPositionAt3}), Found{"failed 2 .. 4: 2 4"});
  // Numbers on both sides of a point without one.
  EXPECT_EQ(found_of(hole, {{{"p", "1:5:3"}}, kPositionAt3}), Found{"failed 1 .. 5: 1 5"});
  EXPECT_EQ(found_of(hole + " + 10 * floor(p / 4)", {{{"p", "0:8:5"}}, kPositionOfIt}),
            Found{"failed 2 .. 4: 2 14"});
}

/// A failed end of an axis does not end the search: the crossing may be next to it, or between it
/// and its neighbour.
TEST(RefinedSweep, GoesOnNextToAFailedEnd) {
  const std::string above = "p + 0 * sqrt(p - 1.5)";
  EXPECT_EQ(found_of(above, {{{"p", "1:9:3"}}, kPositionAt3, "", "0.5"}),
            Found{"found 2.5 .. 3: 2.5 3"});
  const std::string below = "p + 0 * sqrt(8.5 - p)";
  EXPECT_EQ(found_of(below, {{{"p", "1:9:3"}}, std::string(kPositionOfIt) + "=7", "", "0.5"}),
            Found{"found 6.5 .. 7: 6.5 7"});
  // Whatever is beyond the last point that has a number is not known.
  const std::string at_one = "p + 0 * sqrt(p - 1.2)";
  EXPECT_EQ(found_of(at_one, {{{"p", "1:9:3"}}, std::string(kPositionOfIt) + "=1", "", "0.5"}),
            Found{"failed 1 .. 1.5: nan 1.5"});
  // Known neighbours on either side are what is bisected.
  EXPECT_EQ(found_of(at_one, {{{"p", "1:9:3"}}, std::string(kPositionOfIt) + "=6", "", "0.5"}),
            Found{"found 5.5 .. 6: 5.5 6"});
}

/// A threshold that is known: 4 pi^2 V0.
TEST(RefinedSweep, FindsWhereSlidingBecomesSmooth) {
  constexpr double kTo = 1e-4;
  for (const double V0 : {0.1, 0.2}) {
    const TemporaryFolder folder;
    RefinedSweep sweep(refined_plan(kSlowTip, {{{"k", "1:9:5"}}, "events.slips=0.5", "", "1e-4"},
                                    {{"V0", fmt::format("{}", V0)}}),
                       folder.path());
    sweep.run();
    ASSERT_EQ(sweep.bisections().size(), 1);
    const auto& [low, high] = sweep.bisections()[0].ends;
    EXPECT_EQ(high.number, 0.0);
    EXPECT_GT(low.number, 0.0);
    EXPECT_LE(high.at - low.at, kTo);
    // The last slips are so small that half of the width may be missed.
    EXPECT_NEAR(0.5 * (low.at + high.at), kTau * kTau * V0, kTo);
  }
}

/// Rows are in the order of the axes, have the bits of runs, and are the same from any number of
/// threads and when the process is killed after any row; none is run again.
TEST(RefinedSweep, KilledAfterAnyRowItIsTheSame) {
  const RefinedAxes axes = {{{"q", "0,2"}, {"p", "0:8:3"}, {"run.integrator.dt", "0.5,-1,0.25"}},
                            kPositionAt3,
                            "p",
                            "0.5"};
  const std::vector<Setting> settings = {{"f", "p + q"}};
  const TemporaryFolder folder;
  RefinedSweep whole(refined_plan(kPlacedParticle, axes, settings), folder.path());
  const std::size_t all = whole.run().size();
  EXPECT_EQ(whole.found(), (Found{"found 2.5 .. 3: 2.5 3", "none", "found 2.5 .. 3: 2.5 3",
                                  "found 0.5 .. 1: 2.5 3", "none", "found 0.5 .. 1: 2.5 3"}));
  EXPECT_EQ(all, 18 + 4 * 3);
  const std::string results = whole.results();

  const RowOrder order(whole.plan());
  ASSERT_EQ(order.size(), all);
  std::vector<std::vector<double>> numbers;
  for (std::size_t row = 0; row < all; ++row) {
    const std::size_t point = order.point(row);
    numbers.push_back({});
    for (const std::size_t axis : {0, 1}) {
      numbers.back().push_back(whole.plan().number(axis, point));
    }
    numbers.back().push_back(static_cast<double>(whole.plan().index(2, point)));
    SweepRow kept;
    whole.journal().read(point, {&kept, 1});
    std::vector<Setting> of_run = settings;
    for (const Setting& setting : whole.plan().settings_at(point)) of_run.push_back(setting);
    try {
      const RunResult result =
          run(SceneDocument(kPlacedParticle, "test.toml").read(standard(), of_run));
      EXPECT_EQ(std::bit_cast<std::uint64_t>(kept.numbers[0]),
                std::bit_cast<std::uint64_t>(*observable(result, kPositionOfIt)));
    } catch (const InputError&) {
      EXPECT_EQ(kept.status, SweepStatus::refused);
    }
  }
  EXPECT_TRUE(std::is_sorted(numbers.begin(), numbers.end()));

  for (const std::size_t threads : {1, 2, 3}) {
    for (std::size_t most = 0; most <= all; most += threads) {
      const TemporaryFolder other;
      std::set<std::size_t> before =
          RefinedSweep(refined_plan(kPlacedParticle, axes, settings), other.path())
              .run(threads, most);
      RefinedSweep again(refined_plan(kPlacedParticle, axes, settings), other.path());
      const std::set<std::size_t> after = again.run(threads);
      EXPECT_EQ(before.size(), most);
      EXPECT_EQ(after.size(), all - most);
      EXPECT_EQ(again.progress().before, most);
      EXPECT_TRUE(again.progress().complete());
      before.insert(after.begin(), after.end());
      EXPECT_EQ(before.size(), all);
      EXPECT_EQ(again.results(), results) << threads << " threads, after " << most;
    }
  }
}

/// Along an axis that falls, too.
TEST(RefinedSweep, RowsFallAsTheirAxisDoes) {
  const TemporaryFolder folder;
  RefinedSweep sweep(refined_plan(kPlacedParticle, {{{"p", "8:0:3"}}, kPositionAt3, "", "0.5"}),
                     folder.path());
  sweep.run();
  const RowOrder order(sweep.plan());
  std::vector<double> numbers;
  for (std::size_t row = 0; row < order.size(); ++row) {
    numbers.push_back(sweep.plan().number(0, order.point(row)));
  }
  EXPECT_EQ(numbers, (std::vector<double>{8.0, 4.0, 3.0, 2.5, 2.0, 0.0}));
}

/// A record that is damaged is run again, and what depends on it is found again.
TEST(RefinedSweep, ADamagedRecordIsRunAgain) {
  const RefinedAxes axes = {{{"p", "0:8:3"}}, kPositionAt3, "", "0.25"};
  const TemporaryFolder folder;
  std::string results;
  {
    RefinedSweep whole(refined_plan(kPlacedParticle, axes), folder.path());
    EXPECT_EQ(whole.run().size(), 3 + 4);
    results = whole.results();
  }
  std::string bytes = content(folder.path() / "journal");
  bytes[bytes.size() / 3] ^= 1;
  write(folder.path() / "journal", bytes);
  RefinedSweep again(refined_plan(kPlacedParticle, axes), folder.path());
  EXPECT_EQ(again.run().size(), 1);
  EXPECT_EQ(again.results(), results);
}

TEST(RefinedSweep, TheSceneWithItsTableIsTheSame) {
  for (const RefinedAxes& axes :
       {RefinedAxes{{{"q", "1,2"}, {"p", "0:8:3"}}, kPositionAt3, "q", "0.1"},
        RefinedAxes{{{"q", "1,2"}, {"p", "1:8:3:log"}}, kPositionOfIt}}) {
    const SweepPlan plan = refined_plan(kPlacedParticle, axes);
    const SweepPlan again = plan_in(plan.scene_text());
    EXPECT_EQ(again.scene_text(), plan.scene_text());
    EXPECT_EQ(again.identity(), plan.identity());
    // Another level, width or axis is another sweep.
    for (const RefinedAxes& other :
         {RefinedAxes{axes.over, std::string(kPositionOfIt) + "=3.5", axes.along, axes.to},
          RefinedAxes{axes.over, axes.refine, axes.along, "0.2"},
          RefinedAxes{axes.over, axes.refine, axes.along == "q" ? "p" : "q", axes.to}}) {
      EXPECT_NE(refined_plan(kPlacedParticle, other).identity(), plan.identity());
    }
  }
}

Found refined_faults(const RefinedAxes& axes) {
  return briefs_of([&] { refined_plan(kPlacedParticle, axes); });
}

TEST(RefinedSweep, AllFaultsTogether) {
  const AxisTexts p = {{"p", "0:8:3"}};
  EXPECT_EQ(refined_faults({p, kPositionAt3}), Found{});
  EXPECT_EQ(refined_faults({p, "tip.centre_of_mas.x=1"}),
            Found{"tip.centre_of_mas.x [observable.unknown] did you mean "
                  "tip.centre_of_mass.x"});
  EXPECT_EQ(refined_faults({{{"p", "0:8:3"}, {"qq", "1,2"}}, "tip.centre_of_mass.x=x", "pp", "-1"}),
            (Found{"tip.centre_of_mass.x=x [command.invalid_value]", "-1 [command.invalid_value]",
                   "pp [scene.unknown_name]", "qq = 1 [scene.unknown_key]"}));
  EXPECT_EQ(refined_faults({p, "=3"}), Found{"=3 [command.missing_argument]"});
  EXPECT_EQ(refined_faults({p, kPositionAt3 + "e999"}).size(), 1);
  for (const std::string width : {"0", "-1", "1e-20", "nan", "x", "inf"}) {
    EXPECT_EQ(refined_faults({p, kPositionAt3, "", width}),
              Found{width + " [command.invalid_value]"});
  }
  // Only an axis of numbers in their order has values between its values.
  for (const std::string values : {"1", "1,3,2", "1,1", "1,2,2", "a,b", "-1e308,1e308"}) {
    EXPECT_EQ(refined_faults({{{"p", values}}, kPositionAt3}).at(0),
              kPositionAt3 + " [scene.conflict]")
        << values;
  }
  EXPECT_EQ(refined_faults({{{"p", "1,2"}, {"q", "1,2"}}, kPositionAt3, "", "", {{"p", "q"}}}),
            Found{kPositionAt3 + " [scene.conflict]"});
  EXPECT_EQ(refined_faults({p, kPositionAt3, "", "", {}, true}),
            Found{kPositionAt3 + " [command.conflict]"});
  EXPECT_EQ(refined_faults({{{"q", "0:1:3000"}, {"p", "0:1:3000"}}, kPositionAt3, "", "1e-12"}),
            Found{kPositionAt3 + " [scene.too_large]"});
}

}  // namespace
}  // namespace tomlin::test
