#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "framework/core/records/parameter.hpp"

namespace tomlin {

/// What a file of positions says, or the faults that keep it from being read.
struct PositionFile {
  PointList positions;
  std::vector<std::string> faults;  ///< "NAME:LINE: why", by line; of many the first ones
};

/// One particle per line, one column per dimension, columns apart by spaces, tabs or one comma;
/// `#` begins a comment, blank lines do not count. `name` stands in messages.
PositionFile parse_positions(std::string_view text, const std::string& name);

}  // namespace tomlin
