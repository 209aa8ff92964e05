#include <chrono>
#include <cmath>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "framework/plugin/load.hpp"
#include "tests/framework/cli/cli_fixture.hpp"
#include "tests/framework/plugin/plugin_files.hpp"
#include "tests/support/paths.hpp"

namespace tomlin::test {
namespace {

constexpr const char* kBonded = R"(
[[body]]
type = "chain"
count = 2
spacing = 1.3
particle_mass = 1.0

[[force]]
type = "morse"
pairs = "neighbours"
depth = 2.0
steepness = 1.5
rest_length = 1.0

[run]
duration = 5.0
integrator = { type = "dopri5", absolute_tolerance = 1e-12, relative_tolerance = 1e-12 }
ledger = true

[output]
every = 0.5
trajectory = true
trajectory_format = "xyz"
)";

constexpr const char* kParts = R"(
[[body]]
type = "dumbbell"
centre = [0.0, 1.0]
length = 2.0
particle_mass = 1.0
velocity = [[-0.5, 0.0], [0.5, 0.0]]

[[force]]
type = "harmonic_bonds"
pairs = "all"
stiffness = 0.5
rest_lengths = 2.0

[[observer]]
name = "bond"
type = "particle_distance"

[run]
duration = 2.0
integrator = { type = "symplectic_euler", dt = 1e-3 }

[measure]
from = 1.0

[output]
every = 0.5
)";

constexpr const char* kSwings = R"(
[[observer]]
name = "swings"
type = "particle_swings"
middle = 2.0
)";

constexpr const char* kFaulty = R"(
[[body]]
type = "point"
position = [1.0]
particle_mass = 1.0

[[force]]
name = "spring"
type = "faulty"
strength = 1.0

[run]
duration = 10.0
integrator = { type = "rk4", dt = 1e-2 }

[output]
every = 1.0
)";

/// Its forces and, from a start at rest, its velocities are below the smallest normal number.
constexpr const char* kSubnormal = R"(
[[body]]
type = "point"
position = [1e-160]
particle_mass = 1.0

[[force]]
type = "expression"
energy = "1e-150*x^2"

[run]
duration = 1.0
integrator = { type = "rk4", dt = 1e-2 }

[output]
every = 0.1
)";

std::string named(const std::string& library, const char* scene) {
  return "plugins = [\"" + library + "\"]\n" + scene;
}

class PluginCli : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    for (const char* name : {"morse", "parts", "faulty"}) {
      write(folder_ / ("lib" + std::string(name) + ".so"), content(plugin(name)));
    }
    write(folder_ / "bonded.toml", named("libmorse.so", kBonded));
    write(folder_ / "parts.toml", named("libparts.so", kParts));
    write(folder_ / "swings.toml", named("libparts.so", kParts) + kSwings);
    write(folder_ / "faulty.toml", named("libfaulty.so", kFaulty));
  }
  std::string path(const std::string& name) { return (folder_ / name).string(); }
  static Conditions with(std::vector<std::string> environment) {
    Conditions conditions;
    conditions.environment = std::move(environment);
    return conditions;
  }
};

// ---- what works

/// The bond's energy at its ends is known: so is the speed in the middle of its swing.
TEST_F(PluginCli, RunsAForceOfItsOwn) {
  ASSERT_EQ(tomlin({"run", "bonded.toml"}).status, 0);
  const Json result = summary("bonded.out");
  const double away = 1.0 - std::exp(-1.5 * 0.3);
  const double energy =
      result["energy"]["kinetic"].get<double>() + result["energy"]["potential"].get<double>();
  constexpr double kTolerance = 1e-9;  // 1e-12 a step, some dozens of steps
  EXPECT_NEAR(energy, 2.0 * away * away, kTolerance);
  EXPECT_GT(result["energy"]["kinetic"].get<double>(), 1e-3) << "it moves";
  ASSERT_EQ(result["plugins"].size(), 1U);
  EXPECT_EQ(result["plugins"][0]["given"], "libmorse.so");
  EXPECT_EQ(result["plugins"][0]["path"], path("libmorse.so"));
  EXPECT_EQ(result["plugins"][0]["xxh3_128"], examine_plugin(folder_ / "libmorse.so").hash);
}

