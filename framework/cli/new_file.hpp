#pragma once

#include <filesystem>
#include <string_view>

namespace tomlin {

/// Throws InputError where a file that -o names cannot be written: it is a folder, or there already
/// and not to be replaced.
void refuse_to_replace(const std::filesystem::path& file, bool force);

/// Throws InputError where no file can be written that `option` names: it, or the unfinished file
/// beside it, is a folder, or the folder around it is not there or may not be written to.
void refuse_unwritable(const std::filesystem::path& file, const char* option = "-o");

/// Writes a file whole or not at all. Throws OutputError.
void write_new_file(const std::filesystem::path& file, std::string_view text);

}  // namespace tomlin
