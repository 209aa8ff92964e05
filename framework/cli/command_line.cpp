#include "framework/cli/command_line.hpp"

#include <algorithm>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "framework/cli/command.hpp"
#include "framework/cli/options.hpp"
#include "framework/cli/printable.hpp"
#include "framework/core/system/instruction_set.hpp"
#include "framework/core/text/nearest_name.hpp"

namespace tomlin {
namespace {

constexpr const char* kVersion = "tomlin " TOMLIN_VERSION;

constexpr const char* kProgramFooter = R"(
A first run. Write this to pt.toml, the Prandtl-Tomlinson model:

  [parameters]
  v = 1e-2

  [[body]]
  type = "point"
  position = [0.5]                 # in a well: x = 0 is a maximum of the substrate
  particle_mass = 1.0

  [[force]]
  type = "driving_spring"
  stiffness = 2.0
  velocity = ["v"]

  [[force]]
  type = "viscous_damping"
  coefficient = 2.0

  [[force]]
  type = "sinusoidal_substrate"
  amplitude = 0.1
  period = 1.0

  [run]
  duration = 1000.0
  integrator = { type = "rk4", dt = 1e-2 }

  [output]
  every = 1.0

and type

  tomlin run pt.toml

The mean lateral force is printed; pt.out/ then holds summary.json with all results,
observables.csv with the friction trace, and scene.toml, the scene with every default filled in.

  tomlin run --help            how to change parameters and choose the folder
  tomlin explain pt.toml       its scales, its regime, the stable step, what a run costs
  tomlin check pt.toml         validates the scene and verifies what its forces declare
  tomlin new pt|fk|ring        a commented scene to start from
  tomlin describe expression   a user-defined force as a formula in the scene
  tomlin new plugin NAME       a user-defined force in C++, with its test
  tomlin describe              the bodies, forces, integrators and observers
  tomlin describe NAME         one of them: equation, source, parameters, an example
  tomlin schema                with which editors complete and check scenes
  tomlin plot pt.out -o a.svg  the friction trace
  tomlin sweep pt.toml --over v=1e-4:1e-1:31:log --observable driver.mean_force.x
                               many runs over values of parameters, a table of results
  tomlin tradeoff pt.toml --observable driver.mean_force.x
                               measure the cost of accuracy and find the cheapest setting

Exit status: 0 done; 1 a run or a check failed; 2 invalid input; nothing was done.)";

/// CLI11 has one kind of error for too few values and for too many.
FaultCode code_of(const CLI::ParseError& error) {
  const std::string_view text = error.what();
  switch (static_cast<CLI::ExitCodes>(error.get_exit_code())) {
    case CLI::ExitCodes::RequiredError:
    case CLI::ExitCodes::RequiresError:
      return FaultCode::command_missing_argument;
    case CLI::ExitCodes::ExcludesError:
      return FaultCode::command_conflict;
    case CLI::ExitCodes::ArgumentMismatch:
      return text.ends_with("missing") || text.find("least") != std::string_view::npos
                 ? FaultCode::command_missing_argument
                 : FaultCode::command_invalid_value;
    default:
      return FaultCode::command_invalid_value;
  }
}

bool is_option(std::string_view word) { return word.size() > 1 && word.front() == '-'; }

std::vector<std::string> names_of(const std::vector<CommandRecord>& records) {
  std::vector<std::string> names;
  names.reserve(records.size());
  for (const CommandRecord& record : records) names.push_back(record.name);
  return names;
}

std::string all_commands() {
  return fmt::format("{}; tomlin --help tells more", fmt::join(names_of(commands()), ", "));
}

/// Refuses a word that is no command.
void check_word(std::string_view word) {
  const std::vector<std::string> names = names_of(commands());
  if (std::find(names.begin(), names.end(), word) != names.end()) return;
  refuse_command(FaultCode::command_unknown, fmt::format("there is no command \"{}\"", word),
                 all_commands(), nearest_name(word, names).value_or(""));
}

/// An option without a command: of the program itself.
void check_option(std::string_view word) {
  static const std::vector<std::string> names = {"-h", "--help", "--version"};
  if (std::find(names.begin(), names.end(), word) != names.end()) return;
  refuse_command(FaultCode::command_unknown_option, fmt::format("tomlin has no option {}", word),
                 "tomlin --help shows them", nearest_name(word, names).value_or(""));
}

/// The command line as CLI11 sees it.
class CommandLine {
 public:
  CommandLine() {
    app_.set_help_flag("-h,--help", "print this help and exit");
    app_.set_version_flag("--version", kVersion, "print the version and exit");
    app_.get_formatter()->column_width(28);
    app_.require_subcommand(1);
    app_.footer(kProgramFooter);
    for (const CommandRecord& record : commands()) {
      CLI::App* parser = app_.add_subcommand(record.name, record.summary);
      parser->footer(record.footer);
      declared_.emplace_back(parser, record.declare(*parser));
    }
  }

