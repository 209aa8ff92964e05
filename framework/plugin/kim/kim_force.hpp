#pragma once

#include <memory>

#include "framework/core/records/bound_force.hpp"
#include "framework/plugin/kim/kim_model.hpp"

namespace tomlin::kim {

/// The model among all atoms of the bodies of a binding, in three dimensions.
std::unique_ptr<BoundForce<double>> bind_model(const KimModelDescription& description,
                                               const Binding<double>& binding);

}  // namespace tomlin::kim
