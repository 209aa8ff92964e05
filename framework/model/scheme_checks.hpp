#pragma once

#include <string>

#include "framework/core/records/integrator.hpp"
#include "framework/model/assembly.hpp"

/// Refuses before a run what an integrator cannot do right, with the integrators that can.
/// What a scheme can take stands in the flags of its record alone.
namespace tomlin {

/// Names of the scene's registered integrators that `fits` accepts: "dop853, dopri5, rk4".
template <class Fits>
std::string integrators_that(const Scene& scene, Fits fits) {
  std::string names;
  for (const auto& record : scene.registry->integrators()) {
    if (!fits(*record)) continue;
    names += (names.empty() ? "" : ", ") + record->name;
  }
  return names;
}

/// Names of those that take any scene of particles, whatever its forces are.
std::string integrators_for_any_scene(const Scene& scene);

/// Names of those that evaluate bonds as forces, and friction as a force or an operator.
std::string integrators_with_bonds_as_forces(const Scene& scene);

/// Throws InputError where the scene's integrator does not take its forces, dynamics or ledger.
void check_scheme(const Assembly<double>& assembly);

}  // namespace tomlin
