#pragma once

#include "framework/core/records/body.hpp"
#include "framework/core/text/axis_names.hpp"

/// Equally spaced particles on a straight line: the chain of Frenkel and Kontorova.
namespace tomlin {

struct ChainDescription : BodyDescription {
  std::int64_t count = 0;
  double spacing = 0.0;
  SpaceVector origin;
  Axis axis = Axis::x;
};

BodyRecord chain_record();

}  // namespace tomlin
