#include "forcefields/memory_damping.hpp"

#include <algorithm>
#include <memory>

#include "framework/core/elements/own_state_force.hpp"
#include "framework/core/numbers/normal_numbers.hpp"

TOMLIN_DECLARE_KERNELS(MemoryDamping)

namespace tomlin {
namespace {

/// v' = -p u/m, u' = r (v - u), over h: v <- a v + b u, u <- c v + d u.
template <class Real>
struct MemoryFlow {
  Real a, b, c, d;

  MemoryFlow(Real rate, Real pull_by_mass, Real h) {
    // About the mean of the eigenvalues, -r/2, the matrix squares to a number.
    const Real half = Real(0.5) * rate;
    const Real square = half * half - rate * pull_by_mass;
    const Real s = sqrt(abs(square));
    Real even = exp(-(half * h));
    Real odd = even * h;
    if (square > Real(0.0)) {
      const Real slow = exp((s - half) * h);
      const Real fast = exp(-((s + half) * h));
      even = Real(0.5) * (slow + fast);
      odd = Real(0.5) * (slow - fast) / s;
    } else if (square < Real(0.0)) {
      Real sine;
      Real cosine;
      sincos_turns(s * h / tau<Real>(), sine, cosine);
      odd = even * sine / s;
      even = even * cosine;
    }
    a = even + odd * half;
    b = -(odd * pull_by_mass);
    c = odd * rate;
    d = even - odd * half;
  }
};

bool is_noisy(const MemoryDampingDescription& d) {
  return d.temperature > 0.0 && d.coefficient > 0.0;
}

/// An operator on velocities and internal variables together, with noise or without.
template <class Real, int D>
class MemoryForce : public OwnStateForce<MemoryDamping, Real, D>, public ExactFlow<Real> {
  using Base = OwnStateForce<MemoryDamping, Real, D>;

 public:
  MemoryForce(const MemoryDampingDescription& d, const Binding<Real>& binding)
      : Base(d, binding, kernels::MemoryDamping, kRankCheap),
        slot_(binding.bodies.front()->slot),
        parameters_(MemoryDamping::parameters<Real, D>(d)),
        temperature_(d.temperature) {
    if (!is_noisy(d)) return;
    for (auto& normals : normals_) normals.assign(D * slot_.stride, Real(0.0));
  }

  void place_own(std::size_t first) override {
    Base::place_own(first);
    first_ = first;
  }

  bool flow(Flow<Real>& flow) override {
    if (slot_.mapped) return false;
    flow = {&run, &drag, this, {}};
    return true;
  }

 private:
  template <class Use>
  void for_coordinates(Use&& use) const {
    for (std::size_t d = 0; d < D; ++d) {
      for (std::size_t i = 0; i < slot_.count; ++i) {
        const std::size_t at = d * slot_.stride + i;
        use(at, slot_.offset + at, first_ + d * slot_.count + i);
      }
    }
  }

  static Real run(const void* arguments, const FlowStage<Real>& stage, Real h) {
    return static_cast<const MemoryForce*>(arguments)->advance(stage, h);
  }

  Real advance(const FlowStage<Real>& stage, Real h) const {
    const bool noisy = !normals_[0].empty();
    for (std::uint64_t which = 0; noisy && which < 2; ++which) {
      fill_normals<Real>(stage.key, {stage.step, stage.part, 0, which}, D * slot_.stride,
                         slot_.count, normals_[which].data());
    }
    const Real stored = parameters_.stiffness;
    Real heat(0.0);
    for_coordinates([&](std::size_t k, std::size_t at, std::size_t own) {
      Real& v = stage.velocity[at];
      Real& u = stage.own[own];
      const Real v0 = v;
      const Real u0 = u;
      const Real inverse = stage.inverse_mass[at];
      const MemoryFlow<Real> m(parameters_.rate, parameters_.pull * inverse, h);
      v = m.a * v0 + m.b * u0;
      u = m.c * v0 + m.d * u0;
      if (noisy) add_noise(m, inverse, k, u, v);
      if (!stage.heat) return;
      if (inverse > Real(0.0)) heat += Real(0.5) * (v0 - v) * (v0 + v) / inverse;
      heat += Real(0.5) * stored * (u0 - u) * (u0 + u);
    });
    return heat;
  }

