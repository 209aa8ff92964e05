#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/model/model.hpp"
#include "framework/scene/scene.hpp"

/// The scales of a scene, composed from what its forces and bodies declare: periods, bounds on
/// curvature, stiffness and velocity of drivers, friction.
namespace tomlin {

/// How fast one force alone makes the scene's bodies move.
struct ForceScale {
  std::string force;
  double frequency = 0.0;     ///< angular, sqrt(k/m): bound of its fastest motion; 0: no spring
  double damping_rate = 0.0;  ///< coefficient/mass, 1/time; 0: does not damp
  /// The largest that friction which is not linear has, near rest as a rule; 0: there is none.
  double rate_at_rest = 0.0;
  bool internal = false;  ///< acts within one body, whose centre of mass does not feel it
  std::vector<std::string> between;  ///< the bodies that it binds to each other; empty: it does not
};

enum class Regime {
  undamped,
  underdamped,
  critically_damped,
  overdamped,
  no_oscillation,
  no_inertia
};

constexpr auto word_table(Regime) {
  using enum Regime;
  return std::to_array<Word<Regime>>({{undamped, "undamped"},
                                      {underdamped, "underdamped"},
                                      {critically_damped, "critically damped"},
                                      {overdamped, "overdamped"},
                                      {no_oscillation, "no oscillation"},
                                      {no_inertia, "no inertia"}});
}

/// The damping against the critical damping, 2 * frequency, of the fastest oscillation that the
/// bodies' positions feel; one within a body counts only when there is no other.
struct Damping {
  Regime regime = Regime::no_oscillation;
  double rate = 0.0;       ///< the largest, 1/time
  double critical = 0.0;   ///< 2 * frequency of that oscillation
  std::string oscillator;  ///< the force behind it
};

/// A driver that pulls a body over a periodic force, along one axis: by its own spring, or by
/// another body that is bonded to it.
struct Sliding {
  std::string body;
  std::string driver;
  std::string substrate;
  int axis = 0;
  std::size_t particles = 0;
  double period = 0.0;
  double stiffness = 0.0;  ///< of the driver, all its springs together; with a bond, in series
  std::string bond;  ///< the force by which the driven body pulls this one; empty: it is driven
  double driver_stiffness = 0.0;
  double bond_stiffness = 0.0;  ///< 0 without a bond
  /// Largest curvature of the substrate's energy for the body as a whole if all its particles were
  /// in phase, mass/time^2.
  double curvature = 0.0;
  /// Largest curvature for the body as placed, moved along the axis without changing its shape.
  double curvature_as_placed = 0.0;
  /// 0: the driver does not move.
  double washboard_frequency = 0.0;  ///< angular, 2 pi |v| / period
  double rolling_radius = 0.0;       ///< 0: the body does not roll

  /// Smooth sliding below 1, stick-slip possible above.
  double stick_slip() const { return curvature / stiffness; }
  double stick_slip_as_placed() const { return curvature_as_placed / stiffness; }
};

/// A driver whose body has no periodic force of its own, but is bonded to another that has one, in
/// another way than by one linear spring along the axis: there is no stiffness in series.
struct Transmission {
  std::string driver;
  std::string body;          ///< that the driver pulls
  std::string substrate;     ///< and the periodic force
  std::string sliding_body;  ///< on this one
  int axis = 0;
};

/// p/q.
struct Fraction {
  std::int64_t p = 0;
  std::int64_t q = 1;
};

/// The ratio as a fraction with a denominator up to 1000, where there is one within 1e-9: a
/// quadratic irrational such as the golden mean is never that close.
std::optional<Fraction> as_fraction(double ratio);

/// Equally spaced particles of a body on a periodic force.
struct Misfit {
  std::string body;
  std::string substrate;
  int axis = 0;
  double spacing = 0.0;
  double period = 0.0;
  double ratio() const { return spacing / period; }
  /// In parts of the period, from the nearest whole number of periods.
  double misfit() const;
};

struct Scales {
  double frequency = 0.0;     ///< of the fastest motion of all, angular
  double damping_rate = 0.0;  ///< the largest
  /// Without inertia, instead of them: curvature/friction of the fastest motion.
  double relaxation_rate = 0.0;
  /// The least of 1/frequency, 1/damping rate (of friction that is not linear the largest),
  /// 1/relaxation rate and 1/washboard frequency; 0: none.
  double shortest_time = 0.0;
  std::string stiffest_force;      ///< behind the fastest motion or damping; may be empty
  std::vector<ForceScale> forces;  ///< those built, in the scene's order
  Damping damping;
  std::vector<Sliding> sliding;
  /// Sliding where a force has no period along the axis, as a turned lattice, or its curvature no
  /// bound, as one that depends on height: what is known is the curvature as placed, over a period
  /// or the length of a cell. The period is 0 where there is none, the curvature without a bound.
  std::vector<Sliding> sliding_as_placed;
  std::vector<Transmission> transmissions;
  std::vector<Misfit> misfits;
};

/// Throws InputError when the scene cannot be bound.
Scales scales_of(const std::shared_ptr<const Scene>& scene);

}  // namespace tomlin
