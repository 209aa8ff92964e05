#include "framework/output/summary.hpp"

#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "framework/run/results/observables.hpp"
#include "framework/scene/language.hpp"
#include "tests/support/results.hpp"

namespace tomlin::test {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Scene planar_scene() {
  Scene scene;
  scene.dimension = 2;
  scene.parameters = {{"xi", 2.0 * std::sqrt(2.0)}, {"N", 8.0}};
  return scene;
}

RunResult planar_result() {
  RunResult result;
  result.end_time = 1e4;
  result.steps = 123456789012345ULL;
  result.force_evaluations = 7;
  result.refused_steps = 2;
  result.window_from = 0.1;
  result.window_to = 1.0 / 3.0;
  result.groups = {group_of("drivers", "driver", 2,
                            {{"mean_force", {4.628633704e-3, -1e-17}},
                             {"final_force", {1.0, 2.0}},
                             {"max_force", {3.0, 4.0}},
                             {"min_force", {-3.0, -4.0}},
                             {"peak_to_peak_force", {6.0, 8.0}},
                             {"static_force", {0.25}},
                             {"work", {5.0}},
                             {"work_per_distance", {0.5}},
                             {"distance", {10.0}}}),
                   group_of("bodies", "ring", 2,
                            {{"centre_of_mass", {9.0, 1.0}},
                             {"velocity", {0.0, -0.0}},
                             {"rotation", {-0.785}},
                             {"turns", {-1.125}},
                             {"rolling", {0.7853981633974483}},
                             {"mean_velocity", {1e-3, 0.0}},
                             {"max_speed", {0.1}},
                             {"temperature", {0.3}}}),
                   group_of("events", "", 2,
                            {{"slips", {12.0}},
                             {"hops", {0.0}},
                             {"turns", {0.0}},
                             {"reversals", {3.0}},
                             {"driver_reversals", {0.0}},
                             {"ties", {0.0}}})};
  for (ResultValue& other : result.groups.front().values) {
    if (!other) other.set(std::vector<double>(other.count(), 7.0));
  }
  result.warnings = {{FaultCode::run_few_slips, "a warning with \"quotes\"", "drivers.driver"}};
  result.left_out = {{"springs", "inside a rigid body"}};
  result.wall_seconds = 0.5;
  result.steps_per_second = 1e6;
  return result;
}

std::vector<std::string> keys(const Json& object) {
  std::vector<std::string> names;
  for (const auto& [key, value] : object.items()) names.push_back(key);
  return names;
}

std::string names_in(const Json& object) { return fmt::format("{}", fmt::join(keys(object), " ")); }

TEST(Summary, HasEveryKeyOfAFinishedRun) {
  const Json summary = Json::parse(summary_json(planar_scene(), planar_result()));
  EXPECT_EQ(names_in(summary),
            "status program scene integrator parameters time window drivers bodies events warnings "
            "warning_codes left_out references performance");
  EXPECT_EQ(summary["status"], "finished");
  EXPECT_EQ(names_in(summary["parameters"]), "xi N");
  EXPECT_EQ(names_in(summary["time"]),
            "end steps force_evaluations jacobian_columns rejected_steps");
  EXPECT_EQ(summary["time"]["steps"], 123456789012345ULL);
  EXPECT_EQ(names_in(summary["window"]), "from to");
  EXPECT_EQ(
      names_in(summary["drivers"]["driver"]),
      "trace retrace half_difference loop_area loops mean_force mean_force_along mean_force_across "
      "final_force max_force min_force peak_to_peak_force static_force slips mean_slip_length "
      "slip_length_deviation min_slip_length max_slip_length mean_slip_force slip_force_deviation "
      "min_slip_force max_slip_force mean_slip_energy slip_energy_deviation min_slip_energy "
      "max_slip_energy mean_waiting_time waiting_time_deviation min_waiting_time max_waiting_time "
      "effective_stiffness work work_per_distance distance dissipated_per_period force_deviation");
  EXPECT_EQ(names_in(summary["bodies"]["ring"]),
            "centre_of_mass velocity rotation turns rolling mean_velocity max_speed temperature");
  EXPECT_EQ(names_in(summary["events"]), "slips hops turns reversals driver_reversals ties");
  EXPECT_EQ(summary["events"]["slips"], 12);
  EXPECT_EQ(summary["events"]["turns"], 0);
  EXPECT_EQ(summary["warnings"], Json({"a warning with \"quotes\""}));
  EXPECT_EQ(summary["warning_codes"], Json({"run.few_slips"}));
  EXPECT_EQ(summary["left_out"],
            Json::parse(R"([{"force": "springs", "why": "inside a rigid body"}])"));
  EXPECT_EQ(names_in(summary["performance"]),
            "wall_seconds steps_per_second threads scene_file instruction_set processor system");
  EXPECT_EQ(summary["performance"]["instruction_set"], "baseline");
}

TEST(Summary, SaysWhatMadeIt) {
  Scene scene = planar_scene();
  scene.name = "a ring";
  scene.file = "here/ring.toml";
  scene.effective_toml = "[scene]\n";
  const Json summary = Json::parse(summary_json(scene, planar_result()));
  EXPECT_EQ(summary["program"]["name"], "tomlin");
  EXPECT_EQ(summary["program"]["format"], 1);
  EXPECT_NE(summary["program"]["version"], "");
  EXPECT_EQ(summary["scene"]["name"], "a ring");
  EXPECT_EQ(summary["scene"]["xxh3_64"].get<std::string>().size(), 16U);
  EXPECT_EQ(summary["performance"]["scene_file"], "here/ring.toml");
  EXPECT_NE(summary["performance"]["system"], "");

  // Another scene, another hash; the same one elsewhere, the same.
  scene.file = "there/ring.toml";
  EXPECT_EQ(Json::parse(summary_json(scene, planar_result()))["scene"], summary["scene"]);
  scene.effective_toml += "name = \"\"\n";
  EXPECT_NE(Json::parse(summary_json(scene, planar_result()))["scene"], summary["scene"]);
}

/// A body that were called like a key of the summary could not be asked for by its name.
TEST(Summary, ItsKeysAreNoNamesOfBodies) {
  Scene scene = planar_scene();
  scene.libraries = {Library{}};
  RunResult result = planar_result();
  result.failure = RunFailure{};
  result.steady = SteadyResult{};
  result.groups.push_back({"observers", "own", {}});
  for (const char* family : {"equilibrium", "energy"}) {
    result.groups.push_back(group_of(family, "", 2, {}));
  }
  result.determined = {DeterminedResult{}};
  result.accuracy = AccuracyResult{};
  result.errors = {ErrorEstimate{}};
  const Json summary = Json::parse(summary_json(scene, result));
  EXPECT_GT(summary.size(), 20U);
  for (const std::string& key : keys(summary)) EXPECT_TRUE(is_word_of_summary(key)) << key;
}

TEST(Summary, SaysHowARunUntilSteadyCameOut) {
  RunResult result = planar_result();
  result.steady = SteadyResult{"driver.mean_force.x", true, 5, 1e-7};
  const Json until = Json::parse(summary_json(planar_scene(), result))["until"];
  EXPECT_EQ(names_in(until), "steady reached periods change");
  EXPECT_EQ(until["steady"], "driver.mean_force.x");
  EXPECT_EQ(until["reached"], true);
  EXPECT_EQ(until["periods"], 5);
  EXPECT_EQ(until["change"], 1e-7);
}

TEST(Summary, SaysHowARunUntilAnErrorCameOut) {
  RunResult result = planar_result();
  result.until_error = UntilErrorResult{"driver.mean_force.x", true, 0.01, 0.009};
  Json until = Json::parse(summary_json(planar_scene(), result))["until"];
  EXPECT_EQ(names_in(until), "of asked reached error");
  EXPECT_EQ(until["of"], "driver.mean_force.x");
  EXPECT_EQ(until["asked"], 0.01);
  EXPECT_EQ(until["reached"], true);
  EXPECT_EQ(until["error"], 0.009);
  result.until_error->error.reset();
  EXPECT_TRUE(Json::parse(summary_json(planar_scene(), result))["until"]["error"].is_null());
}

TEST(Summary, NumbersReadBackAsTheSameBits) {
  const Json summary = Json::parse(summary_json(planar_scene(), planar_result()));
  EXPECT_EQ(summary["parameters"]["xi"].get<double>(), 2.0 * std::sqrt(2.0));
  EXPECT_EQ(summary["window"]["from"].get<double>(), 0.1);
  EXPECT_EQ(summary["window"]["to"].get<double>(), 1.0 / 3.0);
  const Json& driver = summary["drivers"]["driver"];
  EXPECT_EQ(driver["mean_force"].get<std::vector<double>>(),
            (std::vector<double>{4.628633704e-3, -1e-17}));
  EXPECT_EQ(driver["static_force"].get<double>(), 0.25);
  const Json& body = summary["bodies"]["ring"];
  EXPECT_EQ(body["rolling"].get<double>(), 0.7853981633974483);
  EXPECT_TRUE(std::signbit(body["velocity"][1].get<double>()));
}

/// The numbers below `json`, by path.
void collect(const Json& json, const std::string& path, std::map<std::string, Json>& numbers) {
  constexpr const char* kAxes[] = {"x", "y", "z"};
  if (json.is_object()) {
    for (const auto& [key, value] : json.items()) collect(value, path + "." + key, numbers);
  } else if (json.is_array()) {
    for (std::size_t d = 0; d < json.size(); ++d) collect(json[d], path + "." + kAxes[d], numbers);
  } else if (!json.is_string()) {
    numbers[path] = json;
  }
}

/// Neither list forgets what the other one has.
TEST(Summary, HoldsTheObservables) {
  const RunResult result = planar_result();
  const Json summary = Json::parse(summary_json(planar_scene(), result));
  std::map<std::string, Json> numbers;
  for (const auto& [key, value] : summary.items()) {
    // Not results.
    if (key == "parameters" || key == "left_out" || key.starts_with("warning")) continue;
    if (key == "references" || key == "program" || key == "scene" || key == "integrator") continue;
    collect(value, key, numbers);
  }
  std::size_t found = 0;
  for (const Observable& one : observables(result)) {
    SCOPED_TRACE(one.path);
    ASSERT_TRUE(numbers.contains(one.path));
    ASSERT_TRUE(one.value.has_value());
    EXPECT_EQ(numbers[one.path].get<double>(), *one.value);
    ++found;
  }
  EXPECT_EQ(found, numbers.size());
}

TEST(Summary, NumbersAreAsShortAsTheyCanBe) {
  const std::string text = summary_json(planar_scene(), planar_result());
  EXPECT_NE(text.find("\"from\": 0.1,"), std::string::npos) << text;
  EXPECT_NE(text.find("0.004628633704"), std::string::npos) << text;
}

TEST(Summary, WhatIsUndefinedIsNull) {
  Scene scene = planar_scene();
  RunResult result;
  result.groups = {group_of("drivers", "driver", 2, {{"final_force", {std::nan(""), kInfinity}}}),
                   group_of("bodies", "ring", 2, {})};
  result.end_time = -kInfinity;
  const Json summary = Json::parse(summary_json(scene, result));
  const Json& driver = summary["drivers"]["driver"];
  EXPECT_TRUE(driver.at("mean_force").is_null());
  EXPECT_EQ(driver["final_force"], Json::parse("[null, null]"));
  for (const char* key : {"static_force", "work", "work_per_distance", "distance"}) {
    EXPECT_TRUE(driver.contains(key) && driver[key].is_null()) << key;
  }
  const Json& body = summary["bodies"]["ring"];
  for (const char* key : {"rotation", "turns", "rolling", "mean_velocity", "max_speed"}) {
    EXPECT_TRUE(body.contains(key) && body[key].is_null()) << key;
  }
  EXPECT_TRUE(summary["time"].at("end").is_null());
}

TEST(Summary, OnlyPlanarBodiesRotate) {
  Scene scene = planar_scene();
  scene.dimension = 1;
  RunResult result;
  result.groups = {group_of("bodies", "ring", 1, {})};
  const Json summary = Json::parse(summary_json(scene, result));
  EXPECT_EQ(names_in(summary["bodies"]["ring"]),
            "centre_of_mass velocity mean_velocity max_speed temperature");
}

TEST(Summary, EmptyListsAndTablesAreThere) {
  const Json summary = Json::parse(summary_json(Scene(), RunResult()));
  EXPECT_EQ(summary["parameters"], Json::object());
  EXPECT_EQ(summary["drivers"], Json::object());
  EXPECT_EQ(summary["bodies"], Json::object());
  EXPECT_EQ(summary["warnings"], Json::array());
  EXPECT_EQ(summary["warning_codes"], Json::array());
  EXPECT_EQ(summary["left_out"], Json::array());
}

TEST(Summary, AFailureHasItsPlace) {
  RunResult result = planar_result();
  result.status = RunStatus::failed;
  result.failure = {
      41, 0.5, "ring", 3, "y", "harmonic_bonds", "the speed runs away", "the step is too long"};
  Json summary = Json::parse(summary_json(planar_scene(), result));
  EXPECT_EQ(summary["status"], "failed");
  EXPECT_EQ(summary["failure"],
            Json::parse(R"({"code": "run.step.unstable", "step": 41, "time": 0.5, "body": "ring",
      "particle": 3, "axis": "y", "force": "harmonic_bonds", "what": "the speed runs away",
      "cause": "the step is too long"})"));

  result.failure->particle = -1;
  result.failure->axis = "";
  summary = Json::parse(summary_json(planar_scene(), result));
  EXPECT_TRUE(summary["failure"].at("particle").is_null());
  EXPECT_TRUE(summary["failure"].at("axis").is_null());
}

TEST(Summary, AnInterruptedRunSaysSo) {
  RunResult result = planar_result();
  result.status = RunStatus::interrupted;
  const Json summary = Json::parse(summary_json(planar_scene(), result));
  EXPECT_EQ(summary["status"], "interrupted");
  EXPECT_FALSE(summary.contains("failure"));
}

}  // namespace
}  // namespace tomlin::test
