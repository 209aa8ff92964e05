#pragma once

#include <array>
#include <cstddef>

#include "framework/core/system/kernel_arguments.hpp"

/// Kernels that add up the energies of elements, beside those of forces. Plain data only, see
/// stage.hpp.
namespace tomlin {

/// One pair, with the number of its own that the evaluator reads (a rest length, say).
template <class Real>
struct BoundPair {
  std::size_t i = 0;              ///< of the first body
  std::size_t j = 0;              ///< of the second, or of the same
  std::array<double, 3> image{};  ///< through a periodic box: added to the way from i to j
  Real datum{};
};

/// The pairs of a force in the order in which their energies are added up.
template <class Real>
struct PairEnergyArguments {
  BodySlot<Real> first;
  BodySlot<Real> second;
  const void* parameters = nullptr;
  const BoundPair<Real>* pairs = nullptr;
  std::size_t count = 0;
  Real box[3] = {};  ///< as in PairListArguments
};

/// The energy of all elements of a force.
template <class Real>
using EnergyKernel = Real (*)(const void* arguments, const Stage<Real>& stage);

/// All kernels of an evaluator. Those of energies are by dimension, and null where it has none.
template <class Real>
struct ElementTable : KernelTable<Real> {
  EnergyKernel<Real> site_energy[3] = {};
  EnergyKernel<Real> varied_site_energy[3] = {};
  EnergyKernel<Real> pair_energy[3] = {};
};

}  // namespace tomlin
