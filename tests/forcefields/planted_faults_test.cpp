#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "forcefields/constant_force.hpp"
#include "forcefields/coulomb_friction.hpp"
#include "forcefields/driving_spring.hpp"
#include "forcefields/harmonic_bonds.hpp"
#include "forcefields/sinusoidal_substrate.hpp"
#include "forcefields/viscous_damping.hpp"
#include "tests/forcefields/only_energy.hpp"
#include "tests/forcefields/planted.hpp"
#include "tests/forcefields/wrong_forces.hpp"

// The suite of conformance_test.cpp against forces that are wrong on purpose.

namespace tomlin::test {
namespace {

/// The evaluators themselves, bound here: the checker is silent, so what it says below is said of
/// the fault and not of the way it was planted.
TEST(PlantedFaults, SoundForcesBoundTheSameWayAreNotAccused) {
  EXPECT_EQ(broken_properties("constant_force", planted<ConstantForce>),
            std::vector<std::string>{});
  EXPECT_EQ(broken_properties("sinusoidal_substrate", planted<SinusoidalSubstrate>),
            std::vector<std::string>{});
  EXPECT_EQ(broken_properties("viscous_damping", planted<ViscousDamping>),
            std::vector<std::string>{});
  EXPECT_EQ(
      broken_properties("sinusoidal_substrate", planted<OnlyEnergyOnSites<SinusoidalSubstrate>>),
      std::vector<std::string>{});
}

TEST(PlantedFaults, WrongSign) {
  EXPECT_CAUGHT("conservative", "sinusoidal_substrate", (planted<ScaledSubstrate<-2, -2>>));
  EXPECT_CAUGHT("conservative", "sinusoidal_substrate", (planted<ScaledSubstrate<2, -2>>));
}

TEST(PlantedFaults, FactorOfTwo) {
  EXPECT_CAUGHT("conservative", "sinusoidal_substrate", (planted<ScaledSubstrate<4, 4>>));
  EXPECT_CAUGHT("conservative", "sinusoidal_substrate", (planted<ScaledSubstrate<2, 1>>));
}

TEST(PlantedFaults, MissingChainRuleOfTheDecay) {
  EXPECT_CAUGHT("conservative", "sinusoidal_substrate", planted<WithoutChainRule>);
}

TEST(PlantedFaults, EnergyOff) {
  EXPECT_CAUGHT("conservative", "sinusoidal_substrate", planted<EnergyWithoutDecay>);
}

TEST(PlantedFaults, PairsThatAreNotReciprocal) {
  EXPECT_CAUGHT("internal", "harmonic_bonds", bind_lopsided<-1>);
  EXPECT_CAUGHT("conservative", "harmonic_bonds", bind_lopsided<-1>);
}

/// Forces sum to zero, so only the torque tells.
TEST(PlantedFaults, ReactionOnTheWrongParticle) {
  EXPECT_CAUGHT("internal", "harmonic_bonds", bind_lopsided<1>);
}

TEST(PlantedFaults, DampingThatDrives) {
  EXPECT_CAUGHT("dissipative", "viscous_damping", planted<AntiDissipative>);
  EXPECT_CAUGHT("friction", "viscous_damping", planted<AntiDissipative>);
}

TEST(PlantedFaults, WrongFriction) {
  EXPECT_CAUGHT("friction", "viscous_damping", planted<TwiceTheFriction>);
}

TEST(PlantedFaults, FrictionBoundTooLow) {
  EXPECT_EQ(broken_properties("coulomb_friction", planted<CoulombFriction>),
            std::vector<std::string>{});
  EXPECT_CAUGHT("friction bound", "coulomb_friction", planted<UnderstatedFriction>);
}

TEST(PlantedFaults, HeatOff) {
  EXPECT_CAUGHT("balance", "viscous_damping", (wrapped<HeatOfOthers, ViscousDamping>));
  EXPECT_CAUGHT("balance", "viscous_damping", (wrapped<WithoutHeat, ViscousDamping>));
  EXPECT_CAUGHT("balance", "viscous_damping", (wrapped<HalfTheHeat, ViscousDamping>));
}

TEST(PlantedFaults, HeatOfAMemory) {
  EXPECT_EQ(broken_properties("memory_damping", planted_memory<MemoryDamping>),
            std::vector<std::string>{});
  EXPECT_CAUGHT("balance", "memory_damping", planted_memory<MemoryStoresTwice>);
  EXPECT_CAUGHT("balance", "memory_damping", planted_memory<MemoryFadesFaster>);
}

TEST(PlantedFaults, PropertiesThatAreNotTrue) {
  EXPECT_CAUGHT("conservative", "viscous_damping", nullptr,
                [](ForceRecord& r) { r.traits.conservative = true; });
  EXPECT_CAUGHT("velocity", "viscous_damping", nullptr,
                [](ForceRecord& r) { r.traits.depends_on_velocity = false; });
  EXPECT_CAUGHT("uses velocity", "sinusoidal_substrate", nullptr,
                [](ForceRecord& r) { r.traits.depends_on_velocity = true; });
  EXPECT_CAUGHT("time", "driving_spring", nullptr,
                [](ForceRecord& r) { r.traits.depends_on_time = false; });
  EXPECT_CAUGHT("uses time", "sinusoidal_substrate", nullptr,
                [](ForceRecord& r) { r.traits.depends_on_time = true; });
  EXPECT_CAUGHT("internal", "sinusoidal_substrate", nullptr,
                [](ForceRecord& r) { r.traits.internal = true; });
  EXPECT_CAUGHT("not internal", "harmonic_bonds", nullptr,
                [](ForceRecord& r) { r.traits.internal = false; });
  EXPECT_CAUGHT("not conservative", "sinusoidal_substrate", nullptr,
                [](ForceRecord& r) { r.traits.conservative = false; });
  EXPECT_CAUGHT("dissipative", "constant_force", nullptr,
                [](ForceRecord& r) { r.traits.dissipative = true; });
  EXPECT_CAUGHT("driver", "driving_spring", nullptr,
                [](ForceRecord& r) { r.traits.does_work = false; });
  EXPECT_CAUGHT("periodic", "harmonic_bonds", nullptr,
                [](ForceRecord& r) { r.traits.periodic = true; });
  EXPECT_CAUGHT("periodic", "sinusoidal_substrate", nullptr, [](ForceRecord& r) {
    r.period = [](const void* d, int axis) {
      return axis == 0 ? 1.5 * static_cast<const SinusoidalSubstrateDescription*>(d)->period : 0.0;
    };
  });
}

TEST(PlantedFaults, OriginForgotten) {
  EXPECT_CAUGHT("origin", "sinusoidal_substrate", planted<WithoutRebase>);
}

TEST(PlantedFaults, CurvatureBoundThatIsNone) {
  EXPECT_CAUGHT("stiffness", "sinusoidal_substrate", planted<BoundAlongTooSmall>);
  EXPECT_CAUGHT("stiffness", "sinusoidal_substrate", planted<BoundTooSmall>);
  EXPECT_CAUGHT("tight", "sinusoidal_substrate", planted<BoundTooLarge>);
}

TEST(PlantedFaults, SetAndAddSwapped) {
  EXPECT_CAUGHT("set and add", "sinusoidal_substrate",
                (wrapped<SwappedPasses, SinusoidalSubstrate>));
}

TEST(PlantedFaults, LastBitOfAnInstructionSet) {
  if (!is_supported(InstructionSet::avx2)) GTEST_SKIP() << "only one instruction set here";
  EXPECT_CAUGHT("same bits", "sinusoidal_substrate",
                (planted_by_set<SinusoidalSubstrate, OneBitOff, double>));
}

TEST(PlantedFaults, HessianOff) {
  EXPECT_CAUGHT("hessian", "sinusoidal_substrate", (wrapped<TwiceTheHessian, SinusoidalSubstrate>));
}

TEST(PlantedFaults, DriversPower) {
  EXPECT_EQ(broken_properties("driving_spring", (wrapped<PlainDriver, DrivingSpring>)),
            std::vector<std::string>{});
  EXPECT_CAUGHT("driver", "driving_spring", (wrapped<PlainDriver, PowerOfTheWrongSign>));
}

TEST(PlantedFaults, DriversEnergyAndTime) {
  EXPECT_CAUGHT("conservative", "driving_spring", (wrapped<PlainDriver, WithoutOneHalf>));
  EXPECT_CAUGHT("time", "driving_spring", (wrapped<PlainDriver, ElapsedForgotten>));
}

}  // namespace
}  // namespace tomlin::test
