#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "framework/run/run.hpp"

namespace tomlin {

/// The quantities that a run is asked for; all of them where nothing is said. A path is that of an
/// observable: "drivers.driver.mean_force.x". Its family may be left out, and its axis, since a
/// vector is reported as a whole. "drivers.mean_force" is that of all drivers.
class Selection {
 public:
  Selection() = default;
  explicit Selection(std::vector<std::string> paths) : paths_(std::move(paths)) {}

  bool is_all() const { return paths_.empty(); }
  /// A row of some group.
  bool wants(std::string_view key) const;
  /// A row of this one, whose name is empty where it is that of the whole run.
  bool wants(std::string_view family, std::string_view name, std::string_view key) const;
  /// Leaves those rows alone; what the scene's own observers give stays.
  void keep_rows(std::vector<ResultGroup>& groups) const;

 private:
  std::vector<std::string> paths_;
};

/// Returns what is asked of a run, by whoever runs it or by the scene, and what it needs itself.
Selection selection_of(const Scene& scene, const RunOptions& options);

}  // namespace tomlin
