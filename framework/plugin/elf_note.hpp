#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace tomlin {

/// tomlin's note in a shared library, or why there is none to be had.
struct ElfNote {
  std::string text;
  std::string why;  ///< empty when the text is there
};

/// Reads the bytes of a file of any content; they are not loaded, and nothing in them is trusted.
ElfNote read_elf_note(std::span<const std::byte> file);

}  // namespace tomlin
