#pragma once

#include <cstddef>

#include "framework/core/element.hpp"
#include "framework/core/kernel_arguments.hpp"
#include "framework/core/math.hpp"
#include "framework/core/pack.hpp"

/// The loops over elements, written once per element kind. They turn an evaluator, which knows one
/// element, into kernels for the particles of one run, eight at a time.
///
/// An evaluator E has
///   template <class T, int D> struct Parameters;     // nothing but T (and arrays of T)
///   for sites:  static constexpr Reads reads;
///               static T energy(const Parameters<T,D>&, const Site<T,D>&);
///               static Vec<T,D> force(const Parameters<T,D>&, const Site<T,D>&);
///   for pairs:  static T energy(const Parameters<T,D>&, const Pair<T,D>&);
///               static Vec<T,D> force(const Parameters<T,D>&, const Pair<T,D>&);   on the first
///   (energy or force may be missing: a force without energy is not conservative, an energy
///   without force is differentiated)
///   drivers:    static T power(const Parameters<T,D>&, const Site<T,D>&, const Vec<T,D>& force);
namespace tomlin {
inline namespace TOMLIN_TARGET {

/// The same parameters in every lane.
template <class E, int D>
TOMLIN_INLINE typename E::template Parameters<Pack, D> in_all_lanes(const void* parameters) {
  return in_type<E, Pack, double, D>(
      *static_cast<const typename E::template Parameters<double, D>*>(parameters));
}

template <class E, int D>
concept DoesWork = requires(const typename E::template Parameters<double, D>& p,
                            const Site<double, D>& site, const Vec<double, D>& force) {
  E::power(p, site, force);
};

/// Store `value`, or add it to what is there; lanes outside `mask` hold padding and get zero.
template <bool set>
TOMLIN_INLINE void put(double* at, const Pack& value) {
  (set ? value : Pack::load(at) + value).store(at);
}

// ---- sites ------------------------------------------------------------------------------------

template <class E, int D, bool set>
TOMLIN_FLATTEN void site_kernel(const void* arguments, const Stage<double>& stage) {
  const SiteArguments<double> a = *static_cast<const SiteArguments<double>*>(arguments);
  const auto p = in_all_lanes<E, D>(a.parameters);
  const double* x = (a.body.mapped ? stage.mapped_position : stage.position) + a.body.offset;
  const double* v = (a.body.mapped ? stage.mapped_velocity : stage.velocity) + a.body.offset;
  double* f = (a.body.mapped ? stage.mapped_force : stage.force) + a.body.offset;
  const std::size_t stride = a.body.stride;
  const std::size_t count = a.body.count;

  Vec<Pack, D> total;
  Pack power(0.0);
  for (int d = 0; d < D; ++d) total[d] = Pack(0.0);

  for (std::size_t i = 0; i < count; i += kGroup) {
    Site<Pack, D> site;
    for (int d = 0; d < D; ++d) {
      site.position[d] = Pack::load(x + d * stride + i);
      if constexpr (E::reads.velocity) site.velocity[d] = Pack::load(v + d * stride + i);
      if constexpr (E::reads.start) site.start[d] = Pack::load(a.start + d * stride + i);
    }
    site.elapsed = Pack(stage.elapsed);
    Vec<Pack, D> force = force_on<E, Pack, D>(p, site);
    if (i + kGroup > count) {
      const PackMask real = first_lanes(static_cast<int>(count - i));
      for (int d = 0; d < D; ++d) force[d] = select(real, force[d], Pack(0.0));
    }
    for (int d = 0; d < D; ++d) put<set>(f + d * stride + i, force[d]);
    if constexpr (DoesWork<E, D>) {
      for (int d = 0; d < D; ++d) total[d] += force[d];
      power += E::power(p, site, force);
    }
  }
  if constexpr (DoesWork<E, D>) {
    if (a.rate != kNoRate) {
      for (int d = 0; d < D; ++d) stage.rates[a.rate + d] = sum(total[d]);
      stage.rates[a.rate + D] = sum(power);
    }
  }
}

/// The same on a single particle on a line, in registers: small scenes are bound by latency.
template <class E>
TOMLIN_FLATTEN PointResult<double> point_kernel(const void* parameters, double position,
                                                double velocity, double start, double elapsed) {
  const auto& p = *static_cast<const typename E::template Parameters<double, 1>*>(parameters);
  Site<double, 1> site;
  site.position[0] = position;
  site.velocity[0] = velocity;
  site.start[0] = start;
  site.elapsed = elapsed;
  const Vec<double, 1> force = force_on<E, double, 1>(p, site);
  if constexpr (DoesWork<E, 1>) return {force[0], E::power(p, site, force)};
  return {force[0], 0.0};
}

// ---- the centre of mass of a body, or one particle of it ----------------------------------------

template <class E, int D, bool set>
TOMLIN_FLATTEN void centre_kernel(const void* arguments, const Stage<double>& stage) {
  const CentreArguments<double> a = *static_cast<const CentreArguments<double>*>(arguments);
  const auto& p = *static_cast<const typename E::template Parameters<double, D>*>(a.parameters);
  const double* x = a.body.mapped ? stage.mapped_position : stage.position;
  const double* v = a.body.mapped ? stage.mapped_velocity : stage.velocity;
  const std::size_t stride = a.body.stride;

  Site<double, D> site;
  if (a.on_coordinates) {
    for (int d = 0; d < D; ++d) {
      site.position[d] = stage.position[a.body.centre + d];
      if constexpr (E::reads.velocity) site.velocity[d] = stage.velocity[a.body.centre + d];
    }
  } else if (a.single) {
    for (int d = 0; d < D; ++d) {
      const std::size_t at = a.body.offset + d * stride + a.particle;
      site.position[d] = x[at];
      if constexpr (E::reads.velocity) site.velocity[d] = v[at];
    }
  } else {
    Vec<Pack, D> position;
    Vec<Pack, D> velocity;
    for (int d = 0; d < D; ++d) position[d] = velocity[d] = Pack(0.0);
    for (std::size_t i = a.first; i < a.last; i += kGroup) {
      const Pack weight = Pack::load(a.weight + i);
      for (int d = 0; d < D; ++d) {
        const std::size_t at = a.body.offset + d * stride + i;
        position[d] = fma(weight, Pack::load(x + at), position[d]);
        if constexpr (E::reads.velocity) {
          velocity[d] = fma(weight, Pack::load(v + at), velocity[d]);
        }
      }
    }
    for (int d = 0; d < D; ++d) {
      site.position[d] = sum(position[d]);
      if constexpr (E::reads.velocity) site.velocity[d] = sum(velocity[d]);
    }
  }
  if constexpr (E::reads.start) {
    for (int d = 0; d < D; ++d) site.start[d] = a.start[d];
  }
  site.elapsed = stage.elapsed;
  const Vec<double, D> force = force_on<E, double, D>(p, site);

  if (a.on_coordinates) {
    // Written whole: a group stored in parts would stall the load that takes it whole.
    const Pack lanes = three_lanes(force[0], D > 1 ? force[D > 1 ? 1 : 0] : 0.0,
                                   D > 2 ? force[D > 2 ? 2 : 0] : 0.0);
    put<set>(stage.force + a.body.centre, lanes);
  } else {
    double* f = (a.body.mapped ? stage.mapped_force : stage.force) + a.body.offset;
    if constexpr (set) {
      for (int d = 0; d < D; ++d) {
        for (std::size_t i = 0; i < a.first; i += kGroup) Pack(0.0).store(f + d * stride + i);
        for (std::size_t i = a.last; i < a.body.count; i += kGroup) {
          Pack(0.0).store(f + d * stride + i);
        }
      }
    }
    for (std::size_t i = a.first; i < a.last; i += kGroup) {
      const Pack weight = Pack::load(a.weight + i);
      for (int d = 0; d < D; ++d) put<set>(f + d * stride + i, weight * Pack(force[d]));
    }
  }
  if constexpr (DoesWork<E, D>) {
    if (a.rate != kNoRate) {
      for (int d = 0; d < D; ++d) stage.rates[a.rate + d] = force[d];
      stage.rates[a.rate + D] = E::power(p, site, force);
    }
  }
}

// ---- pairs around a ring

/// Each particle's row is i + 1, i + 2, ... i - 1: forces computed forwards are added first, then
/// those of the particles behind are taken off, the furthest first.
template <class E, int D, bool set, int rows>
TOMLIN_INLINE void cyclic_in_registers(const CyclicArguments<double>& a, const double* x,
                                       double* f) {
  const auto p = in_all_lanes<E, D>(a.parameters);
  const std::size_t stride = a.body.stride;
  Vec<Pack, D> position;
  for (int d = 0; d < D; ++d) position[d] = Pack::load(x + d * stride);
  Vec<Pack, D> force[rows];
  Vec<Pack, D> total;
  for (int d = 0; d < D; ++d) total[d] = Pack(0.0);
#pragma GCC unroll 4
  for (int row = 0; row < rows; ++row) {
    Pair<Pack, D> pair;
    for (int d = 0; d < D; ++d) {
      pair.separation[d] = permute(position[d], a.forward + row * kGroup) - position[d];
    }
    pair.datum = Pack::load(a.datum + row * a.row_stride);
    force[row] = force_on<E, Pack, D>(p, pair);
    for (int d = 0; d < D; ++d) total[d] += force[row][d];
  }
#pragma GCC unroll 4
  for (int row = rows - 1; row >= 0; --row) {
    if (row == rows - 1 && a.half_row_last) continue;
    for (int d = 0; d < D; ++d) {
      total[d] = total[d] - permute(force[row][d], a.backward + row * kGroup);
    }
  }
  const PackMask real = first_lanes(static_cast<int>(a.body.count));
  for (int d = 0; d < D; ++d) put<set>(f + d * stride, select(real, total[d], Pack(0.0)));
}

/// Positions of one axis followed by a second copy, so that i + shift needs no modulo.
TOMLIN_INLINE void extend(const double* x, std::size_t count, double* extended) {
  for (std::size_t i = 0; i < count; i += kGroup) Pack::load(x + i).store(extended + i);
  for (std::size_t i = 0; i < count; i += kGroup) {
    Pack::load(x + i).store_unaligned(extended + count + i);
  }
}

template <class E, int D, bool set>
TOMLIN_FLATTEN void cyclic_kernel(const void* arguments, const Stage<double>& stage) {
  const CyclicArguments<double> a = *static_cast<const CyclicArguments<double>*>(arguments);
  const double* x = (a.body.mapped ? stage.mapped_position : stage.position) + a.body.offset;
  double* f = (a.body.mapped ? stage.mapped_force : stage.force) + a.body.offset;
  const std::size_t stride = a.body.stride;
  const std::size_t count = a.body.count;
  if (count <= kGroup) {
    switch (a.rows) {
      case 1:
        return cyclic_in_registers<E, D, set, 1>(a, x, f);
      case 2:
        return cyclic_in_registers<E, D, set, 2>(a, x, f);
      case 3:
        return cyclic_in_registers<E, D, set, 3>(a, x, f);
      default:
        return cyclic_in_registers<E, D, set, 4>(a, x, f);
    }
  }
  const auto p = in_all_lanes<E, D>(a.parameters);
  for (int d = 0; d < D; ++d) extend(x + d * stride, count, a.extended + d * a.extended_stride);

  // The force on i from i + shift, every pair once; each row is stored twice over, so that
  // i - shift needs no modulo either.
  for (std::size_t row = 0; row < a.rows; ++row) {
    const std::size_t shift = row + 1;
    double* result = a.result + row * D * a.result_stride;
    for (std::size_t i = 0; i < count; i += kGroup) {
      Pair<Pack, D> pair;
      for (int d = 0; d < D; ++d) {
        pair.separation[d] = Pack::load_unaligned(a.extended + d * a.extended_stride + i + shift) -
                             Pack::load(x + d * stride + i);
      }
      pair.datum = Pack::load(a.datum + row * a.row_stride + i);
      Vec<Pack, D> force = force_on<E, Pack, D>(p, pair);
      if (i + kGroup > count) {
        const PackMask real = first_lanes(static_cast<int>(count - i));
        for (int d = 0; d < D; ++d) force[d] = select(real, force[d], Pack(0.0));
      }
      for (int d = 0; d < D; ++d) force[d].store(result + d * a.result_stride + i);
    }
    // The second copy begins in the padding of the first, so it is written after it.
    for (int d = 0; d < D; ++d) {
      double* at = result + d * a.result_stride;
      for (std::size_t i = 0; i < count; i += kGroup) {
        Pack::load(at + i).store_unaligned(at + count + i);
      }
    }
  }
  for (std::size_t i = 0; i < count; i += kGroup) {
    Vec<Pack, D> total;
    for (int d = 0; d < D; ++d) total[d] = Pack(0.0);
    for (std::size_t row = 0; row < a.rows; ++row) {
      const double* result = a.result + row * D * a.result_stride + i;
      for (int d = 0; d < D; ++d) total[d] += Pack::load(result + d * a.result_stride);
    }
    for (std::size_t row = a.half_row_last ? a.rows - 1 : a.rows; row-- > 0;) {
      const double* result = a.result + row * D * a.result_stride + i + count - (row + 1);
      for (int d = 0; d < D; ++d) {
        total[d] = total[d] - Pack::load_unaligned(result + d * a.result_stride);
      }
    }
    if (i + kGroup > count) {
      const PackMask real = first_lanes(static_cast<int>(count - i));
      for (int d = 0; d < D; ++d) total[d] = select(real, total[d], Pack(0.0));
    }
    for (int d = 0; d < D; ++d) put<set>(f + d * stride + i, total[d]);
  }
}

// ---- pairs along an open chain

alignas(64) inline constexpr std::int64_t kOneBack[kGroup] = {7, 0, 1, 2, 3, 4, 5, 6};

template <class E, int D, bool set>
TOMLIN_FLATTEN void chain_kernel(const void* arguments, const Stage<double>& stage) {
  const ChainArguments<double> a = *static_cast<const ChainArguments<double>*>(arguments);
  const auto p = in_all_lanes<E, D>(a.parameters);
  const double* x = (a.body.mapped ? stage.mapped_position : stage.position) + a.body.offset;
  double* f = (a.body.mapped ? stage.mapped_force : stage.force) + a.body.offset;
  const std::size_t stride = a.body.stride;
  const std::size_t count = a.body.count;
  const std::size_t bonds = count - 1;
  const PackMask lane_zero = first_lanes(1);

  // Forwards bond by bond; the bond behind each particle is the forward one of its predecessor,
  // carried over from group to group in lane 0.
  Vec<Pack, D> behind;
  for (int d = 0; d < D; ++d) behind[d] = Pack(0.0);
  for (std::size_t i = 0; i < count; i += kGroup) {
    Pair<Pack, D> pair;
    for (int d = 0; d < D; ++d) {
      pair.separation[d] =
          Pack::load_unaligned(x + d * stride + i + 1) - Pack::load(x + d * stride + i);
    }
    pair.datum = Pack::load(a.datum + i);
    Vec<Pack, D> force = force_on<E, Pack, D>(p, pair);
    if (i + kGroup > bonds) {
      const PackMask real = first_lanes(bonds > i ? static_cast<int>(bonds - i) : 0);
      for (int d = 0; d < D; ++d) force[d] = select(real, force[d], Pack(0.0));
    }
    for (int d = 0; d < D; ++d) {
      const Pack moved = permute(force[d], kOneBack);
      put<set>(f + d * stride + i, force[d] - select(lane_zero, behind[d], moved));
      behind[d] = moved;
    }
  }
}

// ---- a list of pairs ----------------------------------------------------------------------------

TOMLIN_INLINE Pack gather(const double* from, const std::size_t* index) {
  alignas(64) double lane[kGroup];
  for (std::size_t k = 0; k < kGroup; ++k) lane[k] = from[index[k]];
  return Pack::load(lane);
}

template <class E, int D>
TOMLIN_FLATTEN void pair_list_kernel(const void* arguments, const Stage<double>& stage) {
  const PairListArguments<double> a = *static_cast<const PairListArguments<double>*>(arguments);
  const auto p = in_all_lanes<E, D>(a.parameters);
  const double* x1 = (a.first.mapped ? stage.mapped_position : stage.position) + a.first.offset;
  const double* x2 = (a.second.mapped ? stage.mapped_position : stage.position) + a.second.offset;
  const std::size_t row_length = (a.pairs + kGroup - 1) / kGroup * kGroup;

  for (std::size_t k = 0; k < a.pairs; k += kGroup) {
    Pair<Pack, D> pair;
    for (int d = 0; d < D; ++d) {
      pair.separation[d] =
          gather(x2 + d * a.second.stride, a.j + k) - gather(x1 + d * a.first.stride, a.i + k);
    }
    pair.datum = Pack::load(a.datum + k);
    const Vec<Pack, D> force = force_on<E, Pack, D>(p, pair);
    for (int d = 0; d < D; ++d) force[d].store(a.result + d * row_length + k);
  }

  const auto share_out = [&](const BodySlot<double>& body, std::size_t rows,
                             std::size_t first_row) {
    double* f = (body.mapped ? stage.mapped_force : stage.force) + body.offset;
    for (int d = 0; d < D; ++d) {
      const double* result = a.result + d * row_length;
      for (std::size_t i = 0; i < rows; ++i) {
        double total = 0.0;
        for (std::size_t k = a.row_start[first_row + i]; k < a.row_start[first_row + i + 1]; ++k) {
          const std::ptrdiff_t signed_pair = a.row[k];
          total += signed_pair > 0 ? result[signed_pair - 1] : -result[-signed_pair - 1];
        }
        f[d * body.stride + i] += total;
      }
    }
  };
  share_out(a.first, a.particles_first, 0);
  if (!a.same_body) share_out(a.second, a.particles_second, a.particles_first);
}

// ---- tables -------------------------------------------------------------------------------------

template <class E, int D>
constexpr void fill_table(KernelTable<double>& table) {
  if constexpr (HasForce<E, D, Site> || HasEnergy<E, D, Site>) {
    table.site.set[D - 1] = &site_kernel<E, D, true>;
    table.site.add[D - 1] = &site_kernel<E, D, false>;
    table.centre.set[D - 1] = &centre_kernel<E, D, true>;
    table.centre.add[D - 1] = &centre_kernel<E, D, false>;
    if constexpr (D == 1) table.point = &point_kernel<E>;
  }
  if constexpr (HasForce<E, D, Pair> || HasEnergy<E, D, Pair>) {
    table.cyclic.set[D - 1] = &cyclic_kernel<E, D, true>;
    table.cyclic.add[D - 1] = &cyclic_kernel<E, D, false>;
    table.chain.set[D - 1] = &chain_kernel<E, D, true>;
    table.chain.add[D - 1] = &chain_kernel<E, D, false>;
    table.pair_list.add[D - 1] = &pair_list_kernel<E, D>;
  }
}

/// Everything that the loops make of an evaluator, on this instruction set. What is no evaluator
/// (an integrator's stage passes, say) names its own table.
template <class E>
constexpr auto kernel_table() {
  if constexpr (requires { E::kernels(); }) {
    return E::kernels();
  } else {
    KernelTable<double> table;
    fill_table<E, 1>(table);
    fill_table<E, 2>(table);
    fill_table<E, 3>(table);
    return table;
  }
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin

#define TOMLIN_JOIN_(a, b) a##b
#define TOMLIN_JOIN(a, b) TOMLIN_JOIN_(a, b)

/// In a kernel file, which is compiled once per instruction set: define the evaluator's table.
#define TOMLIN_DEFINE_KERNELS(Evaluator)                                                         \
  namespace tomlin::kernels {                                                                    \
  extern const decltype(kernel_table<Evaluator>()) TOMLIN_JOIN(Evaluator##_, TOMLIN_TARGET);     \
  constinit const decltype(kernel_table<Evaluator>()) TOMLIN_JOIN(Evaluator##_, TOMLIN_TARGET) = \
      kernel_table<Evaluator>();                                                                 \
  }
