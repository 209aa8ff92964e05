#include "framework/scene/motion_slope.hpp"

#include <cmath>
#include <memory>
#include <string>
#include <variant>

#include <gtest/gtest.h>

namespace tomlin {
namespace {

TimeFunction function_of(const std::string& text) {
  TimeFunction function;
  function.text = text;
  function.expression =
      std::make_shared<const Expression>(std::get<Expression>(Expression::parse(text)));
  function.parameters = {{"w", 1.7}, {"n", 3.0}};
  return function;
}

/// Against central differences, whose error falls as the square of the step.
TEST(MotionSlope, IsTheDerivativeOfEveryFunction) {
  constexpr double kStep = 1e-5;
  constexpr double kDifference = 1e-8;
  for (const char* text : {"t",
                           "-t",
                           "3",
                           "w*t - n",
                           "t*t/(1 + t)",
                           "(w - t)/(n + t^2)",
                           "t^n",
                           "t^-2",
                           "w^t",
                           "t^t",
                           "(-t)^3",
                           "sqrt(t)",
                           "exp(-w*t)",
                           "log(t)",
                           "sin(w*t)",
                           "cos(2*pi*t)",
                           "tan(t)",
                           "asin(t/2)",
                           "acos(t/2)",
                           "atan(w*t)",
                           "atan2(t, 1 + t)",
                           "abs(t - 2)",
                           "min(t, t^2, 3)",
                           "max(t, t^2)",
                           "floor(t) + t",
                           "tanh((t - 1)/w)",
                           "sinh(w*t) - cosh(t)",
                           "t*step(t - 0.5) + sign(t - 1)*t",
                           "n*exp(-((t - 1)/w)^2)*cos(w*t)",
                           "log(n)*t",
                           "sqrt(w)"}) {
    const TimeFunction function = function_of(text);
    for (const double t : {0.4, 0.83, 1.3}) {
      const double expected = (function(t + kStep) - function(t - kStep)) / (2.0 * kStep);
      EXPECT_NEAR(slope_of(function, t), expected, kDifference * (1.0 + std::abs(expected)))
          << text << " at " << t;
    }
  }
}

TEST(MotionSlope, IsNoNumberWhereThereIsNone) {
  EXPECT_FALSE(std::isfinite(slope_of(function_of("sqrt(t)"), 0.0)));
  EXPECT_FALSE(std::isfinite(slope_of(function_of("t^0.5"), 0.0)));
  EXPECT_EQ(slope_of(function_of("t^2"), 0.0), 0.0);
  EXPECT_EQ(slope_of(function_of("t^1"), 0.0), 1.0);
  EXPECT_EQ(slope_of(function_of("sqrt(n - 3) + t"), 0.0), 1.0);
}

}  // namespace
}  // namespace tomlin