TEST_F(PluginCli, TheEffectiveSceneRunsAnywhere) {
  ASSERT_EQ(tomlin({"run", "bonded.toml", "-o", "one"}).status, 0);
  write(folder_ / "by_option.toml", kBonded);
  ASSERT_EQ(tomlin({"run", "by_option.toml", "--plugin", "libmorse.so", "-o", "two"}).status, 0);
  ASSERT_EQ(tomlin({"run", "one/scene.toml", "-o", "three"}).status, 0);
  EXPECT_EQ(file("one/scene.toml"), file("two/scene.toml"));
  EXPECT_EQ(file("one/scene.toml"), file("three/scene.toml"));
  EXPECT_TRUE(contains(file("one/scene.toml"), "plugins = [\"" + path("libmorse.so") + "\"]\n"));
  for (const char* other : {"two", "three"}) {
    EXPECT_EQ(file("one/observables.csv"), file(std::string(other) + "/observables.csv"));
    EXPECT_EQ(file("one/trajectory.xyz"), file(std::string(other) + "/trajectory.xyz"));
  }
}

TEST_F(PluginCli, PathsAreFromTheSceneOrTheCurrentFolder) {
  fs::create_directory(folder_ / "deep");
  fs::create_directory(folder_ / "deep/libs");
  write(folder_ / "deep/libs/libmorse.so", content(plugin("morse")));
  write(folder_ / "deep/here.toml", named("libs/libmorse.so", kBonded));
  EXPECT_EQ(tomlin({"check", "deep/here.toml"}).status, 0);
  write(folder_ / "deep/plain.toml", kBonded);
  EXPECT_EQ(tomlin({"check", "deep/plain.toml", "--plugin", "deep/libs/libmorse.so"}).status, 0);
  write(folder_ / "deep/libbeside.so", content(plugin("morse")));
  // The file beside the scene is not the one that was named.
  EXPECT_EQ(tomlin({"check", "deep/plain.toml", "--plugin", "libbeside.so"}).status, 2);
  EXPECT_EQ(tomlin({"check", "deep/plain.toml", "--plugin", "deep/libbeside.so"}).status, 0);
  // The loader's own search path is none of them.
  expect_status(2, tomlin({"check", "deep/plain.toml", "--plugin", "libelsewhere.so"},
                          with({std::string("LD_LIBRARY_PATH=") + paths::plugins})));
}

TEST_F(PluginCli, EveryCommandTakesThem) {
  write(folder_ / "plain.toml", kBonded);
  EXPECT_EQ(tomlin({"explain", "bonded.toml"}).status, 0);
  const Ended checked = expect_status(0, tomlin({"check", "bonded.toml", "--verbose"}));
  EXPECT_TRUE(contains(checked.out, "morse conservative")) << checked.out;
  expect_status(0, tomlin({"compare", "parts.toml", "parts.toml", "--observable", "bond.length"}));
  expect_status(
      0, tomlin({"tradeoff", "bonded.toml", "--observable", "chain.max_speed", "--budget", "1"}));
  EXPECT_EQ(tomlin({"describe", "--plugin", "libmorse.so"}).status, 0);
  const Ended described = tomlin({"describe", "--plugin", "libmorse.so", "morse"});
  EXPECT_TRUE(contains(described.out, "comes from\n  the plugin " + path("libmorse.so")))
      << described.out << described.err;
  EXPECT_TRUE(contains(tomlin({"describe", "rk4"}).out, "comes from\n  tomlin itself"));
  const Ended listed = tomlin({"describe", "--plugin", "libparts.so"});
  expect_parts(listed.out, {"observers\n  particle_distance", "(" + path("libparts.so") + ")"});
}

