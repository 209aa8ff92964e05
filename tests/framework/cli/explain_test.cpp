#include <cmath>
#include <string>

#include "tests/framework/cli/cli_fixture.hpp"

namespace tomlin::test {
namespace {

const double kTau = 2.0 * std::acos(-1.0);
constexpr double kRounding = 1e-12;

class Explain : public Cli {
 protected:
  Json explained(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "explain");
    arguments.emplace_back("--json");
    const Ended ended = expect_status(0, tomlin(arguments));
    EXPECT_EQ(ended.err, "");
    return Json::parse(ended.out);
  }
};

TEST_F(Explain, ShowsWhatIsBuiltAndLeavesNothingBehind) {
  const auto before = all_files();
  const Ended ended = expect_status(0, tomlin({"explain", "tip.toml"}));
  EXPECT_EQ(ended.err, "");
  EXPECT_EQ(all_files(), before);
  EXPECT_EQ(ended.out.substr(0, 7), "a tip: ");
  expect_parts(
      ended.out,
      {"\nbuilt\n", "point: 1 particle, mass 1", "1 degree of freedom", "driving_spring on tip",
       "\navailable, but off\n", "energy ledger", "\nnatural angular frequencies",
       "underdamped: damping ratio 0.50",
       "s = 1.974 = substrate curvature 3.948 / driver stiffness 2; s > 1: stick-slip possible",
       "washboard", "of the stable step", "force evaluations", "about "});
  EXPECT_FALSE(contains(ended.out, "warnings"));
}

TEST_F(Explain, NumbersAreThoseOfTheScene) {
  const Json tip = explained({"tip.toml"});
  EXPECT_EQ(tip["bodies"][0]["type"], "point");
  EXPECT_EQ(tip["bodies"][0]["degrees_of_freedom"], 1);
  EXPECT_EQ(tip["forces"].size(), 3U);
  EXPECT_EQ(tip["left_out"].size(), 0U);
  const double curvature = 0.1 * kTau * kTau;
  EXPECT_NEAR(tip["scales"]["frequency"], std::sqrt(2.0 + curvature), kRounding);
  EXPECT_NEAR(tip["scales"]["damping_rate"], 2.0, kRounding);
  EXPECT_NEAR(tip["scales"]["damping_ratio"], 1.0 / std::sqrt(curvature), kRounding);
  EXPECT_EQ(tip["scales"]["regime"], "underdamped");
  EXPECT_NEAR(tip["sliding"][0]["stick_slip"], curvature / 2.0, kRounding);
  EXPECT_EQ(tip["sliding"][0]["stick_slip_is_upper_bound"], false);
  EXPECT_NEAR(tip["sliding"][0]["period_duration"], 100.0, 1e-9);
  EXPECT_EQ(tip["integrator"]["type"], "rk4");
  EXPECT_EQ(tip["integrator"]["stable"], true);
  EXPECT_EQ(tip["cost"]["steps"], 30000);
  EXPECT_EQ(tip["cost"]["force_evaluations"], 120000);
  EXPECT_EQ(tip["misfits"].size(), 0U);

  const Json stiff = explained({"tip.toml", "--set", "force.driver.stiffness=8"});
  EXPECT_NEAR(stiff["sliding"][0]["stick_slip"], curvature / 8.0, kRounding);
  EXPECT_TRUE(contains(tomlin({"explain", "tip.toml", "--set", "force.driver.stiffness=8"}).out,
                       "s < 1: smooth sliding"));
}

/// A run treats steps as explain reports.
TEST_F(Explain, AStepBeyondTheLimitIsShownAndNotRefused) {
  const double stable = explained({"tip.toml"})["integrator"]["stable_step"];
  const auto with_step = [](double dt) {
    return std::vector<std::string>{"tip.toml", "--set", "run.integrator.dt=" + std::to_string(dt)};
  };
  const Json beyond = explained(with_step(1.01 * stable));
  EXPECT_EQ(beyond["integrator"]["stable"], false);
  EXPECT_TRUE(beyond.at("cost").is_null());
  EXPECT_EQ(beyond["warnings"].size(), 1U);
  EXPECT_EQ(beyond["warning_codes"], Json({"run.step.unstable"})) << "that of the refusal";
  EXPECT_EQ(explained(plus(with_step(1.01 * stable),
                           {"--set", "run.allow_unstable=true"}))["warning_codes"][0],
            "integrator.beyond_stability");
  EXPECT_EQ(explained(with_step(0.99 * stable))["integrator"]["stable"], true);
  expect_status(1, tomlin({"run", "tip.toml", "--set",
                           "run.integrator.dt=" + std::to_string(1.01 * stable)}));
  const Ended text =
      expect_status(0, tomlin({"explain", "tip.toml", "--set", "run.integrator.dt=5"}));
  expect_parts(text.out, {"NOT STABLE", " [run.step.unstable]\n"});
}

TEST_F(Explain, AnAdaptiveSchemesCostIsEstimated) {
  const Json tip = explained(
      {"tip.toml", "--set", "run.integrator={ type = \"dopri5\" }", "--set", "run.duration=1e7"});
  EXPECT_EQ(tip["integrator"]["adaptive"], true);
  EXPECT_TRUE(tip["integrator"].at("dt").is_null());
  EXPECT_TRUE(tip["integrator"].at("stable_step").is_null());
  EXPECT_EQ(tip["cost"]["exact"], false);
  EXPECT_GT(tip["cost"]["tried_part"], 0.0);
  EXPECT_LT(tip["cost"]["tried_part"], 1.0);
  EXPECT_GT(tip["cost"]["force_evaluations"], tip["cost"]["steps"]);
}

TEST_F(Explain, SaysWhatIsLeftOutAndWhy) {
  ASSERT_EQ(tomlin({"new", "ring"}).status, 0);
  const Json ring = explained({"ring.toml"});
  ASSERT_EQ(ring["left_out"].size(), 1U);
  EXPECT_EQ(ring["left_out"][0]["force"], "harmonic_bonds");
  EXPECT_EQ(ring["bodies"][0]["coordinate_count"], 3);
  EXPECT_EQ(ring["sliding"][0]["stick_slip_is_upper_bound"], true);
  EXPECT_NEAR(ring["sliding"][0]["circumference_in_periods"], kTau, kRounding);
  EXPECT_TRUE(contains(tomlin({"explain", "ring.toml"}).out, "an upper bound: all particles in"));
  const Json flexible = explained({"ring.toml", "--set", "body.ring.coordinates=particles"});
  EXPECT_EQ(flexible["left_out"].size(), 0U);
  EXPECT_EQ(flexible["bodies"][0]["coordinate_count"], 16);
}

TEST_F(Explain, TellsSpacingAgainstPeriod) {
  ASSERT_EQ(tomlin({"new", "fk"}).status, 0);
  const Json chain = explained({"fk.toml"});
  ASSERT_EQ(chain["misfits"].size(), 1U);
  EXPECT_EQ(chain["misfits"][0]["fraction"], (Json{21, 34}));
  EXPECT_TRUE(contains(tomlin({"explain", "fk.toml"}).out, "commensurate, 21/34"));
  const Json golden = explained({"fk.toml", "--set", "b=(sqrt(5) - 1) / 2"});
  EXPECT_TRUE(golden["misfits"].at(0).at("fraction").is_null());
}

TEST_F(Explain, ShowsWhatARunWouldWrite) {
  const Json output = explained({"tip.toml"})["output"];
  EXPECT_EQ(output["rows"], 429.0);
  ASSERT_EQ(tomlin({"run", "tip.toml"}).status, 0);
  const auto table = static_cast<double>(file("tip.out/observables.csv").size());
  EXPECT_GE(output["table_bytes"], table);
  // Numbers of 17 digits with an exponent and a sign are seldom.
  EXPECT_LE(output["table_bytes"], 1.5 * table);
  EXPECT_EQ(output["trajectory_bytes"], 0.0);
  EXPECT_GT(output["checkpoint_bytes"], 0.0);
  EXPECT_GT(output["room_bytes"], 0.0);
  EXPECT_EQ(output["most_events"], 1000000);

  const std::vector<std::string> with_trajectory = {"explain", "tip.toml", "--set",
                                                    "output.trajectory=true"};
  const std::string text = tomlin(with_trajectory).out;
  expect_parts(text, {"\noutput, at most\n", "429 rows, ", "trajectory.h5", "429 frames, ",
                      "run.journal ", "free disk space  "});
  const std::string beyond = tomlin({"explain", "tip.toml", "--set", "output.every=1e-9"}).out;
  expect_parts(beyond, {"output.every  ", "the run is refused: the run would write 3e+11 rows"});
}

/// The note of a part.
std::string note(const Json& explained, const std::string& part) {
  for (const Json& one : explained["parts"]) {
    if (one["name"] == part) return one["note"];
  }
  return "";
}

constexpr const char* kShaken = R"toml([[body]]
type = "point"
position = [0.1]
particle_mass = 1.0

[[force]]
name = "shaker"
type = "expression"
energy = "x^2 * (1 + 0.1 * cos(t))"

[run]
duration = 1.0
integrator = { type = "rk4", dt = 1e-2 }
)toml";

