#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "framework/run/results/results.hpp"

namespace tomlin::test {

/// A group with every row of its family in so many dimensions: these values, the rest undefined.
inline ResultGroup group_of(
    std::string_view family, const std::string& name, std::size_t axes,
    const std::vector<std::pair<std::string, std::vector<double>>>& values) {
  ResultGroup group = {std::string(family), name, {}};
  for (const ResultFamily& one : result_families()) {
    if (one.family != family) continue;
    for (const ResultQuantity& row : one.quantities) {
      const bool turns = row.key == "rotation" || row.key == "turns" || row.key == "rolling";
      if (family == "bodies" && turns && axes != 2) continue;
      ResultValue& added = group.add_row(row, axes);
      for (const auto& [key, numbers] : values) {
        if (key == row.key) added.set(numbers);
      }
    }
  }
  return group;
}

}  // namespace tomlin::test
