#include "framework/core/formula/program.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

namespace tomlin {
namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

/// A number that the code computes, or is given: each once.
struct Value {
  enum class From : std::uint8_t { constant, uniform, block, operation } from = From::operation;
  std::size_t index = 0;  ///< of a constant, a uniform variable or a block
  FormulaOp op = FormulaOp::add;
  std::array<std::size_t, 3> operands = {kNone, kNone, kNone};
  bool varies = false;       ///< not the same for all elements
  std::size_t twin = kNone;  ///< the cosine of a sine, and the sine of a cosine
};

/// From the graph's sums, products and functions to operations of at most three operands.
class Lowering {
 public:
  Lowering(const FormulaGraph& graph, const FormulaInputs& inputs)
      : graph_(graph), inputs_(inputs), lowered_(graph.size(), kNone) {}

  std::size_t value_of(FormulaGraph::Id id) {
    if (lowered_[id] == kNone) {
      const std::size_t value = lower(graph_[id]);
      lowered_[id] = value;
    }
    return lowered_[id];
  }

  std::vector<Value> values;
  std::vector<Quad> constants;

 private:
  std::size_t lower(const FormulaGraph::Node& node) {
    switch (node.kind) {
      case FormulaGraph::Kind::constant:
        return constant(node.number);
      case FormulaGraph::Kind::variable:
        return variable(node.index);
      case FormulaGraph::Kind::sum:
        return sum(node);
      case FormulaGraph::Kind::product:
        return product(node);
      case FormulaGraph::Kind::function:
        return function(node);
    }
    return kNone;
  }

  std::size_t constant(Quad number) {
    for (std::size_t v = 0; v < values.size(); ++v) {
      if (values[v].from == Value::From::constant && constants[values[v].index] == number) return v;
    }
    constants.push_back(number);
    values.push_back({Value::From::constant, constants.size() - 1});
    return values.size() - 1;
  }

  std::size_t variable(std::uint32_t index) {
    const auto& blocks = inputs_.blocks;
    const auto block = std::find(blocks.begin(), blocks.end(), index);
    if (block != blocks.end()) {
      Value value{Value::From::block, static_cast<std::size_t>(block - blocks.begin())};
      value.varies = true;
      values.push_back(value);
      return values.size() - 1;
    }
    const auto& uniforms = inputs_.uniforms;
    const auto uniform = std::find(uniforms.begin(), uniforms.end(), index);
    values.push_back({Value::From::uniform, static_cast<std::size_t>(uniform - uniforms.begin())});
    return values.size() - 1;
  }

  std::size_t operation(FormulaOp op, std::size_t a, std::size_t b = kNone, std::size_t c = kNone) {
    const auto key = std::make_tuple(op, a, b, c);
    const auto found = operations_.find(key);
    if (found != operations_.end()) return found->second;
    Value value;
    value.op = op;
    value.operands = {a, b, c};
    for (const std::size_t operand : value.operands) {
      if (operand != kNone) value.varies = value.varies || values[operand].varies;
    }
    values.push_back(value);
    operations_.emplace(key, values.size() - 1);
    return values.size() - 1;
  }

  /// c0 + c1 u1 + c2 u2 + ...: from the constant on where there is one, else from a plain term.
  std::size_t sum(const FormulaGraph::Node& node) {
    std::vector<FormulaGraph::Term> terms = node.terms;
    const auto plain = [](const FormulaGraph::Term& term) { return term.factor == Quad(1.0); };
    std::stable_partition(terms.begin(), terms.end(), plain);
    std::size_t total = kNone;
    if (node.number != Quad(0.0)) total = constant(node.number);
    for (const FormulaGraph::Term& term : terms) {
      const std::size_t value = value_of(term.node);
      if (plain(term)) {
        total = total == kNone ? value : operation(FormulaOp::add, value, total);
      } else if (term.factor == Quad(-1.0)) {
        total = total == kNone ? operation(FormulaOp::negate, value)
                               : operation(FormulaOp::subtract, total, value);
      } else {
        const std::size_t factor = constant(term.factor);
        total = total == kNone ? operation(FormulaOp::multiply, value, factor)
                               : operation(FormulaOp::multiply_add, value, factor, total);
      }
    }
    return total;
  }

  std::size_t product(const FormulaGraph::Node& node) {
    std::size_t above = kNone;
    std::size_t below = kNone;
    for (const FormulaGraph::Factor& factor : node.factors) {
      const std::size_t value = whole_power(value_of(factor.node), std::abs(factor.exponent));
      std::size_t& side = factor.exponent > 0 ? above : below;
      side = side == kNone ? value : operation(FormulaOp::multiply, side, value);
    }
    if (below == kNone) return above;
    return operation(FormulaOp::divide, above == kNone ? constant(Quad(1.0)) : above, below);
  }