TEST_F(Explain, AFormulaInTimeDoesWork) {
  write(folder_ / "shaken.toml", kShaken);
  const std::string said = "shaker changes with time and does work, which the energy ledger has";
  EXPECT_EQ(note(explained({"shaken.toml"}), "driver integrals"), "no driver; " + said);
  EXPECT_EQ(
      note(explained({"shaken.toml", "--set", "force.shaker.energy=x^2"}), "driver integrals"),
      "nothing does work");
  write(folder_ / "driven.toml",
        std::string(kShaken) +
            "[[force]]\ntype = \"driving_spring\"\nstiffness = 1.0\nvelocity = [0.1]\n");
  EXPECT_EQ(note(explained({"driven.toml"}), "driver integrals"),
            "the force and the power of every driver; " + said);
}

constexpr const char* kLever = R"([[body]]
name = "support"
type = "point"
position = [-1.5]
particle_mass = 1.0

[[body]]
name = "tip"
type = "point"
position = [0.5]
particle_mass = 1.0

[[force]]
name = "driver"
type = "driving_spring"
body = "support"
stiffness = 2.0
velocity = [0.1]

[[force]]
name = "lever"
type = "harmonic_bonds"
bodies = ["support", "tip"]
pairs = "all"
stiffness = 6.0

[[force]]
type = "sinusoidal_substrate"
body = "tip"
amplitude = 0.1
period = 1.0

