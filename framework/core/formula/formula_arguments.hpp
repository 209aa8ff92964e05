#pragma once

#include <cstddef>

#include "framework/core/formula/program.hpp"
#include "framework/core/system/kernel_arguments.hpp"

/// Arguments of the kernels of formulas, and their table. Plain data only, see stage.hpp.
namespace tomlin {

/// Packs of eight in a block: registers hold so many, and stand apart by an odd number of cache
/// lines, so that none shadows another.
inline constexpr std::size_t kFormulaBlock = 16;
inline constexpr std::size_t kFormulaElements = kFormulaBlock * kGroup;
inline constexpr std::size_t kFormulaRegister = kFormulaElements + kGroup;

/// A block of numbers: `step` from one pack to the next, 0 where all elements have the same.
template <class Real>
struct FormulaOperand {
  const Real* at = nullptr;
  std::size_t step = 0;
};

/// An instruction with its operands found.
template <class Real>
struct FormulaStep {
  FormulaOp op = FormulaOp::add;
  FormulaOperand<Real> a;
  FormulaOperand<Real> b;
  FormulaOperand<Real> c;
  Real* to = nullptr;
  Real* also = nullptr;
};

/// An operand that is an input: it is pointed at the caller's numbers before each run.
template <class Real>
struct FormulaPatch {
  const Real** at = nullptr;
  std::size_t input = 0;
};

/// An output: where it is found, and where the instruction that makes it writes it, so that it may
/// go to the caller at once. Null where it is needed afterwards, or is none of the body's.
template <class Real>
struct FormulaOutput {
  FormulaOperand<Real> operand;
  Real* home = nullptr;  ///< its register
  Real** writes_to = nullptr;
  std::ptrdiff_t input = -1;  ///< an input that is an output as it is
};

/// Code with its numbers and its memory, for one number type.
template <class Real>
struct FormulaView {
  const FormulaStep<Real>* prologue = nullptr;
  std::size_t prologue_length = 0;
  const FormulaStep<Real>* body = nullptr;
  std::size_t body_length = 0;
  const FormulaPatch<Real>* patches = nullptr;
  std::size_t patch_count = 0;
  const FormulaOutput<Real>* outputs = nullptr;
  std::size_t output_count = 0;
  Real* time = nullptr;  ///< [kGroup], where the time goes; null: the formula has none
  const Real* start_of_time = nullptr;  ///< the time from which a stage's `elapsed` counts
};

/// Position and velocity of a particle, and what else is a number of it.
inline constexpr std::size_t kMostFormulaInputs = 32;
inline constexpr std::size_t kMostFormulaAxes = 6;

/// A formula for every particle of a body: x, y, z, vx, vy, vz as it names them, then the numbers
/// that each particle has.
template <class Real>
struct FormulaSiteArguments {
  FormulaView<Real> code;  ///< outputs: the force on each axis
  BodySlot<Real> body;
  int dimension = 0;
  std::size_t axes = 0;             ///< inputs that are positions or velocities
  int axis[kMostFormulaAxes] = {};  ///< of each: 0 to 2 position, 3 to 5 velocity
  std::size_t numbers = 0;          ///< the inputs behind these
  const Real* number = nullptr;     ///< [number][body.stride]; padding has finite ones, too
  std::ptrdiff_t rate = kNoRate;    ///< for the ledger, see `heat` below
  bool heat_is_power = false;       ///< heat = -F.v of outputs; else the sum of the only output
};

/// A formula for the centre of mass of a body.
template <class Real>
struct FormulaCentreArguments {
  FormulaView<Real> code;
  CentreArguments<Real> centre;
  int dimension = 0;
  std::size_t inputs = 0;
  int axis[kMostFormulaAxes] = {};
};

/// A formula of the distance of each pair of a list; the output is dV/dr.
template <class Real>
struct FormulaPairArguments {
  FormulaView<Real> code;
  PairListArguments<Real> list;
  int dimension = 0;
  /// Neighbours (i, i + 1) of one body instead of the list: these run along contiguous numbers.
  bool chain = false;
  bool closed = false;     ///< by the pair of the last particle and the first one's image
  Real wrap[3] = {};       ///< from the first particle to its image behind the last
  Real* result = nullptr;  ///< scratch [axis][result_stride], the first pair's behind kGroup others
  std::size_t result_stride = 0;
  std::ptrdiff_t rate = kNoRate;  ///< for the ledger: the sum of the only output
};

/// A formula of the angle at the middle particle of each triple of a list; the output is dV/dtheta.
template <class Real>
struct FormulaAngleArguments {
  FormulaView<Real> code;
  BodySlot<Real> body;
  std::size_t angles = 0;
  const std::size_t* particle = nullptr;  ///< [3][padded angles]: end, middle, end
  const Real* image = nullptr;  ///< [2][axis][padded angles], added to the two bonds; null: none
  Real* result = nullptr;       ///< scratch [3][axis][padded angles]
  /// For each particle: its triples in row order, as 3 * triple + index in it.
  const std::size_t* row_start = nullptr;
  const std::size_t* row = nullptr;
  int dimension = 0;
  std::ptrdiff_t rate = kNoRate;
};

template <class Real>
struct FormulaKernelTable {
  KernelPair<Real> site;  ///< the dimension stands in the arguments: the first entry is for all
  KernelPair<Real> centre;
  Kernel<Real> pairs = nullptr;   ///< adds
  Kernel<Real> angles = nullptr;  ///< adds
  Kernel<Real> site_heat = nullptr;
  Kernel<Real> pair_heat = nullptr;
  Kernel<Real> angle_heat = nullptr;
  Kernel<Real> centre_heat[3] = {};  ///< by dimension
  PointKernel<Real> point = nullptr;
  /// All outputs for one element.
  void (*evaluate)(const FormulaView<Real>& code, const Real* inputs, std::size_t count,
                   Real elapsed, Real* outputs) = nullptr;
};

}  // namespace tomlin
