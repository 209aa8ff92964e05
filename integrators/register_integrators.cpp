#include "integrators/register_integrators.hpp"

#include <utility>

#include "framework/core/records/integrator.hpp"
#include "integrators/baoab.hpp"
#include "integrators/blanes_moan.hpp"
#include "integrators/continuation.hpp"
#include "integrators/dop853.hpp"
#include "integrators/dopri5.hpp"
#include "integrators/euler_maruyama.hpp"
#include "integrators/exponential_verlet.hpp"
#include "integrators/gjf.hpp"
#include "integrators/leimkuhler_matthews.hpp"
#include "integrators/midpoint.hpp"
#include "integrators/radau9.hpp"
#include "integrators/rk4.hpp"
#include "integrators/velocity_verlet.hpp"

namespace tomlin {

void register_integrators(Registry& registry, const SchemesWithForces& compiled) {
  IntegratorRecord midpoint = midpoint_record();
  midpoint.lane_block = compiled.midpoint;
  IntegratorRecord rk4 = rk4_record();
  rk4.lane_block = compiled.rk4;
  registry.add(baoab_record());
  registry.add(blanes_moan_record());
  registry.add(continuation_record());
  registry.add(dop853_record());
  registry.add(dopri5_record());
  registry.add(euler_maruyama_record());
  registry.add(exponential_verlet_record());
  registry.add(gjf_record());
  registry.add(leimkuhler_matthews_record());
  registry.add(std::move(midpoint));
  registry.add(radau9_record());
  registry.add(std::move(rk4));
  registry.add(velocity_verlet_record());
}

}  // namespace tomlin
