#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "forcefields/coulomb_friction.hpp"
#include "forcefields/driving_spring.hpp"
#include "forcefields/harmonic_bonds.hpp"
#include "forcefields/memory_damping.hpp"
#include "forcefields/sinusoidal_substrate.hpp"
#include "forcefields/viscous_damping.hpp"
#include "framework/core/elements/own_state_force.hpp"
#include "tests/forcefields/planted.hpp"

/// Evaluators and bound forces that are wrong on purpose, each in one way.
namespace tomlin::test {

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

/// Eq. (18) of the paper: the y that the chain rule brings down is missing.
struct WithoutChainRule : SinusoidalSubstrate {
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    Vec<T, D> force = SinusoidalSubstrate::force(p, site);
    if constexpr (D > 1) {
      const T y = site.position[1];
      const T wave = cos_turns(site.phase(0));
      force[1] = exp(-(p.decay * y) * y) * (p.vertical_slope * wave);
    }
    return force;
  }
};

/// The decay left out of the energy, which is what the ledger would add up.
struct EnergyWithoutDecay : SinusoidalSubstrate {
  template <class T, int D>
  static T energy(const Parameters<T, D>& p, const Site<T, D>& site) {
    return p.amplitude * cos_turns(site.phase(0));
  }
};

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

struct AntiDissipative : ViscousDamping {
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    return p.coefficient * site.velocity;
  }
};

struct TwiceTheFriction : ViscousDamping {
  template <class T, int D>
  static T friction(const Parameters<T, D>& p) {
    return T(2.0) * p.coefficient;
  }
};

struct UnderstatedFriction : CoulombFriction {
  static double friction_bound(const Description& d) {
    return 0.5 * CoulombFriction::friction_bound(d);
  }
};

/// The heat of particles that are not where the body's are: velocities of the free ones for a
/// body whose particles are mapped.
template <class E, class Real, int D>
class HeatOfOthers : public ParticleForce<E, Real, D> {
 public:
  using ParticleForce<E, Real, D>::ParticleForce;
  bool heat(std::ptrdiff_t rate, Operation<Real>& operation) override {
    arguments_ = {this->body_.slot, &this->with_frame_, nullptr, rate};
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
    half_ = this->with_frame_;
    half_.own.coefficient *= Real(0.5);
    arguments_ = {this->body_.slot, &half_, nullptr, rate};
    operation = {&heat_kernel<E, Real, D>, &arguments_};
    return true;
  }

 private:
  SiteParameters<E, Real, D> half_;
  HeatArguments<Real> arguments_;
};

/// A substrate that does not hear of a new origin.
struct WithoutRebase : SinusoidalSubstrate {
  template <class T, int D>
  static T energy(const Parameters<T, D>& p, const Site<T, D>& site) {
    return SinusoidalSubstrate::energy(p, at_first_origin(site));
  }
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    return SinusoidalSubstrate::force(p, at_first_origin(site));
  }

 private:
  template <class T, int D>
  static Site<T, D> at_first_origin(Site<T, D> site) {
    for (int d = 0; d < D; ++d) site.frame.origin[d] = site.frame.phase[d] = T(0.0);
    return site;
  }
};

struct BoundTooSmall : SinusoidalSubstrate {
  template <int D>
  static double curvature_bound(const Description& d) {
    return 0.9 * SinusoidalSubstrate::curvature_bound<1>(d);
  }
};

struct BoundFarTooSmall : SinusoidalSubstrate {
  template <int D>
  static double curvature_bound(const Description& d) {
    return 0.1 * SinusoidalSubstrate::curvature_bound<D>(d);
  }
};

struct BoundAlongFarTooSmall : SinusoidalSubstrate {
  template <int D>
  static double curvature_bound_along(const Description& d, int axis) {
    return 0.1 * SinusoidalSubstrate::curvature_bound_along<D>(d, axis);
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

/// `add` that overwrites; `set` is valid.
template <class E, class Real, int D>
class AddsOverwriting : public ParticleForce<E, Real, D> {
 public:
  using ParticleForce<E, Real, D>::ParticleForce;
  std::vector<Pass<double>> passes() override {
    auto passes = ParticleForce<E, Real, D>::passes();
    for (Pass<double>& pass : passes) pass.add = pass.set;
    return passes;
  }
};

/// The last bit differs on the wider sets.
struct OneBitOff : SinusoidalSubstrate {
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    return T(1 + std::numeric_limits<Scalar<T>>::epsilon()) * SinusoidalSubstrate::force(p, site);
  }
};

template <class E, class Real, int D>
class TwiceTheHessian : public ParticleForce<E, Real, D> {
 public:
  using ParticleForce<E, Real, D>::ParticleForce;
  void hessian(const Stage<double>& stage, HessianSink& sink) const override {
    ParticleForce<E, Real, D>::hessian(stage, sink);
    ParticleForce<E, Real, D>::hessian(stage, sink);
  }
};

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

/// The factor 1/2 left out of a spring's energy.
struct WithoutOneHalf : DrivingSpring {
  template <class T, int D>
  static T energy(const Parameters<T, D>& p, const Site<T, D>& site) {
    return T(2.0) * DrivingSpring::energy(p, site);
  }
};

/// The support stands still within a step.
struct ElapsedForgotten : DrivingSpring {
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, Site<T, D> site) {
    site.elapsed = T(0.0);
    return DrivingSpring::force(p, site);
  }
};

