#include "framework/run/results/selection.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/text/fault.hpp"
#include "framework/run/results/observables.hpp"
#include "tests/support/ring_scenes.hpp"

// [measure] observables: what is not asked for is neither looked at nor reported, and what is asked
// for has the same bits.

namespace tomlin::test {
namespace {

std::string measuring(const std::vector<std::string>& paths, const std::string& more = "") {
  std::string list;
  for (const std::string& path : paths) list += (list.empty() ? "\"" : ", \"") + path + "\"";
  return "[measure]\nfrom = 2.0\nin = \"time\"\n" + more +
         (paths.empty() ? "" : "observables = [" + list + "]\n");
}

TipScene tip_measuring(const std::vector<std::string>& paths, const std::string& integrator) {
  return {.integrator = integrator, .more = measuring(paths)};
}

RingScene ring_measuring(const std::vector<std::string>& paths, const std::string& coordinates,
                         const std::string& integrator) {
  return {.coordinates = coordinates, .integrator = integrator, .more = measuring(paths)};
}

/// Groups of the run alone: what it took is always told.
std::vector<std::string> reported(const RunResult& result) {
  std::vector<std::string> rows;
  for (const ResultGroup& group : result.groups) {
    for (const ResultValue& value : group.values) {
      rows.push_back(group.family + "." + (group.name.empty() ? "" : group.name + ".") +
                     value.quantity().key);
    }
  }
  return rows;
}

TEST(Selection, HasTheSameBitsAsAllOfIt) {
  const std::vector<std::string> schemes = {fixed_step(0.01), "{ type = \"dopri5\" }",
                                            "{ type = \"radau9\" }"};
  for (const std::string& scheme : schemes) {
    for (const char* coordinates : {"rigid", "particles", "tip"}) {
      const bool is_tip = coordinates == std::string("tip");
      const auto run_of = [&](const std::vector<std::string>& paths) {
        return run(scene_of(is_tip ? tip_measuring(paths, scheme).text()
                                   : ring_measuring(paths, coordinates, scheme).text()));
      };
      const RunResult all = run_of({});
      std::vector<std::string> paths;
      for (const Observable& one : observables(all)) {
        if (!one.path.starts_with("time.") && !one.path.starts_with("window.") &&
            !one.path.starts_with("performance.")) {
          paths.push_back(one.path);
        }
      }
      for (const std::string& path : paths) {
        const RunResult one = run_of({path});
        ASSERT_EQ(one.groups.size(), 1u) << path;
        EXPECT_EQ(one.groups[0].values.size(), 1u) << path;
        EXPECT_EQ(observable(one, path), observable(all, path)) << path << " " << scheme;
        EXPECT_EQ(one.force_evaluations, all.force_evaluations) << path;
      }
    }
  }
}

TEST(Selection, LeavesOutFamilyAndAxis) {
  const auto rows_of = [](const std::vector<std::string>& paths) {
    return reported(run(scene_of(ring_measuring(paths, "rigid", fixed_step(0.01)).text())));
  };
  EXPECT_EQ(rows_of({"driver.mean_force.x"}),
            (std::vector<std::string>{"drivers.driver.mean_force"}));
  EXPECT_EQ(rows_of({"drivers.driver.mean_force.y", "ring.turns"}),
            (std::vector<std::string>{"drivers.driver.mean_force", "bodies.ring.turns"}));
  EXPECT_EQ(rows_of({"events.slips"}), (std::vector<std::string>{"events.slips"}));
}

TEST(Selection, FindsNoEventsThatNobodyAsksFor) {
  const auto events_of = [](const std::vector<std::string>& paths) {
    KeptSamples kept;
    run(scene_of(tip_measuring(paths, fixed_step(0.01)).text()), watched_by(kept));
    return kept.events.size();
  };
  const std::size_t all = events_of({});
  ASSERT_GT(all, 0u);
  EXPECT_EQ(events_of({"driver.mean_force.x"}), 0u);
  EXPECT_EQ(events_of({"events.slips"}), all);
  EXPECT_EQ(events_of({"driver.static_force"}), all);  // it ends with the first slip
}

TEST(Selection, KnowsTheNearestNameOfAll) {
  const auto refused = [](const std::string& path) {
    return brief_refusal(tip_measuring({"driver.mean_force.x", path}, fixed_step(0.01)).text());
  };
  for (const auto& [path, nearest] : {std::pair("driver.max_forse.x", "driver.max_force.x"),
                                      std::pair("driver.mean_force.y", "driver.mean_force.x"),
                                      std::pair("driver.mean_force", "driver.mean_force.x")}) {
    EXPECT_EQ(refused(path),
              std::string("25:15 ") + path + " [observable.unknown] did you mean " + nearest);
  }
  EXPECT_EQ(refused("time.steps"), "");
}

/// Not another one before it, that only those who ask for it have.
TEST(Selection, NamesTheObservableThatIsWrong) {
  const std::string only_asked = "forces.sinusoidal_substrate.on.tip.mean_force.x";
  EXPECT_EQ(brief_refusal(tip_measuring({only_asked}, fixed_step(0.01)).text()), "");
  EXPECT_EQ(
      brief_refusal(tip_measuring({only_asked, "driver.mean_force"}, fixed_step(0.01)).text()),
      "25:15 driver.mean_force [observable.unknown] did you mean driver.mean_force.x");
}

TEST(Selection, HoldsWhatTheRunItselfNeeds) {
  TipScene tip = {.duration = 400.0};
  tip.more = measuring({"driver.mean_force.x"});
  std::string text = tip.text();
  const std::string key = "duration = " + digits(tip.duration);
  text.replace(text.find(key), key.size(),
               "until = { steady = \"driver.max_force.x\", tolerance = 1e-3, max = 400.0 }");
  const RunResult steady = run(scene_of(text));
  ASSERT_TRUE(steady.steady.has_value());
  const std::string asked = "observables = [\"driver.mean_force.x\"]";
  const RunResult all = run(scene_of(text.replace(text.find(asked), asked.size(), "")));
  EXPECT_EQ(steady.steady->change, all.steady->change);
  EXPECT_EQ(reported(steady),
            (std::vector<std::string>{"drivers.driver.mean_force", "drivers.driver.max_force"}));

  TipScene repeated = {.more = measuring({"driver.work"})};
  repeated.integrator += "\nperturb = { size = 1e-9 }";
  const RunResult determined = run_as_bound(scene_of(repeated.text()));
  ASSERT_EQ(determined.determined.size(), 1u);
  EXPECT_EQ(determined.determined[0].path, "driver.work");
}

}  // namespace
}  // namespace tomlin::test
