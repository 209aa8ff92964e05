#pragma once

#include <limits>
#include <string>
#include <vector>

#include "framework/core/records/integrator.hpp"
#include "framework/scene/scene.hpp"
#include "framework/study/variants.hpp"

/// The ladder: all ways to compute what a scene asks for. Each rung is a few lines in the scene.
namespace tomlin {

/// The finest tolerance of an adaptive scheme that doubles can keep.
inline constexpr double kFinestTolerance = 1e-13;

/// What a rung is turned finer by.
enum class Knob { step, tolerance };

/// "dt", "tolerance".
const char* to_string(Knob knob);

struct Rung {
  std::string name;   ///< "dopri5", "dopri5 in float", "rigid, overdamped, rk4"
  std::string model;  ///< what differs from the scene's equations, "rigid"; empty: nothing
  const IntegratorRecord* integrator = nullptr;
  std::string number_type = "double";
  std::vector<Setting> settings;  ///< all but the integrator
  Knob knob = Knob::tolerance;
  /// Tolerances as the knob has them are relative; absolute ones are this many times larger: the
  /// scene's length.
  double absolute_share = 1.0;
  /// What steps have two digits in, so that a scene in other units gets the same: the run's
  /// duration.
  double unit = 1.0;
  /// Of a fixed step; infinite where nothing is known to limit it.
  double stable_step = std::numeric_limits<double>::infinity();
  std::string refused;  ///< why the scene cannot be run so; empty when it can

  /// Does it solve the scene's own equations, so that only the numerics differ?
  bool is_own_model() const { return model.empty(); }
  /// The settings that select it with its knob at this value.
  std::vector<Setting> at(double knob) const;
};

/// Every registered integrator on the scene as it is, each in double and in float, then the same
/// on simpler models of it: flexible bodies held together by forces of their own taken as rigid;
/// without inertia; following the equilibria. Rungs that the scene refuses stay in the list, with
/// the reason; the order is that of the registry. Binds the scene once for each rung.
std::vector<Rung> ladder(const Variants& variants);

/// Those of them that solve the scene's own equations in its own number type.
std::vector<Rung> own_ladder(const Variants& variants);

/// The scene's length (framework/scene/natural_units.hpp).
double length_scale(const Scene& scene);

/// What an error of the input says, on one line: its first fault without its place, and how many
/// more there are.
std::string condensed(const InputError& error);

}  // namespace tomlin
