#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "framework/core/text/fault.hpp"
#include "framework/run/results/observables.hpp"
#include "tests/support/scenes.hpp"

// Every force, with every kind of partner and far from the origin, by every scheme that admits it:
// a scheme whose way of asking a force leaves it with wrong neighbours, or with another time, ends
// elsewhere than the others.

namespace tomlin::test {
namespace {

/// Schemes may differ by this part of the displacement in a run: those of first order differ most,
/// by about a third of this at kStep.
constexpr double kTolerance = 1e-2;
/// Quasistatic paths are compared with slow ones, which lag behind by about this part.
constexpr double kToleranceOfSlow = 5e-2;
/// Tolerance of adaptive schemes, and the steps of the others as parts of the run.
constexpr double kAdaptive = 1e-7;
constexpr double kStep = 1e-3;

/// Keys of a force in a scene; "{}" is the body that a force on one body acts on.
struct Specimen {
  const char* force;
  const char* keys;
};
constexpr const char* kBetween = "bodies = [\"a\", \"b\"]\n";
constexpr const char* kOnOne = "body = \"{}\"\n";
constexpr const char* kPairs = "pairs = [[0, 1], [1, 2], [2, 3]]\n";

/// Scenes of bodies in the plane.
std::vector<Specimen> in_plane() {
  return {{"constant_force", "force = [0.1, -0.05]"},
          {"coulomb_friction", "force = 0.05\nwidth = 0.05"},
          {"driving_spring", "stiffness = 1.0\nvelocity = [{v}, 0.0]"},
          {"expression", "energy = \"0.1 * cos(2*pi*x) * exp(-(y + 8)^2)\""},
          {"expression", "force = [\"-0.1*vx + 0.05*t\", \"0.05*sin(x) - 0.1*vy\"]"},
          {"expression", "pairs = \"all\"\nenergy = \"0.1 * exp(-r)\""},
          {"harmonic_bonds", "stiffness = 2.0\nrest_lengths = 0.55"},
          {"langevin", "coefficient = 0.2\ntemperature = 0.0"},
          {"lattice_substrate", "lattice = \"square\"\nperiod = 0.8\namplitude = 0.02"},
          {"lennard_jones", "epsilon = 0.2\nsigma = 0.4\ncutoff = 1.0"},
          {"memory_damping", "coefficient = 0.5\nmemory_time = 0.3"},
          {"morse_bonds", "depth = 0.1\ninverse_width = 2.0\nrest_lengths = 0.55"},
          {"nose_hoover_chain", "temperature = 0.05\nperiod = 2.0"},
          {"sinusoidal_substrate", "amplitude = 0.05\nperiod = 0.7"},
          {"velocity_weakening", "force = 0.05\nweakening_velocity = 0.5\nwidth = 0.05"},
          {"viscous_damping", "coefficient = 0.2"}};
}

const std::vector<std::string> kKinds = {"particles", "rigid", "fixed", "prescribed"};

bool acts_between(const Specimen& one) {
  const std::string force = one.force;
  return force == "lennard_jones" || force.ends_with("bonds") ||
         std::string(one.keys).starts_with("pairs");
}

std::string force_of(const Specimen& one, const std::string& body) {
  std::string text = std::string("[[force]]\nname = \"") + one.force + "_on_" + body +
                     "\"\ntype = \"" + one.force + "\"\n" + one.keys + "\n";
  if (!acts_between(one)) return text + fmt::format(fmt::runtime(kOnOne), body);
  const bool bonds = std::string(one.force).ends_with("bonds");
  return text + kBetween + (bonds ? kPairs : "");
}

/// How a scene is run.
struct Course {
  Dynamics dynamics = Dynamics::inertial;
  double duration = 1.5;
  double speed = 0.2;
};
constexpr Course kInertial;
constexpr Course kOverdamped = {Dynamics::overdamped};
constexpr Course kSlow = {Dynamics::quasistatic, 40.0, 1e-3};

bool has_inertia(const Course& course) { return course.dynamics == Dynamics::inertial; }

/// Three particles over a row of five, which is of one of the kinds.
std::string scene_in_plane(const Specimen& one, const std::string& kind, const Course& course) {
  const std::string v = digits(course.speed);
  std::string text = tables(R"([[body]] | name = "a" | type = "particles"
positions = [[20.6, -7.55], [21.1, -7.6], [21.6, -7.52]] | particle_mass = 1.0
[[body]] | name = "b" | type = "particles"
positions = [[20.0, -8.0], [20.5, -8.05], [21.0, -8.0], [21.5, -8.05], [22.0, -8.0]]
particle_mass = 1.0
)");
  text += "coordinates = \"" + kind + "\"\n";
  if (kind == "prescribed") text += "motion = { velocity = [" + v + ", 0.0] }\n";
  std::vector<std::string> moving = {"a"};
  if (kind == "particles" || kind == "rigid") moving.push_back("b");
  text += force_of(one, "a");
  for (const std::string& body : moving) {
    if (body == "b" && !acts_between(one)) text += force_of(one, body);
    if (!has_inertia(course)) {
      text += "[[force]]\nname = \"drag_" + body +
              "\"\ntype = \"viscous_damping\"\ncoefficient = 1.0\nbody = \"" + body + "\"\n";
    }
    if (course.dynamics == Dynamics::quasistatic || course.duration == kSlow.duration) {
      text += "[[force]]\nname = \"hold_" + body +
              "\"\ntype = \"driving_spring\"\nattach = \"each_particle\"\nstiffness = 8.0\n"
              "velocity = [" +
              v + ", 0.0]\nbody = \"" + body + "\"\n";
    }
  }
  if (std::string(one.force) != "lennard_jones") {
    text += force_of({"lennard_jones", "epsilon = 0.2\nsigma = 0.4\ncutoff = 1.0"}, "a");
  }
  for (std::size_t at = text.find("{v}"); at != std::string::npos; at = text.find("{v}")) {
    text.replace(at, 3, v);
  }
  return text;
}

std::string run_of(const Course& course) {
  // The limit of schemes whose errors grow slowly is of no account in so short a run.
  return fmt::format("[run]\nallow_unstable = true\nduration = {}\ndynamics = \"{}\"\n",
                     course.duration, to_string(course.dynamics));
}

/// Positions and velocities of the bodies at the end.
using Ends = std::map<std::string, double>;

Ends ends_of(const RunResult& result) {
  Ends ends;
  for (const Observable& one : observables(result)) {
    if (!one.path.starts_with("bodies.") || !one.value) continue;
    const bool position = one.path.find(".centre_of_mass.") != std::string::npos;
    const bool velocity = one.path.find(".velocity.") != std::string::npos;
    if (position || velocity) ends[one.path] = *one.value;
  }
  return ends;
}

/// The states in which schemes end one scene.
struct Compared {
  std::map<std::string, Ends> ends;            ///< by scheme
  std::map<std::string, std::string> refused;  ///< the same
  bool any_solves = false;                     ///< one that asks for second derivatives

