#pragma once

#include <array>
#include <cstddef>

/// Interpolation within one step along a path. The step's parameter theta runs from 0 to 1.
///
/// Positions and slopes are known at five Chebyshev points: Hermite's polynomial of degree 9. Rates
/// are known at nine, of which those are every other one: the polynomial of degree 8, whose
/// integral over the whole step is the rule of Clenshaw and Curtis.
namespace tomlin {

inline constexpr std::size_t kPathNodes = 5;
inline constexpr std::size_t kRateNodes = 9;

/// (1 - cos(j pi / 8)) / 2
inline constexpr std::array<double, kRateNodes> kRateNode = {
    0.0, 0.038060233744356624, 0.14644660940672624, 0.30865828381745514,
    0.5, 0.6913417161825449,   0.8535533905932737,  0.9619397662556434,
    1.0};
inline constexpr double path_node(std::size_t j) { return kRateNode[2 * j]; }

/// Weights of values and of slopes (with respect to theta) at the first `count` nodes for the
/// interpolant at theta, and for its first two derivatives.
struct HermiteWeights {
  std::array<double, kPathNodes> value{};
  std::array<double, kPathNodes> slope{};
  std::array<double, kPathNodes> value_of_slope{};
  std::array<double, kPathNodes> slope_of_slope{};

  HermiteWeights(std::size_t count, double theta) {
    for (std::size_t i = 0; i < count; ++i) {
      // Lagrange's polynomial l of node i, its derivative, and the one at the node itself.
      double l = 1.0;
      double dl = 0.0;
      double at_node = 0.0;
      for (std::size_t k = 0; k < count; ++k) {
        if (k == i) continue;
        const double apart = path_node(i) - path_node(k);
        const double factor = (theta - path_node(k)) / apart;
        dl = dl * factor + l / apart;
        l *= factor;
        at_node += 1.0 / apart;
      }
      const double from = theta - path_node(i);
      const double bend = 1.0 - 2.0 * from * at_node;
      value[i] = bend * l * l;
      slope[i] = from * l * l;
      value_of_slope[i] = 2.0 * l * (bend * dl - at_node * l);
      slope_of_slope[i] = l * (l + 2.0 * from * dl);
    }
  }
};

/// Weights of the nine rates for their polynomial at theta (barycentric formula).
inline std::array<double, kRateNodes> rate_weights(double theta) {
  std::array<double, kRateNodes> weight{};
  double total = 0.0;
  for (std::size_t j = 0; j < kRateNodes; ++j) {
    const double apart = theta - kRateNode[j];
    if (apart == 0.0) {
      weight.fill(0.0);
      weight[j] = 1.0;
      return weight;
    }
    const bool end = j == 0 || j + 1 == kRateNodes;
    weight[j] = (j % 2 == 0 ? 1.0 : -1.0) * (end ? 0.5 : 1.0) / apart;
    total += weight[j];
  }
  for (double& w : weight) w /= total;
  return weight;
}

/// Weights of the nine rates for the integral of their polynomial from 0 to theta: Gauss' rule of
/// five points, which is exact for it.
inline std::array<double, kRateNodes> integral_weights(double theta) {
  constexpr std::array<double, 5> node = {0.046910077030668004, 0.23076534494715845, 0.5,
                                          0.7692346550528415, 0.953089922969332};
  constexpr std::array<double, 5> share = {0.11846344252809454, 0.23931433524968324,
                                           0.28444444444444444, 0.23931433524968324,
                                           0.11846344252809454};
  std::array<double, kRateNodes> weight{};
  for (std::size_t k = 0; k < node.size(); ++k) {
    const auto here = rate_weights(theta * node[k]);
    for (std::size_t j = 0; j < kRateNodes; ++j) weight[j] += theta * share[k] * here[j];
  }
  return weight;
}

}  // namespace tomlin
