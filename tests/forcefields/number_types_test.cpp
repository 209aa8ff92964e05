#include <string>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include "forcefields/sinusoidal_substrate.hpp"
#include "forcefields/viscous_damping.hpp"
#include "tests/forcefields/planted.hpp"

// Forces that are another one, or of another precision, in one of the number types.

namespace tomlin::test {
namespace {

template <class E>
const ForceFactories kValid{planted<E, double>, planted<E, Quad>};

TEST(NumberTypes, SoundForcesBoundTheSameWayAreNotAccused) {
  EXPECT_EQ(broken_properties("sinusoidal_substrate", kValid<SinusoidalSubstrate>),
            std::vector<std::string>{});
  EXPECT_EQ(broken_properties("viscous_damping", kValid<ViscousDamping>),
            std::vector<std::string>{});
}

/// A relative error of 1e-13: hundreds of units in double.
template <class E>
struct Off : E {
  template <class T, int D>
  static Vec<T, D> force(const typename E::template Parameters<T, D>& p, const Site<T, D>& site) {
    return T(1.0 + 1e-13) * E::force(p, site);
  }
};

TEST(NumberTypes, AnotherForceInOneTypeIsSeen) {
  ForceFactories substrate = kValid<SinusoidalSubstrate>;
  substrate.in_quadruple = planted<Off<SinusoidalSubstrate>, Quad>;
  EXPECT_CAUGHT("number types", "sinusoidal_substrate", substrate);
  substrate = kValid<SinusoidalSubstrate>;
  substrate.in_double = planted<Off<SinusoidalSubstrate>, double>;
  EXPECT_CAUGHT("number types", "sinusoidal_substrate", substrate);
  ForceFactories damping = kValid<ViscousDamping>;
  damping.in_quadruple = planted<Off<ViscousDamping>, Quad>;
  EXPECT_CAUGHT("number types", "viscous_damping", damping);
}

/// Quadruple in name only.
struct ThroughDouble : ViscousDamping {
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    Vec<T, D> force = ViscousDamping::force(p, site);
    if constexpr (std::is_same_v<T, QuadPack>) {
      for (int d = 0; d < D; ++d) {
        for (std::size_t i = 0; i < kGroup; ++i) {
          force[d].v[i] =
              -static_cast<double>(p.coefficient.v[i]) * static_cast<double>(site.velocity[d].v[i]);
        }
      }
    }
    return force;
  }
};

/// 2 pi with the digits of a double in the force, and all of them in the energy.
struct ShortPi : SinusoidalSubstrate {
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    const T ratio = T(6.283185307179586) / tau<T>();
    return ratio * SinusoidalSubstrate::force(p, site);
  }
};

TEST(NumberTypes, QuadrupleInNameOnlyIsSeen) {
  ForceFactories damping = kValid<ViscousDamping>;
  damping.in_quadruple = planted<ThroughDouble, Quad>;
  EXPECT_CAUGHT("digits", "viscous_damping", damping);
  ForceFactories substrate = kValid<SinusoidalSubstrate>;
  substrate.in_quadruple = planted<ShortPi, Quad>;
  EXPECT_CAUGHT("quadruple", "sinusoidal_substrate", substrate);
}

}  // namespace
}  // namespace tomlin::test
