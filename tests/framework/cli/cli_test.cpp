#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "framework/cli/command.hpp"
#include "tests/framework/cli/cli_fixture.hpp"

namespace tomlin::test {
namespace {

// ---- the command line

TEST_F(Cli, HelpIsEverywhere) {
  std::vector<std::vector<std::string>> calls = {{}};
  for (const CommandRecord& record : commands()) calls.push_back({record.name});
  for (const std::vector<std::string>& command : calls) {
    for (const char* flag : {"--help", "-h"}) {
      auto arguments = command;
      arguments.emplace_back(flag);
      const Ended ended = tomlin(arguments);
      EXPECT_EQ(ended.status, 0);
      EXPECT_EQ(ended.err, "");
      EXPECT_TRUE(contains(ended.out, "Usage: tomlin")) << ended.out;
    }
  }
  const std::string help = tomlin({"--help"}).out;
  EXPECT_EQ(tomlin({"help"}).out, help);
  EXPECT_EQ(tomlin({"help", "run"}).out, tomlin({"run", "--help"}).out);
}

TEST_F(Cli, TheSceneInTheHelpRuns) {
  const std::string help = tomlin({"--help"}).out;
  const auto begin = help.find("  [parameters]");
  const auto end = help.find("\nand type");
  ASSERT_TRUE(begin < end && end < help.size());
  write(folder_ / "pt.toml", help.substr(begin, end - begin));
  const Ended ended = tomlin({"run", "pt.toml"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_TRUE(exists("pt.out/observables.csv"));
  // From a well the first maximum is the barrier, which the drag comes on top of; from a barrier it
  // would be the drag alone.
  const Json driver = summary("pt.out")["drivers"]["driving_spring"];
  const double barrier = 2.0 * std::acos(-1.0) * 0.1;
  EXPECT_GT(driver["static_force"], barrier);
  EXPECT_GT(driver["static_force"], driver["mean_force"][0]);
}

/// Refused before anything is made or begun.
TEST_F(Cli, SamplesThatFillADiskAreRefused) {
  write(folder_ / "chain.toml", R"([[body]]
type = "chain"
count = 100000
spacing = 1.0
particle_mass = 1.0

[[force]]
type = "constant_force"
force = [1.0]

[run]
duration = 1e3
integrator = { type = "rk4", dt = 1e-2 }

[output]
every = 1e-5
trajectory = true
)");
  expect_refused({"run", "tip.toml", "--set", "output.every=1e-9"},
                 "--set output.every=1e-9: output.every = 1e-09 [output.too_large]\n",
                 {" 3e+11 rows", " of run.journal", " room "});
  // Eighty terabytes.
  const std::string frames = "chain.toml:16:9: output.every = 1e-05 [output.too_large]\n";
  expect_refused({"run", "chain.toml"}, frames,
                 {" 100000001 rows", " TB of trajectory.h5", " of run.journal"});
  // With an accuracy in place of an integrator, too.
  expect_refused({"run", "chain.toml", "--set", "run.accuracy=1e-6"}, frames);
  expect_refused({"run", "tip.toml", "--set", "output.every=1e-9", "--resume"},
                 "--set output.every=1e-9: output.every = 1e-09 [output.too_large]\n");
}

/// The interval that the message admits is accepted.
TEST_F(Cli, TheIntervalThatFitsIsTaken) {
  const Ended refused = tomlin({"explain", "tip.toml", "--set", "output.every=1e-9"});
  const std::string admissible = "expected: >= ";
  const auto at = refused.out.find(admissible);
  ASSERT_NE(at, std::string::npos) << refused.out;
  const std::string every = refused.out.substr(at + admissible.size(), 12);
  const Ended taken =
      tomlin({"explain", "tip.toml", "--set", "output.every=" + every.substr(0, every.find(','))});
  EXPECT_EQ(taken.status, 0) << taken.err;
  EXPECT_FALSE(contains(taken.out, "refused")) << taken.out;
}

/// A word of 1e5 characters, wherever a word can be given, is not printed whole.
TEST_F(Cli, LongWordsAreShownByTheirBeginning) {
  constexpr std::size_t kLongest = 3000;  // characters of all faults of a command together
  const std::string word(100000, 'x');
  std::string other_name = kTip;
  const std::size_t at = other_name.find("\"tip\"");
  ASSERT_NE(at, std::string::npos);
  other_name.replace(at + 1, 3, word);
  other_name += "[[force]]\ntype = \"constant_force\"\nbody = \"nothing\"\nforce = [1.0]\n";
  write(folder_ / "long.toml", other_name);
  const std::vector<std::string> sweep = {
      "sweep", "tip.toml", "--over", "v=1,2", "--observable", "driver.mean_force.x", "-o", "s"};
  const auto swept = [&](const std::string& option) {
    std::vector<std::string> all = sweep;
    all.insert(all.end(), {option, word});
    return all;
  };
  const std::vector<std::vector<std::string>> commands = {
      {word},
      {"run", word},
      {"run", "long.toml"},
      {"run", "tip.toml", word},
      {"run", "tip.toml", "-o", word},
      {"run", "tip.toml", "--" + word},
      {"run", "tip.toml", "--threads", word},
      {"run", "tip.toml", "--set", word},
      {"run", "tip.toml", "--set", word + "=1"},
      {"run", "tip.toml", "--set", "v=" + word},
      {"run", "tip.toml", "--set", "measure.observables=[\"" + word + "\"]"},
      {"run", "tip.toml", "--plugin", word},
      {"describe", word},
      {"new", word},
      {"new", "plugin", word},
      {"export", "tip.toml", "--to", word},
      {"tradeoff", "tip.toml", "--observable", word},
      {"merge", word},
      {"plot", word},
      swept("--zip"),
      swept("--refine"),
      swept("--observable")};
  for (const std::vector<std::string>& command : commands) {
    const Ended ended = tomlin(command);
    EXPECT_EQ(ended.status, 2) << command.front();
    EXPECT_LT(ended.err.size(), kLongest) << ended.err.substr(0, kLongest);
    EXPECT_FALSE(ended.err.empty()) << command.front();
  }
}

TEST_F(Cli, VersionIsANumber) {
  const Ended ended = tomlin({"--version"});
  EXPECT_EQ(ended.status, 0);
  EXPECT_EQ(ended.out.substr(0, 7), "tomlin ");
  EXPECT_EQ(std::count(ended.out.begin(), ended.out.end(), '.'), 2) << ended.out;
}

TEST_F(Cli, WhatItDoesNotKnowIsBadInput) {
  const std::string option = "tomlin: [command.unknown_option]";
  const std::string missing = "tomlin: [command.missing_argument]\n";
  expect_refused({}, missing, {"run, sweep, merge, tradeoff, compare, "});
  expect_refused({"swep"}, "tomlin: [command.unknown] did you mean sweep\n", {"\"swep\""});
  expect_refused({"run", "tip.toml", "--frce"}, option + " did you mean --force\n",
                 {"tomlin run ", "--frce", "--set"});
  expect_refused({"run", "tip.toml", "v=1"}, option + "\n", {"\"v=1\"", "--set v=1"});
  expect_refused({"--verison"}, option + " did you mean --version\n", {"--verison"});
  expect_refused({"--quiet", "run", "tip.toml"}, option + "\n", {"--quiet"});
  expect_refused({"run", "tip.toml", "other.toml"}, option + "\n", {"\"other.toml\""});
  expect_refused({"run"}, missing, {"SCENE"});
  EXPECT_EQ(tomlin({"run", "tip.toml", "-o"}).status, 2);
  EXPECT_EQ(tomlin({"run", "tip.toml", "-o", "a", "-o", "b"}).status, 2);
}

// ---- describe

TEST_F(Cli, DescribeListsTheComponents) {
  const Ended ended = tomlin({"describe"});
  EXPECT_EQ(ended.status, 0);
  const Json list = Json::parse(tomlin({"describe", "--json"}).out);
  std::size_t count = 0;
  for (const char* kinds : {"bodies", "forces", "integrators"}) {
    for (const Json& component : list[kinds]) {
      ++count;
      EXPECT_TRUE(contains(ended.out, "\n  " + component["name"].get<std::string>() + " "));
      EXPECT_TRUE(contains(ended.out, component["summary"].get<std::string>()));
    }
  }
  EXPECT_GE(count, 10U);
}

TEST_F(Cli, DescribeShowsOneComponentAndItsExampleRuns) {
  const Json list = Json::parse(tomlin({"describe", "--json"}).out);
  std::size_t keys = 0;
  for (const char* kinds : {"bodies", "forces", "integrators"}) {
    ASSERT_FALSE(list.at(kinds).empty());
    for (const Json& listed : list[kinds]) {
      const auto name = listed["name"].get<std::string>();
      const Ended text = tomlin({"describe", name});
      EXPECT_EQ(text.status, 0);
      const Json component = Json::parse(tomlin({"describe", name, "--json"}).out);
      for (const char* key : {"summary", "equation"}) {
        const auto value = component[key].get<std::string>();
        EXPECT_TRUE(contains(text.out, value.substr(0, value.find('\n')))) << name << " " << key;
      }
      EXPECT_FALSE(component["works"].empty());
      for (const Json& work : component["works"]) {
        EXPECT_TRUE(contains(text.out, "\n  " + work["work"].get<std::string>())) << name;
      }
      for (const Json& row : component["parameters"]) {
        ++keys;
        EXPECT_TRUE(contains(text.out, "\n  " + row["key"].get<std::string>() + " ["));
        EXPECT_FALSE(row["dimension"].get<std::string>().empty());
        EXPECT_FALSE(row["admissible"].get<std::string>().empty());
        EXPECT_FALSE(row["kind"].get<std::string>().empty());
        EXPECT_FALSE(row["doc"].get<std::string>().empty());
        EXPECT_TRUE(row["choices"].is_array());
        EXPECT_EQ(row["required"].get<bool>() && !row.at("default").is_null(), false);
      }
      write(folder_ / (name + ".toml"), component["example"].get<std::string>());
      const Ended ended = tomlin({"run", name + ".toml", "--quiet"});
      EXPECT_EQ(ended.status, 0) << name << ": " << ended.err;
    }
  }
  EXPECT_GT(keys, 30U);
}

TEST_F(Cli, DescribeKnowsWhatItDoesNotKnow) {
  expect_refused({"describe", "sinusoidal_substrat"},
                 "tomlin: [scene.unknown_component] did you mean sinusoidal_substrate\n",
                 {"\"sinusoidal_substrat\""});
}

TEST_F(Cli, DescribeShowsTheTablesOfAScene) {
  const Json list = Json::parse(tomlin({"describe", "--json"}).out);
  std::size_t keys = 0;
  for (const Json& listed : list["tables"]) {
    const auto name = listed["name"].get<std::string>();
    const Ended text = tomlin({"describe", name});
    EXPECT_EQ(text.status, 0);
    EXPECT_TRUE(contains(text.out, "[" + name + "]: " + listed["summary"].get<std::string>()));
    const Json table = Json::parse(tomlin({"describe", name, "--json"}).out);
    for (const Json& row : table["parameters"]) {
      ++keys;
      EXPECT_TRUE(contains(text.out, "\n  " + row["key"].get<std::string>() + " ["));
    }
  }
  EXPECT_EQ(list["tables"].size(), 10U);
  EXPECT_GT(keys, 20U);
}

/// Every name that the list, a page or a scene has, in every form.
TEST_F(Cli, DescribeKnowsEveryName) {
  const Json list = Json::parse(tomlin({"describe", "--json"}).out);
  std::vector<std::string> names = {"body",       "bodies",    "force",     "forces",
                                    "integrator", "observer",  "[run]",     "[[force]]",
                                    "until",      "run.until", "parameters"};
  for (const auto& [kinds, listed] : list.items()) {
    names.push_back(kinds == "tables" ? "scene" : kinds);
    for (const Json& one : listed) {
      names.push_back(one["name"]);
      if (kinds == "forces") names.push_back("force." + one["name"].get<std::string>());
    }
  }
  EXPECT_GT(names.size(), 40U);
  for (const std::string& name : names) {
    for (const char* form : {"", "--json", "--markdown"}) {
      std::vector<std::string> arguments = {"describe", name};
      if (*form != 0) arguments.emplace_back(form);
      const Ended ended = tomlin(arguments);
      EXPECT_EQ(ended.status, 0) << name << " " << form << ": " << ended.err;
    }
  }
  const std::string forces = tomlin({"describe", "force"}).out;
  for (const Json& one : list["forces"]) {
    EXPECT_TRUE(contains(forces, "\n  " + one["name"].get<std::string>() + " ")) << forces;
  }
  EXPECT_TRUE(contains(forces, "\n  bodies: ")) << forces;
}

TEST_F(Cli, DescribeSaysWhereAKeyIs) {
  const std::string unknown = "tomlin: [scene.unknown_component]\n";
  expect_refused({"describe", "stiffness"}, unknown, {"driving_spring, harmonic_bonds"});
  expect_refused({"describe", "every"}, unknown, {"[output]"});
}

TEST_F(Cli, DescribeNamesTheWorksOfASource) {
  const Json verlet = Json::parse(tomlin({"describe", "velocity_verlet", "--json"}).out);
  ASSERT_EQ(verlet["works"].size(), 2U);
  EXPECT_EQ(verlet["works"][0]["place"], "");
  EXPECT_EQ(verlet["works"][1]["place"], "friction by splitting");
  EXPECT_EQ(verlet["number_types"], (Json{"double", "quadruple"}));
}

// ---- the pages of reference

TEST_F(Cli, ThePagesAreWrittenIntoAFolder) {
  const Ended ended = tomlin({"describe", "--markdown", "-o", "pages/new"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  std::string all;
  for (const char* page :
       {"framework/bodies/REFERENCE.md", "forcefields/REFERENCE.md", "integrators/REFERENCE.md",
        "framework/scene/REFERENCE.md", "framework/run/REFERENCE.md", "framework/DIAGNOSTICS.md"}) {
    EXPECT_TRUE(contains(ended.out, page));
    all += (all.empty() ? "" : "\n") + file(std::string("pages/new/") + page);
  }
  EXPECT_EQ(tomlin({"describe", "--markdown"}).out, all);
  const Json list = Json::parse(tomlin({"describe", "--json"}).out);
  for (const char* kinds : {"bodies", "forces", "integrators"}) {
    for (const Json& listed : list[kinds]) {
      const auto name = listed["name"].get<std::string>();
      const std::string section = tomlin({"describe", name, "--markdown"}).out;
      EXPECT_EQ(section.substr(0, name.size() + 4), "## " + name + "\n");
      // The last of a page has no empty line after it.
      EXPECT_TRUE(contains(all, section.substr(0, section.size() - 1))) << section;
    }
  }
}

TEST_F(Cli, PagesAreNotReplacedUnasked) {
  fs::create_directories(folder_ / "forcefields");
  write(folder_ / "forcefields/REFERENCE.md", "mine");
  expect_refused({"describe", "--markdown", "-o", "."},
                 "-o: ./forcefields/REFERENCE.md [file.exists]\n");
  EXPECT_EQ(file("forcefields/REFERENCE.md"), "mine");
  EXPECT_EQ(tomlin({"describe", "--markdown", "-o", ".", "--force"}).status, 0);
  EXPECT_NE(file("forcefields/REFERENCE.md"), "mine");
  write(folder_ / "a_file", "");
  EXPECT_EQ(tomlin({"describe", "--markdown", "-o", "a_file"}).status, 2);
  EXPECT_EQ(tomlin({"describe", "rk4", "--markdown", "-o", "x"}).status, 2);
  EXPECT_EQ(tomlin({"describe", "-o", "x"}).status, 2);
  EXPECT_EQ(tomlin({"describe", "--markdown", "--json"}).status, 2);
  EXPECT_FALSE(exists("x"));
}

// ---- run

/// A requested result without a value is listed with what it needs; one with a value is shown.
TEST_F(Cli, ARunShowsWhatWasAskedFor) {
  const auto shown = [this](const std::string& observables) {
    const Ended ended =
        tomlin({"run", "tip.toml", "--set", "measure.observables=[" + observables + "]", "--force",
                "-o", "asked"});
    EXPECT_EQ(ended.status, 0) << ended.err;
    EXPECT_FALSE(contains(ended.out, "ended before the window")) << ended.out;
    return ended.out;
  };
  EXPECT_TRUE(contains(shown("\"driver.dissipated_per_period\""), "ledger = true"));
  EXPECT_TRUE(contains(shown("\"driver.distance\""), "  distance 1\n"));
  const std::string both = shown("\"driver.mean_force.x\", \"driver.dissipated_per_period\"");
  EXPECT_TRUE(contains(both, "  mean force ")) << both;
  EXPECT_TRUE(contains(both, "; no dissipated_per_period (")) << both;
}

TEST_F(Cli, ARunLeavesItsFilesAndAShortResult) {
  const Ended ended = tomlin({"run", "tip.toml"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.err, "");
  EXPECT_EQ(ended.out.substr(0, 6), "a tip\n");
  for (const char* part : {"finished", "mean force", "static force", "mean velocity", "tip.out/"}) {
    EXPECT_TRUE(contains(ended.out, part)) << part << "\n" << ended.out;
  }
  EXPECT_LE(lines(ended.out), 12);

  EXPECT_TRUE(contains(ended.out, "\n  cite "));

  const Json results = summary("tip.out");
  EXPECT_EQ(results["status"], "finished");
  EXPECT_EQ(results["program"]["version"], tomlin({"--version"}).out.substr(7, 5));
  EXPECT_EQ(results["scene"]["name"], "a tip");
  EXPECT_EQ(results["integrator"], Json::parse(R"({"type": "rk4", "dt": 0.01})"));
  EXPECT_EQ(results["performance"]["scene_file"], "tip.toml");
  EXPECT_EQ(results["parameters"]["two_v"], 0.02);
  EXPECT_EQ(results["time"]["end"], 300.0);
  EXPECT_EQ(results["time"]["steps"], 30000);
  EXPECT_EQ(results["window"]["from"], 100.0);
  EXPECT_EQ(results["window"]["to"], 200.0);
  EXPECT_EQ(results["drivers"]["driver"]["mean_force"].size(), 1U);
  EXPECT_GT(results["drivers"]["driver"]["mean_force"][0], 0.0);

  const std::string table = file("tip.out/observables.csv");
  EXPECT_EQ(table.substr(0, 35), "time [time],driver.force.x [force],");
  EXPECT_EQ(lines(table), 1 + 429);   // the header, and 0, 0.7, ... below 300
  EXPECT_EQ(all_files().size(), 6U);  // the scene, the folder and four files in it
}

TEST_F(Cli, ASummaryHasTheIntegratorThatWasTaken) {
  ASSERT_EQ(tomlin({"run", "tip.toml", "--set", "run.accuracy=1e-3", "--quiet"}).status, 0);
  const Json results = summary("tip.out");
  const auto type = results["integrator"]["type"].get<std::string>();
  EXPECT_TRUE(contains(results["accuracy"]["integrator"].get<std::string>(), '"' + type + '"'));
  // Every key has its value, those that were left alone too.
  const Json described = Json::parse(tomlin({"describe", type, "--json"}).out);
  for (const Json& row : described["parameters"]) {
    EXPECT_TRUE(results["integrator"].contains(row["key"].get<std::string>())) << row;
  }
}

TEST_F(Cli, NoTableWithoutASamplingInterval) {
  std::string scene = kTip;
  scene.erase(scene.find("[output]"));
  write(folder_ / "tip.toml", scene);
  ASSERT_EQ(tomlin({"run", "tip.toml"}).status, 0);
  EXPECT_TRUE(exists("tip.out/summary.json"));
  EXPECT_FALSE(exists("tip.out/observables.csv"));
}

TEST_F(Cli, QuietSaysNothing) {
  const Ended ended = tomlin({"run", "tip.toml", "--quiet", "-o", "deep/down"});
  EXPECT_EQ(ended.status, 0);
  EXPECT_EQ(ended.out, "");
  EXPECT_EQ(ended.err, "");
  EXPECT_TRUE(exists("deep/down/summary.json"));
}

TEST_F(Cli, TheDefaultFolderIsInTheCurrentOne) {
  fs::create_directory(folder_ / "scenes");
  fs::rename(folder_ / "tip.toml", folder_.path() / "scenes" / "tip.toml");
  ASSERT_EQ(tomlin({"run", "scenes/tip.toml"}).status, 0);
  EXPECT_TRUE(exists("tip.out/summary.json"));
}

TEST_F(Cli, ASecondRunGivesTheSameBits) {
  ASSERT_EQ(tomlin({"run", "tip.toml", "-o", "first"}).status, 0);
  ASSERT_EQ(tomlin({"run", "tip.toml", "-o", "second"}).status, 0);
  ASSERT_EQ(tomlin({"run", "first/scene.toml", "-o", "third"}).status, 0);
  Json first = summary("first");
  first.erase("performance");
  for (const std::string other : {"second", "third"}) {
    EXPECT_EQ(file("first/observables.csv"), file(other + "/observables.csv"));
    EXPECT_EQ(file("first/scene.toml"), file(other + "/scene.toml"));
    Json results = summary(other);
    results.erase("performance");
    EXPECT_EQ(first.dump(), results.dump());
  }
  // The comparison can fail.
  ASSERT_EQ(tomlin({"run", "tip.toml", "--set", "v=1.0000001e-2", "-o", "fourth"}).status, 0);
  EXPECT_NE(file("first/observables.csv"), file("fourth/observables.csv"));
}

TEST_F(Cli, SetReplacesValues) {
  const Ended ended = tomlin({"run", "tip.toml", "--set", "v=two_v0 / 2", "--set", "two_v=0.03"});
  EXPECT_EQ(ended.status, 2);
  ASSERT_EQ(tomlin({"run", "tip.toml", "--set", "v=2e-2", "--set", "run.integrator.dt=2e-2",
                    "--set", "force.driver.stiffness=4 * v", "--set=run.duration=200"})
                .status,
            0);
  const Json results = summary("tip.out");
  EXPECT_EQ(results["parameters"]["v"], 0.02);
  EXPECT_EQ(results["parameters"]["two_v"], 0.04);
  EXPECT_EQ(results["time"]["steps"], 10000);
}

TEST_F(Cli, SetRefusesWhatIsNotThere) {
  expect_refused({"run", "tip.toml", "--set", "v", "--set", ""},
                 "--set: v [command.missing_argument]\n--set: \"\" [command.missing_argument]\n");
  for (const char* setting : {"w=1", "=1", "run.integrator.step=1", "force.drivr.stiffness=1",
                              "v=nan", "run.duration=-1", "v=1/0"}) {
    const Ended ended = tomlin({"run", "tip.toml", "--set", setting});
    EXPECT_EQ(ended.status, 2) << setting;
    EXPECT_EQ(ended.err.substr(0, 5), "--set") << setting << ": " << ended.err;
    EXPECT_FALSE(exists("tip.out"));
  }
}

TEST_F(Cli, AFolderThatIsNotEmptyNeedsForce) {
  ASSERT_EQ(tomlin({"run", "tip.toml"}).status, 0);
  write(folder_.path() / "tip.out" / "notes.txt", "mine");
  const std::string before = file("tip.out/summary.json");
  expect_refused({"run", "tip.toml"}, "-o: tip.out [file.exists]\n");
  EXPECT_EQ(file("tip.out/summary.json"), before);

  std::string scene = kTip;
  scene.erase(scene.find("[output]"));
  write(folder_ / "tip.toml", scene);
  ASSERT_EQ(tomlin({"run", "tip.toml", "--force", "--set", "v=2e-2"}).status, 0);
  EXPECT_EQ(summary("tip.out")["parameters"]["v"], 0.02);
  EXPECT_EQ(file("tip.out/notes.txt"), "mine");
  EXPECT_FALSE(exists("tip.out/observables.csv"));  // the earlier run's
}

TEST_F(Cli, ASceneIsNeverReplacedByAnother) {
  fs::create_directory(folder_ / "work");
  write(folder_.path() / "work" / "scene.toml", kTip);
  expect_refused({"run", "work/scene.toml", "-o", "work", "--force"}, "-o: work [file.exists]\n",
                 {"work/scene.toml"});
  EXPECT_EQ(file("work/scene.toml"), kTip);

  // An effective scene is written again as it is.
  ASSERT_EQ(tomlin({"run", "tip.toml"}).status, 0);
  EXPECT_EQ(tomlin({"run", "tip.out/scene.toml", "-o", "tip.out", "--force"}).status, 0);
}

TEST_F(Cli, AFolderThatCannotBeUsedIsBadInput) {
  write(folder_ / "file", "");
  expect_refused({"run", "tip.toml", "-o", "file"}, "-o: file [file.invalid]\n");
  expect_refused({"run", "tip.toml", "-o", "file/run"}, "-o: file/run [file.cannot_write]\n");
  expect_refused({"run", "tip.toml", "-o", ""}, "-o: \"\" [command.invalid_value]\n");
  if (fs::exists("/proc/self")) {
    EXPECT_EQ(tomlin({"run", "tip.toml", "-o", "/proc/tomlin"}).status, 2);
  }
}

TEST_F(Cli, AFolderThatMayNotBeWrittenIsBadInput) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  fs::create_directory(folder_ / "locked");
  fs::permissions(folder_ / "locked", fs::perms::owner_read | fs::perms::owner_exec);
  for (const std::string folder : {"locked", "locked/run"}) {
    expect_refused({"run", "tip.toml", "-o", folder}, "-o: " + folder + " [file.cannot_write]\n");
  }
}

// ---- scenes that cannot be run

TEST_F(Cli, ASceneThatIsNotThereIsBadInput) {
  write(folder_ / "empty.toml", "");
  fs::create_directory(folder_ / "folder.toml");
  expect_refused({"run", "empty.toml", "-o", "out"}, "empty.toml:1:1: [file.invalid]\n");
  for (const std::string scene : {"missing.toml", "folder.toml", ""}) {
    expect_refused({"run", scene, "-o", "out"}, scene + ":1:1: [file.cannot_read]\n");
  }
}

TEST_F(Cli, ASyntaxErrorStandsAloneWithItsPlace) {
  write(folder_ / "bad.toml", "[run]\nduratoin = 1.0\nintegrator = { type = \n[[body]]\n");
  const Ended ended = tomlin({"run", "bad.toml"});
  EXPECT_EQ(ended.status, 2);
  EXPECT_EQ(lines(ended.err), 3) << ended.err;
  EXPECT_EQ(ended.err.substr(0, 11), "bad.toml:3:") << ended.err;
  EXPECT_TRUE(contains(ended.err, " [scene.syntax]\n  integrator = { type = \n")) << ended.err;
  EXPECT_FALSE(exists("bad.out"));
}

TEST_F(Cli, AllFaultsOfASceneComeTogether) {
  std::string scene = kTip;
  const auto replace = [&scene](const std::string& old_text, const std::string& new_text) {
    scene.replace(scene.find(old_text), old_text.size(), new_text);
  };
  replace("particle_mass = 1.0", "particle_mass = 0.0");
  replace("stiffness = 2.0", "stifness = 2.0");
  replace("duration = 300.0", "duration = inf");
  write(folder_ / "tip.toml", scene);
  const Ended ended = tomlin({"run", "tip.toml"});
  EXPECT_EQ(ended.status, 2);
  for (const char* error :
       {"tip.toml:12:17: body.tip.particle_mass = 0.0 [scene.out_of_range]\n",
        "tip.toml:17:1: force.driver.stifness [scene.unknown_key] did you mean stiffness\n",
        "tip.toml:30:12: run.duration = inf [scene.not_finite]\n"}) {
    expect_error(ended, error);
  }
  EXPECT_GE(lines(ended.err), 3) << ended.err;
  EXPECT_FALSE(exists("tip.out"));
}

TEST_F(Cli, WhatShowsOnlyWhenTheSceneIsBoundMakesNoFolder) {
  expect_refused({"run", "tip.toml", "--set", "measure.to=50", "-o", "a/b"},
                 "--set measure.to=50: measure.to [run.invalid_window]\n");
}

/// A fault that shows as a scene is bound is reported once and at its location, whoever binds it.
TEST_F(Cli, AFaultIsTheSameUnderAnAccuracy) {
  for (const std::vector<std::string>& settings :
       {std::vector<std::string>{"measure.to=50"},
        {"output.every=1e-14"},
        {"force.driver.velocity=[0.0]"},
        {"measure.driver=viscous_damping"},
        {"run.until={ steady = \"driver.mean_force.x\", tolerance = 1e-3 }", "run.duration=10"},
        {"force.sinusoidal_substrate.type=expression"}}) {
    std::vector<std::string> arguments = {"run", "tip.toml"};
    for (const std::string& setting : settings) {
      arguments.insert(arguments.end(), {"--set", setting});
    }
    const Ended with_integrator = tomlin(arguments);
    EXPECT_EQ(with_integrator.status, 2) << settings.front();
    arguments.insert(arguments.end(), {"--set", "run.accuracy=1e-3"});
    const Ended with_accuracy = tomlin(arguments);
    EXPECT_EQ(with_accuracy.status, 2) << settings.front();
    EXPECT_EQ(with_accuracy.err, with_integrator.err) << settings.front();
    EXPECT_FALSE(contains(with_accuracy.err, "run.accuracy: ")) << with_accuracy.err;
  }
}

/// Progress is reported while a pilot runs too, in plain lines where standard error is no terminal.
TEST_F(Cli, APilotShowsThatItGoesOn) {
  ASSERT_EQ(tomlin({"new", "fk"}).status, 0);
  const Ended ended = tomlin({"run", "fk.toml", "--set", "N=20000", "--set", "run.accuracy=1e-8"},
                             {.then = [](pid_t child) {
                               std::this_thread::sleep_for(std::chrono::milliseconds(3500));
                               ::kill(child, SIGINT);
                             }});
  EXPECT_EQ(ended.status, 130) << ended.err;
  EXPECT_TRUE(contains(ended.err, "tomlin: pilot: looking for the integrator, 0:0")) << ended.err;
  EXPECT_TRUE(contains(ended.err, " elapsed\n")) << ended.err;
  EXPECT_FALSE(contains(ended.err, "\r")) << ended.err;
}

// ---- runs that do not end well

TEST_F(Cli, AFailedRunLeavesItsSummary) {
  const Ended ended = tomlin({"run", "tip.toml", "--set", "run.integrator.dt=10"});
  EXPECT_EQ(ended.status, 1);
  EXPECT_EQ(abridged(ended.err),
            "--set run.integrator.dt=10: run.integrator.dt [run.step.unstable]\n");
  const Json results = summary("tip.out");
  EXPECT_EQ(results["status"], "failed");
  EXPECT_TRUE(contains(ended.err, "step 0, time ")) << ended.err;
  EXPECT_TRUE(contains(ended.err, results["failure"]["cause"].get<std::string>())) << ended.err;
  EXPECT_TRUE(contains(results["failure"]["what"].get<std::string>(), "stability limit"));
  EXPECT_TRUE(exists("tip.out/scene.toml"));
}

/// Whatever refuses a step stands where the step does.
TEST_F(Cli, AStepThatIsRefusedHasItsPlace) {
  struct Refused {
    const char* integrator;
    const char* key;
    int column;
    const char* code;
    std::vector<std::string> more;
  };
  for (const Refused& one :
       {Refused{R"({ type = "rk4", dt = 10 })", "dt", 35, "run.step.unstable", {}},
        Refused{R"({ type = "velocity_verlet", dt = 10 })", "dt", 47, "run.step.unstable", {}},
        Refused{R"({ type = "velocity_verlet", dt = 0.4 })",
                "dt",
                47,
                "run.step.unstable",
                {"force.viscous_damping.coefficient=40"}},
        Refused{
            R"({ type = "dopri5", most_steps = 20 })", "most_steps", 46, "run.step.limit", {}}}) {
    std::string scene = kTip;
    const std::string old_text = R"({ type = "rk4", dt = 1e-2 })";
    scene.replace(scene.find(old_text), old_text.size(), one.integrator);
    write(folder_ / "step.toml", scene);
    std::vector<std::string> arguments = {"run", "step.toml", "--force"};
    for (const std::string& setting : one.more) {
      arguments.insert(arguments.end(), {"--set", setting});
    }
    const Ended ended = tomlin(arguments);
    EXPECT_EQ(ended.status, 1) << one.integrator;
    EXPECT_EQ(abridged(ended.err), "step.toml:31:" + std::to_string(one.column) +
                                       ": run.integrator." + one.key + " [" + one.code + "]\n");
  }
}

TEST_F(Cli, ARunThatBreaksDownLeavesItsSummary) {
  // Beyond the limit, insisting.
  const Ended ended = tomlin({"run", "tip.toml", "--set", "run.integrator.dt=5", "--set",
                              "run.allow_unstable=true", "--set", "run.duration=1e6"});
  EXPECT_EQ(ended.status, 1);
  expect_error(ended, "tip.toml: [run.step.unstable]\n", {": step "});
  EXPECT_EQ(summary("tip.out")["status"], "failed");
  EXPECT_FALSE(contains(file("tip.out/observables.csv"), "nan"));
}

TEST_F(Cli, AFullDiskIsReportedAndEndsTheRun) {
  const Ended ended =
      tomlin({"run", "tip.toml", "--set", "run.duration=1e6"}, {.largest_file = 100000});
  EXPECT_EQ(ended.status, 1);
  EXPECT_EQ(abridged(ended.err), "tomlin: [file.cannot_write]\n");
  EXPECT_TRUE(contains(ended.err, "tip.out/run.journal")) << ended.err;
  EXPECT_FALSE(exists("tip.out/observables.csv"));
  EXPECT_TRUE(exists("tip.out/run.checkpoint"));
  const Json results = summary("tip.out");
  EXPECT_EQ(results["status"], "failed");
  EXPECT_LT(results["time"]["end"], 1e6);
}

TEST_F(Cli, AStandardOutputThatIsFullIsReported) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full here";
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"run", "tip.toml"}, std::vector<std::string>{"describe"},
        std::vector<std::string>{"--help"}}) {
    const Ended ended = tomlin(arguments, {.standard_output = "/dev/full"});
    EXPECT_EQ(ended.status, 1);
    EXPECT_EQ(abridged(ended.err), "tomlin: [file.cannot_write]\n");
    EXPECT_TRUE(contains(ended.err, "standard output")) << ended.err;
  }
  EXPECT_EQ(summary("tip.out")["status"], "finished");
}

TEST_F(Cli, ASignalEndsARunThatLeavesWhatIsKnown) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const std::string folder = "signal-" + std::to_string(signal);
    const auto begun = folder_.path() / folder / "run.checkpoint";
    const Ended ended = tomlin(
        {"run", "tip.toml", "--set", "run.duration=1e9", "--set", "output.every=1e3", "-o", folder},
        {.then = [&](pid_t child) {
          EXPECT_TRUE(appears(begun));
          ::kill(child, signal);
        }});
    EXPECT_EQ(ended.status, 128 + signal) << ended.err;
    const Json results = summary(folder);
    EXPECT_EQ(results["status"], "interrupted");
    EXPECT_LT(results["time"]["end"], 1e9);
    EXPECT_TRUE(exists(folder + "/observables.csv"));
    EXPECT_TRUE(exists(folder + "/scene.toml"));
  }
}

