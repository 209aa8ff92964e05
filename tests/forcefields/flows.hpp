#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <vector>

#include "forcefields/memory_damping.hpp"
#include "forcefields/viscous_damping.hpp"
#include "framework/core/elements/own_state_force.hpp"
#include "framework/core/numbers/random.hpp"
#include "tests/forcefields/planted.hpp"

/// Forces with an operator of their own (framework/core/system/flow.hpp), right and wrong.
namespace tomlin::test {

/// One coordinate of one flow.
struct Flowing {
  const FlowStage<double>& stage;
  std::size_t at;
  double coefficient;
  double inverse_mass;
  double h;

  double rate() const { return coefficient * inverse_mass; }
};

/// v' = v exp(-c h/m).
struct ExactDecay {
  static double velocity(const Flowing& f, double v) { return v * std::exp(-f.rate() * f.h); }
  static double heat(const Flowing&, double lost, double) { return lost; }
};

/// exp(-c h) instead of exp(-c h/m).
struct DecayWithoutMass : ExactDecay {
  static double velocity(const Flowing& f, double v) { return v * std::exp(-f.coefficient * f.h); }
};

struct DecayToFirstOrder : ExactDecay {
  static double velocity(const Flowing& f, double v) { return v * (1.0 - f.rate() * f.h); }
};

/// Second order, stable and symmetric, but not exact: the implicit midpoint rule.
struct DecayByMidpoint : ExactDecay {
  static double velocity(const Flowing& f, double v) {
    const double half = 0.5 * f.rate() * f.h;
    return v * (1.0 - half) / (1.0 + half);
  }
};

/// Also what is held.
struct DecayOfTheHeld : ExactDecay {
  static double velocity(const Flowing& f, double v) {
    return f.inverse_mass > 0.0 ? ExactDecay::velocity(f, v) : 1.0;
  }
};

struct DecayWithHalfTheHeat : ExactDecay {
  static double heat(const Flowing&, double lost, double) { return 0.5 * lost; }
};

/// The power at the start times h, as a rate would be integrated.
struct DecayWithHeatOfItsRate : ExactDecay {
  static double heat(const Flowing& f, double, double v) { return f.coefficient * v * v * f.h; }
};

/// Slower with each call.
struct DecayThatCounts : ExactDecay {
  static double velocity(const Flowing& f, double v) {
    static std::uint64_t calls = 0;
    return v * std::exp(-f.rate() * f.h) * (1.0 + 1e-9 * static_cast<double>(++calls));
  }
};

inline constexpr double kTemperature = 0.7;  // times Boltzmann's constant

/// An Ornstein-Uhlenbeck process by its exact solution, but for the shape of the noise: uniform
/// numbers of variance one in place of normal ones.
struct Thermal : ExactDecay {
  static double noise(const Flowing& f) {
    return std::sqrt(3.0) * uniform_symmetric(f.stage.key, {f.stage.step, f.stage.part, f.at, 0});
  }
  static double kicked(const Flowing& f, double v, double noise) {
    const double spread = -kTemperature * f.inverse_mass * std::expm1(-2.0 * f.rate() * f.h);
    return ExactDecay::velocity(f, v) + std::sqrt(spread) * noise;
  }
  static double velocity(const Flowing& f, double v) { return kicked(f, v, noise(f)); }
};

/// Numbers in the order of the calls.
struct ThermalInSequence : Thermal {
  static double velocity(const Flowing& f, double v) {
    static std::uint64_t calls = 0;
    return kicked(f, v, uniform_symmetric(f.stage.key, {++calls, 0, 0, 0}));
  }
};

/// Draws the same numbers in every step.
struct ThermalWithoutStep : Thermal {
  static double velocity(const Flowing& f, double v) {
    return kicked(f, v, uniform_symmetric(f.stage.key, {0, f.stage.part, f.at, 0}));
  }
};

/// Draws the same numbers for every seed of the scene and for every force.
struct ThermalWithoutKey : Thermal {
  static double velocity(const Flowing& f, double v) {
    return kicked(f, v, uniform_symmetric({}, {f.stage.step, f.stage.part, f.at, 0}));
  }
};

struct FlowThatThrows : ExactDecay {
  static double velocity(const Flowing&, double) { throw std::runtime_error("out of flow"); }
};

/// A damper on free particles that hands out the flow of Law.
template <class Law>
struct WithFlow {
  template <class E, class Real, int D>
  class Force : public ParticleForce<E, Real, D>, public ExactFlow<double> {
   public:
    using ParticleForce<E, Real, D>::ParticleForce;
    bool flow(Flow<double>& flow) override {
      if (this->body_.slot.mapped) return false;
      flow = {&run, &drag, this, {}};
      return true;
    }

