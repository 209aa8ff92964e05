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
      const Ended ended = expect_status(0, tomlin(plus(command, {flag})));
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
  expect_status(0, tomlin({"run", "pt.toml"}));
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
  const Ended taken = expect_status(
      0,
      tomlin({"explain", "tip.toml", "--set", "output.every=" + every.substr(0, every.find(','))}));
  EXPECT_FALSE(contains(taken.out, "refused")) << taken.out;
}

/// A word of 1e5 characters, wherever a word can be given, is not printed whole.
TEST_F(Cli, LongWordsAreShownByTheirBeginning) {
  constexpr std::size_t kLongest = 3000;  // characters of all faults of a command together
  const std::string word(100000, 'x');
  const std::string other_name =
      replaced(kTip, "\"tip\"", "\"" + word + "\"") +
      "[[force]]\ntype = \"constant_force\"\nbody = \"nothing\"\nforce = [1.0]\n";
  write(folder_ / "long.toml", other_name);
  const std::vector<std::string> sweep = {
      "sweep", "tip.toml", "--over", "v=1,2", "--observable", "driver.mean_force.x", "-o", "s"};
  const auto swept = [&](const std::string& option) { return plus(sweep, {option, word}); };
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
  const Ended ended = expect_status(0, tomlin({"--version"}));
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

TEST_F(Cli, DescribeListsAndShowsComponents) {
  const Ended whole = expect_status(0, tomlin({"describe"}));
  const Json list = Json::parse(tomlin({"describe", "--json"}).out);
  std::size_t keys = 0;
  for (const char* kinds : {"bodies", "forces", "integrators"}) {
    ASSERT_FALSE(list.at(kinds).empty());
    for (const Json& listed : list[kinds]) {
      const auto name = listed["name"].get<std::string>();
      SCOPED_TRACE(name);
      expect_parts(whole.out, {"\n  " + name + " ", listed["summary"].get<std::string>()});
      const Ended text = expect_status(0, tomlin({"describe", name}));
      const Json component = Json::parse(tomlin({"describe", name, "--json"}).out);
      for (const char* key : {"summary", "equation"}) {
        const auto value = component[key].get<std::string>();
        expect_parts(text.out, {value.substr(0, value.find('\n'))});
      }
      EXPECT_FALSE(component["works"].empty());
      for (const Json& work : component["works"]) {
        expect_parts(text.out, {"\n  " + work["work"].get<std::string>()});
      }
      for (const Json& row : component["parameters"]) {
        ++keys;
        expect_parts(text.out, {"\n  " + row["key"].get<std::string>() + " ["});
        for (const char* key : {"dimension", "admissible", "kind", "doc"}) {
          EXPECT_FALSE(row[key].get<std::string>().empty()) << key;
        }
        EXPECT_TRUE(row["choices"].is_array());
        EXPECT_EQ(row["required"].get<bool>() && !row.at("default").is_null(), false);
      }
      EXPECT_FALSE(component["example"].get<std::string>().empty());
    }
  }
  EXPECT_GT(keys, 30U);
}

TEST_F(Cli, DescribeKnowsWhatItDoesNotKnow) {
  const std::string unknown = "tomlin: [scene.unknown_component]";
  expect_refused({"describe", "sinusoidal_substrat"},
                 unknown + " did you mean sinusoidal_substrate\n", {"\"sinusoidal_substrat\""});
  expect_refused({"describe", "stiffness"}, unknown + "\n", {"driving_spring, harmonic_bonds"});
  expect_refused({"describe", "every"}, unknown + "\n", {"[output]"});
}

TEST_F(Cli, DescribeShowsTheTablesOfAScene) {
  const Json list = Json::parse(tomlin({"describe", "--json"}).out);
  std::size_t keys = 0;
  for (const Json& listed : list["tables"]) {
    const auto name = listed["name"].get<std::string>();
    const Ended text = expect_status(0, tomlin({"describe", name}));
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

/// Every name that the list, a page or a scene has, in every form. Components by their bare names
/// are in DescribeListsAndShowsComponents and in ThePagesAreWrittenIntoAFolder.
TEST_F(Cli, DescribeKnowsEveryName) {
  const Json list = Json::parse(tomlin({"describe", "--json"}).out);
  std::vector<std::string> names = {"body",       "bodies",    "force",     "forces",
                                    "integrator", "observer",  "[run]",     "[[force]]",
                                    "until",      "run.until", "parameters"};
  for (const auto& [kinds, listed] : list.items()) {
    names.push_back(kinds == "tables" ? "scene" : kinds);
    if (kinds == "bodies" || kinds == "forces" || kinds == "integrators") continue;
    for (const Json& one : listed) names.push_back(one["name"]);
  }
  EXPECT_GT(names.size(), 20U);
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
    const auto name = one["name"].get<std::string>();
    expect_status(0, tomlin({"describe", "force." + name}));
    EXPECT_TRUE(contains(forces, "\n  " + name + " ")) << forces;
  }
  EXPECT_TRUE(contains(forces, "\n  bodies: ")) << forces;
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
  const Ended ended = expect_status(0, tomlin({"describe", "--markdown", "-o", "pages/new"}));
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
    const Ended ended = expect_status(
        0, tomlin({"run", "tip.toml", "--set", "measure.observables=[" + observables + "]",
                   "--force", "-o", "asked"}));
    EXPECT_FALSE(contains(ended.out, "ended before the window")) << ended.out;
    return ended.out;
  };
  EXPECT_TRUE(contains(shown("\"driver.dissipated_per_period\""), "ledger = true"));
  EXPECT_TRUE(contains(shown("\"driver.distance\""), "  distance 1\n"));
  const std::string both = shown("\"driver.mean_force.x\", \"driver.dissipated_per_period\"");
  expect_parts(both, {"  mean force ", "; no dissipated_per_period ("});
}

TEST_F(Cli, ARunLeavesItsFilesAndAShortResult) {
  const Ended ended = expect_status(0, tomlin({"run", "tip.toml"}));
  EXPECT_EQ(ended.err, "");
  EXPECT_EQ(ended.out.substr(0, 6), "a tip\n");
  expect_parts(ended.out, {"finished", "mean force", "static force", "mean velocity", "tip.out/"});
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
  const Ended ended = expect_status(0, tomlin({"run", "tip.toml", "--quiet", "-o", "deep/down"}));
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
  const Json first = comparable_summary("first");
  for (const std::string other : {"second", "third"}) {
    EXPECT_EQ(file("first/observables.csv"), file(other + "/observables.csv"));
    EXPECT_EQ(file("first/scene.toml"), file(other + "/scene.toml"));
    EXPECT_EQ(first.dump(), comparable_summary(other).dump());
  }
  // The comparison can fail.
  ASSERT_EQ(tomlin({"run", "tip.toml", "--set", "v=1.0000001e-2", "-o", "fourth"}).status, 0);
  EXPECT_NE(file("first/observables.csv"), file("fourth/observables.csv"));
}

TEST_F(Cli, SetReplacesValues) {
  expect_status(2, tomlin({"run", "tip.toml", "--set", "v=two_v0 / 2", "--set", "two_v=0.03"}));
  expect_status(0, tomlin({"run", "tip.toml", "--set", "v=2e-2", "--set", "run.integrator.dt=2e-2",
                           "--set", "force.driver.stiffness=4 * v", "--set=run.duration=200"}));
  const Json results = summary("tip.out");
  EXPECT_EQ(results["parameters"]["v"], 0.02);
  EXPECT_EQ(results["parameters"]["two_v"], 0.04);
  EXPECT_EQ(results["time"]["steps"], 10000);
}

TEST_F(Cli, SetRefusesWhatIsNotThere) {
  expect_refused({"run", "tip.toml", "--set", "v", "--set", ""},
                 "--set: v [command.missing_argument]\n--set: \"\" [command.missing_argument]\n");
  expect_refused({"run", "tip.toml", "--set", "w=1"}, "--set w=1: w = 1 [scene.unknown_key]\n");
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
  const Ended ended = expect_status(2, tomlin({"run", "bad.toml"}));
  EXPECT_EQ(lines(ended.err), 3) << ended.err;
  EXPECT_EQ(ended.err.substr(0, 11), "bad.toml:3:") << ended.err;
  EXPECT_TRUE(contains(ended.err, " [scene.syntax]\n  integrator = { type = \n")) << ended.err;
  EXPECT_FALSE(exists("bad.out"));
}

TEST_F(Cli, AllFaultsOfASceneComeTogether) {
  std::string scene = replaced(kTip, "particle_mass = 1.0", "particle_mass = 0.0");
  scene = replaced(scene, "stiffness = 2.0", "stifness = 2.0");
  write(folder_ / "tip.toml", replaced(scene, "duration = 300.0", "duration = inf"));
  const Ended ended = expect_status(2, tomlin({"run", "tip.toml"}));
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
  const Ended ended = expect_status(
      130, tomlin({"run", "fk.toml", "--set", "N=20000", "--set", "run.accuracy=1e-8"},
                  {.then = signal_after(std::chrono::milliseconds(3500), SIGINT)}));
  expect_parts(ended.err, {"tomlin: pilot: looking for the integrator, 0:0", " elapsed\n"});
  EXPECT_FALSE(contains(ended.err, "\r")) << ended.err;
}

// ---- runs that do not end well

TEST_F(Cli, AFailedRunLeavesItsSummary) {
  const Ended ended =
      expect_status(1, tomlin({"run", "tip.toml", "--set", "run.integrator.dt=10"}));
  EXPECT_EQ(abridged(ended.err),
            "--set run.integrator.dt=10: run.integrator.dt [run.step.unstable]\n");
  const Json results = summary("tip.out");
  EXPECT_EQ(results["status"], "failed");
  expect_parts(ended.err, {"step 0, time ", results["failure"]["cause"].get<std::string>()});
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
    write(folder_ / "step.toml", replaced(kTip, R"({ type = "rk4", dt = 1e-2 })", one.integrator));
    std::vector<std::string> arguments = {"run", "step.toml", "--force"};
    for (const std::string& setting : one.more) {
      arguments.insert(arguments.end(), {"--set", setting});
    }
    const Ended ended = tomlin(arguments);
    EXPECT_EQ(ended.status, 1) << one.integrator;
    EXPECT_EQ(abridged(ended.err), "step.toml:31:" + std::to_string(one.column) +
                                       ": run.integrator." + one.key + " [" + one.code + "]\n");
    EXPECT_EQ(summary("step.out")["failure"]["code"], one.code);
  }
}

