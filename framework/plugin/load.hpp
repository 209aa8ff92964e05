#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/core/records/registry.hpp"
#include "framework/core/text/fault.hpp"

/// Shared libraries with user-defined components: what the program does with those that a scene or
/// the command line names. See plugin.hpp for what one looks like, entry.hpp for how it is linked.
namespace tomlin {

/// A library that was asked for.
struct PluginRequest {
  std::string given;           ///< as it was written
  std::filesystem::path path;  ///< absolute
  SourceLocation location;     ///< where it was written
  bool everywhere = false;     ///< see Library
};

/// Contents of a library's file, or the reason why it cannot be loaded. Nothing of it is run.
struct PluginFile {
  std::string hash;  ///< of its content, where it could be read
  std::vector<std::string> number_types;
  std::string why;                                 ///< empty when it may be loaded
  FaultCode code = FaultCode::plugin_cannot_load;  ///< of `why`
};
PluginFile examine_plugin(const std::filesystem::path& path);

/// Paths of the libraries that this process has loaded, for a message on what comes from nobody
/// knows where.
const std::vector<std::string>& loaded_plugins();

/// Adds the components of these libraries, each once. Throws InputError with what is wrong with
/// any of them; the registry then has those of the others only.
void load_plugins(const std::vector<PluginRequest>& requests, Registry& registry);

}  // namespace tomlin