  std::function<int()> parse(int argc, const char* const* argv) {
    try {
      app_.parse(argc, argv);
    } catch (const CLI::CallForHelp&) {
      return [text = app_.help()] { return print_result(text); };
    } catch (const CLI::CallForVersion&) {
      return [] { return print_result(std::string(kVersion) + "\n"); };
    } catch (const CLI::ExtrasError&) {
      refuse_extras();
    } catch (const CLI::ParseError& error) {
      refuse_command(code_of(error),
                     fmt::format("{} ({} --help tells more)", error.what(), name_of(chosen())));
    }
    refuse_empty_plugins(chosen());
    for (const auto& [parser, command] : declared_) {
      if (!app_.got_subcommand(parser)) continue;
      command.check();
      return [run = command.run] {
        chosen_instruction_set();  // before anything is made for it
        return run();
      };
    }
    // CLI11 also takes what follows "--" for a command.
    check_word(chosen().get_name());
    return nullptr;
  }

 private:
  const CLI::App& chosen() const {
    const auto subcommands = app_.get_subcommands();
    return subcommands.empty() ? app_ : *subcommands.back();
  }

  std::string name_of(const CLI::App& app) const {
    return &app == &app_ ? "tomlin" : "tomlin " + app.get_name();
  }

  /// Refuses the arguments left over, which stand before the command or after it.
  [[noreturn]] void refuse_extras() const {
    const CLI::App& app = app_.remaining().empty() ? chosen() : app_;
    const auto extras = app.remaining();
    const std::string word = extras.empty() ? "" : extras.front();
    const bool takes_settings = app.get_option_no_throw("--set") != nullptr;
    if (takes_settings && !is_option(word) && word.find('=') != std::string::npos) {
      refuse_command(FaultCode::command_unknown_option,
                     fmt::format("\"{}\" is not preceded by --set", word), "--set " + word);
    }
    if (!is_option(word)) {
      refuse_command(FaultCode::command_unknown_option,
                     fmt::format("{} does not expect \"{}\" ({} --help tells more)", name_of(app),
                                 word, name_of(app)));
    }
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options()) {
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
    const std::string name = word.substr(0, word.find('='));
    std::string admissible = name_of(app) + " --help shows them";
    if (takes_settings) admissible += "; values of the scene are given by --set PATH=VALUE";
    refuse_command(FaultCode::command_unknown_option,
                   fmt::format("{} has no option {}", name_of(app), name), admissible,
                   nearest_name(name, names).value_or(""));
  }

  CLI::App app_{"Nanoscale friction models from plain scene files.", "tomlin"};
  std::vector<std::pair<CLI::App*, DeclaredCommand>> declared_;
};

}  // namespace

std::function<int()> parse_command_line(int argc, const char* const* argv) {
  if (argc < 2) {
    refuse_command(FaultCode::command_missing_argument, "a command is missing", all_commands());
  }
  // `tomlin help run` is `tomlin run --help`.
  if (argv[1] == std::string_view("help")) {
    std::vector<const char*> words = {argv[0]};
    if (argc > 2) words.push_back(argv[2]);
    words.push_back("--help");
    return parse_command_line(static_cast<int>(words.size()), words.data());
  }
  if (!is_option(argv[1])) {
    check_word(argv[1]);
  } else if (argc == 2) {
    check_option(argv[1]);
  }
  return CommandLine().parse(argc, argv);
}

}  // namespace tomlin
