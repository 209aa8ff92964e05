#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "framework/scene/scene.hpp"

/// The command line: what was asked for.
namespace tomlin {

/// `tomlin run SCENE ...`
struct RunArguments {
  std::string scene;
  std::vector<Setting> settings;
  std::vector<std::string> plugins;
  std::optional<std::string> folder;
  bool resume = false;
  bool force = false;
  bool quiet = false;
};

/// `tomlin tradeoff SCENE --observable O ...`
struct TradeoffArguments {
  std::string scene;
  std::vector<Setting> settings;
  std::vector<std::string> plugins;
  std::string observable;
  double tolerance = 1e-3;
  double budget = 60.0;              ///< seconds
  std::optional<std::string> write;  ///< a scene file to be made
  std::optional<std::string> folder;
  bool force = false;
};

/// `tomlin compare A B ... --observable O ...`
struct CompareArguments {
  std::vector<std::string> scenes;
  std::vector<Setting> settings;
  std::vector<std::string> plugins;
  std::string observable;
  double tolerance = 1e-2;
  std::optional<std::string> folder;
  bool force = false;
};

/// `tomlin explain SCENE ...`
struct ExplainArguments {
  std::string scene;
  std::vector<Setting> settings;
  std::vector<std::string> plugins;
  bool json = false;
};

/// `tomlin check SCENE ...`
struct CheckArguments {
  std::string scene;
  std::vector<Setting> settings;
  std::vector<std::string> plugins;
  bool json = false;
  bool verbose = false;    ///< what holds, too
  std::uint64_t seed = 1;  ///< of the random states that claims are looked at
};

/// `tomlin new MODEL [NAME] ...`
struct NewArguments {
  std::string model;                ///< "pt", "fk", "ring", "plugin"
  std::optional<std::string> name;  ///< of the file, without .toml; of the force
  std::optional<std::string> file;  ///< instead of the name; the folder of a plugin
  bool force = false;
};

/// `tomlin describe [NAME] ...`
struct DescribeArguments {
  std::string name;  ///< empty: all components
  std::vector<std::string> plugins;
  bool json = false;
  bool markdown = false;
  std::optional<std::string> folder;  ///< for the reference pages
  bool force = false;
};

/// `tomlin schema ...`
struct SchemaArguments {
  std::optional<std::string> file;  ///< standard output without it
  std::vector<std::string> plugins;
  bool of_summary = false;
  bool force = false;
};

/// `tomlin plot DIR... [WHAT] ...`
struct PlotArguments {
  std::vector<std::string> words;  ///< DIRs and WHAT
  std::string file;
  std::string x;                            ///< empty: WHAT's own
  std::vector<std::vector<std::string>> y;  ///< panels; empty: WHAT's own
  std::optional<double> from;
  std::optional<double> to;
  std::vector<double> at;
  std::string driver;  ///< empty: the only one
  std::string body;
  std::string title;
  std::vector<std::string> labels;  ///< one for each DIR; empty: by what differs
};

/// `--help`, `--version`
struct TextToPrint {
  std::string text;
};

using Arguments = std::variant<RunArguments, TradeoffArguments, CompareArguments, ExplainArguments,
                               CheckArguments, NewArguments, DescribeArguments, SchemaArguments,
                               PlotArguments, TextToPrint>;

/// Throws InputError when the command line does not say anything that can be done.
Arguments parse_arguments(int argc, const char* const* argv);

}  // namespace tomlin
