#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "framework/core/records/coordinates.hpp"
#include "framework/core/records/neighbours.hpp"
#include "framework/core/records/registry.hpp"
#include "framework/core/text/fault_code.hpp"

/// Bodies: where particles start. Pure geometry; nothing here moves.
namespace tomlin {

/// Keys that every body takes; a body's description derives from this.
struct BodyDescription {
  PerParticle particle_mass;
  NamePerParticle species;
  PerParticleVector velocity;
  PerParticleVector displacement;
  double start_temperature = 0.0;
  Coordinates coordinates = Coordinates::particles;
};

/// The rows for BodyDescription, for a description D derived from it.
template <class D>
std::vector<Parameter> with_body_parameters(std::vector<Parameter> own) {
  own.push_back(parameter_of<D>("particle_mass", &BodyDescription::particle_mass, dimension::mass,
                                "mass of each particle: one number for all, or one each")
                    .in(positive)
                    .for_each_particle());
  own.push_back(parameter_of<D>("species", &BodyDescription::species, dimension::none,
                                "what each particle is, as \"C\": a name for all, or one each; "
                                "potentials between atoms know their parameters by it, and "
                                "trajectories have it")
                    .or_absent());
  own.push_back(parameter_of<D>("velocity", &BodyDescription::velocity, dimension::velocity,
                                "starting velocity: one vector for all particles, or one each; "
                                "at rest by default")
                    .or_absent()
                    .for_each_particle());
  own.push_back(
      parameter_of<D>("displacement", &BodyDescription::displacement, dimension::length,
                      "from the positions of the body's shape at the start: one vector for "
                      "all particles, or one each; none by default")
          .or_absent()
          .for_each_particle());
  own.push_back(
      parameter_of<D>("start_temperature", &BodyDescription::start_temperature,
                      dimension::temperature,
                      "velocities at the start are drawn from the Maxwell distribution of "
                      "this temperature, in reduced units an energy, and added to `velocity`")
          .in(non_negative)
          .by_default(0.0));
  own.push_back(
      parameter_of<D>("coordinates", &BodyDescription::coordinates, dimension::none,
                      "what may move: every particle, the body as a whole, nothing, or the body "
                      "as a whole by its motion")
          .by_default(Coordinates::particles));
  return own;
}

/// Initial positions of a body's particles: i starts at anchor + relative[i]. The two stay apart so
/// that a body far from the origin keeps its shape to the last digit.
struct BodyGeometry {
  std::vector<double> anchor;                 ///< [dimension]
  std::vector<std::vector<double>> relative;  ///< [count][dimension]
  /// Perimeter of the outline / (2 pi): what the body advances per radian where it rolls without
  /// sliding. 0 when the body does not roll.
  double rolling_radius = 0.0;
  /// Largest less smallest distance of the outline from its centre: by so much the centre rises
  /// and sinks where the body rolls. 0 when it is round.
  double rolling_rise = 0.0;
  /// Axis about which a body in space rolls; -1: none.
  int rolling_axis = -1;
};

/// Whether "neighbours" joins the last particle to the first.
struct BodyEnds {
  bool closed = false;  ///< always
  int open_along = -1;  ///< axis along which a periodic box closes it; -1: none
};

/// For bodies that nothing closes.
inline BodyEnds open_ends(const void*, int) { return {}; }

/// For bodies whose keys say all.
inline std::string no_body_note(const void*) { return {}; }

/// A fault that only shows when several keys are held against each other.
struct Complaint {
  std::string key;
  std::string why;
  std::string admissible = {};
  std::string nearest = {};
  std::optional<std::size_t> column = {};         ///< 0-based, within a formula
  std::size_t index = 0;                          ///< of the formula in a list of them
  FaultCode code = FaultCode::component_invalid;  ///< of a force: that of a warning, too
  std::optional<std::size_t> body = {};  ///< of a force: the key is one of this body of its outline
};

struct BodyRecord : ComponentRecord {
  /// The part that every body's description has.
  const BodyDescription& (*common)(const void* description) = nullptr;
  /// Length of the body's vectors as given; 0 when the description has none.
  int (*dimension)(const void* description) = nullptr;
  /// Number of particles.
  std::int64_t (*count)(const void* description) = nullptr;
  /// Faults across keys for a scene of this dimension; empty when valid.
  std::vector<Complaint> (*complaints)(const void* description, int dimension) = nullptr;
  BodyEnds (*ends)(const void* description, int dimension) = &open_ends;
  /// Pairs that "neighbours" means where these are not consecutive particles, each once, in
  /// a box of these lengths, 0 along an axis that is not periodic. Called for a valid description
  /// only.
  std::vector<IndexPair> (*neighbours)(const void* description,
                                       const std::array<double, 3>& box) = nullptr;
  /// Text of `explain` on the body besides its keys, as the lengths of a box that it fills.
  std::string (*note)(const void* description) = &no_body_note;
  /// Called for a valid description only.
  BodyGeometry (*build)(const void* description, int dimension) = nullptr;
};

/// The neighbours of a body; the description is kept for as long as they may be asked for.
inline NeighbourList neighbour_list(const BodyRecord& record,
                                    std::shared_ptr<const void> description,
                                    const std::array<double, 3>& box) {
  if (record.neighbours == nullptr) return nullptr;
  return [list = record.neighbours, description = std::move(description), box] {
    return list(description.get(), box);
  };
}

template <class D>
const BodyDescription& body_part(const void* description) {
  return *static_cast<const D*>(description);
}

/// A record for descriptions of this type, with `own` parameters and those of every body; otherwise
/// empty.
template <class D>
BodyRecord body_record(std::vector<Parameter> own) {
  BodyRecord record;
  record.make_description = &make_description<D>;
  record.common = &body_part<D>;
  record.parameters = with_body_parameters<D>(std::move(own));
  return record;
}

}  // namespace tomlin
