#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "framework/core/formula/graph.hpp"

/// A formula as a short list of instructions on blocks of numbers.
namespace tomlin {

/// Operation of one instruction, element by element: to = op(a, b, c).
enum class FormulaOp : std::uint8_t {
  add,
  subtract,
  multiply,
  divide,
  multiply_add,  ///< a b + c, rounded once
  negate,
  square_root,
  exponential,
  logarithm,
  power,
  sine,             ///< sin(2 pi a)
  cosine,           ///< cos(2 pi a)
  sine_and_cosine,  ///< both, the cosine to `also`
  scaled_sine,      ///< b sin(2 pi a): waves mostly come with a factor
  scaled_cosine,
  tangent,
  arc_sine,
  arc_cosine,
  arc_tangent,
  arc_tangent_2,
  magnitude,
  minimum,
  maximum,
  round_down,
  hyperbolic_sine,
  hyperbolic_cosine,
  hyperbolic_tangent,
  sech_squared,  ///< 1 / cosh(a)^2
  sign,
  unit_step,
  less,           ///< 1 where a < b, else 0
  pick,           ///< b where a is not 0, else c
  when_positive,  ///< a where a > 0, else no number
  phase,          ///< a where its sine and cosine have digits, else no number
  where_finite,   ///< a where b is finite, else no number
};

/// Location of an operand.
struct FormulaSlot {
  enum class Area : std::uint16_t {
    registers,  ///< a block of its own: one number for each element
    uniforms,   ///< one number for all elements
    inputs,     ///< a block that the caller brings
  };
  Area area = Area::registers;
  std::uint16_t index = 0;
  friend bool operator==(const FormulaSlot&, const FormulaSlot&) = default;
};

struct FormulaInstruction {
  FormulaOp op = FormulaOp::add;
  std::uint8_t operands = 0;
  FormulaSlot to;
  FormulaSlot a;
  FormulaSlot b;
  FormulaSlot c;
  FormulaSlot also;
};

/// Instructions for some outputs of a graph. Uniforms are: the constants, then the variables that
/// are the same for all elements, then what the prologue computes from these.
struct FormulaCode {
  static constexpr std::size_t kMostRegisters = 128;
  static constexpr std::size_t kMostUniforms = 4096;

  std::vector<FormulaInstruction> prologue;  ///< of uniforms only: once for all elements
  std::vector<FormulaInstruction> body;
  std::vector<Quad> constants;
  std::size_t uniforms = 0;          ///< in all
  std::size_t registers = 0;         ///< needed at once
  std::vector<FormulaSlot> outputs;  ///< of the nodes, in their order

  /// Index of uniform variable k among the uniforms.
  std::size_t index_of_uniform(std::size_t k) const { return constants.size() + k; }
  bool fits() const { return registers <= kMostRegisters && uniforms <= kMostUniforms; }
};

/// The variables of a graph with these indices are blocks, in this order the inputs 0, 1, ...;
/// those are uniform, in this order.
struct FormulaInputs {
  std::vector<std::uint32_t> blocks;
  std::vector<std::uint32_t> uniforms;
};

/// Code for the nodes. What they share is computed once.
FormulaCode compile(const FormulaGraph& graph, std::span<const FormulaGraph::Id> nodes,
                    const FormulaInputs& inputs);

}  // namespace tomlin
