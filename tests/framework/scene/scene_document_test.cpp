#include "framework/scene/scene_document.hpp"

#include <string>

#include <gtest/gtest.h>

#include "tests/framework/scene/scene_fixture.hpp"

namespace tomlin::test {
namespace {

const Registry& registry() {
  static const Registry all = components();
  return all;
}

TEST(SceneDocument, IsParsedOnceHoweverManyScenesAreReadFromIt) {
  const std::size_t before = parsed_documents();
  const SceneDocument document(kRing, "ring.toml");
  for (int k = 1; k <= 100; ++k) {
    const auto scene = document.read(
        registry(), {{"run.duration", std::to_string(100 * k)},
                     {"run.integrator", "{ type = \"euler\", dt = " + std::to_string(k) + " }"}});
    EXPECT_EQ(scene->run.duration, 100.0 * k);
  }
  EXPECT_EQ(parsed_documents(), before + 1);
}

TEST(SceneDocument, KeepsItsOwnValues) {
  const SceneDocument document(kRing, "ring.toml");
  const auto changed = document.read(registry(), {{"R", "3"}, {"run.duration", "100"}});
  EXPECT_EQ(changed->effective_toml,
            parsed(kRing, {{"R", "3"}, {"run.duration", "100"}})->effective_toml);
  EXPECT_EQ(document.read(registry())->effective_toml, parsed(kRing)->effective_toml);
}

TEST(SceneDocument, FaultsStandWhereTheyAreWritten) {
  const SceneDocument document(replaced("[run]\nduration", "[run]\nlength"), "ring.toml");
  for (const char* radius : {"1.0", "2.0"}) {
    try {
      (void)document.read(registry(), {{"R", radius}, {"N", "no number"}});
      ADD_FAILURE() << "the scene has faults";
    } catch (const InputError& error) {
      EXPECT_EQ(abridged(error.what()),
                "ring.toml:25:1: run.duration [scene.missing_key]\n"
                "ring.toml:26:1: run.length [scene.unknown_key]\n"
                "--set N=no number: parameters.N = no number [expression.syntax]");
    }
  }
}

TEST(SceneDocument, BadSyntaxIsThrownWhenASceneIsAskedFor) {
  const SceneDocument document("[run", "ring.toml");
  EXPECT_EQ(document.contents(), nullptr);
  EXPECT_TRUE(document.libraries().empty());
  EXPECT_THROW((void)document.read(registry()), InputError);
  EXPECT_THROW((void)document.read(registry(), {{"R", "2"}}), InputError);
}

TEST(SceneDocument, AFileThatIsNotThereIsAFaultOfTheScene) {
  const SceneDocument document("no such scene.toml");
  EXPECT_TRUE(document.libraries().empty());
  EXPECT_THROW((void)document.read(registry()), InputError);
}

}  // namespace
}  // namespace tomlin::test
