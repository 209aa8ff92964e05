#include "integrators/register.hpp"

#include "framework/core/integrator.hpp"
#include "integrators/continuation.hpp"
#include "integrators/dopri5.hpp"
#include "integrators/rk4.hpp"
#include "integrators/velocity_verlet.hpp"

namespace tomlin {

void register_integrators(Registry& registry) {
  registry.add(continuation_record());
  registry.add(dopri5_record());
  registry.add(rk4_record());
  registry.add(velocity_verlet_record());
}

}  // namespace tomlin
