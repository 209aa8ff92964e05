#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "forcefields/constant_force.hpp"
#include "forcefields/driving_spring.hpp"
#include "forcefields/harmonic_bonds.hpp"
#include "forcefields/sinusoidal_substrate.hpp"
#include "forcefields/viscous_damping.hpp"
#include "tests/forcefields/only_energy.hpp"
#include "tests/forcefields/planted.hpp"

// The checks of conformance_test.cpp against forces that are wrong on purpose.

namespace tomlin::test {
namespace {

/// The evaluators themselves, bound here: the checker is silent, so what it says below is said of
/// the fault and not of the way it was planted.
TEST(PlantedFaults, SoundForcesBoundTheSameWayAreNotAccused) {
  EXPECT_EQ(broken_claims("constant_force", planted<ConstantForce>), std::vector<std::string>{});
  EXPECT_EQ(broken_claims("sinusoidal_substrate", planted<SinusoidalSubstrate>),
            std::vector<std::string>{});
  EXPECT_EQ(broken_claims("viscous_damping", planted<ViscousDamping>), std::vector<std::string>{});
  EXPECT_EQ(broken_claims("sinusoidal_substrate", planted<OnlyEnergyOnSites<SinusoidalSubstrate>>),
            std::vector<std::string>{});
}

/// A substrate whose force is multiplied by `numerator`/2 on each axis.
template <int x_halves, int y_halves>
struct ScaledSubstrate : SinusoidalSubstrate {
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    Vec<T, D> force = SinusoidalSubstrate::force(p, site);
    force[0] = T(0.5 * x_halves) * force[0];
    if constexpr (D > 1) force[1] = T(0.5 * y_halves) * force[1];
    return force;
  }
};

TEST(PlantedFaults, WrongSign) {
  EXPECT_CAUGHT("gradient", "sinusoidal_substrate", (planted<ScaledSubstrate<-2, -2>>));
  EXPECT_CAUGHT("gradient", "sinusoidal_substrate", (planted<ScaledSubstrate<2, -2>>));
}

TEST(PlantedFaults, FactorOfTwo) {
  EXPECT_CAUGHT("gradient", "sinusoidal_substrate", (planted<ScaledSubstrate<4, 4>>));
  EXPECT_CAUGHT("gradient", "sinusoidal_substrate", (planted<ScaledSubstrate<2, 1>>));
}

/// Eq. (18) of the paper: the y that the chain rule brings down is missing.
struct WithoutChainRule : SinusoidalSubstrate {
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    Vec<T, D> force = SinusoidalSubstrate::force(p, site);
    if constexpr (D > 1) {
      const T y = site.position[1];
      const T wave = cos_turns(fma(site.position[0], p.wave_number, p.phase));
      force[1] = exp(-(p.decay * y) * y) * (p.vertical_slope * wave);
    }
    return force;
  }
};

TEST(PlantedFaults, MissingChainRuleOfTheDecay) {
  EXPECT_CAUGHT("gradient", "sinusoidal_substrate", planted<WithoutChainRule>);
}

/// The decay left out of the energy, which is what the ledger would add up.
struct EnergyWithoutDecay : SinusoidalSubstrate {
  template <class T, int D>
  static T energy(const Parameters<T, D>& p, const Site<T, D>& site) {
    return p.amplitude * cos_turns(fma(site.position[0], p.wave_number, p.phase));
  }
};

TEST(PlantedFaults, EnergyOff) {
  EXPECT_CAUGHT("gradient", "sinusoidal_substrate", planted<EnergyWithoutDecay>);
}

/// Bonds whose reaction is lost, or acts on the next particle.
template <int reaction_shift>
class LopsidedBonds : public BoundForce<double> {
 public:
  LopsidedBonds(double stiffness, const Binding<double>& binding) : body_(*binding.bodies.front()) {
    arguments_.body = body_.slot;
    arguments_.axes = binding.dimension;
    arguments_.stiffness = stiffness;
  }
  std::vector<Pass<double>> passes() override {
    return {{nullptr, &add, &arguments_, {{body_.index, false}}, kRankPairs}};
  }

 private:
  struct Arguments {
    BodySlot<double> body;
    int axes = 0;
    double stiffness = 0.0;
  };

