#pragma once

#include <optional>
#include <string>

namespace tomlin {

/// Elements that the force of a new plugin acts on.
enum class NewForce { particles, pairs };

/// `tomlin new plugin NAME [--pairs] [-o DIR]`: a folder with a force to start from. Throws
/// InputError and OutputError.
int new_plugin(const std::optional<std::string>& given_name,
               const std::optional<std::string>& given_folder, NewForce kind, bool force);

}  // namespace tomlin