TEST_F(PluginCli, InQuadruplePrecision) {
  ASSERT_EQ(tomlin({"run", "bonded.toml", "-o", "double"}).status, 0);
  const double exact = summary("double")["energy"]["kinetic"];
  const std::string setting = "run.number_type=\"quadruple\"";
  expect_status(0, tomlin({"run", "bonded.toml", "--set", setting, "--set",
                           "run.integrator={ type = \"rk4\", dt = 1e-3 }", "-o", "quadruple"}));
  constexpr double kToTheScheme = 1e-9;
  EXPECT_NEAR(summary("quadruple")["energy"]["kinetic"].get<double>(), exact, kToTheScheme);
  expect_refused(
      {"run", "faulty.toml", "--set", setting},
      "--set " + setting + ": run.number_type = \"quadruple\" [number_type.unsuitable]\n",
      {"\"spring\"", "faulty"});
}

// ---- bodies, integrators, observers

/// x'' = -k x 2/m about the rest length, by an oscillator of frequency 1.
TEST_F(PluginCli, BodiesIntegratorsAndObservers) {
  expect_status(0, tomlin({"run", "parts.toml"}));
  const std::string table = file("parts.out/observables.csv");
  EXPECT_TRUE(
      contains(table, ",bond.length [length],bond.growth [length/time],bond.speed [length/time]\n"))
      << table;
  const Json bond = summary("parts.out")["observers"]["bond"];
  constexpr double kTolerance = 2e-3;  // first order, dt = 1e-3
  EXPECT_NEAR(bond["length"].get<double>(), 2.0 + std::sin(2.0), kTolerance);
  EXPECT_NEAR(bond["growth"].get<double>(), std::cos(2.0), kTolerance);
  const double mean = (std::sin(1.0) + std::sin(1.5) + std::sin(2.0)) / 3.0;
  EXPECT_NEAR(bond["mean_length"].get<double>(), 2.0 + mean, kTolerance);
  EXPECT_TRUE(tomlin({"run", "parts.toml", "-o", "perturbed", "--set",
                      "run.perturb={ size = 1e-9, observables = [\"bond.length\"] }"})
                  .status == 0);
  EXPECT_TRUE(summary("perturbed")["determined"].contains("bond.length"));
}

/// The bond is 2 + sin t long.
TEST_F(PluginCli, ObserversGatherAlongTheRun) {
  const std::vector<std::string> schemes = {
      "{ type = \"rk4\", dt = 1e-2 }",
      "{ type = \"dopri5\", absolute_tolerance = 1e-10, relative_tolerance = 1e-10 }"};
  for (const std::string& scheme : schemes) {
    expect_status(0, tomlin({"run", "swings.toml", "-o", "out", "--force", "--set",
                             "run.integrator=" + scheme, "--set", "run.duration=20", "--set",
                             "measure.to=15.003"}));
    const Json swings = summary("out")["observers"]["swings"];
    // The error is of order 4 in steps of 0.01, for a function of size 1 over tens of radians.
    constexpr double kTolerance = 1e-8;
    const auto whole = [](double t) { return 0.5 * t - 0.25 * std::sin(2.0 * t); };
    EXPECT_NEAR(swings["mean_square"].get<double>(), (whole(15.003) - whole(1.0)) / 14.003,
                kTolerance);
    // Upwards through the middle at 2 pi, 4 pi and 6 pi.
    EXPECT_EQ(swings["passages"].get<double>(), 3.0);
    EXPECT_EQ(swings["looks"].get<double>(), summary("out")["time"]["steps"].get<double>() + 1.0);
    EXPECT_FALSE(swings.contains("square"));
    const std::string events = file("out/events.csv");
    EXPECT_TRUE(contains(events, ",passage,swings,,1,,\n")) << events;
    const auto first = events.find("\n") + 1;
    // Between two steps it is taken for straight: the chord of a tenth.
    EXPECT_NEAR(std::stod(events.substr(first)), 2.0 * 3.141592653589793, 1e-2);
  }
  const Ended failed = expect_status(1, tomlin({"run", "swings.toml"}, with({"FAULT=integrand"})));
  expect_error(failed, "swings.toml: [plugin.error]\n", {"observer swings"});
  const Ended infinite = expect_status(
      1, tomlin({"run", "swings.toml", "-o", "inf"}, with({"FAULT=infinite_integrand"})));
  expect_error(infinite, "swings.toml: [observable.undefined]\n", {"observer swings", " square,"});
  EXPECT_TRUE(summary("inf")["observers"].at("swings").at("mean_square").is_null());
  const Ended clash =
      expect_status(2, tomlin({"run", "swings.toml", "-o", "none"}, with({"FAULT=clash"})));
  expect_error(clash, "swings.toml:30:1: observer.swings [plugin.error]\n", {"\"mean_away\""});
}

