#include "integrators/register.hpp"

#include "framework/core/records/integrator.hpp"
#include "integrators/blanes_moan.hpp"
#include "integrators/continuation.hpp"
#include "integrators/dop853.hpp"
#include "integrators/dopri5.hpp"
#include "integrators/exponential_verlet.hpp"
#include "integrators/midpoint.hpp"
#include "integrators/radau9.hpp"
#include "integrators/rk4.hpp"
#include "integrators/velocity_verlet.hpp"

namespace tomlin {

void register_integrators(Registry& registry) {
  registry.add(blanes_moan_record());
  registry.add(continuation_record());
  registry.add(dop853_record());
  registry.add(dopri5_record());
  registry.add(exponential_verlet_record());
  registry.add(midpoint_record());
  registry.add(radau9_record());
  registry.add(rk4_record());
  registry.add(velocity_verlet_record());
}

}  // namespace tomlin
