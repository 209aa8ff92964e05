#pragma once

#include "framework/core/records/body.hpp"

/// One particle: the tip of Prandtl and Tomlinson.
namespace tomlin {

struct PointDescription : BodyDescription {
  SpaceVector position;
};

BodyRecord point_record();

}  // namespace tomlin
