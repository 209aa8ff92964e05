#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "framework/scene/document.hpp"
#include "framework/scene/settings.hpp"
#include "framework/scene/size_checks.hpp"
#include "tests/framework/scene/scene_fixture.hpp"

/// Files that are no scenes at all: one clear fault, never a crash.
namespace tomlin::test {
namespace {

std::string repeated(const std::string& part, std::size_t times) {
  std::string text;
  text.reserve(part.size() * times);
  for (std::size_t i = 0; i < times; ++i) text += part;
  return text;
}

void expect_one_fault(const std::string& found, const std::string& start) {
  EXPECT_EQ(found.substr(0, start.size()), start) << found.substr(0, 500);
  EXPECT_EQ(std::count(found.begin(), found.end(), '\n'), 1);
  EXPECT_LT(found.size(), 1000U);
}

TEST(HostileInput, Nothing) {
  const std::string empty = "ring.toml:1:1: error: the file is empty";
  expect_one_fault(faults_of(""), empty);
  expect_one_fault(faults_of(" \r\n\t\n"), empty);
  expect_one_fault(faults_of("# nothing\n# but comments"), empty);
  expect_one_fault(faults_of("\xEF\xBB\xBF"), empty);
}

TEST(HostileInput, DeepNesting) {
  const std::string deep = "nested too deeply; admissible: at most 32 levels";
  expect_one_fault(faults_of("a = " + repeated("[", 10000)), "ring.toml:1:37: error: " + deep);
  expect_one_fault(faults_of("a = " + repeated("[", 10000) + repeated("]", 10000)),
                   "ring.toml:1:37: error: " + deep);
  expect_one_fault(faults_of("a = " + repeated("{ a = ", 10000)), "ring.toml:1:");
  expect_one_fault(faults_of("[" + repeated("a.", 1000000) + "a]"),
                   "ring.toml:1:65: error: " + deep);
  expect_one_fault(faults_of(repeated("a.", 1000000) + "a = 1"), "ring.toml:1:64: error: " + deep);
  expect_one_fault(faults_of(repeated("\"=,]\" . ", 1000000) + "a = 1"), "ring.toml:1:");
  expect_one_fault(faults_of("x = '''a\n\"'''\n" + repeated("'\".' .", 100000) + "a = 1"),
                   "ring.toml:3:");
  // Not nesting: brackets and dots in strings and comments, and one after the other.
  const std::string brackets = repeated("[.", 10000);
  EXPECT_EQ(faults_of(replaced("a ring", brackets) + "# " + brackets), "");
  EXPECT_EQ(faults_of(replaced("\"a ring\"", "'''\n" + brackets + "'''")), "");
}

TEST(HostileInput, LongExpressions) {
  const auto with_radius = [](const std::string& expression) {
    return faults_of(replaced("radius = \"R\"", "radius = \"" + expression + "\""));
  };
  expect_one_fault(with_radius(repeated("(", 100000)), "ring.toml:12:");
  expect_one_fault(with_radius("1" + repeated(" + 1", 100000)), "ring.toml:12:");
  expect_one_fault(with_radius(repeated("-", 5000) + "1"), "ring.toml:12:");
}

TEST(HostileInput, CharactersBeyondAsciiOutsideOfQuotes) {
  const std::string why = "a character beyond ASCII outside of strings and comments";
  expect_one_fault(faults_of("caf\xC3\xA9 = 1"), "ring.toml:1:4: error: " + why);
  expect_one_fault(faults_of(std::string(kRing) + "\xC2\xA0"), "ring.toml:");
  // In the middle it is no mark.
  expect_one_fault(faults_of("a.\xEF\xBB\xBF.b = 1"), "ring.toml:1:3: error: " + why);
  EXPECT_EQ(faults_of(replaced("a ring", "caf\xC3\xA9") + "# \xC2\xA0"), "");
}

// A string's last own quotes hide nothing of what follows it.
TEST(HostileInput, QuotesBeforeTheClosingOnes) {
  for (const std::string own : {"", "\"", "\"\""}) {
    const std::string list = "a = [\"\"\"x" + own + "\"\"\", ";
    expect_one_fault(faults_of(list + repeated("[", 40)),
                     "ring.toml:1:" + std::to_string(list.size() + 32) + ": error: nested too");
  }
}

TEST(HostileInput, ManyValues) {
  const std::string why = "too many values; admissible: at most 1000000 values, lists and tables";
  expect_one_fault(faults_of("a = [" + repeated("1,", kMostValues) + "]"),
                   "ring.toml:1:2000003: error: " + why);
  expect_one_fault(faults_of(repeated("[[body]]\n", kMostValues / 2 + 1)),
                   "ring.toml:500001:1: error: " + why);
  EXPECT_EQ(faults_of(replaced("a ring", repeated(",", kMostValues + 1))), "");
}

TEST(HostileInput, Expressions) {
  const auto parameters = [](const std::string& expression, int count) {
    std::string text = std::string(kRow) + "[parameters]\n";
    for (int i = 0; i < count; ++i) text += fmt::format("p{} = \"{}\"\n", i, expression);
    return text;
  };
  const std::string sum = repeated("1 + ", 2000) + "1";
  const int most = static_cast<int>(kMostExpressionText / sum.size());
  EXPECT_EQ(faults_of(parameters(sum, most)), "");
  expect_one_fault(faults_of(parameters(sum, most + 1)),
                   fmt::format("ring.toml:{}:", 8 + 1 + most));
  EXPECT_NE(faults_of(parameters(sum, most + 1)).find("at most 1048576 bytes in all"),
            std::string::npos);
  // Sums of sums double each time and are computed once each; what overflows is told.
  std::string doubling = std::string(kRow) + "[parameters]\np0 = 1\n";
  for (int i = 0; i < 1100; ++i) doubling += fmt::format("p{} = \"p{} + p{}\"\n", i + 1, i, i);
  EXPECT_NE(faults_of(doubling).find("parameters.p1024 = \"p1023 + p1023\": "), std::string::npos);
  EXPECT_NE(
      faults_of(parameters("9^" + repeated("9^", 200) + "9", 1)).find("nested deeper than 200"),
      std::string::npos);
}

TEST(HostileInput, Settings) {
  const std::vector<Setting> many(kMostSettings + 1, Setting{"N", "8"});
  expect_one_fault(faults_of(kRing, many),
                   "--set N=8: error: there are 1001 of these; admissible: at most 1000");
  const std::string deep = repeated("a.", 100000) + "a";
  expect_one_fault(faults_of(kRing, {{"run." + deep, "1"}}), "--set run.a.a");
  EXPECT_NE(faults_of(kRing, {{"run." + deep, "1"}}).find("at most 32 levels"), std::string::npos);
  expect_one_fault(faults_of(kRing, {{"R", repeated("(", 100000)}}), "--set R=((");
  expect_one_fault(faults_of(kRing, {{"R", repeated("[", 100000)}}), "--set R=[[");
}

TEST(HostileInput, Junk) {
  std::mt19937 random(1);
  for (const int last_byte : {126, 255}) {
    std::string junk(5'000'000, '\0');
    for (char& c : junk) {
      c = static_cast<char>(
          std::uniform_int_distribution<int>(last_byte == 126 ? 33 : 0, last_byte)(random));
    }
    expect_one_fault(faults_of(junk), "ring.toml:1:");
  }
  expect_one_fault(faults_of(repeated("a", 5'000'000)), "ring.toml:1:");
  expect_one_fault(faults_of(std::string(1000, '\0')), "ring.toml:1:1: error: TOML syntax error");
  expect_one_fault(faults_of(replaced("a ring", std::string("a\0ring", 6))),
                   "ring.toml:2:10: error: ");
  expect_one_fault(faults_of(repeated("a", kLargestSceneFile + 1)),
                   "ring.toml:1:1: error: the file is too large; admissible: at most 16 MiB");
}

TEST(HostileInput, OtherEncodings) {
  const std::string why = "the file is not UTF-8 text";
  expect_one_fault(faults_of(replaced("a ring", "a r\xEFng")), "ring.toml:2:12: error: " + why);
  expect_one_fault(faults_of("# ok \xC3\xA4\n\xFF\xFE"), "ring.toml:2:1: error: " + why);
  expect_one_fault(faults_of(std::string("\xFF\xFE[\0r\0", 6)), "ring.toml:1:1: error: " + why);
  EXPECT_EQ(faults_of(replaced("a ring", "anneau \xC3\xA0 l'\xC3\xA9preuve")), "");
}

TEST(HostileInput, ManyFaultsAreCutShort) {
  std::string keys;
  for (int i = 0; i < 100000; ++i) keys += "unknown_" + std::to_string(i) + " = 1\n";
  const auto found = faults_of(replaced("pairs = \"all\"\n", keys));
  EXPECT_EQ(std::count(found.begin(), found.end(), '\n'), 201);
  EXPECT_NE(found.find("and more faults"), std::string::npos);
}

TEST(HostileInput, TooMuchOfEverything) {
  std::string parameters = "[parameters]\n";
  for (int i = 0; i <= 10000; ++i) parameters += "p" + std::to_string(i) + " = 1\n";
  expect_one_fault(faults_of(kRow + parameters),
                   "ring.toml:8:1: error: parameters: there are 10001; admissible: at most 10000");
  const auto bodies = repeated("[[body]]\n", 10001);
  expect_one_fault(
      faults_of(bodies + "[run]\nduration = 1\nintegrator = { type = \"euler\", dt = 1 }"),
      "ring.toml:1:1: error: body: there are 10001; admissible: at most 10000");
}

// Any single byte changed, taken out or doubled: a scene or faults, nothing else.
TEST(HostileInput, EveryMutationIsReadOrRefused) {
  const std::string text = kRing;
  std::mt19937 random(2);
  constexpr char kBytes[] = "\0\n\r\t \"'#=[]{}.,-+_09aeinx\\\x7f\x80\xff";
  const std::string bytes(kBytes, sizeof kBytes - 1);
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string changed = text;
    changed[i] = bytes[random() % bytes.size()];
    std::string shorter = text;
    shorter.erase(i, 1 + random() % 20);
    std::string doubled = text;
    doubled.insert(i, text.substr(i, random() % 40));
    for (const std::string& mutation : {changed, shorter, doubled, text.substr(0, i)}) {
      EXPECT_NO_THROW({
        const auto found = faults_of(mutation);
        EXPECT_TRUE(found.empty() || found.starts_with("ring.toml:")) << found;
      });
    }
  }
}

class Files : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = testing::TempDir() + "tomlin_files_" + std::to_string(getpid());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return folder_ + "/" + name; }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
  }
  std::string faults_reading(const std::string& file) const {
    try {
      (void)read_scene(file, components());
    } catch (const InputError& error) {
      return std::string(error.what()) + "\n";
    }
    return "";
  }

  std::string folder_;
};

