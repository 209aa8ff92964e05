#pragma once

#include <cstddef>
#include <optional>

#include "framework/model/model.hpp"

/// Wells of the potential energy under a body that a spring pulls along one axis.
namespace tomlin {

/// The displacement along the pull from where a body is to a well. `known`: the body has no degrees
/// of freedom but its position along the pull and across it, so that its other wells lie whole
/// periods further on. Else its particles may pass one by one, or it may turn on its way.
struct WellOfBody {
  double distance = 0.0;
  bool known = false;
};

/// Whether all forces but the spring hold the body more strongly than the spring pulls it: when it
/// is moved as it is, their energy is concave by more than the stiffness of the spring somewhere
/// along a period, at the time `since`, whose state the model has, or later, so that it is in one
/// well or another (stick-slip parameter above 1). Nothing where it is not.
std::optional<WellOfBody> well_of_body(Model& model, std::size_t body, const Model::Driver& driver,
                                       double period, const DoubleDouble& since, double duration);

}  // namespace tomlin
