#pragma once

#include <bit>
#include <cstddef>
#include <type_traits>

#include "framework/core/elements/element.hpp"
#include "framework/core/elements/energy_kernels.hpp"
#include "framework/core/elements/lane_kernels.hpp"
#include "framework/core/elements/nearest_image.hpp"
#include "framework/core/numbers/math.hpp"
#include "framework/core/numbers/number_types.hpp"
#include "framework/core/system/kernel_arguments.hpp"

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
///   pairs may have  static constexpr bool central = true;   where force(-separation) is
///               -force(separation) to the last bit: replicas then evaluate such a pair once
///   static const double* table(const Description&);   where reads.table: numbers that stay where
///                                                     they are as long as the description
///   drivers:    static T power(const Parameters<T,D>&, const Site<T,D>&, const Vec<T,D>& force);
namespace tomlin {
inline namespace TOMLIN_TARGET {

/// Returns the parameters with all lanes alike.
template <class E, class Real, int D>
TOMLIN_INLINE typename E::template Parameters<Packed<Real>, D> in_all_lanes(
    const void* parameters) {
  return in_type<E, Packed<Real>, Real, D>(
      *static_cast<const typename E::template Parameters<Real, D>*>(parameters));
}

/// Returns the parameters of a site with all lanes alike.
template <class E, class Real, int D>
TOMLIN_INLINE SiteParameters<E, Packed<Real>, D> site_in_all_lanes(const void* parameters) {
  return number_by_number<SiteParameters<E, Packed<Real>, D>, Packed<Real>, Real>(
      *static_cast<const SiteParameters<E, Real, D>*>(parameters));
}

/// Returns the parameters of eight sites, which differ, from the particle on that `each` points to.
template <class E, class Real, int D>
TOMLIN_INLINE SiteParameters<E, Packed<Real>, D> site_of_each(const Real* each,
                                                              std::size_t stride) {
  struct Numbers {
    Packed<Real> value[sizeof(SiteParameters<E, Real, D>) / sizeof(Real)];
  } numbers;
  for (auto& value : numbers.value) {
    value = Packed<Real>::load(each);
    each += stride;
  }
  return std::bit_cast<SiteParameters<E, Packed<Real>, D>>(numbers);
}

/// Store `value`, or add it to what is there.
template <bool set, class Real>
TOMLIN_INLINE void put(Real* at, const Packed<Real>& value) {
  (set ? value : Packed<Real>::load(at) + value).store(at);
}

/// Keeps lanes of the group from element i on that are among the first `count`; others become zero.
template <class Real>
TOMLIN_INLINE Packed<Real> without_padding(const Packed<Real>& value, std::size_t i,
                                           std::size_t count) {
  using Group = Packed<Real>;
  if (i + kGroup <= count) return value;
  return select(first_lanes_of<Group>(static_cast<int>(count - i)), value, Group(Real(0.0)));
}

// ---- sites ------------------------------------------------------------------------------------

template <class E, class Real, int D, bool set, bool varied = false>
TOMLIN_FLATTEN void site_kernel(const void* arguments, const Stage<Real>& stage) {
  using Group = Packed<Real>;
  const SiteArguments<Real> a = *static_cast<const SiteArguments<Real>*>(arguments);
  auto p = site_in_all_lanes<E, Real, D>(a.parameters);
  const Real* x = (a.body.mapped ? stage.mapped_position : stage.position) + a.body.offset;
  const Real* v = (a.body.mapped ? stage.mapped_velocity : stage.velocity) + a.body.offset;
  Real* f = (a.body.mapped ? stage.mapped_force : stage.force) + a.body.offset;
  const std::size_t stride = a.body.stride;
  const std::size_t count = a.body.count;

  Vec<Group, D> total;
  Group power(Real(0.0));
  for (int d = 0; d < D; ++d) total[d] = Group(Real(0.0));

  for (std::size_t i = 0; i < count; i += kGroup) {
    if constexpr (varied) p = site_of_each<E, Real, D>(a.each + i, stride);
    Site<Group, D> site;
    for (int d = 0; d < D; ++d) {
      site.position[d] = Group::load(x + d * stride + i);
      if constexpr (E::reads.velocity) site.velocity[d] = Group::load(v + d * stride + i);
      if constexpr (E::reads.start) site.start[d] = Group::load(a.start + d * stride + i);
    }
    site.elapsed = Group(stage.elapsed);
    site.frame = p.frame;
    if constexpr (E::reads.table) site.table = a.table;
    Vec<Group, D> force = force_on<E, Group, D>(p.own, site);
    for (int d = 0; d < D; ++d) {
      force[d] = without_padding<Real>(force[d], i, count);
      put<set>(f + d * stride + i, force[d]);
    }
    if constexpr (DoesWork<E, D>) {
      for (int d = 0; d < D; ++d) total[d] += force[d];
      power += E::power(p.own, site, force);
    }
  }
  if constexpr (DoesWork<E, D>) {
    if (a.rate != kNoRate) {
      for (int d = 0; d < D; ++d) stage.rates[a.rate + d] = sum(total[d]);
      stage.rates[a.rate + D] = sum(power);
    }
  }
}

/// Evaluates a single particle on a line, in registers: small scenes are bound by latency.
template <class E, class Real>
TOMLIN_FLATTEN PointResult<Real> point_kernel(const void* parameters, Real position, Real velocity,
                                              Real start, Real elapsed) {
  const auto& p = *static_cast<const SiteParameters<E, Real, 1>*>(parameters);
  Site<Real, 1> site;
  site.position[0] = position;
  site.velocity[0] = velocity;
  site.start[0] = start;
  site.elapsed = elapsed;
  site.frame = p.frame;
  const Vec<Real, 1> force = force_on<E, Real, 1>(p.own, site);
  if constexpr (DoesWork<E, 1>) return {force[0], E::power(p.own, site, force)};
  return {force[0], Real(0.0)};
}

/// Writes the power that a damper takes out of the particles, -F.v, for the energy balance.
template <class E, class Real, int D, bool varied = false>
TOMLIN_FLATTEN void heat_kernel(const void* arguments, const Stage<Real>& stage) {
  using Group = Packed<Real>;
  const HeatArguments<Real> a = *static_cast<const HeatArguments<Real>*>(arguments);
  auto p = site_in_all_lanes<E, Real, D>(a.parameters);
  const Real* x = (a.body.mapped ? stage.mapped_position : stage.position) + a.body.offset;
  const Real* v = (a.body.mapped ? stage.mapped_velocity : stage.velocity) + a.body.offset;
  const std::size_t stride = a.body.stride;
  Group heat(Real(0.0));
  for (std::size_t i = 0; i < a.body.count; i += kGroup) {
    if constexpr (varied) p = site_of_each<E, Real, D>(a.each + i, stride);
    Site<Group, D> site;
    for (int d = 0; d < D; ++d) {
      site.position[d] = Group::load(x + d * stride + i);
      site.velocity[d] = Group::load(v + d * stride + i);
    }
    site.elapsed = Group(stage.elapsed);
    site.frame = p.frame;
    const Group power = dot(force_on<E, Group, D>(p.own, site), site.velocity);
    heat = heat - without_padding<Real>(power, i, a.body.count);
  }
  stage.rates[a.rate] = sum(heat);
}

/// The energy of all sites, by the one rule of sums over particles.
template <class E, class Real, int D, bool varied = false>
TOMLIN_FLATTEN Real site_energy(const void* arguments, const Stage<Real>& stage) {
  using Group = Packed<Real>;
  const SiteArguments<Real> a = *static_cast<const SiteArguments<Real>*>(arguments);
  auto p = site_in_all_lanes<E, Real, D>(a.parameters);
  const Real* x = (a.body.mapped ? stage.mapped_position : stage.position) + a.body.offset;
  [[maybe_unused]] const Real* v =
      (a.body.mapped ? stage.mapped_velocity : stage.velocity) + a.body.offset;
  const std::size_t stride = a.body.stride;
  Group total(Real(0.0));
  for (std::size_t i = 0; i < a.body.count; i += kGroup) {
    if constexpr (varied) p = site_of_each<E, Real, D>(a.each + i, stride);
    Site<Group, D> site;
    for (int d = 0; d < D; ++d) {
      site.position[d] = Group::load(x + d * stride + i);
      if constexpr (E::reads.velocity) site.velocity[d] = Group::load(v + d * stride + i);
      if constexpr (E::reads.start) site.start[d] = Group::load(a.start + d * stride + i);
    }
    site.elapsed = Group(stage.elapsed);
    site.frame = p.frame;
    if constexpr (E::reads.table) site.table = a.table;
    total += without_padding<Real>(E::energy(p.own, site), i, a.body.count);
  }
  return sum(total);
}

// ---- the centre of mass of a body, or one particle of it ----------------------------------------

/// Position of the attached point, or from velocities its velocity.
template <class Real, int D>
TOMLIN_INLINE Vec<Real, D> attached_point(const CentreArguments<Real>& a, const Real* plain,
                                          const Real* mapped) {
  using Group = Packed<Real>;
  Vec<Real, D> point;
  if (a.on_coordinates) {
    for (int d = 0; d < D; ++d) point[d] = plain[a.body.centre + d];
    return point;
  }
  const Real* x = (a.body.mapped ? mapped : plain) + a.body.offset;
  if (a.single) {
    for (int d = 0; d < D; ++d) point[d] = x[d * a.body.stride + a.particle];
    return point;
  }
  Vec<Group, D> mean;
  for (int d = 0; d < D; ++d) mean[d] = Group(Real(0.0));
  for (std::size_t i = a.first; i < a.last; i += kGroup) {
    const Group weight = Group::load(a.weight + i);
    for (int d = 0; d < D; ++d) {
      mean[d] = fma(weight, Group::load(x + d * a.body.stride + i), mean[d]);
    }
  }
  for (int d = 0; d < D; ++d) point[d] = sum(mean[d]);
  return point;
}

/// The force on the attached point, to the particles by their weights.
template <bool set, class Real, int D>
TOMLIN_INLINE void share_out_attached(const CentreArguments<Real>& a, const Stage<Real>& stage,
                                      const Vec<Real, D>& force) {
  using Group = Packed<Real>;
  if (a.on_coordinates) {
    // Written whole: a group stored in parts would stall the load that takes it whole.
    const Group lanes = three_lanes(force[0], D > 1 ? force[D > 1 ? 1 : 0] : Real(0.0),
                                    D > 2 ? force[D > 2 ? 2 : 0] : Real(0.0));
    return put<set>(stage.force + a.body.centre, lanes);
  }
  const std::size_t stride = a.body.stride;
  Real* f = (a.body.mapped ? stage.mapped_force : stage.force) + a.body.offset;
  if constexpr (set) {
    const Group none(Real(0.0));
    for (int d = 0; d < D; ++d) {
      for (std::size_t i = 0; i < a.first; i += kGroup) none.store(f + d * stride + i);
      for (std::size_t i = a.last; i < a.body.count; i += kGroup) none.store(f + d * stride + i);
    }
  }
  for (std::size_t i = a.first; i < a.last; i += kGroup) {
    const Group weight = Group::load(a.weight + i);
    for (int d = 0; d < D; ++d) put<set>(f + d * stride + i, weight * Group(force[d]));
  }
}

template <class E, class Real, int D, bool set>
TOMLIN_FLATTEN void centre_kernel(const void* arguments, const Stage<Real>& stage) {
  const CentreArguments<Real> a = *static_cast<const CentreArguments<Real>*>(arguments);
  const auto& p = *static_cast<const SiteParameters<E, Real, D>*>(a.parameters);
  Site<Real, D> site;
  site.position = attached_point<Real, D>(a, stage.position, stage.mapped_position);
  if constexpr (E::reads.velocity) {
    site.velocity = attached_point<Real, D>(a, stage.velocity, stage.mapped_velocity);
  }
  for (int d = 0; d < D; ++d) site.start[d] = a.start[d];
  site.elapsed = stage.elapsed;
  site.frame = p.frame;
  const Vec<Real, D> force = force_on<E, Real, D>(p.own, site);

  share_out_attached<set>(a, stage, force);
  if constexpr (DoesWork<E, D>) {
    if (a.rate != kNoRate) {
      for (int d = 0; d < D; ++d) stage.rates[a.rate + d] = force[d];
      stage.rates[a.rate + D] = E::power(p.own, site, force);
    }
  }
}

// ---- pairs around a ring

/// Each particle's row is i + 1, i + 2, ... i - 1: forces computed forwards are added first, then
/// those of the particles behind are taken off, the furthest first.
template <class E, class Real, int D, bool set, int rows>
TOMLIN_INLINE void cyclic_in_registers(const CyclicArguments<Real>& a, const Real* x, Real* f) {
  using Group = Packed<Real>;
  const auto p = in_all_lanes<E, Real, D>(a.parameters);
  const std::size_t stride = a.body.stride;
  Vec<Group, D> position;
  for (int d = 0; d < D; ++d) position[d] = Group::load(x + d * stride);
  Vec<Group, D> force[rows];
  Vec<Group, D> total;
  for (int d = 0; d < D; ++d) total[d] = Group(Real(0.0));
#pragma GCC unroll 4
  for (int row = 0; row < rows; ++row) {
    Pair<Group, D> pair;
    for (int d = 0; d < D; ++d) {
      pair.separation[d] = permute(position[d], a.forward + row * kGroup) - position[d];
    }
    pair.datum = Group::load(a.datum + row * a.row_stride);
    force[row] = force_on<E, Group, D>(p, pair);
    for (int d = 0; d < D; ++d) total[d] += force[row][d];
  }
#pragma GCC unroll 4
  for (int row = rows - 1; row >= 0; --row) {
    if (row == rows - 1 && a.half_row_last) continue;
    for (int d = 0; d < D; ++d) {
      total[d] = total[d] - permute(force[row][d], a.backward + row * kGroup);
    }
  }
  for (int d = 0; d < D; ++d) {
    put<set>(f + d * stride, without_padding<Real>(total[d], 0, a.body.count));
  }
}

/// Positions of one axis followed by a second copy, so that i + shift needs no modulo.
template <class Real>
TOMLIN_INLINE void extend(const Real* x, std::size_t count, Real* extended) {
  using Group = Packed<Real>;
  for (std::size_t i = 0; i < count; i += kGroup) Group::load(x + i).store(extended + i);
  for (std::size_t i = 0; i < count; i += kGroup) {
    Group::load(x + i).store_unaligned(extended + count + i);
  }
}

template <class E, class Real, int D, bool set>
TOMLIN_FLATTEN void cyclic_kernel(const void* arguments, const Stage<Real>& stage) {
  using Group = Packed<Real>;
  const CyclicArguments<Real> a = *static_cast<const CyclicArguments<Real>*>(arguments);
  const Real* x = (a.body.mapped ? stage.mapped_position : stage.position) + a.body.offset;
  Real* f = (a.body.mapped ? stage.mapped_force : stage.force) + a.body.offset;
  const std::size_t stride = a.body.stride;
  const std::size_t count = a.body.count;
  if (count <= kGroup) {
    switch (a.rows) {
      case 1:
        return cyclic_in_registers<E, Real, D, set, 1>(a, x, f);
      case 2:
        return cyclic_in_registers<E, Real, D, set, 2>(a, x, f);
      case 3:
        return cyclic_in_registers<E, Real, D, set, 3>(a, x, f);
      default:
        return cyclic_in_registers<E, Real, D, set, 4>(a, x, f);
    }
  }
  const auto p = in_all_lanes<E, Real, D>(a.parameters);
  for (int d = 0; d < D; ++d) extend(x + d * stride, count, a.extended + d * a.extended_stride);

  // The force on i from i + shift, every pair once; each row is stored twice over, so that
  // i - shift needs no modulo either.
  for (std::size_t row = 0; row < a.rows; ++row) {
    const std::size_t shift = row + 1;
    Real* result = a.result + row * D * a.result_stride;
    for (std::size_t i = 0; i < count; i += kGroup) {
      Pair<Group, D> pair;
      for (int d = 0; d < D; ++d) {
        pair.separation[d] = Group::load_unaligned(a.extended + d * a.extended_stride + i + shift) -
                             Group::load(x + d * stride + i);
      }
      pair.datum = Group::load(a.datum + row * a.row_stride + i);
      const Vec<Group, D> force = force_on<E, Group, D>(p, pair);
      for (int d = 0; d < D; ++d) {
        without_padding<Real>(force[d], i, count).store(result + d * a.result_stride + i);
      }
    }
    // The second copy begins in the padding of the first, so it is written after it.
    for (int d = 0; d < D; ++d) {
      Real* at = result + d * a.result_stride;
      for (std::size_t i = 0; i < count; i += kGroup) {
        Group::load(at + i).store_unaligned(at + count + i);
      }
    }
  }
  for (std::size_t i = 0; i < count; i += kGroup) {
    Vec<Group, D> total;
    for (int d = 0; d < D; ++d) total[d] = Group(Real(0.0));
    for (std::size_t row = 0; row < a.rows; ++row) {
      const Real* result = a.result + row * D * a.result_stride + i;
      for (int d = 0; d < D; ++d) total[d] += Group::load(result + d * a.result_stride);
    }
    for (std::size_t row = a.half_row_last ? a.rows - 1 : a.rows; row-- > 0;) {
      const Real* result = a.result + row * D * a.result_stride + i + count - (row + 1);
      for (int d = 0; d < D; ++d) {
        total[d] = total[d] - Group::load_unaligned(result + d * a.result_stride);
      }
    }
    for (int d = 0; d < D; ++d) {
      put<set>(f + d * stride + i, without_padding<Real>(total[d], i, count));
    }
  }
}

// ---- pairs along a chain

alignas(64) inline constexpr std::int64_t kOneBack[kGroup] = {7, 0, 1, 2, 3, 4, 5, 6};

template <class E, class Real, int D, bool set>
TOMLIN_FLATTEN void chain_kernel(const void* arguments, const Stage<Real>& stage) {
  using Group = Packed<Real>;
  const ChainArguments<Real> a = *static_cast<const ChainArguments<Real>*>(arguments);
  const auto p = in_all_lanes<E, Real, D>(a.parameters);
  const Real* x = (a.body.mapped ? stage.mapped_position : stage.position) + a.body.offset;
  Real* f = (a.body.mapped ? stage.mapped_force : stage.force) + a.body.offset;
  const std::size_t stride = a.body.stride;
  const std::size_t count = a.body.count;
  const std::size_t bonds = a.closed ? count : count - 1;
  const auto lane_zero = first_lanes_of<Group>(1);

  // The first particle's image follows the last particle of a closed chain.
  Vec<Group, D> image;
  for (int d = 0; d < D; ++d) image[d] = Group(x[d * stride] + a.wrap[d]);

  // Forwards bond by bond; the bond behind each particle is the forward one of its predecessor,
  // carried over from group to group in lane 0.
  Vec<Group, D> behind;
  for (int d = 0; d < D; ++d) behind[d] = Group(Real(0.0));
  if (a.closed) {
    Pair<Group, D> pair;
    for (int d = 0; d < D; ++d) {
      pair.separation[d] = image[d] - Group(x[d * stride + count - 1]);
    }
    pair.datum = Group(a.datum[count - 1]);
    behind = force_on<E, Group, D>(p, pair);
  }
  for (std::size_t i = 0; i < count; i += kGroup) {
    Pair<Group, D> pair;
    for (int d = 0; d < D; ++d) {
      pair.separation[d] =
          Group::load_unaligned(x + d * stride + i + 1) - Group::load(x + d * stride + i);
    }
    if (a.closed && i + kGroup >= count) {
      const auto before = first_lanes_of<Group>(static_cast<int>(count - 1 - i));
      for (int d = 0; d < D; ++d) {
        const Group closing = image[d] - Group::load(x + d * stride + i);
        pair.separation[d] = select(before, pair.separation[d], closing);
      }
    }
    pair.datum = Group::load(a.datum + i);
    Vec<Group, D> force = force_on<E, Group, D>(p, pair);
    if (i + kGroup > bonds) {
      const auto real = first_lanes_of<Group>(bonds > i ? static_cast<int>(bonds - i) : 0);
      for (int d = 0; d < D; ++d) force[d] = select(real, force[d], Group(Real(0.0)));
    }
    const bool last = i + kGroup >= count;
    for (int d = 0; d < D; ++d) {
      const Group moved = permute(force[d], kOneBack);
      Group total = force[d] - select(lane_zero, behind[d], moved);
      if (last && i + kGroup > count) {
        // The bond past the end pulls on padding, which must stay zero.
        total = select(first_lanes_of<Group>(static_cast<int>(count - i)), total, Group(Real(0.0)));
      }
      put<set>(f + d * stride + i, total);
      behind[d] = moved;
    }
  }
}

// ---- a list of pairs ----------------------------------------------------------------------------

template <class Real>
TOMLIN_INLINE Packed<Real> gather(const Real* from, const std::size_t* index) {
  alignas(64) Real lane[kGroup];
  for (std::size_t k = 0; k < kGroup; ++k) lane[k] = from[index[k]];
  return Packed<Real>::load(lane);
}

/// Separations of pairs from the k-th on, along one axis, from the first particle to the second.
template <class Real>
TOMLIN_INLINE Packed<Real> separation_along(const PairListArguments<Real>& a, const Real* x1,
                                            const Real* x2, int d, std::size_t k) {
  const auto axis = static_cast<std::size_t>(d);
  Packed<Real> apart =
      gather(x2 + axis * a.second.stride, a.j + k) - gather(x1 + axis * a.first.stride, a.i + k);
  if (a.image) {
    const std::size_t row_length = (a.pairs + kGroup - 1) / kGroup * kGroup;
    apart = apart + Packed<Real>::load(a.image + axis * row_length + k);
  }
  return a.box[d] > Real(0.0) ? nearest_image(apart, a.box[d]) : apart;
}

/// Each particle's sum over its pairs, in row order.
template <class Real>
TOMLIN_INLINE void share_out_pairs(const PairListArguments<Real>& a, const Stage<Real>& stage,
                                   int dimension) {
  const std::size_t row_length = (a.pairs + kGroup - 1) / kGroup * kGroup;
  const auto share_out = [&](const BodySlot<Real>& body, std::size_t rows, std::size_t first_row) {
    Real* f = (body.mapped ? stage.mapped_force : stage.force) + body.offset;
    for (std::size_t d = 0; d < static_cast<std::size_t>(dimension); ++d) {
      const Real* result = a.result + d * row_length;
      for (std::size_t i = 0; i < rows; ++i) {
        Real total(0.0);
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

template <class E, class Real, int D>
TOMLIN_FLATTEN void pair_list_kernel(const void* arguments, const Stage<Real>& stage) {
  using Group = Packed<Real>;
  const PairListArguments<Real> a = *static_cast<const PairListArguments<Real>*>(arguments);
  const auto p = in_all_lanes<E, Real, D>(a.parameters);
  const Real* x1 = (a.first.mapped ? stage.mapped_position : stage.position) + a.first.offset;
  const Real* x2 = (a.second.mapped ? stage.mapped_position : stage.position) + a.second.offset;
  const std::size_t row_length = (a.pairs + kGroup - 1) / kGroup * kGroup;

  for (std::size_t k = 0; k < a.pairs; k += kGroup) {
    Pair<Group, D> pair;
    for (int d = 0; d < D; ++d) {
      pair.separation[d] = separation_along(a, x1, x2, d, k);
    }
    pair.datum = Group::load(a.datum + k);
    const Vec<Group, D> force = force_on<E, Group, D>(p, pair);
    for (int d = 0; d < D; ++d) force[d].store(a.result + d * row_length + k);
  }

  share_out_pairs(a, stage, D);
}

/// The energy of pairs of any kind, each with its own image. Energies are evaluated seldom, so that
/// pairs may be gathered one by one.
template <class E, class Real, int D>
TOMLIN_FLATTEN Real pair_energy(const void* arguments, const Stage<Real>& stage) {
  using Group = Packed<Real>;
  const auto a = *static_cast<const PairEnergyArguments<Real>*>(arguments);
  const auto p = in_all_lanes<E, Real, D>(a.parameters);
  const Real* x1 = (a.first.mapped ? stage.mapped_position : stage.position) + a.first.offset;
  const Real* x2 = (a.second.mapped ? stage.mapped_position : stage.position) + a.second.offset;
  Group total(Real(0.0));
  for (std::size_t k = 0; k < a.count; k += kGroup) {
    alignas(64) Real apart[D][kGroup];
    alignas(64) Real image[D][kGroup];
    alignas(64) Real datum[kGroup];
    for (std::size_t lane = 0; lane < kGroup; ++lane) {
      const BoundPair<Real>& bound = a.pairs[k + lane < a.count ? k + lane : a.count - 1];
      for (int d = 0; d < D; ++d) {
        apart[d][lane] = x2[d * a.second.stride + bound.j] - x1[d * a.first.stride + bound.i];
        image[d][lane] = Real(bound.image[d]);
      }
      datum[lane] = bound.datum;
    }
    Pair<Group, D> pair;
    for (int d = 0; d < D; ++d) {
      const Group way = Group::load(apart[d]);
      pair.separation[d] =
          a.box[d] > Real(0.0) ? nearest_image(way, a.box[d]) : way + Group::load(image[d]);
    }
    pair.datum = Group::load(datum);
    total += without_padding<Real>(E::energy(p, pair), k, a.count);
  }
  return sum(total);
}

// ---- tables -------------------------------------------------------------------------------------

template <class E, class Real, int D>
constexpr void fill_table(ElementTable<Real>& table) {
  if constexpr (HasForce<E, D, Site> || HasEnergy<E, D, Site>) {
    table.site.set[D - 1] = &site_kernel<E, Real, D, true>;
    table.site.add[D - 1] = &site_kernel<E, Real, D, false>;
    if constexpr (E::reads.start) {
      table.centre.set[D - 1] = &centre_kernel<E, Real, D, true>;
      table.centre.add[D - 1] = &centre_kernel<E, Real, D, false>;
    }
    if constexpr (E::reads.velocity) table.heat[D - 1] = &heat_kernel<E, Real, D>;
    if constexpr (!DoesWork<E, D> && !E::reads.start && !E::reads.time) {
      table.varied_site[D - 1] = &site_kernel<E, Real, D, false, true>;
      if constexpr (E::reads.velocity) table.varied_heat[D - 1] = &heat_kernel<E, Real, D, true>;
    }
    if constexpr (HasEnergy<E, D, Site>) {
      table.site_energy[D - 1] = &site_energy<E, Real, D>;
      if (table.varied_site[D - 1]) {
        table.varied_site_energy[D - 1] = &site_energy<E, Real, D, true>;
      }
    }
    if constexpr (D == 1 && !E::reads.table) table.point = &point_kernel<E, Real>;
    // A table of numbers differs between replicas, and its kernel reads one.
    if constexpr (std::is_same_v<Real, double> && !E::reads.table) {
      table.lanes.site[D - 1] = &site_over_lanes<E, D, false>;
      if (table.varied_site[D - 1]) table.lanes.varied_site[D - 1] = &site_over_lanes<E, D, true>;
      if constexpr (E::reads.velocity) {
        table.lanes.heat[D - 1] = &heat_over_lanes<E, D, false>;
        if (table.varied_heat[D - 1]) table.lanes.varied_heat[D - 1] = &heat_over_lanes<E, D, true>;
      }
      if constexpr (E::reads.start) table.lanes.centre[D - 1] = &centre_over_lanes<E, D>;
    }
  }
  if constexpr (HasForce<E, D, Pair> || HasEnergy<E, D, Pair>) {
    table.cyclic.set[D - 1] = &cyclic_kernel<E, Real, D, true>;
    table.cyclic.add[D - 1] = &cyclic_kernel<E, Real, D, false>;
    table.chain.set[D - 1] = &chain_kernel<E, Real, D, true>;
    table.chain.add[D - 1] = &chain_kernel<E, Real, D, false>;
    table.pair_list.add[D - 1] = &pair_list_kernel<E, Real, D>;
    if constexpr (HasEnergy<E, D, Pair>) table.pair_energy[D - 1] = &pair_energy<E, Real, D>;
    if constexpr (std::is_same_v<Real, double>) {
      table.lanes.cyclic[D - 1] = &cyclic_over_lanes<E, D>;
      table.lanes.chain[D - 1] = &chain_over_lanes<E, D>;
      table.lanes.pair_list[D - 1] = &pair_list_over_lanes<E, D>;
    }
  }
}

/// Everything that the loops make of an evaluator in one number type, on this instruction set.
/// What is no evaluator (an integrator's stage passes, say) names its own table.
template <class E, class Real>
constexpr auto kernel_table() {
  if constexpr (requires { E::template kernels<Real>(); }) {
    return E::template kernels<Real>();
  } else {
    ElementTable<Real> table;
    fill_table<E, Real, 1>(table);
    fill_table<E, Real, 2>(table);
    fill_table<E, Real, 3>(table);
    return table;
  }
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin

#define TOMLIN_JOIN3_(a, b, c) a##_##b##_##c
#define TOMLIN_JOIN3(a, b, c) TOMLIN_JOIN3_(a, b, c)

/// In a kernel file, which is compiled once per number type and instruction set: define the
/// evaluator's table. `type` names the number type: double or Quad.
#define TOMLIN_DEFINE_KERNELS(Evaluator, type)                                         \
  namespace tomlin::kernels {                                                          \
  extern const decltype(kernel_table<Evaluator, type>()) TOMLIN_JOIN3(Evaluator, type, \
                                                                      TOMLIN_TARGET);  \
  constinit const decltype(kernel_table<Evaluator, type>()) TOMLIN_JOIN3(              \
      Evaluator, type, TOMLIN_TARGET) = kernel_table<Evaluator, type>();               \
  }