  std::size_t whole_power(std::size_t base, int exponent) {
    if (exponent == 1) return base;
    const std::size_t half = whole_power(base, exponent / 2);
    const std::size_t square = operation(FormulaOp::multiply, half, half);
    return exponent % 2 == 0 ? square : operation(FormulaOp::multiply, square, base);
  }

  std::size_t function(const FormulaGraph::Node& node) {
    using enum FormulaGraph::Function;
    std::vector<std::size_t> x;
    x.reserve(node.arguments.size());
    for (const FormulaGraph::Id id : node.arguments) x.push_back(value_of(id));
    const auto of = [&](FormulaOp op) { return operation(op, x[0], x.size() > 1 ? x[1] : kNone); };
    switch (static_cast<FormulaGraph::Function>(node.index)) {
      case sqrt:
        return of(FormulaOp::square_root);
      case exp:
        return of(FormulaOp::exponential);
      case log:
        return of(FormulaOp::logarithm);
      case power:
        return of(FormulaOp::power);
      case sin_turns:
        return sine_or_cosine(FormulaOp::sine, FormulaOp::cosine, x[0]);
      case cos_turns:
        return sine_or_cosine(FormulaOp::cosine, FormulaOp::sine, x[0]);
      case tan_turns:
        return of(FormulaOp::tangent);
      case asin:
        return of(FormulaOp::arc_sine);
      case acos:
        return of(FormulaOp::arc_cosine);
      case atan:
        return of(FormulaOp::arc_tangent);
      case atan2:
        return of(FormulaOp::arc_tangent_2);
      case abs:
        return of(FormulaOp::magnitude);
      case min:
        return of(FormulaOp::minimum);
      case max:
        return of(FormulaOp::maximum);
      case floor:
        return of(FormulaOp::round_down);
      case sinh:
        return of(FormulaOp::hyperbolic_sine);
      case cosh:
        return of(FormulaOp::hyperbolic_cosine);
      case tanh:
        return of(FormulaOp::hyperbolic_tangent);
      case sech_squared:
        return of(FormulaOp::sech_squared);
      case sign:
        return of(FormulaOp::sign);
      case step:
        return of(FormulaOp::unit_step);
      case when_positive:
        return of(FormulaOp::when_positive);
      case phase:
        return of(FormulaOp::phase);
      case where_finite:
        return of(FormulaOp::where_finite);
      case choose:
        return operation(FormulaOp::pick, operation(FormulaOp::less, x[0], x[1]), x[2], x[3]);
    }
    return kNone;
  }

  std::size_t sine_or_cosine(FormulaOp which, FormulaOp other, std::size_t x) {
    const std::size_t value = operation(which, x);
    const auto found = operations_.find(std::make_tuple(other, x, kNone, kNone));
    if (found != operations_.end()) {
      values[value].twin = found->second;
      values[found->second].twin = value;
    }
    return value;
  }

  const FormulaGraph& graph_;
  const FormulaInputs& inputs_;
  std::vector<std::size_t> lowered_;
  std::map<std::tuple<FormulaOp, std::size_t, std::size_t, std::size_t>, std::size_t> operations_;
};

/// A wave that only serves to be multiplied by what is the same for all becomes one operation with
/// its factor: a pass over the block less.
void join_factors(std::vector<Value>& values, const std::vector<std::size_t>& outputs) {
  std::vector<std::size_t> uses(values.size(), 0);
  for (const std::size_t output : outputs) ++uses[output];
  for (const Value& value : values) {
    for (const std::size_t operand : value.operands) {
      if (operand != kNone) ++uses[operand];
    }
  }
  for (Value& value : values) {
    if (value.from != Value::From::operation || value.op != FormulaOp::multiply) continue;
    for (const bool swapped : {false, true}) {
      const std::size_t wave = value.operands[swapped ? 1 : 0];
      const std::size_t factor = value.operands[swapped ? 0 : 1];
      const Value& from = values[wave];
      const bool is_wave = from.from == Value::From::operation &&
                           (from.op == FormulaOp::sine || from.op == FormulaOp::cosine);
      if (!is_wave || uses[wave] != 1 || from.twin != kNone || values[factor].varies) continue;
      value.op = from.op == FormulaOp::sine ? FormulaOp::scaled_sine : FormulaOp::scaled_cosine;
      value.operands = {from.operands[0], factor, kNone};
      break;
    }
  }
}

/// Gives values their slots: uniforms one each, blocks a register for as long as they are needed.
class Placing {
 public:
  Placing(const std::vector<Value>& values, const std::vector<std::size_t>& outputs,
          FormulaCode& code)
      : values_(values), code_(code), slots_(values.size()), uses_(values.size(), 0) {
    for (const std::size_t output : outputs) ++uses_[output];  // never given back
    for (std::size_t v = values.size(); v-- > 0;) {
      if (!needed(v)) continue;
      for (const std::size_t operand : values[v].operands) {
        if (operand != kNone) ++uses_[operand];
      }
    }
  }