/// Particles of a rigid body have velocities, too: it turns as a whole, so its length stays.
TEST_F(PluginCli, ObserversSeeRigidBodies) {
  const std::vector<std::string> rigid = {
      "run",   "parts.toml",
      "--set", "body.dumbbell.coordinates=\"rigid\"",
      "--set", "body.dumbbell.velocity=[[0.0, -1.0], [0.0, 1.0]]",
      "--set", "observer.bond.second=0",
      "--set", "run.integrator={ type = \"rk4\", dt = 1e-2 }",
      "-o",    "rigid"};
  auto far = rigid;
  far[7] = "observer.bond.second=1";
  expect_status(0, tomlin(far));
  const Json bond = summary("rigid")["observers"]["bond"];
  constexpr double kRounding = 1e-12;
  EXPECT_NEAR(bond["length"].get<double>(), 2.0, kRounding);
  EXPECT_NEAR(bond["growth"].get<double>(), 0.0, kRounding);
  EXPECT_NEAR(bond["speed"].get<double>(), 2.0, kRounding);
  auto same = rigid;
  same.back() = "undefined";
  const Ended undefined = tomlin(same);  // a particle and itself: 0/0
  EXPECT_EQ(undefined.status, 1);
  expect_error(undefined, "parts.toml: [observable.undefined]\n", {"observer bond", " growth,"});
  EXPECT_TRUE(summary("undefined")["observers"].at("bond").at("growth").is_null());
}

TEST_F(PluginCli, FaultsOfObserversHaveAPlace) {
  expect_refused({"run", "parts.toml", "--set", "observer.bond.second=7"},
                 "--set observer.bond.second=7: observer.bond.second = 7 [component.invalid]\n");
  write(folder_ / "parts.toml",
        patched(named("libparts.so", kParts), "particle_distance\"", "particle_distanc\" "));
  expect_error(tomlin({"run", "parts.toml"}),
               "parts.toml:18:8: observer.bond.type = \"particle_distanc\" "
               "[scene.unknown_component] did you mean particle_distance\n");
}

// ---- what is refused

TEST_F(PluginCli, AFaultHasThePlaceThatNamesTheLibrary) {
  write(folder_ / "scene.toml", named("libabsent.so", kBonded));
  expect_refused({"run", "scene.toml"},
                 "scene.toml:1:12: plugins = \"libabsent.so\" [plugin.cannot_load]\n",
                 {path("libabsent.so")});
  expect_refused({"run", "bonded.toml", "--plugin", "./tip.toml"},
                 "--plugin: plugins = \"./tip.toml\" [plugin.cannot_load]\n", {path("tip.toml")});
  write(folder_ / "scene.toml", std::string("plugins = \"libmorse.so\"\n") + kBonded);
  expect_error(tomlin({"run", "scene.toml"}),
               "scene.toml:1:11: plugins = \"libmorse.so\" [scene.wrong_type]\n");
  write(folder_ / "scene.toml", std::string("[scene]\nplugins = [\"libmorse.so\"]\n") + kBonded);
  expect_error(tomlin({"run", "scene.toml"}), "scene.toml:2:1: scene.plugins [scene.unknown_key]",
               {"above the first [table]"});
}

