#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "framework/cli/plugins.hpp"
#include "framework/core/text/fault_code.hpp"
#include "framework/scene/scene.hpp"
#include "framework/scene/scene_document.hpp"

/// Options that several commands have, under the same names, and the checks of their values.
namespace tomlin {

/// --set and --plugin
struct SettingOptions {
  std::vector<std::string> given_settings;  ///< "PATH=VALUE" each
  std::vector<Setting> settings;            ///< the same after read_settings()
  std::vector<std::string> plugins;
};

/// SCENE, --set and --plugin
struct SceneOptions : SettingOptions {
  std::string scene;
};

/// The scene of a command, with the components that it may use.
struct OpenedScene {
  /// Throws InputError.
  explicit OpenedScene(const SceneOptions& options)
      : document(options.scene),
        registry(registry_with_plugins(options.plugins, {&document, 1})),
        scene(document.read(registry, options.settings)) {}

  SceneDocument document;
  Registry registry;
  std::shared_ptr<const Scene> scene;
};

/// An option that may be given any number of times, with a value of this kind ("LIB") each.
void add_repeatable_option(CLI::App& parser, const std::string& name,
                           std::vector<std::string>& values, const std::string& kind,
                           const std::string& help);
void add_plugin_option(CLI::App& parser, std::vector<std::string>& plugins);
void add_setting_options(CLI::App& parser, SettingOptions& options);
void add_scene_options(CLI::App& parser, SceneOptions& options);
void add_observable_option(CLI::App& parser, std::string& observable);
/// -o, a folder or a file of that kind ("DIR", "FILE").
CLI::Option* add_output_option(CLI::App& parser, std::optional<std::string>& output,
                               const char* kind, const std::string& help);
CLI::Option* add_json_option(CLI::App& parser, bool& json);

/// -o as it was given, or else the stem of the scene's file with this suffix.
std::string folder_or_default(const std::optional<std::string>& given, const std::string& scene,
                              const std::string& suffix);

/// A fault of the command line. Throws InputError.
[[noreturn]] void refuse_command(FaultCode code, std::string why, std::string admissible = "",
                                 std::string nearest = "");

/// Throw InputError.
void read_settings(SettingOptions& options);
void refuse_empty_plugins(const CLI::App& parser);
void refuse_empty(const std::optional<std::string>& given, const char* option);
void refuse_unless_positive(double number, const char* option);

}  // namespace tomlin
