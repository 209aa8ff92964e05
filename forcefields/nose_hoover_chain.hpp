#pragma once

#include <cstddef>
#include <cstdint>

#include "framework/core/numbers/math.hpp"
#include "framework/core/numbers/number_types.hpp"
#include "framework/core/system/flow.hpp"
#include "framework/core/system/kernel_arguments.hpp"
#include "framework/core/system/stage.hpp"

/// The Nose-Hoover chain: a deterministic thermostat of a body. A factor zeta_1 drags or drives all
/// of its velocities, as their kinetic energy is above or below that of the temperature; its
/// fluctuations are kept at the temperature by a second one, and so on.
///
///   dv_i/dt = -zeta_1 v_i             of particles, or of a rigid body's centre and rotation
///   deta_k/dt = zeta_k
///   Q_1 dzeta_1/dt = sum m_i v_i^2 - N T - Q_1 zeta_1 zeta_2
///   Q_k dzeta_k/dt = Q_{k-1} zeta_{k-1}^2 - T - Q_k zeta_k zeta_{k+1}      zeta_{M+1} = 0
///
///   T       temperature  an energy: Boltzmann's constant times the temperature
///   omega   2 pi/period
///   M       links        1: the thermostat of Nose and Hoover
///   N       coordinates of the body that move; those held are not counted
///   Q_1     N T/omega^2, and Q_k = T/omega^2 of the others
///
/// An operator alone, on velocities and on its own variables eta_1 .. eta_M, zeta_1 .. zeta_M, all
/// zero at the start. Its heat is the kinetic energy that it has taken, which is what its links
/// have: sum Q_k zeta_k^2/2 + N T eta_1 + T (eta_2 + ... + eta_M). So the energy of the scene and
/// the heat together are the conserved energy of the extended system, and their drift is the
/// scheme's.
///
/// The flow is that of the equations above to rounding, whatever the step: in units of the period
/// they are quadratic in 2K/(N T) - 1, zeta_k/omega and the factor of the velocities, whose Taylor
/// series about the start of a step follow from recurrences. As many terms are taken as count in
/// the number type, and shorter steps where too many would. So it is reversible, and preserves
/// the measure, to rounding; a scheme of second order remains one. (The composition of Martyna and
/// others, with weights of Suzuki and Yoshida, is for the same flow to fourth or sixth order.)
///
/// Source: G. J. Martyna, M. L. Klein and M. Tuckerman, J. Chem. Phys. 97 (1992) 2635,
/// doi:10.1063/1.463940, equations and Q_k; G. J. Martyna, M. E. Tuckerman, D. J. Tobias and
/// M. L. Klein, Mol. Phys. 87 (1996) 1117, doi:10.1080/00268979600100761, as a part of reversible
/// schemes; A. Jorba and M. Zou, Exp. Math. 14 (2005) 99, doi:10.1080/10586458.2005.10128904,
/// Taylor series.
namespace tomlin {

struct ForceRecord;  // framework/core/records/force.hpp

struct NoseHooverChainDescription {
  double temperature = 0.0;  ///< an energy
  double period = 0.0;
  std::int64_t links = 3;
};

ForceRecord nose_hoover_chain_record();

template <class Real>
struct NoseHooverArguments {
  BodySlot<Real> body;
  // The body's coordinates, from the first on, padding included: those of free particles, or centre
  // and rotation of a rigid body.
  std::size_t first = 0;
  std::size_t length = 0;
  const Real* mass = nullptr;  ///< [length]; zero in the padding
  // The particles' arrays of all axes: the same where they are free.
  std::size_t particle_length = 0;
  const Real* particle_mass = nullptr;
  Real freedom{};  ///< N
  Real temperature{};
  Real frequency{};        ///< omega
  std::size_t links = 0;   ///< M
  std::size_t own = 0;     ///< first of its variables
  Real* series = nullptr;  ///< scratch: [links + 2][NoseHooverChain::kTerms + 1]
  std::ptrdiff_t heat_rate = kNoRate;
};

template <class Real>
struct NoseHooverTable {
  Kernel<Real> set = nullptr;
  Kernel<Real> add = nullptr;
  Kernel<Real> heat = nullptr;
  Real (*flow)(const void* arguments, const FlowStage<Real>& stage, Real h) = nullptr;
  Real (*drag)(const void* arguments, const Stage<Real>& stage) = nullptr;
};

inline namespace TOMLIN_TARGET {

struct NoseHooverChain {
  /// Terms of a series at most: a step is shortened where they do not suffice.
  template <class Real>
  static constexpr int kTerms = sizeof(Real) == sizeof(double) ? 24 : 48;
  /// Most steps of a flow. More would mean velocities far beyond the temperature, no thermostat.
  static constexpr int kMostSteps = 100000;

  template <class Real>
  TOMLIN_INLINE static Real twice_kinetic(std::size_t length, const Real* mass, const Real* v) {
    using Group = Packed<Real>;
    Group total(Real(0.0));
    for (std::size_t i = 0; i < length; i += kGroup) {
      const Group here = Group::load(v + i);
      total = fma(Group::load(mass + i) * here, here, total);
    }
    return sum(total);
  }

  /// Coefficient n of the product of two series.
  template <class Real>
  TOMLIN_INLINE static Real product(const Real* x, const Real* y, int n) {
    Real total(0.0);
    for (int i = 0; i <= n; ++i) total = fma(x[i], y[n - i], total);
    return total;
  }

  /// Taylor series over the time `left`, or a shorter one, in units of 1/omega, of
  ///   e' = -2 z_1 (1 + e)                  e = 2K/(N T) - 1
  ///   z_1' = e - z_1 z_2                   z_k = zeta_k/omega
  ///   z_k' = (N or 1) z_{k-1}^2 - 1 - z_k z_{k+1}
  ///   s' = -z_1 (1 + s)                    1 + s: factor of the velocities
  /// in rows e, z_1 .. z_M, s, whose first terms are given; term n is multiplied by the n-th power
  /// of the time. Returns the time, 0 where nothing converges, and how many terms count.
  template <class Real>
  TOMLIN_INLINE static Real expand(const NoseHooverArguments<Real>& a, Real left, int& count) {
    constexpr int most = kTerms<Real>;
    const std::size_t rows = a.links + 2;
    const auto row = [&](std::size_t j) { return a.series + j * (most + 1); };
    const Real root = sqrt(a.freedom);
    Real* const e = row(0);
    Real* const s = row(a.links + 1);

    Real fastest = max(Real(2.0), sqrt(root * abs(e[0])));
    fastest = max(fastest, root * abs(row(1)[0]));
    for (std::size_t k = 2; k <= a.links; ++k) fastest = max(fastest, abs(row(k)[0]));
    Real h = min(left, Real(1.0) / fastest);

    constexpr Real rounding = Real(sizeof(Real) == sizeof(double) ? 0x1p-55 : 0x1p-115);
    const Real small = Real(1.0) / root;  // of what fluctuates with all velocities
    const auto counts = [&](int n) {
      for (std::size_t j = 0; j < rows; ++j) {
        const Real unit = j < 2 ? small : Real(1.0);
        if (!(abs(row(j)[n]) <= rounding * (unit + abs(row(j)[0])))) return true;
      }
      return false;
    };
    for (int n = 0; n < most; ++n) {
      const Real step = h / Real(n + 1);
      const Real* const first = row(1);
      e[n + 1] = -(Real(2.0) * step) * (first[n] + product(first, e, n));
      s[n + 1] = -step * (first[n] + product(first, s, n));
      for (std::size_t k = 1; k <= a.links; ++k) {
        Real* const z = row(k);
        Real rate = e[n];
        if (k > 1) {
          rate = product(row(k - 1), row(k - 1), n);
          if (k == 2) rate = a.freedom * rate;
          if (n == 0) rate = rate - Real(1.0);
        }
        if (k < a.links) rate = rate - product(static_cast<const Real*>(z), row(k + 1), n);
        z[n + 1] = step * rate;
      }
      if (n == 0 || counts(n) || counts(n + 1)) continue;
      count = n;
      return h;
    }
    count = most;
    for (int halved = 0; halved < 64; ++halved) {
      h = Real(0.5) * h;
      Real power(1.0);
      for (int n = 1; n <= most; ++n) {
        power = Real(0.5) * power;
        for (std::size_t j = 0; j < rows; ++j) row(j)[n] = power * row(j)[n];
      }
      if (!counts(most - 1) && !counts(most)) return h;
    }
    return Real(0.0);
  }

  /// Its own variables over h, and by what part of themselves velocities change; NaN where their
  /// kinetic energy is too far from the temperature, or none.
  template <class Real>
  TOMLIN_INLINE static Real advance(const NoseHooverArguments<Real>& a, Real twice_kinetic,
                                    Real* own, Real h) {
    constexpr int most = kTerms<Real>;
    Real* const eta = own + a.own;
    Real* const zeta = eta + a.links;
    const Real warmth = twice_kinetic / (a.freedom * a.temperature);
    Real change(0.0);
    Real factor(1.0);  // 1 + change, to its last digit where it is small
    Real left = a.frequency * h;
    for (int taken = 0; left > Real(0.0); ++taken) {
      Real* row = a.series;
      row[0] = warmth * factor * factor - Real(1.0);
      for (std::size_t k = 0; k < a.links; ++k) {
        row += most + 1;
        row[0] = zeta[k] / a.frequency;
      }
      row[most + 1] = Real(0.0);
      int count = 0;
      const Real time = expand(a, left, count);
      if (taken == kMostSteps || !(time > Real(0.0))) return Real(__builtin_nan(""));
      const auto gain = [count](const Real* of) {
        Real total(0.0);
        for (int n = count; n > 0; --n) total = total + of[n];
        return total;
      };
      row = a.series;
      for (std::size_t k = 0; k < a.links; ++k) {
        row += most + 1;
        zeta[k] = fma(a.frequency, gain(row), zeta[k]);
        Real mean(0.0);
        for (int n = count; n >= 0; --n) mean = mean + row[n] / Real(n + 1);
        eta[k] = fma(time, mean, eta[k]);
      }
      const Real more = gain(row + most + 1);
      change = change + fma(change, more, more);
      factor = fma(factor, more, factor);
      left = left - time;
    }
    return change;
  }

  /// On free particles, or on the coordinates of a rigid body, centre and rotation.
  template <class Real>
  TOMLIN_FLATTEN static Real flow(const void* arguments, const FlowStage<Real>& stage, Real h) {
    using Group = Packed<Real>;
    const auto a = *static_cast<const NoseHooverArguments<Real>*>(arguments);
    Real* v = stage.velocity + a.first;
    const Real kinetic = twice_kinetic<Real>(a.length, a.mass, v);
    const Group change(advance(a, kinetic, stage.own, h));
    Group heat(Real(0.0));
    for (std::size_t i = 0; i < a.length; i += kGroup) {
      const Group before = Group::load(v + i);
      const Group after = fma(change, before, before);
      after.store(v + i);
      heat += Group(Real(0.5)) * Group::load(a.mass + i) * (before - after) * (before + after);
    }
    return sum(heat);
  }

  /// The rates of its own variables, by those of the particles; returns the power that it takes.
  template <class Real>
  TOMLIN_INLINE static Real rates(const NoseHooverArguments<Real>& a, Real twice_kinetic,
                                  const Real* own, Real* rates_of_all) {
    const Real* const zeta = own + a.own + a.links;
    const Real square = a.frequency * a.frequency;
    Real* const rates = rates_of_all + a.own;
    for (std::size_t k = 0; k < a.links; ++k) {
      rates[k] = zeta[k];
      Real rate = square * (twice_kinetic / (a.freedom * a.temperature) - Real(1.0));
      if (k > 0) {
        const Real before = zeta[k - 1] * zeta[k - 1];
        rate = (k == 1 ? a.freedom * before : before) - square;
      }
      if (k + 1 < a.links) rate = fnma(zeta[k], zeta[k + 1], rate);
      rates[a.links + k] = rate;
    }
    return twice_kinetic * zeta[0];
  }

  template <class Real, bool set>
  TOMLIN_INLINE static void pull(std::size_t length, const Real* mass, const Real* v, Real zeta,
                                 Real* force) {
    using Group = Packed<Real>;
    const Group first(zeta);
    for (std::size_t i = 0; i < length; i += kGroup) {
      const Group by = -(Group::load(mass + i) * (first * Group::load(v + i)));
      (set ? by : Group::load(force + i) + by).store(force + i);
    }
  }

  /// Evaluates the thermostat as a force on the particles.
  template <class Real, bool set>
  TOMLIN_FLATTEN static void force(const void* arguments, const Stage<Real>& stage) {
    const auto a = *static_cast<const NoseHooverArguments<Real>*>(arguments);
    const Real* v = (a.body.mapped ? stage.mapped_velocity : stage.velocity) + a.body.offset;
    Real* f = (a.body.mapped ? stage.mapped_force : stage.force) + a.body.offset;
    pull<Real, set>(a.particle_length, a.particle_mass, v, stage.own[a.own + a.links], f);
    rates<Real>(a, twice_kinetic<Real>(a.particle_length, a.particle_mass, v), stage.own,
                stage.rates);
  }

  template <class Real>
  TOMLIN_FLATTEN static void heat(const void* arguments, const Stage<Real>& stage) {
    const auto a = *static_cast<const NoseHooverArguments<Real>*>(arguments);
    const Real* v = (a.body.mapped ? stage.mapped_velocity : stage.velocity) + a.body.offset;
    stage.rates[a.heat_rate] =
        twice_kinetic<Real>(a.particle_length, a.particle_mass, v) * stage.own[a.own + a.links];
  }

  /// Evaluates the thermostat as a force on the coordinates.
  template <class Real>
  TOMLIN_FLATTEN static Real drag(const void* arguments, const Stage<Real>& stage) {
    const auto a = *static_cast<const NoseHooverArguments<Real>*>(arguments);
    const Real* v = stage.velocity + a.first;
    pull<Real, false>(a.length, a.mass, v, stage.own[a.own + a.links], stage.force + a.first);
    return rates<Real>(a, twice_kinetic<Real>(a.length, a.mass, v), stage.own, stage.rates);
  }

  template <class Real>
  static constexpr NoseHooverTable<Real> kernels() {
    return {&force<Real, true>, &force<Real, false>, &heat<Real>, &flow<Real>, &drag<Real>};
  }
};

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
