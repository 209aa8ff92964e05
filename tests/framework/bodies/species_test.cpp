#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/framework/bodies/body_fixture.hpp"

/// Species: what a scene may say, and what forces and trajectories see of it.
namespace tomlin::test {
namespace {

using SpeciesLines = std::vector<std::string>;
using Indices = std::vector<std::int32_t>;

std::string row_of(const std::string& name, int count, const std::string& species) {
  return "[[body]]\nname = \"" + name + "\"\ntype = \"chain\"\ncount = " + std::to_string(count) +
         "\nspacing = 1\nparticle_mass = 1\n" + species + "\n";
}

const std::string kRun =
    "[run]\nduration = 0.1\nintegrator = { type = \"rk4\", dt = 0.01 }\n"
    "[output]\nevery = 0.1\ntrajectory = true\n";

const std::string kThree = row_of("a", 3, "species = [\"H\", \"C\", \"H\"]") + row_of("b", 2, "") +
                           row_of("c", 4, "species = \"C\"") + kRun;

/// Keeps the layout of a run.
class KeptLayout : public RunSink {
 public:
  void begin(const RunLayout& given) override { layout = given; }
  void sample(const std::vector<double>&) override {}
  void event(const Event&) override {}
  RunLayout layout;
};

TEST(Species, AreIndicesOfNamesForForces) {
  Engine engine(scene_of(kThree), {});
  const auto& bodies = engine.model().bodies();
  EXPECT_EQ(bodies[0].bound.species, (Indices{0, 1, 0}));
  EXPECT_EQ(bodies[1].bound.species, Indices());
  EXPECT_EQ(bodies[2].bound.species, (Indices{1, 1, 1, 1}));
  for (const auto& body : bodies) {
    const auto names = body.bound.species_names;
    EXPECT_EQ(SpeciesLines(names.begin(), names.end()), (SpeciesLines{"H", "C"}));
  }
}

TEST(Species, ComeToTrajectories) {
  KeptLayout kept;
  RunOptions options;
  options.sink = &kept;
  (void)run_text(kThree, {}, options);
  EXPECT_EQ(kept.layout.species, (SpeciesLines{"H", "C"}));
  ASSERT_EQ(kept.layout.bodies.size(), 3U);
  EXPECT_EQ(kept.layout.bodies[0].species, (Indices{0, 1, 0}));
  EXPECT_EQ(kept.layout.bodies[1].species, Indices());
  EXPECT_EQ(kept.layout.bodies[2].species, (Indices{1, 1, 1, 1}));
}

TEST(Species, StandInTheEffectiveSceneAndTakeSettings) {
  const auto scene = scene_of(kThree);
  EXPECT_NE(scene->effective_toml.find("species = [\"H\", \"C\", \"H\"]\n"), std::string::npos);
  EXPECT_NE(scene->effective_toml.find("species = \"C\"\n"), std::string::npos);
  EXPECT_EQ(scene_of(scene->effective_toml)->effective_toml, scene->effective_toml);
  EXPECT_EQ(scene_of(kThree, {{"body.c.species", "\"Si\""}})->species,
            (SpeciesLines{"H", "C", "Si"}));
  EXPECT_EQ(scene_of(row_of("b", 2, "") + kRun)->species, SpeciesLines());
}

TEST(Species, FaultsHaveTheirPlace) {
  const auto faults = [](const std::string& species) {
    return briefs_of([&] { (void)scene_of(row_of("a", 3, "species = " + species) + kRun); });
  };
  EXPECT_EQ(faults("[\"H\"]"), SpeciesLines()) << "one for all, in a list";
  EXPECT_EQ(faults("[\"H\", \"C\"]"),
            SpeciesLines{"7:11 body.a.species = [\"H\", \"C\"] [scene.wrong_count]"});
  EXPECT_EQ(faults("[]"), SpeciesLines{"7:11 body.a.species = [] [scene.wrong_count]"});
  EXPECT_EQ(faults("6"), SpeciesLines{"7:11 body.a.species = 6 [scene.wrong_type]"});
  EXPECT_EQ(faults("[\"H\", 6, \"H\"]"),
            SpeciesLines{"7:17 body.a.species = 6 [scene.wrong_type]"});
  EXPECT_EQ(faults("\"\""), SpeciesLines{"7:11 body.a.species = \"\" [scene.invalid_name]"});
  EXPECT_EQ(faults("[\"H\", \"C\", \"6 C\"]"),
            SpeciesLines{"7:22 body.a.species = \"6 C\" [scene.invalid_name]"});
  EXPECT_EQ(faults("\"" + std::string(61, 'C') + "\"").size(), 1U);
  EXPECT_EQ(faults("\"" + std::string(60, 'C') + "\""), SpeciesLines());
}

// Sorting as many species as particles takes no time.
TEST(Species, MayAllDiffer) {
  constexpr int kCount = 20000;
  std::string list;
  for (int i = 0; i < kCount; ++i) list += "\"s" + std::to_string(i) + "\",";
  Engine engine(scene_of(row_of("a", kCount, "species = [" + list + "]") + kRun), {});
  EXPECT_EQ(engine.model().bodies()[0].bound.species.back(), kCount - 1);
}

}  // namespace
}  // namespace tomlin::test
