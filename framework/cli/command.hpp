#pragma once

#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include <CLI/CLI.hpp>

#include "framework/cli/options.hpp"

/// The commands of the program. Each stands in a file of its own, NAME_command.cpp: its arguments,
/// its options and their help, and what it does. commands.cpp lists them.
namespace tomlin {

/// A command whose options a parser knows.
struct DeclaredCommand {
  /// Called once the options have been read. Throws InputError where they contradict each other.
  std::function<void()> check;
  /// Called after `check`. Returns the exit status. Throws InputError, OutputError.
  std::function<int()> run;
};

/// Record of a command, which it declares about itself.
struct CommandRecord {
  std::string name;
  std::string summary;  ///< a line of `tomlin --help`
  std::string footer;   ///< below the options in `tomlin NAME --help`, with examples
  /// Adds the options to the command's parser, which may be used as long as what is returned lives.
  std::function<DeclaredCommand(CLI::App&)> declare;
};

/// For `declare`: a command whose options are read into `Arguments`. `check` may be null; the
/// values of --set are read after it.
template <class Arguments>
auto declared(void (*add_options)(CLI::App&, Arguments&), void (*check)(Arguments&),
              int (*run)(const Arguments&)) {
  return [=](CLI::App& parser) {
    const auto arguments = std::make_shared<Arguments>();
    add_options(parser, *arguments);
    const auto check_all = [=] {
      if (check != nullptr) check(*arguments);
      if constexpr (std::is_base_of_v<SettingOptions, Arguments>) read_settings(*arguments);
    };
    return DeclaredCommand{check_all, [=] { return run(*arguments); }};
  };
}

/// All, in the order of `tomlin --help`.
std::vector<CommandRecord> commands();

}  // namespace tomlin
