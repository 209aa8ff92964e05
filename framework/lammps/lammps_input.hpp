#pragma once

#include <memory>
#include <string>
#include <vector>

#include "framework/scene/scene.hpp"

/// A scene as input of LAMMPS (A. P. Thompson et al., Comput. Phys. Commun. 271 (2022) 108171,
/// doi:10.1016/j.cpc.2021.108171) that gives the same energy and the same forces there.
namespace tomlin {

/// The style of units that the numbers are written in. The engine's units are consistent ones, in
/// which Boltzmann's constant is 1; those of LAMMPS need not be.
struct LammpsUnits {
  const char* style;
  double mass;         ///< 1 of LAMMPS in the engine's units
  double temperature;  ///< 1 of LAMMPS as an energy of the engine
};

/// Numbers as they stand: LAMMPS's constants are all 1.
inline constexpr LammpsUnits kLammpsReduced{"lj", 1.0, 1.0};
/// For an engine in eV, Angstrom and ps. The constants are those that LAMMPS itself computes with
/// (src/update.cpp), rounded and older than CODATA 2018: with masses and temperatures that are
/// divided by them accelerations and noise there are those of the engine.
inline constexpr LammpsUnits kLammpsMetal{"metal", 1.0364269e-4, 8.617343e-5};

/// Style of units of LAMMPS for a scene.
LammpsUnits lammps_units(const Scene& scene);

struct LammpsFile {
  std::string name;
  std::string text;
};

inline constexpr const char* kLammpsData = "data.lmp";
inline constexpr const char* kLammpsInput = "in.lmp";

/// The files, the one that LAMMPS is started with last. Throws InputError with all of a scene that
/// LAMMPS has no exact counterpart for.
std::vector<LammpsFile> lammps_input(const std::shared_ptr<const Scene>& scene,
                                     const LammpsUnits& units);

}  // namespace tomlin
