#include "framework/cli/new_plugin.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "framework/cli/new_file.hpp"
#include "framework/cli/printable.hpp"
#include "framework/cli/templates.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/standard_registry.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

/// "MyForce" of "my_force".
std::string class_name(std::string_view name) {
  std::string result;
  bool first = true;
  for (const char c : name) {
    if (c != '_') result += first ? static_cast<char>(std::toupper(c)) : c;
    first = c == '_';
  }
  return result;
}

/// The type of tomlin's own that the force's class, or what describes it, would be called like;
/// empty when there is none.
std::string own_type(const std::string& name) {
  for (const std::string& type : {class_name(name), class_name(name) + "Description"}) {
    if (std::find(core_types().begin(), core_types().end(), type) != core_types().end())
      return type;
  }
  return "";
}

/// CMake makes targets of these names by itself, so that a library cannot have them.
bool is_target_of_cmake(std::string_view name) {
  static const std::set<std::string_view> targets = {"all",        "clean",
                                                     "edit_cache", "help",
                                                     "install",    "list_install_components",
                                                     "package",    "package_source",
                                                     "preinstall", "rebuild_cache",
                                                     "test"};
  return targets.contains(name);
}

/// Refuses a name that files, a class of C++, a target of CMake or a scene do not take.
void check_name(const std::string& name) {
  const auto refuse = [&name](const std::string& why, const std::string& admissible) {
    refuse_input(FaultCode::command_invalid_value, "tomlin", "NAME",
                 fmt::format("\"{}\" {}", name, why), admissible);
  };
  constexpr std::size_t kLongestName = 60;
  const auto fits = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  };
  const bool valid = !name.empty() && name.size() <= kLongestName && name.front() >= 'a' &&
                     name.front() <= 'z' && name.back() != '_' &&
                     name.find("__") == std::string::npos &&
                     std::all_of(name.begin(), name.end(), fits);
  if (!valid) {
    refuse("is not a valid name of a force",
           "small letters, digits and single _, the first a letter: my_force");
  }
  if (is_target_of_cmake(name)) {
    refuse("is a built-in target of CMake, and the library could not be built",
           fmt::format("another name: {}_force", name));
  }
  if (const std::string type = own_type(name); !type.empty()) {
    refuse(fmt::format("would give the type {}, which tomlin has already", type),
           fmt::format("another name: my_{}", name));
  }
  const Registry registry = standard_registry();
  if (registry.body(name) || registry.force(name) || registry.integrator(name) ||
      registry.observer(name)) {
    refuse_input(FaultCode::command_invalid_value, "tomlin", "NAME",
                 fmt::format("tomlin has a built-in component \"{}\"", name), "another name");
  }
}

std::string with_names(std::string text, const std::string& name) {
  const auto replace = [&text](std::string_view from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos;
         at = text.find(from, at + to.size())) {
      text.replace(at, from.size(), to);
    }
  };
  replace("plugin_name", name);
  replace("PairPluginName", class_name(name));  // no name twice among the templates
  replace("PluginName", class_name(name));
  return text;
}

/// Makes it. It may be there when it is empty, or with --force.
void make_folder(const fs::path& folder, bool force) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error)) {
    refuse_input(FaultCode::file_invalid, "-o", folder.string(), "this is not a folder",
                 "another name");
  }
  if (fs::exists(folder, error) && !fs::is_empty(folder, error) && !force) {
    refuse_input(FaultCode::file_exists, "-o", folder.string(), "the folder is not empty",
                 "another name, or --force to replace the files of a plugin of this name");
  }
  fs::create_directories(folder, error);
  if (error) {
    refuse_input(FaultCode::file_cannot_write, "-o", folder.string(), error.message(),
                 "a folder that can be made");
  }
}

}  // namespace

int new_plugin(const std::optional<std::string>& given_name,
               const std::optional<std::string>& given_folder, NewForce kind, bool force) {
  if (!given_name) {
    refuse_input(FaultCode::command_missing_argument, "tomlin", "NAME",
                 "missing: what the force is called", "tomlin new plugin my_force");
  }
  const std::string& name = *given_name;
  check_name(name);
  const fs::path folder = given_folder.value_or(name);
  make_folder(folder, force);
  const auto& templates = kind == NewForce::pairs ? pair_plugin_templates() : plugin_templates();
  for (const PluginTemplate& one : templates) {
    write_new_file(folder / with_names(one.file, name), with_names(one.text, name));
  }
  const std::string where = folder.string();
  return print_result(fmt::format(
      "{0}: a force of your own, in {1}.hpp and {1}.cpp\n"
      "  cmake -S {0} -B {0}/build     finds tomlin where it is installed (CMAKE_PREFIX_PATH)\n"
      "  cmake --build {0}/build       makes {0}/lib{1}.so\n"
      "  ctest --test-dir {0}/build    verifies its declared properties and a closed form\n"
      "  tomlin run {0}/{1}.toml\n",
      where, name));
}

}  // namespace tomlin
