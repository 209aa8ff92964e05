#pragma once

#include <cstddef>
#include <cstdint>

#include "framework/core/elements/cutoff_arguments.hpp"

/// Arguments of kernels of bond-order potentials. Plain data only, see stage.hpp.
namespace tomlin {

/// Particles in groups of eight, a lane each, and rows of neighbours: row k holds the k-th
/// neighbour of each particle of a group, in ascending order. A slot is a row of a group.
template <class Real>
struct BondOrderArguments {
  ListUpdate<Real> update;
  const Team* team = nullptr;  ///< null: one thread
  BodySlot<Real> body;
  /// [(first * species + second) * species + third], or one where there is one species.
  const void* parameters = nullptr;
  std::size_t species = 1;
  bool weighted = false;                     ///< w is not 1 everywhere
  bool by_pairs = false;                     ///< see PairsOfSpecies
  const std::int64_t* kind = nullptr;        ///< [particle, padded] its species
  Real reach{};                              ///< beyond it nothing interacts
  const std::uint32_t* row_start = nullptr;  ///< [group + 1] first slot
  const Real* neighbours = nullptr;          ///< [particle, padded] how many
  const std::int64_t* near = nullptr;        ///< [slot][lane] the neighbour
  const std::int64_t* reverse = nullptr;     ///< [slot][lane] where the particle is the neighbour's
  const Real* shift = nullptr;               ///< [axis][slot][lane] of its image; null: none
  std::size_t slots = 0;
  Real* gradient = nullptr;  ///< scratch [axis][slot][lane] of the energy of the particle
  Real* work = nullptr;      ///< scratch of one group, for each member of the team
  std::size_t work_apart = 0;
  Real* energy = nullptr;  ///< scratch [particle, padded]
};

/// The kernels of a bond-order potential in three dimensions.
template <class Real>
struct BondOrderTable {
  Kernel<Real> set = nullptr;
  Kernel<Real> add = nullptr;
  Kernel<Real> energy = nullptr;  ///< of each particle
};

}  // namespace tomlin