TEST_F(Cli, ARunThatBreaksDownLeavesItsSummary) {
  // Beyond the limit, insisting.
  const Ended ended =
      expect_status(1, tomlin({"run", "tip.toml", "--set", "run.integrator.dt=5", "--set",
                               "run.allow_unstable=true", "--set", "run.duration=1e6"}));
  expect_error(ended, "tip.toml: [run.step.unstable]\n", {": step "});
  EXPECT_EQ(summary("tip.out")["status"], "failed");
  EXPECT_FALSE(contains(file("tip.out/observables.csv"), "nan"));
}

TEST_F(Cli, AStandardOutputThatIsFullIsReported) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full here";
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"run", "tip.toml"}, std::vector<std::string>{"describe"},
        std::vector<std::string>{"--help"}}) {
    const Ended ended = expect_status(1, tomlin(arguments, {.standard_output = "/dev/full"}));
    EXPECT_EQ(abridged(ended.err), "tomlin: [file.cannot_write]\n");
    EXPECT_TRUE(contains(ended.err, "standard output")) << ended.err;
  }
  EXPECT_EQ(summary("tip.out")["status"], "finished");
}

// ---- what others wrote

/// A scene's name, a file's name, a plugin's message: nothing of it controls the terminal.
TEST_F(Cli, WhatOthersWroteReachesATerminalEscaped) {
  const auto acts = [](const std::string& text) {
    return std::any_of(text.begin(), text.end(), [](char c) {
      return c != '\n' && c != '\t' && (static_cast<unsigned char>(c) < 0x20U || c == 0x7F);
    });
  };
  const std::string scene =
      replaced(kTip, "\"a tip\"", "\"\\u001b]0;x\\u0007 \\u009b31m \\u202e\"");
  const std::string file = "\x1b[31m.toml";
  write(folder_ / file, scene);
  for (const char* command : {"explain", "check", "run"}) {
    const Ended ended = expect_status(0, tomlin({command, file}));
    EXPECT_FALSE(acts(ended.out + ended.err)) << command;
    for (const char* hidden : {"\u009b", "\u202e"}) EXPECT_FALSE(contains(ended.out, hidden));
  }
  EXPECT_TRUE(contains(tomlin({"explain", file}).out, "]0;x \\u009B31m \\u202E"));
  const Json json = Json::parse(tomlin({"explain", file, "--json"}).out);
  EXPECT_TRUE(contains(json.dump(), "\u009b31m")) << json.dump();
  write(folder_ / file, "[run]\nduration = oops\n");
  const Ended refused = expect_status(2, tomlin({"run", file}));
  EXPECT_FALSE(acts(refused.err));
  EXPECT_TRUE(contains(refused.err, "\\u001B[31m.toml:2:")) << refused.err;
}

TEST_F(Cli, AnUnknownInstructionSetIsBadInput) {
  const Conditions wish{.environment = {"TOMLIN_INSTRUCTION_SET=AVX2"}};
  const Ended ended = expect_status(2, tomlin({"run", "tip.toml"}, wish));
  EXPECT_EQ(abridged(ended.err),
            "tomlin: TOMLIN_INSTRUCTION_SET = AVX2 [machine.instruction_set] did you mean avx2\n");
  EXPECT_FALSE(exists("tip.out"));
  EXPECT_EQ(tomlin({"--version"}, wish).status, 0);
  EXPECT_EQ(tomlin({"run", "tip.toml"}, {.environment = {"TOMLIN_INSTRUCTION_SET="}}).status, 0);
}

}  // namespace
}  // namespace tomlin::test
