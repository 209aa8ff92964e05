#include <string>

#include "tests/framework/cli/cli_fixture.hpp"

namespace tomlin::test {
namespace {

class Check : public Cli {
 protected:
  Json checked(std::vector<std::string> arguments, int status) {
    arguments.insert(arguments.begin(), "check");
    arguments.emplace_back("--json");
    const Ended ended = expect_status(status, tomlin(arguments));
    EXPECT_EQ(ended.err, "");
    return Json::parse(ended.out);
  }
};

/// Nothing to mend: nothing to read.
TEST_F(Check, ASoundSceneIsOneLine) {
  const Ended ended = expect_status(0, tomlin({"check", "tip.toml"}));
  EXPECT_EQ(ended.err, "");
  EXPECT_EQ(lines(ended.out), 1) << ended.out;
  EXPECT_EQ(ended.out.substr(0, 10), "tip.toml: ");
  EXPECT_TRUE(contains(ended.out, "checks hold")) << ended.out;
  for (const char* model : {"pt", "fk", "ring"}) {
    ASSERT_EQ(tomlin({"new", model}).status, 0);
    const Ended fresh = tomlin({"check", std::string(model) + ".toml"});
    EXPECT_EQ(lines(fresh.out), 1) << fresh.out;
  }
  EXPECT_TRUE(contains(tomlin({"check", "ring.toml"}).out, "harmonic_bonds"));
  EXPECT_EQ(tomlin({"check", "tip.toml", "--verbose", "--json"}).status, 2);
}

/// Forces are checked one by one, also where a run that needs noise needs it of another force.
TEST_F(Check, AThermalSceneMayAskForRepeatsOrAnError) {
  std::string warm = replaced(kTip, "\"viscous_damping\"", "\"langevin\"\ntemperature = 0.01");
  warm = replaced(warm, "\"rk4\"", "\"baoab\"");
  warm.erase(warm.find("[measure]"), warm.find("[output]") - warm.find("[measure]"));
  write(folder_ / "warm.toml", warm);
  for (const char* asked :
       {"run.repeats=4", "run.until={ error = 0.1, of = \"driver.mean_force.x\" }"}) {
    for (const char* command : {"check", "explain"}) {
      const Ended ended = tomlin({command, "warm.toml", "--set", asked});
      EXPECT_EQ(ended.status, 0) << command << ", " << asked << ": " << ended.out << ended.err;
    }
  }
}

TEST_F(Check, ASoundSceneHasALineForEachProperty) {
  const auto before = all_files();
  const Ended ended = expect_status(0, tomlin({"check", "tip.toml", "--verbose"}));
  EXPECT_EQ(ended.err, "");
  EXPECT_EQ(all_files(), before);
  expect_parts(ended.out, {"tip.toml: a valid scene\n", "rk4 stable ", "driver conservative ",
                           "viscous_damping dissipative ", "sinusoidal_substrate conservative ",
                           "sinusoidal_substrate periodic ", "checks hold"});
  EXPECT_FALSE(contains(ended.out, "FAILED"));

  const Json json = checked({"tip.toml"}, 0);
  EXPECT_EQ(json["valid"], true);
  EXPECT_EQ(json["sound"], true);
  EXPECT_EQ(json["warnings"].size(), 0U);
  ASSERT_GT(json["checks"].size(), 30U);
  for (const Json& check : json["checks"]) EXPECT_EQ(check["ok"], true) << check;
  const Json& spring = json["checks"][1];
  EXPECT_EQ(spring["subject"], "driver");
  EXPECT_EQ(spring["type"], "driving_spring");
  EXPECT_EQ(spring["check"], "conservative");
  EXPECT_LE(spring["error"], spring["allowed"]);
  EXPECT_EQ(spring["states"], 9);
}

/// Passed checks are shown beside failed ones on request only; allowed instability is warned of, as
/// in a run.
TEST_F(Check, AStepThatIsTooLongFails) {
  const std::vector<std::string> too_long = {"check", "tip.toml", "--set", "run.integrator.dt=5"};
  const auto with = [&](const std::vector<std::string>& more) {
    return tomlin(plus(too_long, more));
  };
  const Ended failed = expect_status(1, tomlin(too_long));
  expect_parts(failed.out, {"FAILED  dt = 5 is ", " checks FAILED"});
  EXPECT_FALSE(contains(failed.out, "ok  ")) << failed.out;
  EXPECT_LT(lines(failed.out), 8);
  EXPECT_GT(lines(with({"--verbose"}).out), 30);
  const Json json = Json::parse(expect_status(1, with({"--json"})).out);
  EXPECT_EQ(json["valid"], true);
  EXPECT_EQ(json["sound"], false);
  EXPECT_EQ(json["checks"][0]["ok"], false);
  const std::string text = expect_status(0, with({"--set", "run.allow_unstable=true"})).out;
  EXPECT_TRUE(contains(text, "\ntip.toml: warning: dt = 5 is ")) << text;
  EXPECT_TRUE(text.ends_with(" [integrator.beyond_stability]\n")) << text;
  const Json insisted =
      Json::parse(expect_status(0, with({"--set", "run.allow_unstable=true", "--json"})).out);
  EXPECT_EQ(insisted["sound"], true);
  EXPECT_EQ(insisted["warnings"].size(), 1U);
  EXPECT_EQ(insisted["warning_codes"], Json({"integrator.beyond_stability"}));
}

TEST_F(Check, WhatIsNotBuiltIsNamed) {
  ASSERT_EQ(tomlin({"new", "ring"}).status, 0);
  const Json json = checked({"ring.toml"}, 0);
  ASSERT_EQ(json["warnings"].size(), 1U);
  EXPECT_TRUE(contains(json["warnings"][0].get<std::string>(), "harmonic_bonds"));
  EXPECT_EQ(json["warning_codes"], Json({"scene.force_left_out"}));
}

TEST_F(Check, FaultsComeWithTheirPlaces) {
  const std::string scene = replaced(kTip, "particle_mass = 1.0", "particle_mass = 0.0");
  write(folder_ / "tip.toml", replaced(scene, "stiffness = 2.0", "stifness = 2.0"));
  const Ended ended = expect_status(2, tomlin({"check", "tip.toml"}));
  EXPECT_EQ(ended.out, "");
  EXPECT_EQ(ended.err, tomlin({"run", "tip.toml"}).err);

  const Json json = checked({"tip.toml"}, 2);
  EXPECT_EQ(json["valid"], false);
  EXPECT_EQ(static_cast<std::ptrdiff_t>(json["faults"].size()), lines(ended.err));
  const Json& mass = json["faults"][0];
  EXPECT_EQ(mass["file"], "tip.toml");
  EXPECT_EQ(mass["line"], 12);
  EXPECT_EQ(mass["key"], "body.tip.particle_mass");
  EXPECT_EQ(mass["value"], "0.0");
  EXPECT_EQ(mass["code"], "scene.out_of_range");
  EXPECT_EQ(mass["admissible"], "> 0");
  EXPECT_TRUE(mass.at("did_you_mean").is_null());
  bool meant = false;
  for (const Json& fault : json["faults"]) meant = meant || fault["did_you_mean"] == "stiffness";
  EXPECT_TRUE(meant) << json;
}

TEST_F(Check, WhatShowsOnlyWhenBoundIsAFaultToo) {
  const Json json = checked({"tip.toml", "--set", "measure.to=50"}, 2);
  EXPECT_EQ(json["valid"], false);
  EXPECT_EQ(json["faults"][0]["key"], "measure.to");
  EXPECT_EQ(json["faults"][0]["code"], "run.invalid_window");
  EXPECT_EQ(json["faults"][0]["file"], "--set measure.to=50");
  const Json missing = checked({"missing.toml"}, 2);
  EXPECT_EQ(missing["faults"][0]["file"], "missing.toml");
  EXPECT_EQ(missing["faults"][0]["code"], "file.cannot_read");
}

/// Text that is no UTF-8 must not break the JSON.
TEST_F(Check, ValuesMayHoldAnything) {
  write(folder_ / "bytes.toml", "[run]\nduration = \"\xff\xfe\"\n");
  EXPECT_EQ(checked({"bytes.toml"}, 2)["valid"], false);
}

}  // namespace
}  // namespace tomlin::test
