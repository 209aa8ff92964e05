#pragma once

#include <cstdint>

#include "framework/model/model.hpp"

namespace tomlin {

/// The time after which a scene with friction begins to forget a disturbance of its start, and
/// starts that differ have become one state; 0 where it never does.
double memory_of_disturbances(Model& model);

/// Noise on the free coordinates of the bodies that are disturbed, as at the start; `moment` tells
/// one time from another.
void disturb(const Perturbation& noise, std::uint64_t moment, Model& model);

}  // namespace tomlin