/// Along y what belongs along x.
struct WrongAxis : SinusoidalSubstrate {
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    Vec<T, D> force = SinusoidalSubstrate::force(p, site);
    if constexpr (D > 1) std::swap(force[0], force[1]);
    return force;
  }
};

struct WithoutForce : SinusoidalSubstrate {
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>&, const Site<T, D>&) {
    return {};
  }
};

struct EnergyTwice : SinusoidalSubstrate {
  template <class T, int D>
  static T energy(const Parameters<T, D>& p, const Site<T, D>& site) {
    return T(2.0) * SinusoidalSubstrate::energy(p, site);
  }
};

/// No number from a hundred lengths on.
struct NoNumberFarAway : SinusoidalSubstrate {
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    const T far = site.position[0] * T(1.0 / 100.0);
    // The root of a negative number beyond, a plain one within.
    const T one = sqrt(T(1.0) - far * far);
    Vec<T, D> force = SinusoidalSubstrate::force(p, site);
    force[0] = force[0] * (one / one);
    return force;
  }
};

/// Feels velocities that it does not tell of.
struct SecretDrag : SinusoidalSubstrate {
  static constexpr Reads reads{.velocity = true};
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    Vec<T, D> force = SinusoidalSubstrate::force(p, site);
    force[0] = force[0] - T(1e-6) * p.amplitude * site.velocity[0];
    return force;
  }
};

/// Twice the drag above a hundred lengths per unit of time.
struct DragThatDoubles : ViscousDamping {
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    const T fast = max(T(0.0), min(T(1.0), norm_squared(site.velocity) - T(1e4)));
    return -(p.coefficient * (T(1.0) + fast)) * site.velocity;
  }
};

/// Everything passed on to a valid substrate; what follows changes one thing of it each.
template <class E, class Real, int D>
class NegativeHessian : public ParticleForce<E, Real, D> {
 public:
  using ParticleForce<E, Real, D>::ParticleForce;
  void hessian(const Stage<Real>& stage, HessianSink& sink) const override {
    Negative negative(sink);
    ParticleForce<E, Real, D>::hessian(stage, negative);
  }

 private:
  class Negative : public HessianSink {
   public:
    explicit Negative(HessianSink& sink) : sink_(sink) {}
    void site(std::size_t body, std::size_t particle, int a, int b, double value) override {
      sink_.site(body, particle, a, b, -value);
    }
    void pair(std::size_t, std::size_t, std::size_t, std::size_t, int, int, double) override {}
    void block(std::size_t, std::size_t, int, std::size_t, std::size_t, int, double) override {}
    void centre(std::size_t, const double*, int, int, double) override {}

   private:
    HessianSink& sink_;
  };
};

/// A term of the energy that only time changes.
template <class E, class Real, int D>
class EnergyThatDrifts : public ParticleForce<E, Real, D> {
 public:
  using ParticleForce<E, Real, D>::ParticleForce;
  bool depends_on_time() const override { return true; }
  void begin_step(const DoubleDouble& time) override { time_ = static_cast<double>(time); }
  Real energy(const Stage<Real>& stage) const override {
    return ParticleForce<E, Real, D>::energy(stage) + Real(1e-3 * time_);
  }

 private:
  double time_ = 0.0;
};

/// One more kernel call, after those of the valid force.
template <class E, class Real, int D>
class WithAnotherPass : public ParticleForce<E, Real, D> {
 public:
  using ParticleForce<E, Real, D>::ParticleForce;
  std::vector<Pass<Real>> passes() override {
    auto passes = ParticleForce<E, Real, D>::passes();
    passes.push_back({nullptr, kernel(), this, {{this->body_.index, false}}, kRankPairs});
    return passes;
  }

