#include "framework/cli/options.hpp"

#include <cmath>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "framework/core/text/fault.hpp"

namespace tomlin {

void add_repeatable_option(CLI::App& parser, const std::string& name,
                           std::vector<std::string>& values, const std::string& kind,
                           const std::string& help) {
  parser.add_option(name, values, help)
      ->type_name(kind)
      ->option_text(kind + " ...")
      ->allow_extra_args(false);
}

void add_plugin_option(CLI::App& parser, std::vector<std::string>& plugins) {
  add_repeatable_option(parser, "--plugin", plugins, "LIB",
                        "more components, from a shared library");
}

void add_setting_options(CLI::App& parser, SettingOptions& options) {
  add_repeatable_option(parser, "--set", options.given_settings, "PATH=VALUE",
                        "replace a parameter or any value of the scene");
  add_plugin_option(parser, options.plugins);
}

void add_scene_options(CLI::App& parser, SceneOptions& options) {
  parser.add_option("SCENE", options.scene, "the scene, a TOML file")->option_text(" ")->required();
  add_setting_options(parser, options);
}

void add_observable_option(CLI::App& parser, std::string& observable) {
  parser.add_option("--observable", observable, "a dotted path in summary.json")
      ->type_name("O")
      ->required();
}

CLI::Option* add_output_option(CLI::App& parser, std::optional<std::string>& output,
                               const char* kind, const std::string& help) {
  return parser.add_option("-o,--output", output, help)->type_name(kind);
}

CLI::Option* add_json_option(CLI::App& parser, bool& json) {
  return parser.add_flag("--json", json, "as JSON");
}

std::string folder_or_default(const std::optional<std::string>& given, const std::string& scene,
                              const std::string& suffix) {
  return given ? *given : std::filesystem::path(scene).stem().string() + suffix;
}

void refuse_command(FaultCode code, std::string why, std::string admissible, std::string nearest) {
  refuse_input(code, "tomlin", "", std::move(why), std::move(admissible), std::move(nearest));
}

void read_settings(SettingOptions& options) {
  std::vector<Fault> faults;
  for (const std::string& text : options.given_settings) {
    const auto equals = text.find('=');
    if (equals == std::string::npos) {
      faults.emplace_back(FaultCode::command_missing_argument, SourceLocation{"--set"},
                          text.empty() ? "\"\"" : text, "", "no value", "PATH=VALUE");
      continue;
    }
    options.settings.push_back({text.substr(0, equals), text.substr(equals + 1)});
  }
  if (!faults.empty()) throw InputError(std::move(faults));
}

void refuse_empty_plugins(const CLI::App& parser) {
  const CLI::Option* option = parser.get_option_no_throw("--plugin");
  if (option == nullptr) return;
  for (const std::string& name : option->results()) {
    if (name.empty()) {
      refuse_command(FaultCode::command_invalid_value, "--plugin is empty",
                     "the file of a shared library");
    }
  }
}

void refuse_empty(const std::optional<std::string>& given, const char* option) {
  if (given && given->empty()) {
    refuse_command(FaultCode::command_invalid_value, fmt::format("{} is empty", option));
  }
}

void refuse_unless_positive(double number, const char* option) {
  if (!std::isfinite(number) || number <= 0.0) {
    refuse_command(FaultCode::command_invalid_value, fmt::format("{} is {:g}", option, number),
                   "> 0");
  }
}

}  // namespace tomlin
