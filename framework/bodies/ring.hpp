#pragma once

#include "framework/core/records/body.hpp"

/// Particles on a circle in the x-y plane: the ring of Sircar and Patra.
namespace tomlin {

struct RingDescription : BodyDescription {
  std::int64_t count = 0;
  double radius = 0.0;
  SpaceVector centre;
};

BodyRecord ring_record();

}  // namespace tomlin
