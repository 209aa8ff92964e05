#pragma once

#include <optional>

#include "framework/model/single_force.hpp"

/// The length on which a force changes, by looking.
namespace tomlin::properties {

/// About a wavelength of the force near its start, or some decay lengths of it; nothing where it is
/// as good as cubic at all lengths, or at none. With `declared` (0: none) only lengths well below
/// it are looked for.
std::optional<double> length_of(SingleForce& alone, double declared);

}  // namespace tomlin::properties
