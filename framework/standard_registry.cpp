#include "framework/standard_registry.hpp"

#include "forcefields/register.hpp"
#include "framework/bodies/register.hpp"
#include "integrators/register.hpp"

namespace tomlin {

Registry standard_registry() {
  Registry registry;
  register_bodies(registry);
  register_forcefields(registry);
  register_integrators(registry);
  return registry;
}

}  // namespace tomlin
