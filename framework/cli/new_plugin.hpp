#pragma once

#include <optional>
#include <string>

namespace tomlin {

/// `tomlin new plugin NAME [-o DIR]`: a folder with a force to start from. Throws InputError and
/// OutputError.
int new_plugin(const std::optional<std::string>& given_name,
               const std::optional<std::string>& given_folder, bool force);

}  // namespace tomlin
