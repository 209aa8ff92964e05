#pragma once

#include "integrators/coefficient.hpp"
#include "integrators/composition_kernels.hpp"

namespace tomlin {

/// SRKN^b_6 of Blanes and Moan, table 3, where numbers have 15 digits. The last of them in kick[2]
/// and drift[1] follow from the two conditions of fourth order,
///   sum b_i c_i^2 = 1/3,   sum_{j<i} b_i b_j (c_i - c_j) = 1/6,
/// so that the order holds in quadruple precision too.
struct BlanesMoanCoefficients {
  static constexpr Decimal kick[4] = {"0.0829844064174052", "0.396309801498368",
                                      "-0.03905630492234584477961967727001231",
                                      "0.1195241940131452895592393545400246"};
  static constexpr Decimal drift[3] = {"0.245298957184271", "0.6048726657110944231093285127821061",
                                       "-0.3501716228953654231093285127821061"};
  static constexpr Decimal time[6] = {"0.245298957184271",
                                      "0.8501716228953654231093285127821061",
                                      "0.5",
                                      "0.1498283771046345768906714872178939",
                                      "0.754701042815729",
                                      "1"};
};

inline namespace TOMLIN_TARGET {

struct BlanesMoanScheme {
  using C = BlanesMoanCoefficients;
  static constexpr int drifts = 6;
  template <class Real>
  static constexpr Real kick[7] = {
      C::kick[0].as<Real>(), C::kick[1].as<Real>(), C::kick[2].as<Real>(), C::kick[3].as<Real>(),
      C::kick[2].as<Real>(), C::kick[1].as<Real>(), C::kick[0].as<Real>()};
  template <class Real>
  static constexpr Real drift[6] = {C::drift[0].as<Real>(), C::drift[1].as<Real>(),
                                    C::drift[2].as<Real>(), C::drift[2].as<Real>(),
                                    C::drift[1].as<Real>(), C::drift[0].as<Real>()};
  template <class Real>
  static constexpr Real time[6] = {C::time[0].as<Real>(), C::time[1].as<Real>(),
                                   C::time[2].as<Real>(), C::time[3].as<Real>(),
                                   C::time[4].as<Real>(), C::time[5].as<Real>()};
};

struct BlanesMoanKernels : CompositionKernels<BlanesMoanScheme> {};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