  static void add(const void* arguments, const Stage<double>& stage) {
    const auto& a = *static_cast<const Arguments*>(arguments);
    const double* x = (a.body.mapped ? stage.mapped_position : stage.position) + a.body.offset;
    double* f = (a.body.mapped ? stage.mapped_force : stage.force) + a.body.offset;
    for (std::size_t i = 0; i + 1 < a.body.count; ++i) {
      for (int d = 0; d < a.axes; ++d) {
        const std::size_t at = d * a.body.stride;
        const double pull = a.stiffness * (x[at + i + 1] - x[at + i]);
        f[at + i] += pull;
        if (reaction_shift >= 0) f[at + (i + 1 + reaction_shift) % a.body.count] -= pull;
      }
    }
  }

  BoundBody<double> body_;
  Arguments arguments_;
};

template <int reaction_shift>
std::unique_ptr<BoundForce<double>> bind_lopsided(const void* description,
                                                  const Binding<double>& binding) {
  return std::make_unique<LopsidedBonds<reaction_shift>>(
      static_cast<const HarmonicBondsDescription*>(description)->stiffness, binding);
}

TEST(PlantedFaults, PairsThatAreNotReciprocal) {
  EXPECT_CAUGHT("internal", "harmonic_bonds", bind_lopsided<-1>);
  EXPECT_CAUGHT("gradient", "harmonic_bonds", bind_lopsided<-1>);
  EXPECT_CAUGHT("hessian", "harmonic_bonds", bind_lopsided<-1>);
}

/// Forces sum to zero, so only the torque tells.
TEST(PlantedFaults, ReactionOnTheWrongParticle) {
  EXPECT_CAUGHT("internal", "harmonic_bonds", bind_lopsided<1>);
}

struct AntiDissipative : ViscousDamping {
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    return p.coefficient * site.velocity;
  }
};

TEST(PlantedFaults, DampingThatDrives) {
  EXPECT_CAUGHT("dissipative", "viscous_damping", planted<AntiDissipative>);
  EXPECT_CAUGHT("friction", "viscous_damping", planted<AntiDissipative>);
  EXPECT_CAUGHT("flow", "viscous_damping", planted<AntiDissipative>);
}

/// exp(-c h) instead of exp(-c h/m).
template <class E, class Real, int D>
class FlowWithoutMass : public ParticleForce<E, Real, D> {
 public:
  using ParticleForce<E, Real, D>::ParticleForce;
  void flow(const Stage<double>&, const double*, double* velocity, double h) const override {
    const BodySlot<double>& slot = this->body_.slot;
    for (int d = 0; d < D; ++d) {
      for (std::size_t i = 0; i < slot.count; ++i) {
        velocity[slot.offset + d * slot.stride + i] *= E::decay_factor(this->parameters_, h);
      }
    }
  }
};

/// First-order in h: 1 - c h/m.
struct FlowToFirstOrder : ViscousDamping {
  template <class T, int D>
  static T decay_factor(const Parameters<T, D>& p, const T& h_over_mass) {
    return T(1.0) - p.coefficient * h_over_mass;
  }
};

struct TwiceTheFriction : ViscousDamping {
  template <class T, int D>
  static T friction(const Parameters<T, D>& p) {
    return T(2.0) * p.coefficient;
  }
};

TEST(PlantedFaults, WrongFlowOrFriction) {
  EXPECT_CAUGHT("flow", "viscous_damping", (wrapped<FlowWithoutMass, ViscousDamping>));
  EXPECT_CAUGHT("flow", "viscous_damping", planted<FlowToFirstOrder>);
  EXPECT_CAUGHT("friction", "viscous_damping", planted<TwiceTheFriction>);
}

/// The heat of particles that are not where the body's are: velocities of the free ones for a
/// body whose particles are mapped.
template <class E, class Real, int D>
class HeatOfOthers : public ParticleForce<E, Real, D> {
 public:
  using ParticleForce<E, Real, D>::ParticleForce;
  bool heat(std::ptrdiff_t rate, Operation<Real>& operation) override {
    arguments_ = {this->body_.slot, &this->parameters_, rate};
    arguments_.body.mapped = false;
    operation = {&heat_kernel<E, Real, D>, &arguments_};
    return true;
  }

 private:
  HeatArguments<Real> arguments_;
};