   protected:
    template <class Use>
    static double for_coordinates(const void* arguments, Use&& use) {
      const auto& self = *static_cast<const Force*>(arguments);
      const BodySlot<double>& slot = self.body_.slot;
      double total = 0.0;
      for (std::size_t d = 0; d < D; ++d) {
        for (std::size_t i = 0; i < slot.count; ++i) {
          total += use(slot.offset + d * slot.stride + i, self.parameters_.coefficient);
        }
      }
      return total;
    }
    static double run(const void* arguments, const FlowStage<double>& stage, double h) {
      return for_coordinates(arguments, [&](std::size_t at, double coefficient) {
        const Flowing f{stage, at, coefficient, stage.inverse_mass[at], h};
        double& v = stage.velocity[at];
        const double before = v;
        v = Law::velocity(f, v);
        if (f.inverse_mass == 0.0) return 0.0;
        return Law::heat(f, 0.5 * (before - v) * (before + v) / f.inverse_mass, before);
      });
    }
    static double drag(const void* arguments, const Stage<double>& stage) {
      return for_coordinates(arguments, [&](std::size_t at, double coefficient) {
        const double v = stage.velocity[at];
        stage.force[at] -= coefficient * v;
        return coefficient * v * v;
      });
    }
  };

  /// It is nothing but the operator.
  template <class E, class Real, int D>
  class Alone : public Force<E, Real, D> {
   public:
    using Force<E, Real, D>::Force;
    std::vector<Pass<double>> passes() override { return {}; }
    bool heat(std::ptrdiff_t, Operation<double>&) override { return false; }
    bool is_friction() const override { return false; }
    void friction(FrictionSink&) const override {}
  };
};

/// Drag that remembers, with the exact flow of velocities v and own variables u together:
///   v' = -p u/m,  u' = r (v - u)
template <class Law>
class MemoryWithFlow {
 public:
  template <int D>
  class Force : public OwnStateForce<MemoryDamping, double, D>, public ExactFlow<double> {
   public:
    Force(const MemoryDampingDescription& d, const Binding<double>& binding)
        : OwnStateForce<MemoryDamping, double, D>(d, binding, kOwnTables, kRankCheap),
          slot_(binding.bodies.front()->slot),
          rate_(1.0 / d.memory_time),
          pull_(d.coefficient) {}
    void place_own(std::size_t first) override {
      OwnStateForce<MemoryDamping, double, D>::place_own(first);
      first_ = first;
    }
    bool flow(Flow<double>& flow) override {
      if (slot_.mapped) return false;
      flow = {&run, &drag, this, {}};
      return true;
    }

   private:
    template <class Use>
    static double for_coordinates(const void* arguments, Use&& use) {
      const auto& self = *static_cast<const Force*>(arguments);
      double total = 0.0;
      for (std::size_t d = 0; d < D; ++d) {
        for (std::size_t i = 0; i < self.slot_.count; ++i) {
          total += use(self, self.slot_.offset + d * self.slot_.stride + i,
                       self.first_ + d * self.slot_.count + i);
        }
      }
      return total;
    }
    static double run(const void* arguments, const FlowStage<double>& stage, double h) {
      return for_coordinates(arguments, [&](const Force& self, std::size_t at, std::size_t own) {
        double& v = stage.velocity[at];
        double& u = stage.own[own];
        const double inverse_mass = stage.inverse_mass[at];
        const double v0 = v;
        const double u0 = u;
        // About the mean of the eigenvalues, -r/2, the matrix squares to a number.
        const double half = 0.5 * self.rate_;
        const double square = half * half - self.rate_ * self.pull_ * inverse_mass;
        const double s = std::sqrt(std::abs(square));
        const double even = square > 0.0
                                ? 0.5 * (std::exp((s - half) * h) + std::exp(-(s + half) * h))
                                : std::exp(-half * h) * std::cos(s * h);
        const double odd = square > 0.0
                               ? 0.5 * (std::exp((s - half) * h) - std::exp(-(s + half) * h)) / s
                               : std::exp(-half * h) * std::sin(s * h) / s;
        v = even * v0 + odd * (half * v0 - self.pull_ * inverse_mass * u0);
        u = even * u0 + odd * (self.rate_ * v0 - half * u0);
        const double kinetic = inverse_mass > 0.0 ? 0.5 * (v0 - v) * (v0 + v) / inverse_mass : 0.0;
        const double stored = 0.5 * (self.pull_ / self.rate_) * (u0 - u) * (u0 + u);
        return Law::heat(kinetic, stored);
      });
    }
    static double drag(const void* arguments, const Stage<double>& stage) {
      return for_coordinates(arguments, [&](const Force& self, std::size_t at, std::size_t own) {
        stage.force[at] -= self.pull_ * stage.own[own];
        stage.rates[own] = self.rate_ * (stage.velocity[at] - stage.own[own]);
        return self.pull_ * stage.own[own] * stage.own[own];
      });
    }

    static constexpr ElementTable<double> kOwnTable = own_state_table<MemoryDamping, double>();
    static constexpr KernelTables kOwnTables = tables_of<double>({&kOwnTable, nullptr, nullptr});

    BodySlot<double> slot_;
    double rate_;
    double pull_;
    std::size_t first_ = 0;
  };

  static std::unique_ptr<BoundForce<double>> bind(const void* description,
                                                  const Binding<double>& binding) {
    const auto& d = *static_cast<const MemoryDampingDescription*>(description);
    return for_dimension<double>(binding.dimension,
                                 [&]<int D>() -> std::unique_ptr<BoundForce<double>> {
                                   return std::make_unique<Force<D>>(d, binding);
                                 });
  }
};

struct WholeHeat {
  static double heat(double kinetic, double stored) { return kinetic + stored; }
};
/// Counts the energy that the force stores as dissipated.
struct KineticHeat {
  static double heat(double kinetic, double) { return kinetic; }
};

}  // namespace tomlin::test
