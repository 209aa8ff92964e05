#pragma once

#include <filesystem>

namespace tomlin {

/// Throws InputError where a file that -o names cannot be written: it is a folder, or there already
/// and not to be replaced.
void refuse_to_replace(const std::filesystem::path& file, bool force);

/// Throws InputError where no file can be written that `option` names: it, or
/// what it is written as, is a folder, or the folder around it is not there or may not be written
/// to.
void refuse_unwritable(const std::filesystem::path& file, const char* option = "-o");

}  // namespace tomlin
