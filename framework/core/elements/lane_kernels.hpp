#pragma once

#include <bit>
#include <cstddef>

#include "framework/core/elements/element.hpp"
#include "framework/core/elements/nearest_image.hpp"
#include "framework/core/numbers/math.hpp"
#include "framework/core/system/kernel_arguments.hpp"

/// The loops over elements once more, over replicas (framework/core/system/lanes.hpp): eight
/// replicas of one element at a time, particle after particle. They do the operations of the loops
/// in kernels.hpp in the same order for each replica, so that the bits are the same.
namespace tomlin {
inline namespace TOMLIN_TARGET {

/// The numbers of a body's particles in eight replicas: axis d of particle i stands at
/// [(d * count + i) * width].
struct LaneParticles {
  const double* position;
  const double* velocity;
  double* force;
  std::size_t count;
  std::size_t width;

  TOMLIN_INLINE LaneParticles(const LaneArguments& lanes, const BodySlot<double>& body,
                              const Stage<double>& stage, std::size_t lane)
      : count(body.count), width(lanes.width) {
    const std::size_t at =
        (body.mapped ? lanes.mapped : lanes.coordinate)[body.offset] * lanes.width + lane;
    position = (body.mapped ? stage.mapped_position : stage.position) + at;
    velocity = (body.mapped ? stage.mapped_velocity : stage.velocity) + at;
    force = (body.mapped ? stage.mapped_force : stage.force) + at;
  }

  TOMLIN_INLINE std::size_t at(int axis, std::size_t particle) const {
    return (static_cast<std::size_t>(axis) * count + particle) * width;
  }
  template <int D>
  TOMLIN_INLINE Vec<Pack, D> position_of(std::size_t particle) const {
    Vec<Pack, D> x;
    for (int d = 0; d < D; ++d) x[d] = Pack::load(position + at(d, particle));
    return x;
  }
};

/// The time since the start of the step.
TOMLIN_INLINE Pack elapsed_in(const Stage<double>& stage, std::size_t lane) {
  return stage.elapsed_in_lanes ? Pack::load(stage.elapsed_in_lanes + lane) : Pack(stage.elapsed);
}

TOMLIN_INLINE void put_lanes(bool set, double* at, const Pack& value) {
  if (set) {
    value.store(at);
  } else {
    (Pack::load(at) + value).store(at);
  }
}

/// The one rule of sums over particles, see sum() of a Pack.
struct LaneSum {
  Pack part[kGroup];

  TOMLIN_INLINE LaneSum() {
    for (Pack& one : part) one = Pack(0.0);
  }
  TOMLIN_INLINE void add(std::size_t particle, const Pack& x) {
    part[particle % kGroup] = part[particle % kGroup] + x;
  }
  TOMLIN_INLINE void add_product(std::size_t particle, const Pack& a, const Pack& b) {
    part[particle % kGroup] = fma(a, b, part[particle % kGroup]);
  }
  /// Parts that nothing was added to are zeros, which change no bit: no part is -0.
  TOMLIN_INLINE Pack total(std::size_t particles) const {
    if (particles == 1) return part[0];
    const Pack low = (part[0] + part[4]) + (part[2] + part[6]);
    return low + ((part[1] + part[5]) + (part[3] + part[7]));
  }
};

/// The numbers of a structure that holds nothing else, in eight replicas.
template <class Target>
TOMLIN_INLINE Target in_lanes(const double* numbers, std::size_t stride) {
  struct Numbers {
    Pack value[sizeof(Target) / sizeof(Pack)];
  } all;
  for (Pack& value : all.value) {
    value = Pack::load(numbers);
    numbers += stride;
  }
  return std::bit_cast<Target>(all);
}

template <class E, int D>
inline constexpr std::size_t kSiteNumbers = sizeof(SiteParameters<E, double, D>) / sizeof(double);
template <class E, int D>
inline constexpr std::size_t kPairNumbers = sizeof(typename E::template Parameters<double, D>) /
                                            sizeof(double);

// ---- sites

/// Numbers: the parameters, [number] or [number * stride + particle]; then the starts, [axis *
/// stride + particle].
template <class E, int D, bool varied>
TOMLIN_FLATTEN void site_over_lanes(const void* arguments, const Stage<double>& stage) {
  constexpr bool works = DoesWork<E, D>;
  const LaneArguments l = *static_cast<const LaneArguments*>(arguments);
  const auto& a = *static_cast<const SiteArguments<double>*>(l.single);
  const std::size_t count = a.body.count;
  const std::size_t stride = a.body.stride;
  const std::ptrdiff_t rate = a.rate;
  const std::size_t w = l.width;
  for (std::size_t lane = 0; lane < w; lane += kGroup) {
    const LaneParticles body(l, a.body, stage, lane);
    const double* numbers = l.numbers + lane;
    const double* starts = numbers + kSiteNumbers<E, D> * w;
    std::size_t apart = w;  // from one parameter to the next
    if constexpr (varied) apart = stride * w;
    auto p = in_lanes<SiteParameters<E, Pack, D>>(numbers, apart);
    LaneSum total[D];
    LaneSum power;
    for (std::size_t i = 0; i < count; ++i) {
      if constexpr (varied) p = in_lanes<SiteParameters<E, Pack, D>>(numbers + i * w, apart);
      Site<Pack, D> site;
      site.position = body.position_of<D>(i);
      for (int d = 0; d < D; ++d) {
        if constexpr (E::reads.velocity)
          site.velocity[d] = Pack::load(body.velocity + body.at(d, i));
        if constexpr (E::reads.start) {
          site.start[d] = Pack::load(starts + (static_cast<std::size_t>(d) * stride + i) * w);
        }
      }
      site.elapsed = elapsed_in(stage, lane);
      site.frame = p.frame;
      const Vec<Pack, D> force = force_on<E, Pack, D>(p.own, site);
      for (int d = 0; d < D; ++d) put_lanes(l.set, body.force + body.at(d, i), force[d]);
      if constexpr (works) {
        for (int d = 0; d < D; ++d) total[d].add(i, force[d]);
        power.add(i, E::power(p.own, site, force));
      }
    }
    if constexpr (works) {
      if (rate == kNoRate) continue;
      double* rates = stage.rates + l.rate[rate] * w + lane;
      for (int d = 0; d < D; ++d) {
        total[d].total(count).store(rates + static_cast<std::size_t>(d) * w);
      }
      power.total(count).store(rates + static_cast<std::size_t>(D) * w);
    }
  }
}

/// The power that a damper takes out of the particles, -F.v; where `set` is true its force along x,
/// too, as the rate before. Numbers: as for site_over_lanes.
template <class E, int D, bool varied>
TOMLIN_FLATTEN void heat_over_lanes(const void* arguments, const Stage<double>& stage) {
  const LaneArguments l = *static_cast<const LaneArguments*>(arguments);
  const auto& a = *static_cast<const HeatArguments<double>*>(l.single);
  const std::size_t count = a.body.count;
  const std::size_t w = l.width;
  double* const rate = stage.rates + l.rate[a.rate] * w;
  for (std::size_t lane = 0; lane < w; lane += kGroup) {
    const LaneParticles body(l, a.body, stage, lane);
    const double* numbers = l.numbers + lane;
    std::size_t apart = w;  // from one parameter to the next
    if constexpr (varied) apart = a.body.stride * w;
    auto p = in_lanes<SiteParameters<E, Pack, D>>(numbers, apart);
    LaneSum heat;
    LaneSum total;
    for (std::size_t i = 0; i < count; ++i) {
      if constexpr (varied) p = in_lanes<SiteParameters<E, Pack, D>>(numbers + i * w, apart);
      Site<Pack, D> site;
      site.position = body.position_of<D>(i);
      for (int d = 0; d < D; ++d) site.velocity[d] = Pack::load(body.velocity + body.at(d, i));
      site.elapsed = elapsed_in(stage, lane);
      site.frame = p.frame;
      const Vec<Pack, D> force = force_on<E, Pack, D>(p.own, site);
      heat.add(i, -dot(force, site.velocity));
      total.add(i, force[0]);
    }
    heat.total(count).store(rate + lane);
    if (l.set) total.total(count).store(rate - w + lane);
  }
}

// ---- the centre of mass of a body, or one particle of it

template <int D>
TOMLIN_INLINE Vec<Pack, D> attached_in_lanes(const CentreArguments<double>& a,
                                             const LaneArguments& l, const double* of_centre,
                                             const double* of_particles, const double* weights) {
  const std::size_t w = l.width;
  Vec<Pack, D> point;
  for (int d = 0; d < D; ++d) {
    const auto axis = static_cast<std::size_t>(d);
    if (a.on_coordinates) {
      point[d] = Pack::load(of_centre + axis * w);
      continue;
    }
    const double* x = of_particles + axis * a.body.count * w;
    if (a.single) {
      point[d] = Pack::load(x + a.particle * w);
      continue;
    }
    LaneSum mean;
    for (std::size_t i = 0; i < a.body.count; ++i) {
      mean.add_product(i, Pack::load(weights + i * w), Pack::load(x + i * w));
    }
    point[d] = mean.total(kGroup);
  }
  return point;
}

/// Numbers: the parameters, the start, the weights of all particles.
template <class E, int D>
TOMLIN_FLATTEN void centre_over_lanes(const void* arguments, const Stage<double>& stage) {
  const LaneArguments l = *static_cast<const LaneArguments*>(arguments);
  const CentreArguments<double> a = *static_cast<const CentreArguments<double>*>(l.single);
  const std::size_t w = l.width;
  for (std::size_t lane = 0; lane < w; lane += kGroup) {
    const LaneParticles body(l, a.body, stage, lane);
    const std::size_t at = a.on_coordinates ? l.coordinate[a.body.centre] * w + lane : 0;
    const double* numbers = l.numbers + lane;
    const double* starts = numbers + kSiteNumbers<E, D> * w;
    const double* weights = starts + 3 * w;
    const auto p = in_lanes<SiteParameters<E, Pack, D>>(numbers, w);
    Site<Pack, D> site;
    site.position = attached_in_lanes<D>(a, l, stage.position + at, body.position, weights);
    if constexpr (E::reads.velocity) {
      site.velocity = attached_in_lanes<D>(a, l, stage.velocity + at, body.velocity, weights);
    }
    for (int d = 0; d < D; ++d)
      site.start[d] = Pack::load(starts + static_cast<std::size_t>(d) * w);
    site.elapsed = elapsed_in(stage, lane);
    site.frame = p.frame;
    const Vec<Pack, D> force = force_on<E, Pack, D>(p.own, site);

    if (a.on_coordinates) {
      for (int d = 0; d < D; ++d) {
        put_lanes(l.set, stage.force + at + static_cast<std::size_t>(d) * w, force[d]);
      }
      // A planar body's rotation stands behind its position.
      if constexpr (D == 2) put_lanes(l.set, stage.force + at + 2 * w, Pack(0.0));
    } else {
      for (int d = 0; d < D; ++d) {
        for (std::size_t i = 0; i < a.body.count; ++i) {
          double* to = body.force + body.at(d, i);
          if (i >= a.first && i < a.last) {
            put_lanes(l.set, to, Pack::load(weights + i * w) * force[d]);
          } else if (l.set) {
            Pack(0.0).store(to);
          }
        }
      }
    }
    if constexpr (DoesWork<E, D>) {
      if (a.rate == kNoRate) continue;
      double* rates = stage.rates + l.rate[a.rate] * w + lane;
      for (int d = 0; d < D; ++d) force[d].store(rates + static_cast<std::size_t>(d) * w);
      E::power(p.own, site, force).store(rates + static_cast<std::size_t>(D) * w);
    }
  }
}

// ---- pairs

/// The force on the first of two particles.
template <class E, int D>
TOMLIN_INLINE Vec<Pack, D> pair_in_lanes(const typename E::template Parameters<Pack, D>& p,
                                         const Vec<Pack, D>& separation, const double* datum) {
  Pair<Pack, D> pair;
  pair.separation = separation;
  pair.datum = Pack::load(datum);
  return force_on<E, Pack, D>(p, pair);
}

/// Two evaluations of a pair, from either of its particles, have the same bits but for the sign.
template <class E>
concept CentralForce = requires {
  requires E::central;
};

/// Numbers: the parameters, then the pairs' own, [row * row_stride + particle]. Scratch, for eight
/// replicas after eight: what pulls each particle forwards, [axis][particle], and the forces of
/// pairs, [row][axis][particle].
template <class E, int D>
TOMLIN_FLATTEN void cyclic_over_lanes(const void* arguments, const Stage<double>& stage) {
  const LaneArguments l = *static_cast<const LaneArguments*>(arguments);
  const auto& a = *static_cast<const CyclicArguments<double>*>(l.single);
  const std::size_t count = a.body.count;
  const std::size_t rows = a.rows;
  const std::size_t row_stride = a.row_stride;
  const std::size_t backwards = a.half_row_last ? rows - 1 : rows;
  // On a line the direction of a pair without separation does not change its sign.
  const bool is_halved = a.half_row_last && D > 1 && CentralForce<E>;
  const std::size_t w = l.width;
  double* const forwards = l.scratch;
  double* const result = forwards + static_cast<std::size_t>(D) * count * kGroup;
  const auto at = [count](std::size_t row, int d, std::size_t i) TOMLIN_INLINE_LAMBDA {
    return ((row * static_cast<std::size_t>(D) + static_cast<std::size_t>(d)) * count + i) * kGroup;
  };
  for (std::size_t lane = 0; lane < w; lane += kGroup) {
    const LaneParticles body(l, a.body, stage, lane);
    const double* numbers = l.numbers + lane;
    const double* data = numbers + kPairNumbers<E, D> * w;
    const auto p = in_lanes<typename E::template Parameters<Pack, D>>(numbers, w);
    // Forces are added in the order of one run: forwards by rows, then backwards from the furthest.
    for (std::size_t i = 0; i < count; ++i) {
      const Vec<Pack, D> here = body.position_of<D>(i);
      const std::size_t evaluated = is_halved && i >= count / 2 ? rows - 1 : rows;
      Vec<Pack, D> total;
      for (int d = 0; d < D; ++d) total[d] = Pack(0.0);
      for (std::size_t row = 0; row < evaluated; ++row) {
        const std::size_t j = i + row + 1 < count ? i + row + 1 : i + row + 1 - count;
        const Vec<Pack, D> force = pair_in_lanes<E, D>(p, body.position_of<D>(j) - here,
                                                       data + (row * row_stride + i) * w);
        for (int d = 0; d < D; ++d) {
          force[d].store(result + at(row, d, i));
          total[d] += force[d];
        }
      }
      for (int d = 0; d < D; ++d) {
        if (evaluated < rows)
          total[d] = total[d] - Pack::load(result + at(rows - 1, d, i - count / 2));
        total[d].store(forwards + at(0, d, i));
      }
    }
    for (std::size_t i = 0; i < count; ++i) {
      for (int d = 0; d < D; ++d) {
        Pack total = Pack::load(forwards + at(0, d, i));
        for (std::size_t row = backwards; row-- > 0;) {
          const std::size_t j = i >= row + 1 ? i - row - 1 : i + count - row - 1;
          total = total - Pack::load(result + at(row, d, j));
        }
        put_lanes(l.set, body.force + body.at(d, i), total);
      }
    }
  }
}

/// Numbers: the parameters, the way through a closed chain's end (three), the bonds' own.
template <class E, int D>
TOMLIN_FLATTEN void chain_over_lanes(const void* arguments, const Stage<double>& stage) {
  const LaneArguments l = *static_cast<const LaneArguments*>(arguments);
  const auto& a = *static_cast<const ChainArguments<double>*>(l.single);
  const std::size_t count = a.body.count;
  const bool closed = a.closed;
  const std::size_t w = l.width;
  for (std::size_t lane = 0; lane < w; lane += kGroup) {
    const LaneParticles body(l, a.body, stage, lane);
    const double* numbers = l.numbers + lane;
    const double* wrap = numbers + kPairNumbers<E, D> * w;
    const double* data = wrap + 3 * w;
    const auto p = in_lanes<typename E::template Parameters<Pack, D>>(numbers, w);
    Vec<Pack, D> none;
    for (int d = 0; d < D; ++d) none[d] = Pack(0.0);
    // The bond behind the first particle of a closed chain is that of the last.
    Vec<Pack, D> closing = none;
    if (closed) {
      Vec<Pack, D> image;
      for (int d = 0; d < D; ++d) {
        image[d] = Pack::load(body.position + body.at(d, 0)) +
                   Pack::load(wrap + static_cast<std::size_t>(d) * w);
      }
      closing =
          pair_in_lanes<E, D>(p, image - body.position_of<D>(count - 1), data + (count - 1) * w);
    }
    Vec<Pack, D> behind = closing;
    Vec<Pack, D> here = body.position_of<D>(0);
    for (std::size_t i = 0; i < count; ++i) {
      Vec<Pack, D> force = closing;
      if (i + 1 < count) {
        const Vec<Pack, D> next = body.position_of<D>(i + 1);
        force = pair_in_lanes<E, D>(p, next - here, data + i * w);
        here = next;
      }
      for (int d = 0; d < D; ++d) {
        put_lanes(l.set, body.force + body.at(d, i), force[d] - behind[d]);
      }
      behind = force;
    }
  }
}

/// Numbers: the parameters, the lengths of the box (three), the pairs' own and, where there are
/// images, [axis][pair], both with their padding. Scratch: [axis][pair].
template <class E, int D>
TOMLIN_FLATTEN void pair_list_over_lanes(const void* arguments, const Stage<double>& stage) {
  const LaneArguments l = *static_cast<const LaneArguments*>(arguments);
  const PairListArguments<double> a = *static_cast<const PairListArguments<double>*>(l.single);
  const std::size_t w = l.width;
  const std::size_t row_length = (a.pairs + kGroup - 1) / kGroup * kGroup;
  for (std::size_t lane = 0; lane < w; lane += kGroup) {
    const LaneParticles first(l, a.first, stage, lane);
    const LaneParticles second(l, a.second, stage, lane);
    const double* numbers = l.numbers + lane;
    const double* box = numbers + kPairNumbers<E, D> * w;
    const double* data = box + 3 * w;
    const double* image = data + row_length * w;
    double* result = l.scratch + lane;
    const auto p = in_lanes<typename E::template Parameters<Pack, D>>(numbers, w);
    for (std::size_t k = 0; k < a.pairs; ++k) {
      Vec<Pack, D> apart = second.position_of<D>(a.j[k]) - first.position_of<D>(a.i[k]);
      for (int d = 0; d < D; ++d) {
        const auto axis = static_cast<std::size_t>(d);
        if (a.image) apart[d] = apart[d] + Pack::load(image + (axis * row_length + k) * w);
        if (a.box[d] > 0.0) apart[d] = nearest_image(apart[d], Pack::load(box + axis * w));
      }
      const Vec<Pack, D> force = pair_in_lanes<E, D>(p, apart, data + k * w);
      for (int d = 0; d < D; ++d) {
        force[d].store(result + (static_cast<std::size_t>(d) * a.pairs + k) * w);
      }
    }
    const auto share_out = [&](const LaneParticles& body, std::size_t rows, std::size_t first_row) {
      for (int d = 0; d < D; ++d) {
        const double* of_axis = result + static_cast<std::size_t>(d) * a.pairs * w;
        for (std::size_t i = 0; i < rows; ++i) {
          Pack total(0.0);
          for (std::size_t k = a.row_start[first_row + i]; k < a.row_start[first_row + i + 1];
               ++k) {
            const std::ptrdiff_t pair = a.row[k];
            total += pair > 0 ? Pack::load(of_axis + static_cast<std::size_t>(pair - 1) * w)
                              : -Pack::load(of_axis + static_cast<std::size_t>(-pair - 1) * w);
          }
          put_lanes(false, body.force + body.at(d, i), total);
        }
      }
    };
    share_out(first, a.particles_first, 0);
    if (!a.same_body) share_out(second, a.particles_second, a.particles_first);
  }
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
