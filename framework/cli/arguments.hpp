#pragma once

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
  std::optional<std::string> folder;
  bool force = false;
  bool quiet = false;
};

/// `tomlin describe [NAME] ...`
struct DescribeArguments {
  std::string name;  ///< empty: all components
  bool json = false;
};

/// `--help`, `--version`
struct TextToPrint {
  std::string text;
};

using Arguments = std::variant<RunArguments, DescribeArguments, TextToPrint>;

/// Throws InputError when the command line does not say anything that can be done.
Arguments parse_arguments(int argc, const char* const* argv);

}  // namespace tomlin