[run]
duration = 1.0
integrator = { type = "rk4", dt = 1e-2 }
)";

/// Dry friction damps at no one rate, but limits steps; and the length of tolerances is named after
/// what it is of.
TEST_F(Explain, DryFrictionAndALengthOfAForceAreNamed) {
  write(folder_ / "dry.toml", R"([[body]]
type = "point"
position = [0.0, 0.3, 0.9]
particle_mass = 1.0
[[force]]
type = "coulomb_friction"
force = 1.0
width = 1e-3
[[force]]
type = "driving_spring"
stiffness = 1.0
velocity = [0.1, 0.0, 0.0]
[[force]]
type = "lattice_substrate"
lattice = "honeycomb"
misfit = 0.3
period = 1.0
amplitude = 0.1
repulsion = 1.0
repulsion_decay = 5.0
[run]
duration = 1.0
integrator = { type = "dopri5" }
)");
  const std::string text = tomlin({"explain", "dry.toml"}).out;
  expect_parts(text,
               {"not linear: up to 1000 near rest, decay time 0.001",
                "regime                undamped but for friction that is not linear",
                "shortest time scale   0.001,", "length 0.2, the shortest length of a force;"});
}

TEST_F(Explain, ADriverPullsThroughABondBetweenTwoBodies) {
  write(folder_ / "lever.toml", kLever);
  const std::string text = tomlin({"explain", "lever.toml"}).out;
  expect_parts(
      text,
      {", between support and tip\n", "\ntip: driver pulls over sinusoidal_substrate along x\n",
       "s = 2.632 = substrate curvature 3.948 / series stiffness 1.5; s > 1: stick-slip possible",
       "the series of driver, 2, and lever, 6"});
  EXPECT_FALSE(contains(text, "within the body")) << text;
  const Json found = explained({"lever.toml"});
  EXPECT_EQ(found["scales"]["forces"][1]["internal"], false);
  EXPECT_EQ(found["scales"]["forces"][1]["between"], (Json{"support", "tip"}));
  EXPECT_EQ(found["sliding"][0]["bond"], "lever");
  EXPECT_EQ(found["sliding"][0]["driver_stiffness"], 2.0);
  EXPECT_EQ(found["transmissions"].size(), 0U);

  write(folder_ / "held.toml", std::string(kLever) +
                                   "[[force]]\nname = \"other\"\ntype = \"driving_spring\"\n"
                                   "body = \"tip\"\nstiffness = 1.0\nvelocity = [0.0]\n");
  EXPECT_TRUE(contains(tomlin({"explain", "held.toml"}).out,
                       "\nsupport: driver pulls along x\n"
                       "  stick-slip parameter  not known: sinusoidal_substrate acts on tip, and "
                       "between driver and tip there is more than one linear spring\n"));
  EXPECT_EQ(explained({"held.toml"})["transmissions"][0]["sliding_body"], "tip");
}

TEST_F(Explain, ABadSceneIsBadInputAsOfARun) {
  expect_refused({"explain", "missing.toml"}, "missing.toml:1:1: [file.cannot_read]\n");
  expect_refused({"explain", "tip.toml", "--set", "force.driver.stiffness=-1"},
                 "--set force.driver.stiffness=-1: force.driver.stiffness = -1 "
                 "[scene.out_of_range]\n");
  expect_refused({"explain", "tip.toml", "--set", "measure.to=50"},
                 "--set measure.to=50: measure.to [run.invalid_window]\n");
  expect_refused({"explain"}, "tomlin: [command.missing_argument]\n", {"SCENE"});
}

}  // namespace
}  // namespace tomlin::test
