#include "framework/standard_registry.hpp"

#include "forcefields/register_forces.hpp"
#include "framework/bodies/register_bodies.hpp"
#include "framework/point_lanes.hpp"
#include "integrators/register_integrators.hpp"

namespace tomlin {

Registry standard_registry() {
  Registry registry;
  register_bodies(registry);
  register_forcefields(registry);
  register_integrators(registry, {.rk4 = &rk4_block_of, .midpoint = &midpoint_block_of});
  return registry;
}

}  // namespace tomlin
