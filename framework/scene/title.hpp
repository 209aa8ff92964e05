#pragma once

#include <filesystem>
#include <string>

#include "framework/scene/scene.hpp"
#include "framework/scene/text.hpp"

namespace tomlin {

/// Title of a scene in texts, on one line: its name, or else that of its file.
inline std::string title_of(const Scene& scene) {
  constexpr std::size_t kLongest = 200;  // bytes
  const std::string name =
      scene.name.empty() ? std::filesystem::path(scene.file).stem().string() : scene.name;
  return shortened(name, kLongest);
}

}  // namespace tomlin
