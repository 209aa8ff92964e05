#include "forcefields/register_forces.hpp"

#include "forcefields/constant_force.hpp"
#include "forcefields/coulomb_friction.hpp"
#include "forcefields/driving_spring.hpp"
#include "forcefields/expression.hpp"
#include "forcefields/harmonic_bonds.hpp"
#include "forcefields/langevin.hpp"
#include "forcefields/lattice_substrate.hpp"
#include "forcefields/lennard_jones.hpp"
#include "forcefields/memory_damping.hpp"
#include "forcefields/morse_bonds.hpp"
#include "forcefields/nose_hoover_chain.hpp"
#include "forcefields/sheet_field.hpp"
#include "forcefields/sinusoidal_substrate.hpp"
#include "forcefields/tersoff.hpp"
#include "forcefields/velocity_weakening.hpp"
#include "forcefields/viscous_damping.hpp"
#include "framework/core/records/force.hpp"

namespace tomlin {

void register_forcefields(Registry& registry) {
  registry.add(constant_force_record());
  registry.add(coulomb_friction_record());
  registry.add(driving_spring_record());
  registry.add(expression_record());
  registry.add(harmonic_bonds_record());
  registry.add(langevin_record());
  registry.add(lattice_substrate_record());
  registry.add(lennard_jones_record());
  registry.add(memory_damping_record());
  registry.add(morse_bonds_record());
  registry.add(nose_hoover_chain_record());
  registry.add(sheet_field_record());
  registry.add(sinusoidal_substrate_record());
  registry.add(tersoff_record());
  registry.add(velocity_weakening_record());
  registry.add(viscous_damping_record());
}

}  // namespace tomlin