TEST_F(PluginCli, WhatFailsAtRegisteringIsThePlugins) {
  for (const char* fault : {"crash", "throw_registering", "exit"}) {
    const Ended ended = tomlin({"run", "faulty.toml"}, with({std::string("FAULT=") + fault}));
    EXPECT_EQ(ended.status, 2) << fault;
    expect_error(ended, "faulty.toml:1:12: plugins = \"libfaulty.so\" [plugin.cannot_load]\n",
                 {path("libfaulty.so")});
    EXPECT_FALSE(exists("faulty.out"));
  }
}

TEST_F(PluginCli, WhatFailsAtReadingIsThePlugins) {
  const Ended ended =
      expect_status(2, tomlin({"run", "faulty.toml"}, with({"FAULT=throw_looking"})));
  expect_error(ended, "faulty.toml:10:8: force.spring.type = \"faulty\" [plugin.error]\n",
               {path("libfaulty.so"), "not looked at, as planned"});
  EXPECT_FALSE(exists("faulty.out/summary.json"));
}

TEST_F(PluginCli, WhatIsBoundOrMadeWrongIsRefused) {
  const auto refused = [this](const std::string& scene, const std::string& fault,
                              const std::string& error, const std::string& part) {
    const Ended ended = tomlin({"run", scene + ".toml"}, with({"FAULT=" + fault}));
    EXPECT_EQ(ended.status, 2) << fault;
    expect_error(ended, scene + ".toml:" + error + "\n", {path("lib" + scene + ".so"), part});
    EXPECT_FALSE(exists(scene + ".out/summary.json"));
  };
  const std::string spring = "8:1: force.spring [plugin.error]";
  refused("faulty", "throw_binding", spring, "not bound, as planned");
  refused("faulty", "nothing_bound", spring, "null pointer");
  refused("parts", "nothing_bound", "22:14: integrator.symplectic_euler [plugin.error]",
          "null pointer");
  refused("parts", "three", "3:1: body.dumbbell [plugin.error]", " 2 particles in 2 dimensions");
  refused("parts", "neighbours", "4:8: body.dumbbell.type = \"dumbbell\" [plugin.error]",
          "list of neighbours: pair [0, 2]");
  refused("faulty", "nothing_made", "1:12: plugins = \"libfaulty.so\" [plugin.cannot_load]",
          "description of \"faulty\"");
}

/// Before a run what a record throws is nobody's for certain; the plugins that are there are named.
TEST_F(PluginCli, WhatRecordsThrowNamesThePlugin) {
  for (const std::string fault : {"throw_period", "throw_traits"}) {
    const Ended ended = tomlin({"run", "faulty.toml"}, with({"FAULT=" + fault}));
    EXPECT_TRUE(ended.status == 1 || ended.status == 2) << ended.status;
    expect_error(ended, " [plugin.error]\n", {path("libfaulty.so"), "as planned"});
  }
  const Ended ended =
      expect_status(1, tomlin({"explain", "faulty.toml"}, with({"FAULT=throw_element"})));
  EXPECT_EQ(lines(ended.err), 1);
  expect_error(ended, "tomlin: [plugin.error]\n", {"no element, as planned", path("libfaulty.so")});
}

/// In whatever function of its integrator.
TEST_F(PluginCli, WhatFailsInAnIntegratorIsThePlugins) {
  for (const std::string fault :
       {"stable_step", "first_rates", "finish_dense_from", "interpolate", "refused_steps"}) {
    const Ended ended = tomlin({"run", "parts.toml", "--set", "output.every=0.3333", "-o", fault},
                               with({"FAULT=" + fault}));
    EXPECT_EQ(ended.status, 1) << fault;
    expect_error(
        ended, "parts.toml: [plugin.error]\n",
        {path("libparts.so"), "integrator symplectic_euler: no " + fault + ", as planned; "});
    ASSERT_TRUE(exists(fault + "/summary.json")) << fault;
    EXPECT_EQ(summary(fault)["status"], "failed");
    EXPECT_FALSE(exists(fault + "/run.checkpoint"));
  }
}