TEST_F(Files, AreRead) {
  write("ring.toml", kRing);
  const auto scene = read_scene(path("ring.toml"), components());
  EXPECT_EQ(scene->file, path("ring.toml"));
  EXPECT_EQ(scene->effective_toml, parsed(kRing)->effective_toml);
}

TEST_F(Files, ThatCannotBeReadAreRefused) {
  write("empty.toml", "");
  write("plain", "x");
  write("large.toml", std::string(kLargestSceneFile + 1, '#'));
  expect_one_fault(faults_reading(path("none.toml")),
                   path("none.toml") + ":1:1: error: there is no such file");
  expect_one_fault(faults_reading(path("empty.toml")),
                   path("empty.toml") + ":1:1: error: the file is empty");
  expect_one_fault(faults_reading(folder_),
                   folder_ + ":1:1: error: a directory, where a file is expected");
  expect_one_fault(faults_reading(path("plain/scene.toml")),
                   path("plain/scene.toml") + ":1:1: error: ");
  expect_one_fault(faults_reading(path("large.toml")),
                   path("large.toml") + ":1:1: error: the file is too large");
  expect_one_fault(faults_reading("/dev/zero"),
                   "/dev/zero:1:1: error: a device or a socket, where a file is expected");
  expect_one_fault(faults_reading(""), ":1:1: error: there is no such file");
  EXPECT_NE(faults_reading(std::string(100000, 'a')).find(":1:1: error: the file cannot be read"),
            std::string::npos);
}

TEST_F(Files, WithoutPermissionAreRefused) {
  if (geteuid() == 0) GTEST_SKIP() << "the superuser may read everything";
  write("secret.toml", kRing);
  ASSERT_EQ(chmod(path("secret.toml").c_str(), 0), 0);
  expect_one_fault(faults_reading(path("secret.toml")),
                   path("secret.toml") + ":1:1: error: the file cannot be read: ");
}

}  // namespace
}  // namespace tomlin::test
