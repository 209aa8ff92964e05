#pragma once

#include <cstddef>
#include <cstdint>

#include "framework/core/system/stage.hpp"
#include "framework/core/system/team.hpp"

/// Arguments of kernels of forces with a cutoff. Plain data only, see stage.hpp.
namespace tomlin {

/// Brings a neighbour list up to date with the positions of a stage, before they are read.
template <class Real>
struct ListUpdate {
  void (*run)(void* list, const Stage<Real>& stage) = nullptr;
  void* list = nullptr;
};

/// The force of one body's particles on those of another, or of the same body. Each particle has a
/// list of groups of eight consecutive particles among which its neighbours are; those of a group
/// that are beyond the cutoff add zero. So the sum, particle j in lane j modulo 8 in ascending
/// order, does not depend on what else is in the list.
template <class Real>
struct CutoffPairArguments {
  ListUpdate<Real> update;
  const Team* team = nullptr;  ///< null: one thread
  BodySlot<Real> one;          ///< on which the force acts
  BodySlot<Real> other;        ///< from which it comes
  bool same_body = false;
  const void* parameters = nullptr;
  /// If parameters differ between species: the species of each particle of `one`, by index, and the
  /// numbers of the parameters [species of `one`][number][particle of `other`, padded]. Else null.
  const std::uint32_t* kind = nullptr;
  const Real* numbers = nullptr;
  std::size_t numbers_apart = 0;  ///< particles of `other`, padded
  Real cutoff_squared{};
  const std::uint32_t* row_start = nullptr;  ///< [particles of `one` + 1]
  const std::uint32_t* first = nullptr;      ///< [entry] first particle of the group
  const std::uint32_t* shift = nullptr;      ///< [entry] which of the shifts
  const Real* shifts = nullptr;              ///< [shift][3] added to x_j - x_i: an image
  Real* energy = nullptr;                    ///< scratch [particle of `one`, padded]
};

/// Kernels of a pair force with a cutoff, for dimensions 1 to 3.
template <class Real>
struct CutoffPairTable {
  Kernel<Real> set[3] = {};
  Kernel<Real> add[3] = {};
  Kernel<Real> energy[3] = {};  ///< of each particle's pairs
};

}  // namespace tomlin