  void add(const std::string& text, const Course& course) {
    for (const auto& scheme : standard().integrators()) {
      const bool follows = course.dynamics == Dynamics::quasistatic;
      if (scheme->follows_equilibria != follows || ends.count(scheme->name) > 0) continue;
      const std::string line = scheme->adaptive && !follows ? adaptive(kAdaptive, scheme->name)
                               : follows                    ? "{ type = \"" + scheme->name + "\" }"
                                         : held_to(scheme->name, kStep * course.duration);
      try {
        const RunResult result = run_text(text + run_of(course) + "integrator = " + line + "\n");
        ASSERT_EQ(result.status, RunStatus::finished)
            << scheme->name << (result.failure ? to_string(*result.failure) : "") << "\n"
            << text;
        ends[scheme->name] = ends_of(result);
        any_solves = any_solves || scheme->needs_tangent || follows;
      } catch (const InputError& error) {
        EXPECT_FALSE(error.faults().empty());
        refused[scheme->name] = error.faults().front().why;
      }
    }
  }

  /// The largest difference of two schemes, in what a course moves by; says which.
  double largest(const Course& course, std::string& between) const {
    double most = 0.0;
    for (const auto& [path, unused] : ends.begin()->second) {
      const bool position = path.find(".centre_of_mass.") != std::string::npos;
      const double size = course.speed * (position ? course.duration : 1.0);
      for (const auto& one : ends) {
        for (const auto& other : ends) {
          const double apart = std::abs(one.second.at(path) - other.second.at(path)) / size;
          if (apart <= most) continue;
          most = apart;
          between = fmt::format("{} of {} and {}", path, one.first, other.first);
        }
      }
    }
    return most;
  }
};

void expect_agreement(const Compared& all, const Course& course, double tolerance,
                      const std::string& text) {
  std::string between;
  EXPECT_LE(all.largest(course, between), tolerance) << between << "\n" << text;
}

/// One course and kind of partner for all forces. Every force has to be run by two schemes at
/// least where it has inertia, and one that is the gradient of an energy by one that solves.
void compare_all(const std::string& kind, const Course& course) {
  for (const Specimen& one : in_plane()) {
    SCOPED_TRACE(std::string(one.force) + ", " + kind);
    const std::string text = scene_in_plane(one, kind, course);
    Compared all;
    all.add(text, course);
    if (testing::Test::HasFatalFailure()) return;
    const Traits traits = scene_of(text + run_of(course) + "integrator = " + adaptive(kAdaptive))
                              ->forces.front()
                              .traits();
    if (has_inertia(course)) {
      EXPECT_GE(all.ends.size(), 2U) << "too few schemes admit it";
      EXPECT_TRUE(all.any_solves || !traits.conservative) << all.refused["radau9"];
    }
    if (all.ends.size() > 1) expect_agreement(all, course, kTolerance, text);
  }
}

class SchemesAgree : public testing::TestWithParam<std::string> {};

TEST_P(SchemesAgree, WithInertia) { compare_all(GetParam(), kInertial); }
TEST_P(SchemesAgree, WithoutInertia) { compare_all(GetParam(), kOverdamped); }

/// Equilibria as they are followed, and as what is pulled slowly goes through them.
TEST_P(SchemesAgree, AtRest) {
  constexpr int kFewest = 6;
  int compared = 0;
  for (const Specimen& one : in_plane()) {
    SCOPED_TRACE(std::string(one.force) + ", " + GetParam());
    Compared all;
    all.add(scene_in_plane(one, GetParam(), kSlow), kSlow);
    if (all.ends.empty()) continue;  // what depends on velocity has no equilibria to follow
    Course slow = kSlow;
    slow.dynamics = Dynamics::overdamped;
    const std::string text = scene_in_plane(one, GetParam(), slow);
    all.ends["slow"] =
        ends_of(run_text(text + run_of(slow) + "integrator = " + adaptive(kAdaptive)));
    for (auto& [scheme, ends] : all.ends) {
      std::erase_if(ends,
                    [](const auto& end) { return end.first.find(".vel") != std::string::npos; });
    }
    expect_agreement(all, slow, kToleranceOfSlow, text);
    ++compared;
  }
  EXPECT_GE(compared, kFewest);
}

INSTANTIATE_TEST_SUITE_P(PartnerIs, SchemesAgree, testing::ValuesIn(kKinds),
                         [](const auto& kind) { return kind.param; });

// ---- in space

constexpr Course kInSpace = {Dynamics::inertial, 0.02, 5.0};

/// Three atoms of carbon over four others, which do not know them as carbon.
std::string bond_orders(const std::string& kind) {
  std::string text = tables(R"([scene] | units = "metal"
[[body]] | name = "a" | type = "particles"
positions = [[20.0, -15.0, 9.0], [21.6, -15.0, 9.0], [20.8, -13.6, 9.1]]
velocity = [5.0, 0.0, 0.0] | species = "C" | particle_mass = 12.011
[[body]] | name = "b" | type = "particles"
positions = [[19.0, -15.0, 6.2], [21.0, -15.0, 6.0], [23.0, -15.0, 6.1], [21.0, -13.0, 6.0]]
species = "Ar" | particle_mass = 40.0
)");
  text += "coordinates = \"" + kind + "\"\n";
  if (kind == "prescribed") text += "motion = { velocity = [5.0, 0.0, 0.0] }\n";
  return text + tables(R"([[force]] | type = "tersoff" | body = "a"
parameters = "lindsay_broido_2010"
[[force]] | type = "lennard_jones" | bodies = ["a", "b"] | epsilon = 0.05 | sigma = 3.0
cutoff = 6.0
)");
}

/// The body over a sheet is what may move.
std::string over_sheet(const std::string& kind) {
  std::string text = tables(R"([scene] | units = "metal"
[box] | lengths = ["12 * 1.42", "6 * sqrt(3) * 1.42", 40.0] | periodic = [true, true, false]
[[body]] | name = "b" | type = "graphene" | bond_length = 1.42 | cells = [4, 6]
centre = [20.0, -15.0, 7.0] | particle_mass = 12.011 | coordinates = "fixed"
[[body]] | name = "a" | type = "particles"
positions = [[20.3, -15.2, 10.2], [21.9, -15.0, 10.4]] | velocity = [5.0, 0.0, 0.0]
particle_mass = 40.0
)");
  if (kind == "prescribed") {
    text.erase(text.rfind("velocity"), std::string("velocity = [5.0, 0.0, 0.0]\n").size());
    text += "motion = { velocity = [5.0, 0.0, 0.0] }\n";
  }
  return text + "coordinates = \"" + kind + tables(R"("
[[force]] | type = "sheet_field" | bodies = ["a", "b"] | epsilon = 0.05 | sigma = 3.4
cutoff = 8.0 | tolerance = 1e-3
)");
}

TEST_P(SchemesAgree, InSpace) {
  const std::string text = bond_orders(GetParam());
  Compared all;
  all.add(text, kInSpace);
  EXPECT_GE(all.ends.size(), 2U);
  // A rigid body in space has no second derivatives.
  EXPECT_TRUE(all.any_solves || GetParam() == "rigid");
  if (all.ends.size() > 1) expect_agreement(all, kInSpace, kTolerance, text);
}

TEST(SchemesAgreeOverSheet, WhateverMoves) {
  for (const std::string& kind : kKinds) {
    SCOPED_TRACE(kind);
    if (kind == "fixed") continue;  // nothing would move
    Compared all;
    all.add(over_sheet(kind), kInSpace);
    ASSERT_GE(all.ends.size(), 2U);
    expect_agreement(all, kInSpace, kTolerance, over_sheet(kind));
  }
}

// ---- whether all of it would see anything

TEST(SchemesAgreeWithAll, ForcesThereAre) {
  std::set<std::string> compared = {"tersoff", "sheet_field"};
  for (const Specimen& one : in_plane()) compared.insert(one.force);
  for (const auto& force : standard().forces()) {
    EXPECT_EQ(compared.count(force->name), 1U) << force->name << " is compared nowhere";
  }
}

/// One scheme that does not see the contact.
TEST(SchemesAgreeWithAll, AForceThatOneSchemeLosesIsSeen) {
  for (const std::string& kind : kKinds) {
    const Specimen contact = {"lennard_jones", "epsilon = 0.2\nsigma = 0.4\ncutoff = 1.0"};
    const Specimen none = {"lennard_jones", "epsilon = 0.0\nsigma = 0.4\ncutoff = 1.0"};
    const auto end = [&](const Specimen& one) {
      return ends_of(run_text(scene_in_plane(one, kind, kInertial) + run_of(kInertial) +
                              "integrator = " + adaptive(kAdaptive)));
    };
    Compared all;
    all.ends = {{"sound", end(contact)}, {"planted", end(none)}};
    std::string between;
    EXPECT_GT(all.largest(kInertial, between), kTolerance) << kind;
  }
}

}  // namespace
}  // namespace tomlin::test
