#include "tests/support/number_types.hpp"

#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include "forcefields/sinusoidal_substrate.hpp"
#include "forcefields/viscous_damping.hpp"
#include "framework/core/records/parameter.hpp"
#include "tests/forcefields/planted.hpp"

// Every force in float, double and quadruple numbers: one force, each to its own rounding.

namespace tomlin::test {
namespace {

// One particle; less than a group of eight, a whole one, more than one, and several.
constexpr std::size_t kCounts[] = {1, 3, 8, 13, 40};

/// Which ways to pair particles and to attach springs have come up, by dimension.
void note_kinds(const ForceRecord& record, const void* description, int dimension,
                std::set<std::string>& seen) {
  for (const Parameter& row : record.parameters) {
    const ParameterValue value = row.read(description);
    const std::string kind = std::to_string(dimension) + row.key;
    if (const auto* pairs = std::get_if<PairSelection>(&value)) {
      seen.insert(kind + std::to_string(static_cast<int>(pairs->kind)));
    }
    if (const auto* attach = std::get_if<Attachment>(&value)) {
      seen.insert(kind + std::to_string(static_cast<int>(attach->kind)));
    }
  }
}

/// The force of its record's example, on as many particles as the first body there has.
int examine_example(const ForceRecord& record, NumberTypeCheck& check) {
  const auto scene = scene_of(record.example);
  const auto& body = scene->bodies.front();
  const auto count = static_cast<std::size_t>(body.record->count(body.description.get()));
  int examined = 0;
  for (const auto& force : scene->forces) {
    if (force.record->name != record.name) continue;
    for (const std::uint64_t seed : kSeeds) {
      check.examine(force.description.get(), {.dimension = scene->dimension, .count = count}, seed,
                    1.0);
      ++examined;
    }
  }
  return examined;
}

TEST(NumberTypes, EveryForceIsTheSameInAllOfThem) {
  std::set<std::string> kinds;
  for (const auto& record : standard().forces()) {
    SCOPED_TRACE(record->name);
    EXPECT_NE(record->bind.in_float, nullptr);
    EXPECT_NE(record->bind.in_quadruple, nullptr);
    NumberTypeCheck check(*record);
    EXPECT_GT(examine_example(*record, check), 0);
    for (const std::uint64_t seed : kSeeds) {
      Random random(seed);
      for (const std::size_t count : kCounts) {
        for (const Arrangement& arrangement : arrangements_of(*record, count)) {
          const auto description = random_description(*record, arrangement, random);
          if (!description) continue;
          note_kinds(*record, description.get(), arrangement.dimension, kinds);
          check.examine(description.get(), arrangement, random(), uniform(random, 0.5, 3.0));
        }
      }
    }
    EXPECT_EQ(check.broken(), std::vector<std::string>{});
    RecordProperty(record->name + "_units_in_double", std::to_string(check.worst_in_double()));
    RecordProperty(record->name + "_units_in_float", std::to_string(check.worst_in_float()));
  }
  // All, neighbours and lists; the centre of mass, each particle and one: in three dimensions.
  EXPECT_EQ(kinds.size(), 18u);
}

// ---- planted faults

template <class E>
const ForceFactories kSound{planted<E, double>, planted<E, float>, planted<E, Quad>};

TEST(NumberTypes, SoundForcesBoundTheSameWayAreNotAccused) {
  EXPECT_EQ(broken_claims("sinusoidal_substrate", kSound<SinusoidalSubstrate>),
            std::vector<std::string>{});
  EXPECT_EQ(broken_claims("viscous_damping", kSound<ViscousDamping>), std::vector<std::string>{});
}

/// A relative error of 1e-4 or 1e-13: hundreds of units in float and in double.
template <class E, int exponent>
struct OffBy : E {
  template <class T, int D>
  static Vec<T, D> force(const typename E::template Parameters<T, D>& p, const Site<T, D>& site) {
    return T(1.0 + (exponent == 4 ? 1e-4 : 1e-13)) * E::force(p, site);
  }
};

TEST(NumberTypes, AnotherForceInOneTypeIsSeen) {
  ForceFactories substrate = kSound<SinusoidalSubstrate>;
  substrate.in_float = planted<OffBy<SinusoidalSubstrate, 4>, float>;
  EXPECT_CAUGHT("force in float is another", "sinusoidal_substrate", substrate);
  substrate = kSound<SinusoidalSubstrate>;
  substrate.in_double = planted<OffBy<SinusoidalSubstrate, 13>, double>;
  EXPECT_CAUGHT("force in double is another", "sinusoidal_substrate", substrate);
  ForceFactories damping = kSound<ViscousDamping>;
  damping.in_float = planted<OffBy<ViscousDamping, 4>, float>;
  EXPECT_CAUGHT("force in float is another", "viscous_damping", damping);
  EXPECT_CAUGHT("heat in float is another", "viscous_damping", damping);
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
  ForceFactories damping = kSound<ViscousDamping>;
  damping.in_quadruple = planted<ThroughDouble, Quad>;
  EXPECT_CAUGHT("force in quadruple is no better than double", "viscous_damping", damping);
  ForceFactories substrate = kSound<SinusoidalSubstrate>;
  substrate.in_quadruple = planted<ShortPi, Quad>;
  EXPECT_CAUGHT("gradient in quadruple", "sinusoidal_substrate", substrate);
}

}  // namespace
}  // namespace tomlin::test
