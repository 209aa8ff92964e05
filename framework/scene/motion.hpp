#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "framework/core/formula/expression.hpp"

namespace tomlin {

/// A number that may change with time: `"v * cos(2 * pi * t / T)"`.
struct TimeFunction {
  double constant = 0.0;                         ///< the value, where there is no expression
  std::shared_ptr<const Expression> expression;  ///< over `t` and the parameters; null: constant
  std::vector<std::pair<std::string, double>> parameters;  ///< those that the expression names
  std::string text = "0.0";                                ///< as written in the scene

  bool is_constant() const { return expression == nullptr; }
  /// NaN where the expression has no finite value.
  double operator()(double t) const;
};

/// `motion = { velocity = [..], angular_velocity = .. }` of a prescribed body: its particles move
/// as one rigid body does whose centre of mass has this velocity.
struct Motion {
  std::vector<TimeFunction> velocity;  ///< [dimension]
  TimeFunction angular_velocity;       ///< rad/time, counter-clockwise; zero unless planar
};

}  // namespace tomlin