/// Whatever a library does to it when it is loaded: fast mathematics flushes small numbers to zero.
TEST_F(PluginCli, TheArithmeticIsTheProgramsOwn) {
  write(folder_ / "small.toml", kSubnormal);
  for (const std::string scene : {"small.toml", "tip.toml"}) {
    ASSERT_EQ(tomlin({"run", scene, "-o", "own" + scene}).status, 0);
    const std::string own = file("own" + scene + "/observables.csv");
    for (const std::string fault : {"flush", "round"}) {
      const std::string out = fault + scene;
      expect_status(0, tomlin({"run", scene, "--plugin", "libfaulty.so", "-o", out},
                              with({"FAULT=" + fault})));
      EXPECT_EQ(file(out + "/observables.csv"), own) << out;
      EXPECT_EQ(summary(out).at("bodies"), summary("own" + scene).at("bodies")) << out;
    }
  }
  const Json moving = summary("ownsmall.toml")["bodies"]["point"]["velocity"][0];
  EXPECT_NE(moving.get<double>(), 0.0);
  EXPECT_FALSE(std::isnormal(moving.get<double>()));
}

/// Wherever in a run it happens, there is a summary, and it says failed.
TEST_F(PluginCli, WhatFailsInARunIsThePlugins) {
  ASSERT_EQ(tomlin({"run", "faulty.toml", "-o", "sound"}).status, 0);
  const int all = summary("sound")["time"]["force_evaluations"];
  for (const std::string after : {"0", "3", "700", "2002"}) {
    ASSERT_LT(std::stoi(after), all);
    const Ended ended =
        tomlin({"run", "faulty.toml", "-o", "after" + after}, with({"FAULT_AFTER=" + after}));
    EXPECT_EQ(ended.status, 1) << after;
    expect_error(ended, "faulty.toml: [plugin.error]\n",
                 {path("libfaulty.so"), "force spring: no force, as planned; force: spring"});
    const Json result = summary("after" + after);
    EXPECT_EQ(result["status"], "failed");
    EXPECT_TRUE(contains(result["failure"]["what"].get<std::string>(), path("libfaulty.so")));
    EXPECT_LT(result["time"]["end"].get<double>(), 10.0);
    EXPECT_FALSE(exists("after" + after + "/run.checkpoint"));
  }
  const Ended odd = expect_status(1, tomlin({"run", "faulty.toml", "-o", "odd"},
                                            with({"FAULT_AFTER=50", "FAULT=throw_number"})));
  expect_error(odd, "faulty.toml: [plugin.error]\n", {path("libfaulty.so"), "no std::exception"});
  for (const std::string fault : {"crash", "abort", "assert", "overflow"}) {
    const Ended died = tomlin({"run", "faulty.toml", "-o", fault},
                              with({"FAULT_AFTER=50", "FAULT=" + fault + "_later"}));
    EXPECT_GT(died.status, 128) << fault;
    expect_error(died, "tomlin: [plugin.error]\n", {"a crash", path("libfaulty.so")});
  }
  const Ended checked = expect_status(1, tomlin({"check", "faulty.toml"}, with({"FAULT_AFTER=0"})));
  expect_error(checked, " [plugin.error]\n", {path("libfaulty.so")});
}

/// Status 0 is the program's to give.
TEST_F(PluginCli, AForceThatCallsExitIsNoSuccess) {
  const Ended ended = expect_status(
      1, tomlin({"run", "faulty.toml"}, with({"FAULT_AFTER=50", "FAULT=exit_later"})));
  EXPECT_EQ(lines(ended.err), 1);
  expect_error(ended, "tomlin: [plugin.error]\n", {"exit()", path("libfaulty.so")});
  EXPECT_FALSE(exists("faulty.out/summary.json"));
  expect_status(0, tomlin({"run", "faulty.toml", "--resume"}));
}