 protected:
  virtual Kernel<Real> kernel() const = 0;
  static const WithAnotherPass& self(const void* arguments) {
    return *static_cast<const WithAnotherPass*>(arguments);
  }
  const BodySlot<Real>& slot() const { return this->body_.slot; }
};

/// Stronger with each evaluation.
template <class E, class Real, int D>
class CountsItsCalls : public WithAnotherPass<E, Real, D> {
 public:
  using WithAnotherPass<E, Real, D>::WithAnotherPass;

 private:
  Kernel<Real> kernel() const override {
    return [](const void* arguments, const Stage<Real>& stage) {
      const auto& self = static_cast<const CountsItsCalls&>(CountsItsCalls::self(arguments));
      Real* f = (self.slot().mapped ? stage.mapped_force : stage.force) + self.slot().offset;
      self.calls_ += 1.0;
      f[0] += Real(1e-9 * self.calls_);
    };
  }
  mutable double calls_ = 0.0;
};

/// Stronger within each step, which it does not tell of.
template <class E, class Real, int D>
class FeelsTheStep : public WithAnotherPass<E, Real, D> {
 public:
  using WithAnotherPass<E, Real, D>::WithAnotherPass;

 private:
  Kernel<Real> kernel() const override {
    return [](const void* arguments, const Stage<Real>& stage) {
      const auto& self = static_cast<const FeelsTheStep&>(FeelsTheStep::self(arguments));
      Real* f = (self.slot().mapped ? stage.mapped_force : stage.force) + self.slot().offset;
      f[0] = f[0] * (Real(1.0) + Real(1e-3) * stage.elapsed);
    };
  }
};

/// Lags behind: the force is that of the evaluation before.
template <class E, class Real, int D>
class OneBehind : public WithAnotherPass<E, Real, D> {
 public:
  using WithAnotherPass<E, Real, D>::WithAnotherPass;

 private:
  Kernel<Real> kernel() const override {
    return [](const void* arguments, const Stage<Real>& stage) {
      const auto& self = static_cast<const OneBehind&>(OneBehind::self(arguments));
      Real* f = (self.slot().mapped ? stage.mapped_force : stage.force) + self.slot().offset;
      std::swap(self.before_, f[0]);
    };
  }
  mutable Real before_{};
};

/// Pushes what is not its own: the padding behind its last particle, where others stand.
template <class E, class Real, int D>
class BeyondItsBody : public WithAnotherPass<E, Real, D> {
 public:
  using WithAnotherPass<E, Real, D>::WithAnotherPass;

 private:
  Kernel<Real> kernel() const override {
    return [](const void* arguments, const Stage<Real>& stage) {
      const auto& self = static_cast<const BeyondItsBody&>(BeyondItsBody::self(arguments));
      Real* f = (self.slot().mapped ? stage.mapped_force : stage.force) + self.slot().offset;
      f[self.slot().stride * (D - 1) + self.slot().count] += Real(0.5);
    };
  }
};

/// Does not come back when the origin does.
template <class E, class Real, int D>
class StaleAfterRebase : public ParticleForce<E, Real, D> {
 public:
  using ParticleForce<E, Real, D>::ParticleForce;
  void rebase(const Origin& origin) override {
    ParticleForce<E, Real, D>::rebase(origin);
    if (origin.cells[0] != 0) this->parameters_.amplitude *= Real(1.0 + 1e-9);
  }
};

/// A memory without the factor 1/2 in what its spring stores.
struct MemoryStoresTwice : MemoryDamping {
  template <class T, int D>
  static T energy(const Parameters<T, D>& p, const OwnSite<T, D>& site) {
    return p.stiffness * norm_squared(site.own);
  }
  template <class Real>
  static constexpr auto kernels() {
    return own_state_table<MemoryStoresTwice, Real>();
  }
};

/// A memory that fades twice as fast as its heat says.
struct MemoryFadesFaster : MemoryDamping {
  template <class T, int D>
  static Vec<T, D> rate(const Parameters<T, D>& p, const OwnSite<T, D>& site) {
    return site.velocity - (T(2.0) * p.rate) * site.own;
  }
  template <class Real>
  static constexpr auto kernels() {
    return own_state_table<MemoryFadesFaster, Real>();
  }
};

template <class E>
inline constexpr ElementTable<double> kOwnStateTable = own_state_table<E, double>();
template <class E>
inline constexpr KernelTables kOwnStateTables = tables_of<double>({&kOwnStateTable<E>, nullptr,
                                                                   nullptr});

template <class E>
std::unique_ptr<BoundForce<double>> planted_memory(const void* description,
                                                   const Binding<double>& binding) {
  return on_particles_with_state<E, kOwnStateTables<E>>().in_double(description, binding);
}

}  // namespace tomlin::test
