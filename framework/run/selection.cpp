#include "framework/run/selection.hpp"

#include <algorithm>

namespace tomlin {
namespace {

/// "a.b" of "a.b.x".
std::string_view without_axis(std::string_view path) {
  for (const std::string_view axis : {".x", ".y", ".z"}) {
    if (path.ends_with(axis)) return path.substr(0, path.size() - axis.size());
  }
  return path;
}

}  // namespace

bool Selection::wants(std::string_view key) const {
  return is_all() || std::any_of(paths_.begin(), paths_.end(), [&](std::string_view path) {
           const std::string_view row = without_axis(path);
           return row.substr(row.rfind('.') + 1) == key;
         });
}

bool Selection::wants(std::string_view family, std::string_view name, std::string_view key) const {
  if (is_all()) return true;
  const std::string of_name =
      name.empty() ? std::string(key) : std::string(name) + "." + std::string(key);
  const std::string full = std::string(family) + "." + of_name;
  const std::string of_all = std::string(family) + "." + std::string(key);
  return std::any_of(paths_.begin(), paths_.end(), [&](std::string_view path) {
    const std::string_view row = without_axis(path);
    return row == full || row == of_name || row == of_all;
  });
}

}  // namespace tomlin
