#pragma once

#include <cstddef>
#include <cstdint>

#include "framework/core/system/stage.hpp"

/// Arguments of the element kernels, and the table of kernels that one evaluator has on one
/// instruction set. Plain data only, see stage.hpp.
namespace tomlin {

inline constexpr std::ptrdiff_t kNoRate = -1;

/// A force on every particle of a body.
template <class Real>
struct SiteArguments {
  BodySlot<Real> body;
  const void* parameters = nullptr;  ///< the evaluator's Parameters<Real, D>
  /// If they differ: [number * body.stride + particle], as the numbers stand in `parameters`.
  const Real* each = nullptr;
  const double* table = nullptr;  ///< for evaluators that read it
  const Real* start = nullptr;    ///< [axis * body.stride + particle], for evaluators that read it
  std::ptrdiff_t rate = kNoRate;  ///< where a driver's force and power go among the rates
};

/// A force on one attached point of a body: its centre of mass, or a single particle. The point is
/// the weighted mean of the particles and the force is shared out with the same weights, which is
/// virtual work.
template <class Real>
struct CentreArguments {
  BodySlot<Real> body;
  const void* parameters = nullptr;
  const Real* weight = nullptr;  ///< per particle, sum 1, zero in the padding
  std::size_t first = 0;         ///< particles [first, last) carry weight; multiples of kGroup
  std::size_t last = 0;
  bool on_coordinates = false;  ///< act on a rigid body's centre directly
  bool single = false;          ///< all weight on one particle (no sum is needed)
  std::size_t particle = 0;     ///< that particle
  Real start[3] = {};
  std::ptrdiff_t rate = kNoRate;
};

/// Pairs (i, i + shift modulo count) within one body, shifts 1..rows, each pair evaluated once.
template <class Real>
struct CyclicArguments {
  BodySlot<Real> body;
  const void* parameters = nullptr;
  std::size_t rows = 0;
  bool half_row_last = false;   ///< count = 2 rows: the last row holds each pair twice
  std::size_t row_stride = 0;   ///< from one row of `datum` to the next
  const Real* datum = nullptr;  ///< [row][i]
  // Up to kGroup particles stay in registers and are permuted by these orders, [row][kGroup].
  const std::int64_t* forward = nullptr;   ///< i -> i + shift
  const std::int64_t* backward = nullptr;  ///< i -> i - shift
  // More go through memory.
  Real* extended = nullptr;  ///< scratch [axis][extended_stride]
  std::size_t extended_stride = 0;
  Real* result = nullptr;  ///< scratch [row][axis][result_stride]
  std::size_t result_stride = 0;
};

/// Pairs (i, i + 1) within one body: open at both ends, or closed by the pair of the last particle
/// and the first one's image.
template <class Real>
struct ChainArguments {
  BodySlot<Real> body;
  const void* parameters = nullptr;
  const Real* datum = nullptr;  ///< [i]
  bool closed = false;
  Real wrap[3] = {};  ///< from the first particle to its image behind the last
};

/// Any list of pairs, within one body or between two.
template <class Real>
struct PairListArguments {
  BodySlot<Real> first;
  BodySlot<Real> second;
  const void* parameters = nullptr;
  std::size_t pairs = 0;
  const std::size_t* i = nullptr;  ///< [padded pairs]; the padding repeats the last pair
  const std::size_t* j = nullptr;
  const Real* datum = nullptr;  ///< [padded pairs]
  const Real* image = nullptr;  ///< [axis][padded pairs], added to separations; null: none is
  Real box[3] =
      {};  ///< length along each axis on which separations are to the nearest image, else 0
  Real* result = nullptr;  ///< scratch [axis][padded pairs]
  /// For each particle of `first`, then of `second`: its pairs in row order, as +/-(pair + 1).
  std::size_t particles_first = 0;
  std::size_t particles_second = 0;
  const std::size_t* row_start = nullptr;  ///< [particles_first + particles_second + 1]
  const std::ptrdiff_t* row = nullptr;
  bool same_body = true;
};

/// The power that a damper takes out of a body's particles.
template <class Real>
struct HeatArguments {
  BodySlot<Real> body;
  const void* parameters = nullptr;
  const Real* each = nullptr;  ///< as in SiteArguments
  std::ptrdiff_t rate = kNoRate;
};

/// Kernels of one evaluator for dimensions 1 to 3: `set` overwrites the force, `add` adds to it.
/// An entry is null where the evaluator does not offer that element.
template <class Real>
struct KernelPair {
  Kernel<Real> set[3] = {};
  Kernel<Real> add[3] = {};
};

/// A force on a single particle on a line, and a driver's power. Two numbers come back in
/// registers.
template <class Real>
struct PointResult {
  Real force{};
  Real power{};
};
template <class Real>
using PointKernel = PointResult<Real> (*)(const void* parameters, Real position, Real velocity,
                                          Real start, Real elapsed);

/// One force of a scene that is a single particle on a line.
template <class Real>
struct PointForce {
  PointKernel<Real> run = nullptr;
  const void* parameters = nullptr;
  Real start{};
  std::ptrdiff_t rate = kNoRate;
};

/// Starts of the steps of such a particle: row k is the start of step k.
template <class Real>
struct PointStarts {
  Real* rates = nullptr;
  Real* positions = nullptr;
  Real* velocities = nullptr;

  PointStarts from(std::size_t step, std::size_t width) const {
    return {rates + step * width, positions + step, velocities + step};
  }
};

/// Arguments of a kernel over replicas, see lanes.hpp.
struct LaneArguments {
  const void* single = nullptr;     ///< the arguments of one run of the same structure
  const double* numbers = nullptr;  ///< [number * width + replica]
  double* scratch = nullptr;        ///< likewise
  std::size_t width = 0;            ///< replicas, a multiple of kGroup
  bool set = false;                 ///< write the forces; else add to what is there
  // Indices of the numbers of one run among the numbers without padding.
  const std::size_t* coordinate = nullptr;
  const std::size_t* mapped = nullptr;
  const std::size_t* rate = nullptr;
};

/// Kernels over replicas, for dimensions 1 to 3.
struct LaneKernels {
  Kernel<double> site[3] = {};
  Kernel<double> varied_site[3] = {};
  Kernel<double> heat[3] = {};
  Kernel<double> varied_heat[3] = {};
  Kernel<double> centre[3] = {};
  Kernel<double> cyclic[3] = {};
  Kernel<double> chain[3] = {};
  Kernel<double> pair_list[3] = {};  ///< adds
};

template <class Real>
struct KernelTable {
  KernelPair<Real> site;
  KernelPair<Real> centre;
  KernelPair<Real> cyclic;
  KernelPair<Real> chain;
  KernelPair<Real> pair_list;
  Kernel<Real> heat[3] = {};
  Kernel<Real> varied_site[3] = {};  ///< adds; with parameters that differ between particles
  Kernel<Real> varied_heat[3] = {};
  PointKernel<Real> point = nullptr;
  LaneKernels lanes;  ///< of double
};

}  // namespace tomlin
