#pragma once

#include <cstddef>
#include <optional>

#include "framework/model/model.hpp"

/// Wells of the potential energy under a body that a spring pulls along one axis.
namespace tomlin {

/// Whether all forces but the spring hold the body more strongly than the spring pulls it:
/// somewhere along a period, at the start or later, their energy is concave by more than the
/// stiffness of the spring, so that the body is in one well or another (stick-slip parameter above
/// 1). Then the way along the pull from where the body is to a well. Nothing where the body has
/// other degrees of freedom than its place.
std::optional<double> way_to_well(Model& model, std::size_t body, const Model::Driver& driver,
                                  double period, double duration);

}  // namespace tomlin
