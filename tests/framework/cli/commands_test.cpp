#include <algorithm>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <gtest/gtest.h>

#include "framework/cli/command.hpp"
#include "tests/framework/cli/cli_fixture.hpp"

/// Tests of everything that the program derives from the records of its commands.
namespace tomlin::test {
namespace {

/// A line of the program's help that lists a command.
bool lists(const std::string& help, const CommandRecord& record) {
  const auto begin = help.find("\n  " + record.name + " ");
  if (begin == std::string::npos) return false;
  return contains(help.substr(begin, help.find('\n', begin + 1) - begin), "  " + record.summary);
}

/// Lists the parts that a record lacks; empty when it is complete.
std::vector<std::string> missing_in(const CommandRecord& record, const std::string& help) {
  std::vector<std::string> missing;
  if (record.summary.empty() || contains(record.summary, "\n")) missing.push_back("summary");
  if (!contains(record.footer, "\n  tomlin " + record.name + " ")) missing.push_back("example");
  if (!lists(help, record)) missing.push_back("line of the help");
  CLI::App parser;
  const DeclaredCommand command = record.declare(parser);
  if (!command.check || !command.run) missing.push_back("action");
  const auto options = parser.get_options();
  const auto described = [](const auto* option) { return !option->get_description().empty(); };
  if (!std::all_of(options.begin(), options.end(), described)) missing.push_back("description");
  return missing;
}

TEST_F(Cli, RecordsOfCommandsAreComplete) {
  const std::string help = tomlin({"--help"}).out;
  EXPECT_GE(commands().size(), 9U);
  for (const CommandRecord& record : commands()) {
    EXPECT_EQ(missing_in(record, help), std::vector<std::string>{}) << record.name;
    const std::string own = tomlin({record.name, "--help"}).out;
    expect_parts(own, {record.summary, record.footer});
  }
}

TEST_F(Cli, IncompleteRecordsAreSeen) {
  const std::string help = tomlin({"--help"}).out;
  const CommandRecord run = commands().front();
  CommandRecord wrong = run;
  wrong.summary += "\nin two lines";
  EXPECT_EQ(missing_in(wrong, help), (std::vector<std::string>{"summary", "line of the help"}));
  wrong = run;
  wrong.footer = "\nExamples:\n\n  tomlin explain pt.toml";
  EXPECT_EQ(missing_in(wrong, help), std::vector<std::string>{"example"});
  wrong = run;
  wrong.declare = [](CLI::App& parser) {
    parser.add_flag("--quiet");
    return DeclaredCommand{};
  };
  EXPECT_EQ(missing_in(wrong, help), (std::vector<std::string>{"action", "description"}));
}

TEST_F(Cli, NearlyACommandIsSuggested) {
  std::string all = "expected: ";
  for (const CommandRecord& record : commands()) all += record.name + ", ";
  all.replace(all.size() - 2, 2, ";");
  for (const CommandRecord& record : commands()) {
    const std::string misspelt = record.name + record.name.back();
    expect_refused({misspelt}, "tomlin: [command.unknown] did you mean " + record.name + "\n",
                   {all});
  }
}

}  // namespace
}  // namespace tomlin::test