  /// Covariance of the noise, and its root (L. Cholesky).
  void add_noise(const MemoryFlow<Real>& m, Real inverse, std::size_t k, Real& u, Real& v) const {
    const Real stored = parameters_.stiffness;
    const Real sv = temperature_ * inverse;
    const Real su = stored > Real(0.0) ? temperature_ / stored : Real(0.0);
    const Real uu = max(su - (m.c * m.c * sv + m.d * m.d * su), Real(0.0));
    const Real uv = -(m.a * m.c * sv + m.b * m.d * su);
    const Real vv = max(sv - (m.a * m.a * sv + m.b * m.b * su), Real(0.0));
    if (uu > Real(0.0)) {
      const Real root = sqrt(uu);
      const Real along = uv / root;
      u = u + root * normals_[0][k];
      v = v + along * normals_[0][k] + sqrt(max(vv - along * along, Real(0.0))) * normals_[1][k];
    }
  }

  static Real drag(const void* arguments, const Stage<Real>& stage) {
    const auto& self = *static_cast<const MemoryForce*>(arguments);
    Real power(0.0);
    self.for_coordinates([&](std::size_t, std::size_t at, std::size_t own) {
      const Real u = stage.own[own];
      stage.force[at] = stage.force[at] - self.parameters_.pull * u;
      stage.rates[own] = self.parameters_.rate * (stage.velocity[at] - u);
      power += self.parameters_.pull * u * u;
    });
    return power;
  }

  BodySlot<Real> slot_;
  MemoryDamping::Parameters<Real, D> parameters_;
  Real temperature_;
  std::size_t first_ = 0;
  mutable AlignedVector<Real> normals_[2];  ///< scratch of the flow
};

template <class Real>
std::unique_ptr<BoundForce<Real>> bind_memory(const MemoryDampingDescription& d,
                                              const Binding<Real>& binding) {
  return for_dimension<Real>(binding.dimension, [&]<int D>() -> std::unique_ptr<BoundForce<Real>> {
    return std::make_unique<MemoryForce<Real, D>>(d, binding);
  });
}

Traits traits_of_memory(const MemoryDampingDescription& d) {
  return {.depends_on_velocity = true, .stochastic = is_noisy(d)};
}

}  // namespace

ForceRecord memory_damping_record() {
  using Description = MemoryDampingDescription;
  ForceRecord record = own_state_force<MemoryDamping, kernels::MemoryDamping>();
  record.name = "memory_damping";
  record.summary = "drag that remembers: generalised Langevin friction, with noise or without";
  record.equation =
      "F = -integral_0^t K(t-s) v(s) ds + R(t), K(t) = coefficient/memory_time * "
      "exp(-t/memory_time), <R(t) R(t')> = temperature * K(t-t'), per particle";
  record.source =
      "R. Zwanzig, J. Stat. Phys. 9, 215 (1973), doi:10.1007/BF01008729; H. Mori, Prog. Theor. "
      "Phys. 33, 423 (1965), doi:10.1143/PTP.33.423";
  record.parameters = {
      parameter("coefficient", &Description::coefficient, dimension::friction,
                "mass/time, per particle: the drag on what is much slower than the memory")
          .in(non_negative),
      parameter("memory_time", &Description::memory_time, dimension::time,
                "of the exponential kernel; several of these forces make a Prony series")
          .in(positive),
      parameter("temperature", &Description::temperature, dimension::temperature,
                "of the bath, in reduced units an energy: Boltzmann's constant times its "
                "temperature; no noise by default")
          .in(non_negative)
          .by_default(0.0)};
  record.traits_of = of_description<&traits_of_memory>;
  record.bind = {of_description<&bind_memory<double>>, of_description<&bind_memory<Quad>>};
  record.example = R"(# A particle that coasts to rest overshoots: the memory pulls it back.
[[body]]
type = "point"
position = [0.0]
velocity = [1.0]
particle_mass = 1.0

[[force]]
type = "memory_damping"
coefficient = 2.0
memory_time = 1.0

[run]
duration = 10.0
integrator = { type = "rk4", dt = 1e-2 }
)";
  return record;
}

}  // namespace tomlin
