#pragma once

#include <optional>
#include <string>

#include "framework/core/records/parameter.hpp"
#include "framework/scene/scene.hpp"

/// The units that a scene brings along, from what its records declare: periods, rest lengths,
/// stiffnesses, masses, friction. In them tolerances and defaults are pure numbers, so that a scene
/// in any consistent units gives the same bits but for the unit: everything here scales exactly
/// when the units of mass, length and time change by powers of two.
namespace tomlin {

struct NaturalUnits {
  double length = 1.0;
  double time = 1.0;
  double mass = 1.0;
  std::string length_of;  ///< what the length is: "the shortest period"
  std::string time_of;

  double of(const Dimension& dimension) const;
};

/// length  the shortest period that a force declares; else the shortest of its other lengths, rest
///         lengths and distances of neighbours in a body; else the length in which a formula of
///         positions changes; else, with a formula that has none, 1; else the way that the fastest
///         driver or body goes in the unit of time; else the distance of what is farthest from
///         zero; else 1
/// time    the least 1/sqrt(k/m), without inertia c/k, of forces with a period; else of others from
///         outside, else of those within bodies, each only where it is within the run; else m/c of
///         the friction; else the length by the largest speed; else the run's duration.
///         Quasistatic: the last two
/// mass    such that mass/time^2 is that stiffness; else the smallest of a body
NaturalUnits natural_units(const Scene& scene);

/// Whether the default of an integrator's key is a number of the scene's units of length or time.
/// (Beyond 1e300 it stands for no bound.)
bool has_natural_default(const Parameter& row);

/// " of the scene's length", " of the scene's time"; empty for any other default.
std::string natural_unit_text(const Parameter& row);

/// That default in the units of a scene.
double natural_default(const Parameter& row, const NaturalUnits& units);

/// The tolerance that an adaptive scheme is asked to keep: the largest of its keys that end with
/// "tolerance", those that are lengths as parts of this one. Nothing of a fixed scheme.
std::optional<double> tolerance_of(const SceneIntegrator& integrator, double length);

}  // namespace tomlin