/// Kernels that are called after it would round otherwise: the run fails before they are believed.
TEST_F(PluginCli, AForceThatChangesTheRoundingFails) {
  for (const std::string scheme : {"rk4", "velocity_verlet"}) {
    const Ended ended =
        tomlin({"run", "faulty.toml", "-o", scheme, "--set", "run.integrator.type=" + scheme},
               with({"FAULT_AFTER=50", "FAULT=round_later"}));
    EXPECT_EQ(ended.status, 1) << scheme;
    expect_error(ended, "faulty.toml: [plugin.error]\n",
                 {path("libfaulty.so"), "force spring: it has changed the mode"});
    EXPECT_EQ(summary(scheme)["status"], "failed");
  }
}

// ---- going on

class PluginResume : public PluginCli {
 protected:
  /// Interrupts a long run after its first checkpoint.
  void interrupt(const std::vector<std::string>& arguments, const std::string& out) {
    ASSERT_EQ(tomlin(arguments, {.then =
                                     [&](pid_t program) {
                                       ASSERT_TRUE(appears(folder_ / (out + "/run.checkpoint")));
                                       std::this_thread::sleep_for(std::chrono::milliseconds(50));
                                       ::kill(program, SIGINT);
                                     }})
                  .status,
              130);
  }
  std::vector<std::string> long_run() {
    return {"run", "parts.toml", "--set", "run.duration=2000", "-o", "out"};
  }
};

TEST_F(PluginResume, WhatObserversHaveGatheredGoesOn) {
  const auto run = [](const std::string& out) {
    return std::vector<std::string>{"run", "swings.toml", "--set", "run.duration=200", "-o", out};
  };
  ASSERT_EQ(tomlin(run("whole")).status, 0);
  interrupt(run("out"), "out");
  ASSERT_EQ(tomlin(plus(run("out"), {"--resume"})).status, 0);
  for (const std::string name : {"/events.csv", "/observables.csv"}) {
    EXPECT_EQ(file("out" + name), file("whole" + name)) << name;
  }
  EXPECT_EQ(comparable_summary("out"), comparable_summary("whole"));
  EXPECT_GT(summary("out")["observers"]["swings"]["passages"].get<double>(), 30.0);
}

TEST_F(PluginResume, AnotherOrAMissingLibraryIsRefused) {
  interrupt(long_run(), "out");
  std::vector<std::string> on = plus(long_run(), {"--resume"});
  const std::string before = examine_plugin(folder_ / "libparts.so").hash;
  const std::string whole = file("libparts.so");
  write(folder_ / "libparts.so", whole + "\n");  // as good a library, with another content
  const std::string now = examine_plugin(folder_ / "libparts.so").hash;
  ASSERT_NE(before, now);
  const std::string refused = "--resume: out/run.checkpoint [resume.other_version]\n";
  expect_refused(on, refused, {path("libparts.so"), before, now});
  fs::remove(folder_ / "libparts.so");
  expect_refused(on, refused, {path("libparts.so"), before});
  write(folder_ / "libparts.so", whole);
  expect_refused(plus(on, {"--plugin", "libmorse.so"}), refused,
                 {examine_plugin(folder_ / "libmorse.so").hash});
  expect_status(
      0, tomlin({"run", "out/scene.toml", "-o", "out", "--resume", "--set", "run.duration=2000"}));
}

/// A checkpoint names a library by its content, wherever that lies.
TEST_F(PluginResume, GoesOnInAnotherFolder) {
  fs::create_directory(folder_ / "here");
  for (const char* name : {"libparts.so", "parts.toml"}) {
    fs::copy(folder_ / name, folder_ / "here" / name);
  }
  const auto run = [](const std::string& folder) {
    return std::vector<std::string>{"run", folder + "/parts.toml", "--set", "run.duration=2000",
                                    "-o",  folder + "/out"};
  };
  auto whole = run("here");
  whole.back() = "whole";
  ASSERT_EQ(tomlin(whole).status, 0);
  interrupt(run("here"), "here/out");
  fs::rename(folder_ / "here", folder_ / "there");
  expect_status(0, tomlin(plus(run("there"), {"--resume"})));
  EXPECT_EQ(file("there/out/observables.csv"), file("whole/observables.csv"));
  fs::rename(folder_ / "there", folder_ / "back");
  std::vector<std::string> again = plus(run("back"), {"--resume"});
  EXPECT_TRUE(contains(tomlin(again).out, "finished already"));
  // The scene is compared all the same.
  again.insert(again.end(), {"--set", "observer.bond.second=0"});
  expect_refused(again, "--resume: back/out/scene.toml [resume.other_scene]\n");
}

