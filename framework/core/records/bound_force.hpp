#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "framework/core/numbers/double_double.hpp"
#include "framework/core/records/coordinates.hpp"
#include "framework/core/records/facets.hpp"
#include "framework/core/records/neighbours.hpp"
#include "framework/core/records/variation.hpp"
#include "framework/core/system/aligned.hpp"
#include "framework/core/system/instruction_set.hpp"
#include "framework/core/system/kernel_arguments.hpp"
#include "framework/core/system/lanes.hpp"
#include "framework/core/system/stage.hpp"

/// A force is complete once a scene is bound, with every number resolved. Here is the contract that
/// all forces share.
namespace tomlin {

/// The scene's origin: whole cells per axis. All positions are kept relative to it.
struct Origin {
  std::array<std::int64_t, 3> cells{};
  std::array<double, 3> unit{};  ///< length of a cell: the longest period declared; 0: never moves
};

/// A position of the scene relative to its origin, to the last digit.
inline double relative_to(const Origin& origin, int axis, double position) {
  const DoubleDouble shift =
      DoubleDouble(static_cast<double>(origin.cells[axis])) * origin.unit[axis];
  return static_cast<double>(DoubleDouble(position) - shift);
}

/// A body as forces see it when they bind.
template <class Real>
struct BoundBody {
  std::string name;
  std::size_t index = 0;
  Coordinates coordinates = Coordinates::particles;
  bool closed = false;
  BodySlot<Real> slot;
  int open_along = -1;                       ///< a chain that the box closes: along this axis
  int freedom = 0;                           ///< how many of its coordinates move by forces
  std::vector<double> mass;                  ///< [count]
  std::vector<std::array<double, 3>> start;  ///< [count][axis], from the scene's origin; else 0
  std::vector<double> start_centre;          ///< [dimension], centre of mass
  NeighbourList neighbours;
  std::vector<std::int32_t> species;           ///< [count], indices of names; empty: it has none
  std::span<const std::string> species_names;  ///< of all species of the scene, each once
};

template <class Real>
struct Binding {
  int dimension = 0;
  InstructionSet set = InstructionSet::baseline;
  Origin origin;                               ///< at time 0; an axis whose unit is 0 never moves
  std::array<double, 3> box{};                 ///< length of each periodic axis, else 0
  std::vector<const BoundBody<Real>*> bodies;  ///< those the force acts on
  /// Parameters that differ between the particles of its one body; only where its record varies.
  std::span<const Variation> variations;
};

/// Forces on the particles of a body, or on the centre of a rigid one.
struct Region {
  std::size_t body = 0;
  bool centre = false;
};

/// Cheap passes come first and those with long latencies last, so that they overlap.
inline constexpr int kRankCheap = 0;
inline constexpr int kRankPairs = 1;
inline constexpr int kRankTranscendental = 2;

/// One kernel call of a force. The model orders the passes and lets the first on a region set.
template <class Real>
struct Pass {
  /// Null: this pass can only add. What stands in the region before is no number that means
  /// anything, so all of it is written: of particles every axis with its padding, up to a whole
  /// group, and of a centre its group of eight, the rotation included.
  Kernel<Real> set = nullptr;
  Kernel<Real> add = nullptr;
  const void* arguments = nullptr;
  std::vector<Region> writes;
  int rank = kRankCheap;
  LaneForm lanes = {};  ///< the same call over replicas, where there is one
  /// The force of one point in registers, where a kernel for a single particle on a line exists.
  PointForce<Real> point = {};
};

/// A force in a bound scene: what every force may implement. All else that some forces can do are
/// facets (framework/core/records/facets.hpp): classes that a force inherits besides, and that the
/// engine finds there.
template <class Real>
class BoundForce {
 public:
  virtual ~BoundForce() = default;

  /// Kernel calls of one evaluation. Their arguments live as long as this object.
  virtual std::vector<Pass<Real>> passes() = 0;
  /// For forces that depend on time: stages count their `elapsed` from this time on. Called every
  /// few steps, not at each.
  virtual bool depends_on_time() const { return false; }
  virtual void begin_step(const DoubleDouble& time) { (void)time; }
  /// The scene's origin has moved; positions are relative to the new one from now on.
  virtual void rebase(const Origin& origin) { (void)origin; }
  /// Potential energy; 0 for a force without one.
  virtual Real energy(const Stage<Real>& stage) const {
    (void)stage;
    return Real(0.0);
  }
  /// For the energy ledger: a kernel that writes the power which this force takes out of the
  /// particles to stage.rates[rate]. False for a force that only stores energy.
  virtual bool heat(std::ptrdiff_t rate, Operation<Real>& operation) {
    (void)rate;
    (void)operation;
    return false;
  }
};

}  // namespace tomlin
