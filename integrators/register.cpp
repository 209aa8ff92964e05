#include "integrators/register.hpp"

#include "framework/core/integrator.hpp"
#include "integrators/dopri5.hpp"
#include "integrators/rk4.hpp"

namespace tomlin {

void register_integrators(Registry& registry) {
  registry.add(dopri5_record());
  registry.add(rk4_record());
}

}  // namespace tomlin
