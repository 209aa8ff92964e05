#pragma once

#include <cstddef>
#include <type_traits>

#include "forcefields/driving_spring.hpp"
#include "forcefields/sinusoidal_substrate.hpp"
#include "forcefields/viscous_damping.hpp"
#include "framework/core/elements/lane_kernels.hpp"
#include "integrators/midpoint_kernels.hpp"
#include "integrators/rk4_kernels.hpp"

/// Kernels that take steps of single particles on a line, replicas in lanes, with the scheme and
/// all forces in one, so that numbers stay in registers. A call of a force for each vector would
/// take as long as the kernels over all lanes.
namespace tomlin {

/// Kernels of a scheme for a damped tip on a spring, on a sinusoidal substrate. Forces that are
/// equally cheap are in the order of the scene.
struct TipBlocks {
  LaneBlock spring_first = nullptr;
  LaneBlock damping_first = nullptr;
  LaneBlock spring_first_with_heat = nullptr;
  LaneBlock damping_first_with_heat = nullptr;
};
struct PointLanesTable {
  TipBlocks rk4;
  TipBlocks midpoint;
};

inline namespace TOMLIN_TARGET {

/// The energy ledger integrates a damper's force and power as rates, after the force itself.
template <class Force>
struct HeatOf : Force {};
template <class Force>
inline constexpr bool kIsHeat = false;
template <class Force>
inline constexpr bool kIsHeat<HeatOf<Force>> = true;

/// Particles with these forces, in the order of the system's operations; their rates stand in this
/// order too.
template <class... Forces>
struct PointReplicas {
  static constexpr std::size_t kRates =
      (0 + ... + (DoesWork<Forces, 1> || kIsHeat<Forces> ? 2 : 0));

  const double* numbers[sizeof...(Forces)];

  TOMLIN_INLINE explicit PointReplicas(const SystemView<double>& s) {
    for (std::size_t k = 0; k < sizeof...(Forces); ++k) {
      numbers[k] = static_cast<const LaneArguments*>(s.operations[k].arguments)->numbers;
    }
  }

  /// Eight of them.
  struct Particle {
    const PointReplicas& all;
    std::size_t lane, width;
    Pack inverse_mass;

    TOMLIN_INLINE Pack acceleration(const Pack& x, const Pack& v, double elapsed,
                                    Pack* rates) const {
      Pack force;
      std::size_t k = 0;
      (add<Forces>(force, k, x, v, elapsed, rates), ...);
      return force * inverse_mass;
    }

   private:
    template <class E>
    TOMLIN_INLINE void add(Pack& total, std::size_t& k, const Pack& x, const Pack& v,
                           double elapsed, Pack*& rates) const {
      const double* own = all.numbers[k] + lane;
      const auto p = in_lanes<SiteParameters<E, Pack, 1>>(own, width);
      Site<Pack, 1> site;
      site.position[0] = x;
      site.velocity[0] = v;
      if constexpr (E::reads.start) site.start[0] = Pack::load(own + kSiteNumbers<E, 1> * width);
      site.elapsed = Pack(elapsed);
      site.frame = p.frame;
      const Vec<Pack, 1> force = force_on<E, Pack, 1>(p.own, site);
      if constexpr (kIsHeat<E>) {
        *rates++ = force[0];
        *rates++ = -dot(force, site.velocity);
      } else {
        total = k == 0 ? force[0] : total + force[0];
      }
      if constexpr (DoesWork<E, 1>) {
        *rates++ = force[0];
        *rates++ = E::power(p.own, site, force);
      }
      ++k;
    }
  };
  TOMLIN_INLINE Particle particle(const SystemView<double>& s, std::size_t lane) const {
    return {*this, lane, s.dofs, Pack::load(s.inverse_mass + lane)};
  }
};

struct PointLanes {
  template <class Real>
  static constexpr PointLanesTable kernels() {
    return {tips<Rk4Tableau>(), tips<MidpointTableau>()};
  }

 private:
  template <class Tableau>
  static constexpr TipBlocks tips() {
    using Steps = FixedStepKernels<Tableau>;
    using Heat = HeatOf<ViscousDamping>;
    return {&Steps::template lane_block<
                PointReplicas<DrivingSpring, ViscousDamping, SinusoidalSubstrate>>,
            &Steps::template lane_block<
                PointReplicas<ViscousDamping, DrivingSpring, SinusoidalSubstrate>>,
            &Steps::template lane_block<
                PointReplicas<DrivingSpring, ViscousDamping, SinusoidalSubstrate, Heat>>,
            &Steps::template lane_block<
                PointReplicas<ViscousDamping, DrivingSpring, SinusoidalSubstrate, Heat>>};
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
