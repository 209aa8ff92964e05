#pragma once

#include "integrators/explicit_tableau.hpp"

/// Explicit schemes beside the built-in ones, with rows of every kind.
namespace tomlin::test {

/// The trapezoidal rule after a step of Euler's.
struct HeunTableau {
  static constexpr const char* name = "heun";
  static constexpr int order = 2;
  static constexpr int stages = 2;
  static constexpr TableauRow<2> a[2] = {{}, {{1}}};
  static constexpr TableauRow<2> b = {{1, 1}, 2};
};

/// A. Ralston, Math. Comp. 16 (1962) 431, doi:10.1090/S0025-5718-1962-0150954-0.
struct RalstonTableau {
  static constexpr const char* name = "ralston";
  static constexpr int order = 3;
  static constexpr int stages = 3;
  static constexpr TableauRow<3> a[3] = {{}, {{1}, 2}, {{0, 3}, 4}};
  static constexpr TableauRow<3> b = {{2, 3, 4}, 9};
};

/// W. Kutta, Z. Math. Phys. 46 (1901) 435: the 3/8 rule.
struct ThreeEighthsTableau {
  static constexpr const char* name = "three_eighths";
  static constexpr int order = 4;
  static constexpr int stages = 4;
  static constexpr TableauRow<4> a[4] = {{}, {{1}, 3}, {{-1, 3}, 3}, {{1, -1, 1}}};
  static constexpr TableauRow<4> b = {{1, 3, 3, 1}, 8};
};

}  // namespace tomlin::test
