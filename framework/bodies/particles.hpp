#pragma once

#include "framework/core/records/body.hpp"

/// Particles anywhere: listed in the scene, or in a file of coordinates.
namespace tomlin {

struct ParticlesDescription : BodyDescription {
  PointList positions;
  std::string file;  ///< empty once its positions are fetched: see read_from
};

BodyRecord particles_record();

}  // namespace tomlin