/// The ledger would not hear of this damper.
template <class E, class Real, int D>
class WithoutHeat : public ParticleForce<E, Real, D> {
 public:
  using ParticleForce<E, Real, D>::ParticleForce;
  bool heat(std::ptrdiff_t, Operation<Real>&) override { return false; }
};

/// Half the power, as in Rayleigh's dissipation function.
template <class E, class Real, int D>
class HalfTheHeat : public ParticleForce<E, Real, D> {
 public:
  using ParticleForce<E, Real, D>::ParticleForce;
  bool heat(std::ptrdiff_t rate, Operation<Real>& operation) override {
    half_ = this->parameters_;
    half_.coefficient *= Real(0.5);
    arguments_ = {this->body_.slot, &half_, rate};
    operation = {&heat_kernel<E, Real, D>, &arguments_};
    return true;
  }

 private:
  typename E::template Parameters<Real, D> half_;
  HeatArguments<Real> arguments_;
};

TEST(PlantedFaults, HeatOff) {
  EXPECT_CAUGHT("heat", "viscous_damping", (wrapped<HeatOfOthers, ViscousDamping>));
  EXPECT_CAUGHT("heat", "viscous_damping", (wrapped<WithoutHeat, ViscousDamping>));
  EXPECT_CAUGHT("heat", "viscous_damping", (wrapped<HalfTheHeat, ViscousDamping>));
}

