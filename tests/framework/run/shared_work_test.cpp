#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/numbers/quad.hpp"
#include "framework/core/records/facets.hpp"
#include "framework/core/system/thread_team.hpp"
#include "framework/run/context.hpp"
#include "framework/run/engine.hpp"
#include "framework/scene/scene.hpp"
#include "framework/standard_registry.hpp"

/// Threads that share the evaluations of forces change no bit: of forces, of energies, of the state
/// after steps in which lists are made again, of a run that another number of threads resumes.
namespace tomlin::test {
namespace {

/// Two free layers of 320 and 328 atoms, hot and moving against each other, above a fixed one:
/// lists within a body and between two, pairs by species, a field. Whole groups of eight, and not.
std::string layers(const std::string& number_type) {
  const auto layer = [](const std::string& name, const std::string& cells,
                        const std::string& more) {
    return "[[body]]\nname = \"" + name +
           "\"\ntype = \"graphene\"\nbond_length = \"b\"\ncells = " + cells +
           "\nspecies = \"C\"\nparticle_mass = 12.011\n" + more;
  };
  const auto force = [](const std::string& type, const std::string& keys) {
    return "[[force]]\ntype = \"" + type + "\"\n" + keys;
  };
  return "[scene]\nunits = \"metal\"\n[parameters]\nb = 1.4388\n[box]\nlengths = [\"10 * 3 * b\", "
         "\"8 * sqrt(3) * b\", 60.0]\nperiodic = [true, true, false]\n" +
         layer(
             "lower", "[10, 8]",
             "centre = [0.3, 0.2, 3.4]\nstart_temperature = 900.0\nvelocity = [4.0, 0.0, 0.0]\n") +
         layer("upper", "[10, 8]",
               "centre = [0.1, 0.5, 6.8]\nstart_temperature = 900.0\nvelocity = [-90.0, 0.0, "
               "0.0]\n") +
         layer("sheet", "[10, 8]", "coordinates = \"fixed\"\n") +
         "[[body]]\nname = \"grains\"\ntype = \"chain\"\ncount = 261\nspacing = 0.15\norigin = "
         "[-20.0, 0.0, 12.0]\nspecies = \"Ar\"\nparticle_mass = 39.948\nvelocity = [0.0, 30.0, "
         "0.0]\n" +
         force("tersoff",
               "name = \"one\"\nbody = \"lower\"\nparameters = \"lindsay_broido_2010\"\n") +
         force("tersoff",
               "name = \"two\"\nbody = \"upper\"\nparameters = \"lindsay_broido_2010\"\n") +
         force("lennard_jones",
               "name = \"between\"\nbodies = [\"lower\", \"upper\"]\nepsilon = "
               "0.0024\nsigma = 3.4\ncutoff = 5.0\n") +
         force("lennard_jones",
               "name = \"gas\"\nbodies = [\"grains\", \"upper\"]\nentries = \"\"\""
               "\nAr C 0.005 3.4\n\"\"\"\ncutoff = 7.0\n") +
         force("sheet_field",
               "bodies = [\"lower\", \"sheet\"]\nepsilon = 0.0024\nsigma = "
               "3.4\ncutoff = 8.0\ntolerance = 1e-3\n") +
         "[run]\nseed = 4\nduration = 0.03\nnumber_type = \"" + number_type +
         "\"\nledger = true\nintegrator = { type = \"velocity_verlet\", dt = 5e-4 }\n";
}

std::shared_ptr<const Scene> read(const std::string& text) {
  static const Registry components = standard_registry();
  return parse_scene(text, "layers.toml", components, {});
}

RunOptions options_of(const ThreadTeam& team) {
  RunOptions options;
  options.team = &team.team();
  return options;
}

struct SeenRun {
  std::vector<double> forces;
  double energy = 0.0;
  std::vector<std::byte> state;

  bool operator==(const SeenRun&) const = default;
};

SeenRun seen_after(Engine& engine, std::uint64_t steps) {
  engine.advance(steps);
  EXPECT_FALSE(engine.context().outcome.failure);
  EXPECT_EQ(engine.steps() % steps, 0u);
  SeenRun seen;
  Model& model = engine.model();
  const SystemView<double>& view = model.system().view;
  seen.state = engine.state().to_bytes();
  seen.energy = model.potential_energy(DoubleDouble(engine.time()), view.position, view.velocity,
                                       view.integrals);
  seen.forces.assign(view.force, view.force + view.dofs);
  return seen;
}

constexpr std::uint64_t kSteps = 40;

TEST(SharedWork, HasTheBitsOfOneThread) {
  constexpr std::uint64_t kFewSteps = 2;  // quadruple precision is slow
  for (const auto& [type, steps] : {std::pair("double", kSteps), {"quadruple", kFewSteps}}) {
    const auto scene = read(layers(type));
    Engine alone(scene, {});
    const SeenRun expected = seen_after(alone, steps);
    EXPECT_NE(expected.energy, 0.0);
    for (const std::size_t threads : {1, 2, 3, 8}) {
      const ThreadTeam team(threads);
      Engine shared(scene, options_of(team));
      const SeenRun found = seen_after(shared, steps);
      EXPECT_EQ(found.forces, expected.forces) << type << ", " << threads;
      EXPECT_EQ(found.energy, expected.energy) << type << ", " << threads;
      EXPECT_TRUE(found.state == expected.state) << type << ", " << threads;
    }
  }
}

TEST(SharedWork, ARunResumesWithAnyNumberOfThreads) {
  const auto scene = read(layers("double"));
  Engine alone(scene, {});
  const std::vector<std::byte> half = seen_after(alone, kSteps / 2).state;
  const SeenRun expected = seen_after(alone, kSteps / 2);
  for (const std::size_t threads : {1, 2, 5}) {
    const ThreadTeam team(threads);
    Engine resumed(scene, options_of(team));
    resumed.resume(half);
    EXPECT_TRUE(seen_after(resumed, kSteps / 2).state == expected.state) << threads;
  }
}

TEST(SharedWork, ResultsSayHowManyThreads) {
  const auto scene = read(layers("double"));
  const ThreadTeam team(2);
  const RunResult shared = run_as_bound(scene, options_of(team));
  const RunResult alone = run_as_bound(scene);
  EXPECT_EQ(shared.threads, 2u);
  EXPECT_EQ(alone.threads, 1u);
  ASSERT_EQ(shared.status, RunStatus::finished);
  EXPECT_EQ(shared.force_evaluations, alone.force_evaluations);
  const auto energy = [](const RunResult& result) { return *result.group("energy")["potential"]; };
  EXPECT_EQ(energy(shared), energy(alone));
}

}  // namespace
}  // namespace tomlin::test
