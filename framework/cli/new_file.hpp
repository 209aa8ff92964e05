#pragma once

#include <filesystem>

namespace tomlin {

/// Throws InputError where a file that -o names cannot be written: it is a folder, or there already
/// and not to be replaced.
void refuse_to_replace(const std::filesystem::path& file, bool force);

}  // namespace tomlin
