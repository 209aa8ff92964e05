#pragma once

#include <limits>
#include <string>
#include <vector>

#include "framework/core/records/integrator.hpp"
#include "framework/scene/scene.hpp"
#include "framework/study/tradeoff/variants.hpp"

/// All ways to compute what a scene asks for: an integrator, a number type and a model. Each method
/// is a few lines in the scene.
namespace tomlin {

/// The finest tolerance of an adaptive scheme that doubles can keep.
inline constexpr double kFinestTolerance = 1e-13;

/// Setting of a method that makes it more accurate.
enum class Resolution { step, tolerance };

constexpr auto word_table(Resolution) {
  return std::to_array<Word<Resolution>>(
      {{Resolution::step, "dt"}, {Resolution::tolerance, "tolerance"}});
}

struct Method {
  std::string name;   ///< "dopri5", "rigid, overdamped, rk4"
  std::string model;  ///< what differs from the scene's equations, "rigid"; empty: nothing
  const IntegratorRecord* integrator = nullptr;
  NumberType number_type = NumberType::double_precision;
  std::vector<Setting> settings;  ///< all but the integrator
  Resolution resolution = Resolution::tolerance;
  /// Tolerances as the resolution has them are relative; absolute ones are this many times larger:
  /// the scene's length.
  double absolute_share = 1.0;
  /// Unit in which steps have two digits, so that a scene in other units gets the same steps: the
  /// run's duration.
  double unit = 1.0;
  /// The largest stable fixed step; infinite where nothing is known to limit it.
  double stable_step = std::numeric_limits<double>::infinity();
  std::string refused;  ///< why the scene cannot be run so; empty when it can

  /// Does it solve the scene's own equations, so that only the numerics differ?
  bool is_own_model() const { return model.empty(); }
  /// The table of its integrator in a scene, with the resolution at this value.
  std::string integrator_at(double resolution) const;
  /// The settings that select it with its resolution at this value.
  std::vector<Setting> at(double resolution) const;
  /// A resolution in so many digits of its unit, as it will stand in a scene.
  double rounded(double resolution, int digits) const;
};

/// Every registered integrator on the scene as it is, in double precision, then the same on simpler
/// models of it: flexible bodies held together by forces of their own taken as rigid;
/// without inertia; following the equilibria. Methods that the scene refuses stay in the list, with
/// the reason; the order is that of the registry. Binds the scene once for each method.
std::vector<Method> methods_for(const Variants& variants);

/// Methods that solve the scene's own equations in its own number type.
std::vector<Method> methods_of_own_model(const Variants& variants);

/// A number in so many significant digits.
double rounded_to_digits(double x, int digits);

/// Returns an input error on one line: its first fault without its position in the file, and how
/// many more there are.
std::string condensed(const InputError& error);

}  // namespace tomlin
