#pragma once

#include <cstddef>

#include "framework/model/model.hpp"
#include "framework/model/scales.hpp"

namespace tomlin {

/// Adds what drivers pull over a periodic force, for each body under it and each axis.
/// `substrate_in_scene` counts in Scene::forces.
void add_sliding(Scales& scales, Model& model, std::size_t substrate_in_scene,
                 const Model::Force& substrate);

}  // namespace tomlin
