#include "framework/run/results/selection.hpp"

#include <algorithm>
#include <initializer_list>
#include <utility>

namespace tomlin {
namespace {

/// "a.b" of "a.b.x".
std::string_view without_axis(std::string_view path) {
  for (const std::string_view axis : {".x", ".y", ".z"}) {
    if (path.ends_with(axis)) return path.substr(0, path.size() - axis.size());
  }
  return path;
}

/// Whether a path is these parts with dots between them.
bool is_joined(std::string_view path, std::initializer_list<std::string_view> parts) {
  bool first = true;
  for (const std::string_view part : parts) {
    if (!std::exchange(first, false)) {
      if (!path.starts_with('.')) return false;
      path.remove_prefix(1);
    }
    if (!path.starts_with(part)) return false;
    path.remove_prefix(part.size());
  }
  return path.empty();
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
  return std::any_of(paths_.begin(), paths_.end(), [&](std::string_view path) {
    const std::string_view row = without_axis(path);
    if (is_joined(row, {family, key})) return true;
    if (name.empty()) return row == key;
    return is_joined(row, {family, name, key}) || is_joined(row, {name, key});
  });
}

void Selection::keep_rows(std::vector<ResultGroup>& groups) const {
  if (is_all()) return;
  for (ResultGroup& group : groups) {
    // The scene's own observers were asked for by their tables.
    if (group.family == "observers") continue;
    std::erase_if(group.values, [&](const ResultValue& value) {
      return !wants(group.family, group.name, value.quantity().key);
    });
  }
  std::erase_if(groups, [](const ResultGroup& group) { return group.values.empty(); });
}

Selection selection_of(const Scene& scene, const RunOptions& options) {
  std::vector<std::string> paths =
      options.observables.empty() ? scene.measure.observables : options.observables;
  if (paths.empty()) return {};
  if (scene.run.until) paths.push_back(scene.run.until->observable());
  if (scene.run.perturb) {
    const std::vector<std::string>& more = scene.run.perturb->observables;
    paths.insert(paths.end(), more.begin(), more.end());
  }
  return Selection(std::move(paths));
}

}  // namespace tomlin