TEST(PlantedFaults, ClaimsThatAreNotTrue) {
  EXPECT_CAUGHT("gradient", "viscous_damping", nullptr,
                [](ForceRecord& r) { r.traits.conservative = true; });
  EXPECT_CAUGHT("velocity", "viscous_damping", nullptr,
                [](ForceRecord& r) { r.traits.depends_on_velocity = false; });
  EXPECT_CAUGHT("velocity", "sinusoidal_substrate", nullptr,
                [](ForceRecord& r) { r.traits.depends_on_velocity = true; });
  EXPECT_CAUGHT("time", "driving_spring", nullptr,
                [](ForceRecord& r) { r.traits.depends_on_time = false; });
  EXPECT_CAUGHT("time", "sinusoidal_substrate", nullptr,
                [](ForceRecord& r) { r.traits.depends_on_time = true; });
  EXPECT_CAUGHT("internal", "sinusoidal_substrate", nullptr,
                [](ForceRecord& r) { r.traits.internal = true; });
  EXPECT_CAUGHT("internal is not claimed", "harmonic_bonds", nullptr,
                [](ForceRecord& r) { r.traits.internal = false; });
  EXPECT_CAUGHT("conservative is not claimed", "sinusoidal_substrate", nullptr,
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

/// A substrate that does not hear of a new origin.
struct WithoutRebase : SinusoidalSubstrate {
  template <class T, int D>
  static void rebase(Parameters<T, D>&, const Description&, const Origin&) {}
};

TEST(PlantedFaults, OriginForgotten) {
  EXPECT_CAUGHT("origin", "sinusoidal_substrate", planted<WithoutRebase>);
}

struct BoundTooSmall : SinusoidalSubstrate {
  template <int D>
  static double curvature_bound(const Description& d) {
    return 0.9 * SinusoidalSubstrate::curvature_bound<1>(d);
  }
};

struct BoundTooLarge : SinusoidalSubstrate {
  template <int D>
  static double curvature_bound(const Description& d) {
    return 4.0 * SinusoidalSubstrate::curvature_bound<D>(d);
  }
};

struct BoundAlongTooSmall : SinusoidalSubstrate {
  template <int D>
  static double curvature_bound_along(const Description& d, int axis) {
    return 0.9 * SinusoidalSubstrate::curvature_bound_along<D>(d, axis);
  }
};

TEST(PlantedFaults, CurvatureBoundThatIsNone) {
  EXPECT_CAUGHT("curvature bound", "sinusoidal_substrate", planted<BoundAlongTooSmall>);
  EXPECT_CAUGHT("curvature bound", "sinusoidal_substrate", planted<BoundTooSmall>);
  EXPECT_CAUGHT("curvature bound is far too large", "sinusoidal_substrate", planted<BoundTooLarge>);
}

/// `set` that adds to what is there, and `add` that overwrites.
template <class E, class Real, int D>
class SwappedPasses : public ParticleForce<E, Real, D> {
 public:
  using ParticleForce<E, Real, D>::ParticleForce;
  std::vector<Pass<double>> passes() override {
    auto passes = ParticleForce<E, Real, D>::passes();
    for (Pass<double>& pass : passes) std::swap(pass.set, pass.add);
    return passes;
  }
};

TEST(PlantedFaults, SetAndAddSwapped) {
  EXPECT_CAUGHT("set and add", "sinusoidal_substrate",
                (wrapped<SwappedPasses, SinusoidalSubstrate>));
}

/// The last bit differs on the wider sets.
struct OneBitOff : SinusoidalSubstrate {
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    return T(1 + std::numeric_limits<Scalar<T>>::epsilon()) * SinusoidalSubstrate::force(p, site);
  }
};

TEST(PlantedFaults, LastBitOfAnInstructionSet) {
  if (!is_supported(InstructionSet::avx2)) GTEST_SKIP() << "only one instruction set here";
  EXPECT_CAUGHT("instruction sets", "sinusoidal_substrate",
                (planted_by_set<SinusoidalSubstrate, OneBitOff, double>));
  EXPECT_CAUGHT("instruction sets", "sinusoidal_substrate",
                ForceFactories(planted<SinusoidalSubstrate>,
                               planted_by_set<SinusoidalSubstrate, OneBitOff, float>));
}

template <class E, class Real, int D>
class TwiceTheHessian : public ParticleForce<E, Real, D> {
 public:
  using ParticleForce<E, Real, D>::ParticleForce;
  void hessian(const Stage<double>& stage, HessianSink& sink) const override {
    ParticleForce<E, Real, D>::hessian(stage, sink);
    ParticleForce<E, Real, D>::hessian(stage, sink);
  }
};

TEST(PlantedFaults, HessianOff) {
  EXPECT_CAUGHT("hessian", "sinusoidal_substrate", (wrapped<TwiceTheHessian, SinusoidalSubstrate>));
}

/// A driver whose power has the sign of what the body receives; the checker only needs the rates.
struct PowerOfTheWrongSign : DrivingSpring {
  template <class T, int D>
  static T power(const Parameters<T, D>& p, const Site<T, D>&, const Vec<T, D>& force) {
    return -dot(force, p.velocity);
  }
};

template <class E, class Real, int D>
class PlainDriver : public ParticleForce<E, Real, D> {
 public:
  PlainDriver(const DrivingSpringDescription& description, const Binding<double>& binding,
              const KernelTables& tables, int rank)
      : ParticleForce<E, Real, D>(description, binding, tables, rank) {
    drive_.velocity = description.velocity.components;
  }
  bool depends_on_time() const override { return true; }
  void begin_step(const DoubleDouble& time) override {
    for (int d = 0; d < D; ++d) {
      this->parameters_.travel[d] =
          static_cast<double>(time * this->parameters_.velocity[d]) - shift_[d];
    }
  }
  void rebase(const Origin& origin) override {
    for (int d = 0; d < D; ++d) {
      shift_[d] = static_cast<double>(origin.cells[d]) * origin.unit[d];
    }
  }
  const Drive* drive() const override { return &drive_; }

 private:
  double shift_[D] = {};
  Drive drive_;
};

TEST(PlantedFaults, DriversPower) {
  EXPECT_EQ(broken_claims("driving_spring", (wrapped<PlainDriver, DrivingSpring>)),
            std::vector<std::string>{});
  EXPECT_CAUGHT("driver", "driving_spring", (wrapped<PlainDriver, PowerOfTheWrongSign>));
}

/// The factor 1/2 left out of a spring's energy.
struct WithoutOneHalf : DrivingSpring {
  template <class T, int D>
  static T energy(const Parameters<T, D>& p, const Site<T, D>& site) {
    return p.stiffness * norm_squared(extension(p, site));
  }
};

/// The pulled end stands still within a step.
struct ElapsedForgotten : DrivingSpring {
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, Site<T, D> site) {
    site.elapsed = T(0.0);
    return DrivingSpring::force(p, site);
  }
};

TEST(PlantedFaults, DriversEnergyAndTime) {
  EXPECT_CAUGHT("gradient", "driving_spring", (wrapped<PlainDriver, WithoutOneHalf>));
  EXPECT_CAUGHT("elapsed", "driving_spring", (wrapped<PlainDriver, ElapsedForgotten>));
}

}  // namespace
}  // namespace tomlin::test