  void place() {
    std::vector<bool> done(values_.size(), false);
    for (std::size_t v = 0; v < values_.size(); ++v) {
      if (!needed(v) || done[v]) continue;
      if (values_[v].from != Value::From::operation) {
        slots_[v] = given(values_[v]);
        continue;
      }
      emit(v);
      if (values_[v].twin != kNone) done[values_[v].twin] = true;
    }
  }

  FormulaSlot slot(std::size_t value) const { return slots_[value]; }

 private:
  bool needed(std::size_t v) const {
    const std::size_t twin = values_[v].twin;
    return uses_[v] > 0 || (twin != kNone && uses_[twin] > 0);
  }

  FormulaSlot given(const Value& value) const {
    const auto index = static_cast<std::uint16_t>(value.index);
    if (value.from == Value::From::block) return {FormulaSlot::Area::inputs, index};
    if (value.from == Value::From::constant) return {FormulaSlot::Area::uniforms, index};
    return {FormulaSlot::Area::uniforms,
            static_cast<std::uint16_t>(code_.index_of_uniform(value.index))};
  }

  void emit(std::size_t v) {
    const Value& value = values_[v];
    FormulaInstruction instruction;
    instruction.op = value.op;
    const std::array<FormulaSlot*, 3> operands = {&instruction.a, &instruction.b, &instruction.c};
    for (std::size_t k = 0; k < operands.size(); ++k) {
      if (value.operands[k] == kNone) continue;
      *operands[k] = slots_[value.operands[k]];
      ++instruction.operands;
    }
    const bool paired = value.twin != kNone;
    const std::size_t sine = value.op == FormulaOp::cosine && paired ? value.twin : v;
    // Operands are read element by element before the result is written there.
    for (const std::size_t operand : value.operands) give_back(operand, value.varies);
    if (paired) {
      give_back(value.operands[0], value.varies);  // by the twin, too
      instruction.op = FormulaOp::sine_and_cosine;
      slots_[sine] = instruction.to = take(value.varies);
      slots_[values_[sine].twin] = instruction.also = take(value.varies);
    } else {
      slots_[v] = instruction.to = take(value.varies);
    }
    (value.varies ? code_.body : code_.prologue).push_back(instruction);
  }

  FormulaSlot take(bool varies) {
    if (!varies) {
      return {FormulaSlot::Area::uniforms, static_cast<std::uint16_t>(code_.uniforms++)};
    }
    if (!free_.empty()) {
      const std::uint16_t index = free_.back();
      free_.pop_back();
      return {FormulaSlot::Area::registers, index};
    }
    return {FormulaSlot::Area::registers, static_cast<std::uint16_t>(code_.registers++)};
  }

  void give_back(std::size_t operand, bool varies) {
    if (operand == kNone || !varies || !values_[operand].varies) return;
    if (--uses_[operand] > 0 || values_[operand].from != Value::From::operation) return;
    free_.push_back(slots_[operand].index);
  }

  const std::vector<Value>& values_;
  FormulaCode& code_;
  std::vector<FormulaSlot> slots_;
  std::vector<std::size_t> uses_;
  std::vector<std::uint16_t> free_;
};

}  // namespace

FormulaCode compile(const FormulaGraph& graph, std::span<const FormulaGraph::Id> nodes,
                    const FormulaInputs& inputs) {
  Lowering lowering(graph, inputs);
  std::vector<std::size_t> outputs;
  outputs.reserve(nodes.size());
  for (const FormulaGraph::Id node : nodes) outputs.push_back(lowering.value_of(node));

  join_factors(lowering.values, outputs);

  FormulaCode code;
  code.constants = lowering.constants;
  code.uniforms = code.constants.size() + inputs.uniforms.size();
  Placing placing(lowering.values, outputs, code);
  placing.place();
  for (const std::size_t output : outputs) code.outputs.push_back(placing.slot(output));
  return code;
}

}  // namespace tomlin
