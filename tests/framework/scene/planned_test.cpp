#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "framework/scene/language.hpp"
#include "tests/framework/scene/scene_fixture.hpp"

/// What the language is to have one day is refused as not in this version, wherever it is asked
/// for; what it has is not.
namespace tomlin::test {
namespace {

/// Words, types and units that are planned. To switch one on, take it off this list.
const std::vector<std::string> kPlanned = {"replicas", "stability", "report", "constraints"};

void expect_not_yet(const std::string& what, const std::string& text,
                    const std::vector<Setting>& settings = {}) {
  const std::string faults = faults_of(text, settings);
  EXPECT_NE(faults.find("[scene.not_in_this_version]"), std::string::npos) << what << "\n"
                                                                           << faults;
  EXPECT_EQ(faults.find("[scene.unknown_"), std::string::npos) << what << "\n" << faults;
}

TEST(Planned, AreTheWordsOfTheLanguage) {
  ASSERT_EQ(planned_words().size(), kPlanned.size());
  for (const std::string& word : kPlanned) {
    ASSERT_NE(planned_word(word), nullptr) << word;
    EXPECT_NE(planned_word(word)->note, "") << word;
  }
}

TEST(Planned, KeysOfEveryTable) {
  for (const std::string& word : kPlanned) {
    for (const char* before :
         {"name = \"a ring\"", "radius = \"R\"", "pairs = \"all\"", "stiffness = \"k\"",
          "duration = 1e4", "from = 1.0", "every = 1.0"}) {
      expect_not_yet(word + " below " + before,
                     replaced(before, std::string(before) + "\n" + word + " = 1"));
    }
    expect_not_yet(word + " of the integrator", replaced("dt = 1e-4", "dt = 1e-4, " + word + "=1"));
    expect_not_yet("[" + word + "]", std::string(kRing) + "[" + word + "]\n");
    expect_not_yet("--set " + word, kRing, {{word, "1"}});
    expect_not_yet("--set run." + word, kRing, {{"run." + word, "1"}});
    expect_not_yet("--set " + word + ".k", kRing, {{word + ".k", "1"}});
  }
}

TEST(Planned, TypesOfEveryKind) {
  for (const std::string& word : kPlanned) {
    for (const char* type : {"loop", "bonds", "euler"}) {
      const std::string given = std::string("type = \"") + type;
      expect_not_yet(word + " for " + type, replaced(given, "type = \"" + word));
    }
  }
}

TEST(Planned, Choices) {
  expect_not_yet("real", replaced("name = \"a ring\"", "units = \"real\""));
}

TEST(Planned, OtherUnitsAreTheScenesOwn) {
  const std::string faults = faults_of(replaced("name = \"a ring\"", "units = \"SI\""));
  EXPECT_EQ(abridged(faults), "ring.toml:2:9: scene.units = \"SI\" [scene.unknown_choice]\n");
  EXPECT_NE(faults.find("\"reduced\""), std::string::npos) << faults;
  EXPECT_NE(faults.find("\"metal\""), std::string::npos) << faults;
}

/// No word is planned that the language has.
TEST(Planned, NothingThatIsThere) {
  for (const SceneTable& table : scene_tables()) {
    for (const std::string& key : table.layout.keys()) EXPECT_EQ(planned_word(key), nullptr) << key;
  }
  for (const std::string& key : top_level_keys()) EXPECT_EQ(planned_word(key), nullptr) << key;
}

/// A parameter, a body or a force may have any name that is no word of its own.
TEST(Planned, NamesAreFree) {
  for (const std::string& word : kPlanned) {
    EXPECT_EQ(faults_of(replaced("k = \"2 * R\"", "k = 1\n" + word + " = 2")), "") << word;
    EXPECT_EQ(faults_of(replaced("name = \"driver\"", "name = \"" + word + "\"")), "") << word;
  }
}

/// A key of another table is refused with the name of that table.
TEST(Planned, KeysOfOtherTables) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"every", "[output]"},
      {"from", "[measure]"},
      {"lengths", "[box]"},
      {"dt", "integrator = { type = ..., ... }"}};
  for (const auto& [key, table] : cases) {
    const std::string faults =
        faults_of(replaced("duration = 1e4", "duration = 1e4\n" + key + " = 1"));
    EXPECT_EQ(abridged(faults), "ring.toml:27:1: run." + key + " [scene.unknown_key]\n");
    EXPECT_NE(faults.find(table), std::string::npos) << faults;
  }
}

}  // namespace
}  // namespace tomlin::test
