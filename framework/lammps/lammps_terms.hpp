#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "framework/core/text/fault.hpp"
#include "framework/lammps/lammps_input.hpp"
#include "framework/model/model.hpp"

namespace tomlin {

/// A sub-style of `pair_style hybrid/overlay`.
struct LammpsPairs {
  std::string style;      ///< "lj/cut"
  std::string arguments;  ///< of pair_style; may be empty
  std::string modify;     ///< of pair_modify; empty: none
  /// Each pair_coeff has its types, "1*2 3" or "* *", and the coefficients behind the style.
  std::vector<std::array<std::string, 2>> coefficients = {};
  double cutoff = 0.0;                  ///< length
  std::array<std::size_t, 2> bodies{};  ///< that it acts between, the same twice within a body
  std::string comment;
};

/// A type of bonds: all of one form with the same numbers.
struct LammpsBondType {
  std::string style;  ///< "harmonic"
  std::string coefficients;
};

struct LammpsBond {
  std::size_t type = 0;  ///< counts from 1, as atoms do
  std::array<std::size_t, 2> atoms{};
};

/// Atoms in the order of bodies and particles, from 1. Types, from 1: for each body one for each
/// mass and species that its particles have.
struct LammpsAtoms {
  struct Type {
    double mass = 0.0;    ///< in the engine's units
    std::string species;  ///< empty: none
    friend bool operator==(const Type&, const Type&) = default;
  };
  struct Body {
    std::size_t first_atom = 0;
    std::size_t first_type = 0;
    std::vector<Type> types;
    std::vector<std::size_t> type;  ///< of each particle

    /// "2*4", or "2" where there is but one.
    std::string range() const;
  };
  std::vector<Body> bodies;
  std::size_t types = 0;
  std::size_t count = 0;
};

/// Counterparts of a scene's forces in LAMMPS, collected while they are translated.
struct LammpsTerms {
  const Model& model;
  const LammpsUnits& units;
  const LammpsAtoms& atoms;

  std::vector<LammpsPairs> pairs = {};
  std::vector<LammpsBondType> bond_types = {};
  std::vector<LammpsBond> bonds = {};
  double longest_bond = 0.0;               ///< at the start or at rest
  std::vector<std::string> commands = {};  ///< variables and fixes, with comments
  std::vector<std::string> columns = {};   ///< of the table that is printed
  std::vector<LammpsFile> files = {};
  // The commands read these: the time, positions of particles, positions at the start.
  bool uses_time = false;
  bool uses_positions = false;
  bool uses_starts = false;
  std::vector<Fault> faults = {};
};

/// Adds a force of the scene that the model has not left out. What has no exact counterpart becomes
/// a fault.
void add_lammps_force(const SceneForce& force, LammpsTerms& terms);

/// "body2": the group of a body, an index into the scene's.
std::string lammps_group(std::size_t body);
/// With the digits that it takes to read the same bits back.
std::string lammps_number(double number);
/// Text of a comment without quotes in triples and a final "&", which LAMMPS looks for even there.
std::string lammps_comment(const std::string& text);
/// Coordinates as formulas name them, through the sides of a periodic box.
std::string lammps_coordinate(LammpsTerms& terms, int axis);
/// Starting coordinates as formulas name them, through the sides of a periodic box.
std::string lammps_start(LammpsTerms& terms, int axis);

}  // namespace tomlin
