#pragma once

#include <string>
#include <utility>

#include "tests/support/tables.hpp"
#include "tests/support/text.hpp"

/// A small scene of molecular dynamics with most of what such scenes have: a thermostatted nanotube
/// that is pulled over a fixed sheet in a periodic box. A picosecond takes some 30 ms.
namespace tomlin::test {

inline const std::string kTubeOnSheet = tables(R"([scene] | units = "metal"

[parameters] | b = 1.4388 | a = "sqrt(3) * b"

[box] | lengths = ["6 * b", "4 * a", 40.0] | periodic = [true, true, false]

[[body]] | name = "tube" | type = "nanotube" | chirality = [5, 0] | bond_length = "b"
cells = 2 | axis = "x" | centre = [0.0, 0.0, 5.2] | species = "C" | particle_mass = 12.011
start_temperature = 300.0

[[body]] | name = "sheet" | type = "graphene" | bond_length = "b" | cells = [2, 4]
armchair = "x" | species = "C" | particle_mass = 12.011 | coordinates = "fixed"

[[force]] | name = "bonds" | type = "tersoff" | body = "tube"
parameters = "lindsay_broido_2010"

[[force]] | name = "contact" | type = "lennard_jones" | bodies = ["tube", "sheet"]
epsilon = 0.0024 | sigma = 3.4 | cutoff = 3.7

[[force]] | name = "bath" | type = "nose_hoover_chain" | body = "tube" | temperature = 300.0
period = 0.1

[[force]] | name = "driver" | type = "driving_spring" | body = "tube"
stiffness = [0.0, 1.0, 0.0] | velocity = [0.0, 1.0, 0.0]

[run] | duration = 1.0 | integrator = { type = "velocity_verlet", dt = 1e-3 } | ledger = true

[output] | every = 0.05 | trajectory = true
)");

/// The scene with its first `old_text` replaced.
inline std::string tube_scene_with(const std::string& old_text, const std::string& new_text,
                                   std::string scene = kTubeOnSheet) {
  return replaced(std::move(scene), old_text, new_text);
}

}  // namespace tomlin::test
