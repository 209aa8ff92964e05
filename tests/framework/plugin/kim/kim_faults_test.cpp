#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "tests/framework/plugin/kim/kim_scenes.hpp"

// Scenes with kim_model that are refused, each with its position, and runs that fail.

namespace tomlin::test {
namespace {

/// FAULT for as long as it lives; see test_model.cpp.
class FaultOfModel {
 public:
  explicit FaultOfModel(const char* fault) { ::setenv("FAULT", fault, 1); }
  ~FaultOfModel() { ::unsetenv("FAULT"); }
  FaultOfModel(const FaultOfModel&) = delete;
  FaultOfModel& operator=(const FaultOfModel&) = delete;
};

std::string two_atoms(const std::string& more, double apart = 4.0) {
  return "[[body]]\nname = \"a\"\ntype = \"particles\"\nparticle_mass = 39.948\npositions = "
         "[[0.0, 0.0, 0.0], [" +
         digits(apart) + ", 0.0, 0.0]]\n" + more + "\n";
}

std::string of_two(const std::string& model, const std::string& heading = kMetal,
                   const std::string& species = "species = \"Ar\"", double apart = 4.0) {
  return heading + two_atoms(species, apart) + kim_force(model, "[\"a\"]") + kShortRun;
}

std::string refused(const std::string& text) { return brief_refusal(text, with_kim()); }

TEST(KimFaults, AreToldWithTheirPlace) {
  const std::string key = "12:9 force.kim_model.model = ";
  EXPECT_EQ(refused(of_two("tomlin_test_pair")), "");
  EXPECT_EQ(refused(of_two("tomlin_test_pain")),
            key + "\"tomlin_test_pain\" [scene.unknown_name] did you mean tomlin_test_pair");
  const std::string valid = "\"tomlin_test_pair\" ";
  EXPECT_EQ(refused(of_two("tomlin_test_pair", "[scene]\nunits = \"reduced\"\n")),
            key + valid + "[component.unsuitable]");
  EXPECT_EQ(refused(of_two("tomlin_test_pair", kMetal, "")),
            "3:1 body.a.species [component.unsuitable]");
  EXPECT_EQ(refused(of_two("tomlin_test_pair", kMetal, "species = [\"Ar\", \"Si\"]")),
            "8:11 body.a.species = [\"Ar\", \"Si\"] [component.unsuitable]");
  EXPECT_NE(refusal(of_two("tomlin_test_pair", kMetal, "species = [\"Ar\", \"Si\"]"), with_kim())
                .find("expected: Ar, Kr"),
            std::string::npos);
  EXPECT_EQ(
      refused(kMetal + "[box]\nlengths = [13.7, 20.0, 20.0]\nperiodic = [true, true, true]\n" +
              two_atoms("species = \"Ar\"") + kim_force("tomlin_test_pair", "[\"a\"]") + kShortRun),
      "15:9 force.kim_model.model = " + valid + "[scene.out_of_range]");
  EXPECT_EQ(refused(of_two("tomlin_test_pair", kMetal, "species = \"Ar\"", 0.4)),
            "9:1 force.kim_model.body [body.invalid_coordinates]");
  EXPECT_EQ(refused(kMetal +
                    "[[body]]\ntype = \"particles\"\npositions = [[0.0, 0.0], [4.0, 0.0]]\n"
                    "particle_mass = 1.0\nspecies = \"Ar\"\n[[force]]\ntype = \"kim_model\"\n"
                    "model = \"tomlin_test_pair\"\n" +
                    kShortRun),
            "10:9 force.kim_model.model = " + valid + "[component.unsuitable]");
  EXPECT_EQ(refused(of_two("tomlin_test_pair") + "number_type = \"quadruple\"\n"),
            "16:15 run.number_type = \"quadruple\" [number_type.unsuitable]");
}

TEST(KimFaults, ModelsThatCannotBeUsedAreRefused) {
  const std::string found = "12:9 force.kim_model.model = \"tomlin_test_faulty\" ";
  const struct {
    const char* fault;
    const char* part;
  } cases[] = {{"no_forces", "gives no forces"},
               {"needs_derivatives", "ProcessDEDrTerm"},
               {"units", "kcal_mol and A"},
               {"not_created", "no parameters"}};
  for (const auto& one : cases) {
    SCOPED_TRACE(one.fault);
    const FaultOfModel fault(one.fault);
    const std::string text = of_two("tomlin_test_faulty");
    EXPECT_EQ(refused(text), found + "[component.unsuitable]");
    const std::string why = refusal(text, with_kim());
    EXPECT_NE(why.find(one.part), std::string::npos) << why;
  }
  EXPECT_EQ(refused(of_two("tomlin_test_faulty")), "") << "the same without a fault";
}

TEST(KimFaults, AModelsErrorEndsTheRun) {
  // The two approach each other from rest.
  const std::string meet = "species = \"Ar\"\nvelocity = [[0.0, 0.0, 0.0], [-16.0, 0.0, 0.0]]";
  const auto scene =
      kim_scene(of_two("tomlin_test_faulty", kMetal, meet), {{"run.duration", "1.0"}});
  {
    const FaultOfModel fault("error_when_near");
    const RunResult result = run(scene, {});
    ASSERT_EQ(result.status, RunStatus::failed);
    ASSERT_TRUE(result.failure);
    const std::string why = to_string(*result.failure);
    for (const char* part :
         {"tomlin_test_faulty", "has returned an error", "two atoms are too near"}) {
      EXPECT_NE(why.find(part), std::string::npos) << why;
    }
    EXPECT_GT(result.steps, 50U);
  }
  const FaultOfModel fault("no_number");
  const RunResult result = run(kim_scene(of_two("tomlin_test_faulty")), {});
  ASSERT_EQ(result.status, RunStatus::failed);
  const std::string why = to_string(*result.failure);
  EXPECT_NE(why.find("gives no finite force on particle 1 of \"a\" (Ar)"), std::string::npos)
      << why;
}

}  // namespace
}  // namespace tomlin::test
