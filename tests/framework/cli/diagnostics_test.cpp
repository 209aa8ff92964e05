#include <algorithm>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/framework/cli/cli_fixture.hpp"
#include "tests/support/paths.hpp"

// Codes of diagnostics: the table, the examples in it, and where codes are shown.

namespace tomlin::test {
namespace {

class Diagnostics : public Cli {
 protected:
  Json all_codes() {
    return Json::parse(tomlin({"describe", "diagnostics", "--json"}).out)["codes"];
  }
};

/// The summary has a code for each warning, this one among them.
void expect_warning(const Json& summary, const std::string& id) {
  const Json& codes = summary["warning_codes"];
  EXPECT_EQ(codes.size(), summary["warnings"].size());
  EXPECT_NE(std::find(codes.begin(), codes.end(), id), codes.end()) << id;
}

/// The words of a command line, without the quotes around some.
std::vector<std::string> words_of(const std::string& line) {
  std::vector<std::string> words(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '\'') {
      quoted = !quoted;
    } else if (c == ' ' && !quoted) {
      words.emplace_back();
    } else {
      words.back() += c;
    }
  }
  return words;
}

TEST_F(Diagnostics, TableIsComplete) {
  const std::regex form("[a-z_]+(\\.[a-z_]+)+");
  std::set<std::string> ids;
  const Json table = all_codes();
  EXPECT_GE(table.size(), 60U);
  for (const Json& row : table) {
    const auto id = row["name"].get<std::string>();
    EXPECT_TRUE(std::regex_match(id, form)) << id;
    EXPECT_TRUE(ids.insert(id).second) << id << " is there twice";
    EXPECT_TRUE(row["severity"] == "error" || row["severity"] == "warning") << id;
    for (const char* part : {"meaning", "cure"}) {
      const auto text = row[part].get<std::string>();
      EXPECT_TRUE(text.ends_with('.')) << id << ": " << text;
    }
    EXPECT_FALSE(row["example"].get<std::string>().empty()) << id;
  }
}

/// The script that draws is beside the program: not where the Python module is left out, as it is
/// under sanitizers.
bool draws() {
  return fs::exists(fs::path(paths::program).parent_path().parent_path() / "python/tomlin-plot");
}

TEST_F(Diagnostics, ExamplesGiveTheirCode) {
  ASSERT_EQ(tomlin({"new", "pt"}).status, 0);
  int errors = 0;
  int warnings = 0;
  for (const Json& row : all_codes()) {
    const auto id = row["name"].get<std::string>();
    const auto example = row["example"].get<std::string>();
    std::vector<std::string> words = words_of(example);
    if (words.front() != "tomlin") continue;
    words.erase(words.begin());
    const Ended ended = tomlin(words);
    const bool warns = row["severity"] == "warning";
    EXPECT_EQ(ended.status, warns ? 0 : id.starts_with("run.step.") ? 1 : 2) << example;
    const std::string& text = warns ? ended.out : ended.err;
    const std::string code = words.front() == "plot" && !draws() ? "plot.no_matplotlib" : id;
    EXPECT_TRUE(contains(text, " [" + code + "]\n")) << example << "\n" << text;
    if (fs::exists(folder_.path() / "pt.out") && warns) expect_warning(summary("pt.out"), id);
    fs::remove_all(folder_.path() / "pt.out");
    ++(warns ? warnings : errors);
  }
  EXPECT_GE(errors, 25);
  EXPECT_GE(warnings, 15);
}

/// Sources of all tests but this one.
std::string other_tests() {
  std::string text;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(paths::source) / "tests")) {
    const std::string name = entry.path().filename();
    if (name.ends_with(".cpp") && name != "diagnostics_test.cpp") text += content(entry.path());
  }
  return text;
}

/// A warning whose example is no command is expected by another test.
TEST_F(Diagnostics, EveryWarningIsRaisedByATest) {
  const std::string tests = other_tests();
  const auto is_expected = [&](std::string id) {
    const bool by_id = contains(tests, id + "]\"") || contains(tests, "\"" + id + "\"");
    std::replace(id.begin(), id.end(), '.', '_');
    return by_id || contains(tests, "FaultCode::" + id);
  };
  for (const Json& row : all_codes()) {
    if (row["severity"] != "warning") continue;
    const auto example = row["example"].get<std::string>();
    const auto id = row["name"].get<std::string>();
    EXPECT_TRUE(example.starts_with("tomlin ") || is_expected(id)) << id;
  }
  EXPECT_FALSE(is_expected("run.a_warning_that_no_test_names"));
}

TEST_F(Diagnostics, AreExplained) {
  const Ended one = expect_status(0, tomlin({"describe", "scene.unknown_key"}));
  expect_parts(one.out, {"meaning\n", "example\n  tomlin run pt.toml", "cure\n"});
  EXPECT_TRUE(one.out.starts_with("scene.unknown_key (error)\n")) << one.out;
  EXPECT_TRUE(tomlin({"describe", "run.few_slips"}).out.starts_with("run.few_slips (warning)\n"));
  const Json unstable = Json::parse(tomlin({"describe", "run.step.unstable", "--json"}).out);
  EXPECT_EQ(unstable["name"], "run.step.unstable");
  EXPECT_EQ(unstable["severity"], "error");
  const Ended misspelt = expect_status(2, tomlin({"describe", "scene.unknown_kee"}));
  EXPECT_TRUE(contains(misspelt.err, "did you mean \"scene.unknown_key\"?")) << misspelt.err;
}

TEST_F(Diagnostics, AreInTheJsonOfCheckAndExplain) {
  ASSERT_EQ(tomlin({"new", "pt"}).status, 0);
  for (const char* command : {"check", "explain"}) {
    const Ended ended =
        expect_status(2, tomlin({command, "pt.toml", "--json", "--set", "run.duration=-1"}));
    const Json faults = Json::parse(ended.out)["faults"];
    ASSERT_EQ(faults.size(), 1U) << command;
    EXPECT_EQ(faults[0]["code"], "scene.out_of_range");
    EXPECT_EQ(faults[0]["key"], "run.duration");
    EXPECT_EQ(faults[0]["value"], "-1");
    EXPECT_EQ(ended.err.empty(), std::string(command) == "check") << ended.err;
  }
}

}  // namespace
}  // namespace tomlin::test
