#pragma once

#include <optional>
#include <vector>

#include "framework/core/system/scheme.hpp"
#include "framework/core/text/warning.hpp"
#include "framework/model/model.hpp"

namespace tomlin {

/// The integrals that drivers' mean forces and works, and works of energies that change with time,
/// are made of.
std::vector<WatchedIntegral> watched_integrals(const Model& model);

/// The velocity of each number of the state, [dofs], when all free bodies move with the fastest
/// steady driver; zeros where there is none.
std::vector<double> along_with_drivers(const Model& model);

/// A warning where rounding makes up more than a part `tolerance` of a driver's work over the
/// window. `rounding` is an energy.
std::optional<Warning> doubt_of_rounding(double rounding, double work, double tolerance);

}  // namespace tomlin
