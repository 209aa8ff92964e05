#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace tomlin {

/// What stands in a file, or why it cannot be had.
struct TextFile {
  std::string text;
  std::string why;  ///< empty when the text is there
};

/// Never throws. Of a file that is larger than `most_bytes` one byte more is read, so that the
/// excess is noticed; a device may never end.
TextFile read_text_file(const std::filesystem::path& path, std::size_t most_bytes);

}  // namespace tomlin