TEST_F(Cli, AKilledRunLeavesNothingThatLooksComplete) {
  const auto begun = folder_.path() / "tip.out" / "run.checkpoint";
  const Ended ended =
      tomlin({"run", "tip.toml", "--set", "run.duration=1e9", "--set", "output.every=1e3"},
             {.then = [&](pid_t child) {
               EXPECT_TRUE(appears(begun));
               ::kill(child, SIGKILL);
             }});
  EXPECT_EQ(ended.status, 128 + SIGKILL);
  EXPECT_FALSE(exists("tip.out/summary.json"));
  EXPECT_FALSE(exists("tip.out/observables.csv"));
  EXPECT_EQ(tomlin({"run", "tip.toml"}).status, 2);
  EXPECT_EQ(tomlin({"run", "tip.toml", "--force"}).status, 0);
  EXPECT_FALSE(fs::exists(begun));
}

// ---- what others wrote

/// A scene's name, a file's name, a plugin's message: nothing of it controls the terminal.
TEST_F(Cli, WhatOthersWroteReachesATerminalEscaped) {
  const auto acts = [](const std::string& text) {
    return std::any_of(text.begin(), text.end(), [](char c) {
      return c != '\n' && c != '\t' && (static_cast<unsigned char>(c) < 0x20U || c == 0x7F);
    });
  };
  std::string scene = kTip;
  const std::string name = "name = \"a tip\"";
  scene.replace(scene.find(name), name.size(), "name = \"\\u001b]0;x\\u0007 \\u009b31m \\u202e\"");
  const std::string file = "\x1b[31m.toml";
  write(folder_ / file, scene);
  for (const char* command : {"explain", "check", "run"}) {
    const Ended ended = tomlin({command, file});
    EXPECT_EQ(ended.status, 0) << ended.err;
    EXPECT_FALSE(acts(ended.out + ended.err)) << command;
    for (const char* hidden : {"\u009b", "\u202e"}) EXPECT_FALSE(contains(ended.out, hidden));
  }
  EXPECT_TRUE(contains(tomlin({"explain", file}).out, "]0;x \\u009B31m \\u202E"));
  const Json json = Json::parse(tomlin({"explain", file, "--json"}).out);
  EXPECT_TRUE(contains(json.dump(), "\u009b31m")) << json.dump();
  write(folder_ / file, "[run]\nduration = oops\n");
  const Ended refused = tomlin({"run", file});
  EXPECT_EQ(refused.status, 2);
  EXPECT_FALSE(acts(refused.err));
  EXPECT_TRUE(contains(refused.err, "\\u001B[31m.toml:2:")) << refused.err;
}

TEST_F(Cli, AnUnknownInstructionSetIsBadInput) {
  const Conditions wish{.environment = {"TOMLIN_INSTRUCTION_SET=AVX2"}};
  const Ended ended = tomlin({"run", "tip.toml"}, wish);
  EXPECT_EQ(ended.status, 2);
  EXPECT_EQ(abridged(ended.err),
            "tomlin: TOMLIN_INSTRUCTION_SET = AVX2 [machine.instruction_set] did you mean avx2\n");
  EXPECT_FALSE(exists("tip.out"));
  EXPECT_EQ(tomlin({"--version"}, wish).status, 0);
  EXPECT_EQ(tomlin({"run", "tip.toml"}, {.environment = {"TOMLIN_INSTRUCTION_SET="}}).status, 0);
}

}  // namespace
}  // namespace tomlin::test
