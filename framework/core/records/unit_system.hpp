#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "framework/core/records/parameter.hpp"
#include "framework/core/text/words.hpp"

/// Systems of units: what the numbers of a scene, and those of its results, stand for. The engine
/// itself computes in consistent units, in which Boltzmann's constant is 1; numbers are converted
/// where scenes are read and where results are written, and nowhere else.
namespace tomlin {

/// reduced  any consistent units, the scene's own; a temperature is an energy: nothing is converted
/// metal    eV, Angstrom, ps, u and K. The engine computes in eV, Angstrom, ps and in the mass and
///          the temperature that follow from them, eV ps^2/Angstrom^2 and eV
enum class UnitSystem { reduced, metal };

constexpr auto word_table(UnitSystem) {
  using enum UnitSystem;
  return std::to_array<Word<UnitSystem>>({{reduced, "reduced"}, {metal, "metal"}});
}

// CODATA 2018 (E. Tiesinga et al., Rev. Mod. Phys. 93 (2021) 025010,
// doi:10.1103/RevModPhys.93.025010): e = 1.602176634e-19 C and k_B = 1.380649e-23 J/K, both exact,
// and u = 1.66053906660(50)e-27 kg. Below they are quotients of integers that doubles hold exactly,
// so that each constant is rounded once.

/// Boltzmann's constant in eV/K: 8.617333262e-5.
inline constexpr double kBoltzmannInMetal = 1380649.0 / 16021766340.0;
/// The atomic mass unit in eV ps^2/Angstrom^2: 1.0364269e-4.
inline constexpr double kAtomicMassInMetal = 166053906660.0 / 1602176634000000.0;

/// The unit of a scene in the engine's units. In metal units kelvins count as energies, and what
/// has mass and no time (a mass, a moment of inertia, a density) is in u; all else that has mass is
/// made of eV (a stiffness, eV/Angstrom^2; a friction coefficient, eV ps/Angstrom^2), and is 1.
double scene_unit(UnitSystem units, const Dimension& dimension);

/// "eV/A" of a force in metal units, in reduced ones "mass*length/time^2"; "1" of a pure number.
std::string unit_symbol(UnitSystem units, const Dimension& dimension);
/// Form of unit_symbol() for tables: "force" and "energy" in reduced units.
std::string unit_in_tables(UnitSystem units, const Dimension& dimension);
/// Form for tables of a unit that records of observers spell, "length" or "mass/time^2"; any other,
/// "rad" or "1/s", as it is.
std::string unit_in_tables(UnitSystem units, const std::string& unit);

/// "mass*length/time^2", "1/time", "force", "energy"; nothing where the text names no dimension.
std::optional<Dimension> dimension_named(std::string_view text);

}  // namespace tomlin