/// A run that is over, finished or failed, is not continued: it was made with another library.
TEST_F(PluginResume, OfARunThatIsOverAnotherLibraryIsRefused) {
  ASSERT_EQ(tomlin({"run", "parts.toml", "-o", "finished"}).status, 0);
  ASSERT_EQ(tomlin({"run", "parts.toml", "-o", "failed"}, with({"FAULT=first_rates"})).status, 1);
  const std::string before = examine_plugin(folder_ / "libparts.so").hash;
  write(folder_ / "libparts.so", file("libparts.so") + "\n");
  const std::string now = examine_plugin(folder_ / "libparts.so").hash;
  for (const std::string folder : {"finished", "failed"}) {
    expect_refused({"run", "parts.toml", "-o", folder, "--resume"},
                   "--resume: " + folder + "/summary.json [resume.other_version]\n",
                   {path("libparts.so"), before, now});
    EXPECT_EQ(tomlin({"run", "parts.toml", "-o", folder, "--force"}).status, 0);
  }
}

// ---- a new one

TEST_F(PluginCli, NewPluginWritesAFolder) {
  struct Made {
    std::string name;
    std::vector<std::string> option;
    std::string part;  // of the source
  };
  for (const Made& made : {Made{"my_force", {}, "TOMLIN_DECLARE_KERNELS(MyForce)"},
                           Made{"my_pairs", {"--pairs"}, "pair_potential<MyPairs"}}) {
    expect_status(0, tomlin(plus({"new", "plugin", made.name}, made.option)));
    for (const std::string& name :
         {made.name + ".hpp", made.name + ".cpp", made.name + ".toml",
          std::string("CMakeLists.txt"), "test_" + made.name + ".py", std::string("README.md")}) {
      const std::string text = file(made.name + "/" + name);
      EXPECT_FALSE(text.empty()) << name;
      EXPECT_FALSE(contains(text, "plugin_name") || contains(text, "PluginName")) << name;
    }
    EXPECT_TRUE(contains(file(made.name + "/" + made.name + ".cpp"), made.part));
  }
  EXPECT_EQ(tomlin({"new", "pt", "--pairs"}).status, 2);
  expect_refused({"new", "plugin", "my_force"}, "-o: my_force [file.exists]\n");
  EXPECT_EQ(tomlin({"new", "plugin", "my_force", "--force"}).status, 0);
  EXPECT_EQ(tomlin({"new", "plugin", "other", "-o", "some/where"}).status, 0);
  EXPECT_TRUE(exists("some/where/other.hpp"));
  for (const char* name : {"My_Force", "2d", "a-b", "harmonic_bonds", "a__b", "x_", "../up"}) {
    EXPECT_EQ(tomlin({"new", "plugin", name}).status, 2) << name;
  }
  EXPECT_EQ(tomlin({"new", "plugin"}).status, 2);
  const std::string taken = "tomlin: NAME [command.invalid_value]\n";
  for (const auto& [name, type] : {std::pair<std::string, std::string>{"site", "Site"},
                                   {"pair_list", "PairList"},
                                   {"body", "BodyDescription"}}) {
    expect_refused({"new", "plugin", name}, taken, {" " + type + ",", "my_" + name});
  }
  // Types of formulas are not in what a plugin includes: their names are free.
  for (const char* name : {"numbers", "pair_block", "formula_law"}) {
    EXPECT_EQ(tomlin({"new", "plugin", name}).status, 0) << name;
  }
  for (const std::string name : {"test", "all", "install", "clean", "help", "package"}) {
    expect_refused({"new", "plugin", name}, taken, {"CMake", name + "_force"});
  }
}

}  // namespace
}  // namespace tomlin::test
