#pragma once

#include <memory>

#include "framework/core/records/number_type.hpp"
#include "framework/core/system/scheme.hpp"
#include "framework/model/model.hpp"

/// `[run] number_type`: the numbers that the state is held in. Whoever looks on sees doubles.
namespace tomlin {

/// The scheme on the model itself for "double". For "quadruple" the scene is bound a
/// second time, in that type, and does the stepping; after each step the model gets its numbers.
/// Throws InputError when a force or the scheme is not available in that type.
std::unique_ptr<Integrator<double>> integrator_in(NumberType number_type, Model& model,
                                                  const void* description,
                                                  const IntegratorRecord& scheme);

}  // namespace tomlin
