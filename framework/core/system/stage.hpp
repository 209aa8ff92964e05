#pragma once

#include <cstddef>

/// The plain data that kernels work on. No functions live here: kernels are compiled once per
/// instruction set, and what they share must be free of code.
namespace tomlin {

/// Particles come in groups of eight, the width of the summation rule; arrays are padded to it.
inline constexpr std::size_t kGroup = 8;

/// One evaluation of the forces: where to read, where to write.
template <class Real>
struct Stage {
  const Real* position = nullptr;  ///< generalised coordinates, relative to the scene's origin
  const Real* velocity = nullptr;
  Real* force = nullptr;            ///< generalised forces
  Real* mapped_position = nullptr;  ///< particles of rigid and fixed bodies
  Real* mapped_velocity = nullptr;
  Real* mapped_force = nullptr;
  const Real* own = nullptr;  ///< state variables owned by forces
  Real* rates = nullptr;      ///< time derivatives: of own variables, then of running integrals
  Real elapsed{};             ///< time since the start of the step
  /// Elapsed times of replicas in lanes whose steps differ; null: `elapsed` is that of all.
  const Real* elapsed_in_lanes = nullptr;
};

/// A kernel reads its own plain arguments and a stage. It neither allocates nor throws.
template <class Real>
using Kernel = void (*)(const void* arguments, const Stage<Real>& stage);

struct LaneForm;  // lanes.hpp

template <class Real>
struct Operation {
  Kernel<Real> run = nullptr;
  const void* arguments = nullptr;
  const LaneForm* lanes = nullptr;  ///< of a heat: how the call is made over replicas, if it can be
};

/// Location of a body's numbers.
template <class Real>
struct BodySlot {
  std::size_t offset = 0;       ///< of the first particle's x
  std::size_t stride = 0;       ///< from one axis to the next
  std::size_t count = 0;        ///< particles, without padding
  bool mapped = false;          ///< particles stand in the mapped arrays, not among the coordinates
  bool rigid = false;           ///< the centre of mass is itself a coordinate
  std::size_t centre = 0;       ///< rigid: where its coordinates x, y, (z), turns stand
  const Real* share = nullptr;  ///< mass fractions m_i/M, zero in the padding
};

}  // namespace tomlin
