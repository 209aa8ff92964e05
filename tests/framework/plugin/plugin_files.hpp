#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>

#include "tests/framework/output/temporary_folder.hpp"
#include "tests/support/paths.hpp"

/// The libraries that CMakeLists.txt makes, and files that differ from them in a few bytes.
namespace tomlin::test {

inline std::filesystem::path plugin(const std::string& name) {
  return std::filesystem::path(paths::plugins) / ("lib" + name + ".so");
}

inline std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text));
}

/// The first `from` in a text replaced by as many bytes.
inline std::string patched(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  if (at == std::string::npos || from.size() != to.size()) {
    throw std::invalid_argument("there is no \"" + from + "\" to replace");
  }
  return text.replace(at, from.size(), to);
}

}  // namespace tomlin::test
