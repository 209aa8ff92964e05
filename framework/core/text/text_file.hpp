#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace tomlin {

/// Contents of a file, or the reason why it cannot be had.
struct TextFile {
  std::string text;
  std::string why;         ///< empty when the text is there, or too much of it
  bool too_large = false;  ///< there are more bytes than were allowed, and none of them is here
};

/// Never throws. Only regular files are opened: a pipe or a device may never end, or do something
/// when it is opened. One that is too large is not read.
TextFile read_text_file(const std::filesystem::path& path, std::size_t most_bytes);

}  // namespace tomlin
