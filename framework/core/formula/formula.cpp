#include "framework/core/formula/formula.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

namespace tomlin {
namespace {

namespace variable = formula_variable;
/// Formulas have been parsed when the scene was read.
Expression parsed(const std::string& text) { return std::get<Expression>(Expression::parse(text)); }

/// The variables that code for an element reads from blocks.
std::vector<std::uint32_t> blocks_of(const FormulaLaw& law) {
  std::vector<std::uint32_t> blocks;
  for (std::uint32_t index = 0; index < variable::time; ++index) {
    if (law.uses(index)) blocks.push_back(index);
  }
  return blocks;
}

/// Variables by which the energy of one element is differentiated.
std::vector<std::uint32_t> coordinates_of(FormulaElement element, int dimension) {
  switch (element) {
    case FormulaElement::pair:
      return {variable::distance};
    case FormulaElement::angle:
      return {variable::angle};
    case FormulaElement::particle:
    case FormulaElement::centre:
      break;
  }
  const std::uint32_t first =
      element == FormulaElement::particle ? variable::position : variable::centre;
  std::vector<std::uint32_t> coordinates;
  coordinates.reserve(static_cast<std::size_t>(dimension));
  for (int axis = 0; axis < dimension; ++axis) {
    coordinates.push_back(first + static_cast<std::uint32_t>(axis));
  }
  return coordinates;
}

}  // namespace

std::string_view formula_variable_name(std::uint32_t index) {
  if (index < variable::index) return expression_variables()[index];
  return particle_variables()[index - variable::index];
}

/// Finds the numbers of particles in a component: what each step of it depends on follows from its
/// operands.
class FormulaLaw::NumberSearch {
 public:
  NumberSearch(FormulaLaw& law, std::size_t component)
      : law_(law), component_(component), expression_(law.parts_[component]) {}

  void run() {
    std::vector<Operand> stack;
    for (std::size_t k = 0; k < expression_.nodes().size(); ++k) {
      const Expression::Node& node = expression_.nodes()[k];
      const std::size_t first = stack.size() - node.arguments;
      Depends depends = node.op == Expression::Op::name ? of_name(node) : Depends::on_nothing;
      for (std::size_t a = first; a < stack.size(); ++a) {
        depends = std::max(depends, stack[a].depends);
      }
      if (is_random_call(node)) look_at_random(k, depends);
      if (depends == Depends::on_position) {
        for (std::size_t a = first; a < stack.size(); ++a) note(stack[a]);
      }
      stack.resize(first);
      stack.push_back({k, depends});
    }
    note(stack.back());
  }

 private:
  enum class Depends : std::uint8_t { on_nothing, on_particle, on_position };
  struct Operand {
    std::size_t step;
    Depends depends;
  };

  Depends of_name(const Expression::Node& node) const {
    const std::string& name = expression_.names()[node.index].name;
    const bool is_same_for_all =
        law_.is_parameter(component_, name) || name == formula_variable_name(variable::count);
    if (is_same_for_all) return Depends::on_nothing;
    return name == formula_variable_name(variable::index) ? Depends::on_particle
                                                          : Depends::on_position;
  }

  static bool is_random_call(const Expression::Node& node) {
    return node.op == Expression::Op::call && is_random(expression_functions()[node.index].id);
  }

  void look_at_random(std::size_t step, Depends depends) {
    if (depends == Depends::on_nothing) {
      law_.constant_at_[component_].emplace(step, expression_.part(step));
    } else if (depends == Depends::on_position && !law_.misplaced_) {
      law_.misplaced_ = Use{component_, expression_.nodes()[step].column};
    }
  }

  /// Numbers that are written alike are one.
  void note(const Operand& operand) {
    if (operand.depends != Depends::on_particle) return;
    Expression part = expression_.part(operand.step);
    auto& all = law_.numbers_;
    const auto known = std::find_if(all.begin(), all.end(), [&](const Number& one) {
      return one.expression.text() == part.text();
    });
    law_.number_at_[component_][operand.step] = static_cast<std::size_t>(known - all.begin());
    if (known == all.end()) all.push_back({component_, std::move(part)});
  }

  FormulaLaw& law_;
  const std::size_t component_;
  const Expression& expression_;
};

FormulaLaw::FormulaLaw(const Formula& energy, const FormulaList& force)
    : is_energy_(!energy.text.empty()) {
  const auto take = [&](const Formula& formula) {
    parts_.push_back(parsed(formula.text));
    parameters_.push_back(formula.parameters);
  };
  if (is_energy_) {
    take(energy);
  } else {
    for (const Formula& component : force.components) take(component);
  }
  number_at_.resize(parts_.size());
  constant_at_.resize(parts_.size());
  for (std::size_t k = 0; k < parts_.size(); ++k) NumberSearch(*this, k).run();
}

bool FormulaLaw::is_parameter(std::size_t component, std::string_view name) const {
  const auto& known = parameters_[component];
  return std::any_of(known.begin(), known.end(),
                     [&](const auto& one) { return one.first == name; });
}

std::optional<FormulaLaw::Use> FormulaLaw::use_of(std::uint32_t index) const {
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    for (const Expression::Name& used : parts_[k].names()) {
      if (used.name != formula_variable_name(index) || is_parameter(k, used.name)) continue;
      return Use{k, used.column};
    }
  }
  return std::nullopt;
}

FormulaElement FormulaLaw::element() const {
  if (uses(variable::distance)) return FormulaElement::pair;
  if (uses(variable::angle)) return FormulaElement::angle;
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    if (uses(variable::centre + axis)) return FormulaElement::centre;
  }
  return FormulaElement::particle;
}

bool FormulaLaw::depends_on_velocity() const {
  return uses(variable::velocity) || uses(variable::velocity + 1) || uses(variable::velocity + 2);
}

std::variant<FormulaLaw::ParticleNumbers, FormulaLaw::Trouble> FormulaLaw::numbers_of_particles(
    std::size_t count) const {
  Values at{};
  at[variable::count] = static_cast<double>(count);
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    for (const auto& [step, expression] : constant_at_[k]) {
      const auto value = evaluate(k, expression, at);
      if (const auto* error = std::get_if<ExpressionError>(&value)) {
        return Trouble{k, error->column, error->why};
      }
    }
  }
  ParticleNumbers all;
  for (const Number& number : numbers_) {
    std::vector<double>& values = all.emplace_back();
    values.reserve(count);
    for (std::size_t particle = 0; particle < count; ++particle) {
      at[variable::index] = static_cast<double>(particle);
      const auto value = evaluate(number.component, number.expression, at);
      if (const auto* error = std::get_if<ExpressionError>(&value)) {
        return Trouble{number.component, error->column,
                       fmt::format("{}, for particle {}", error->why, particle)};
      }
      values.push_back(std::get<double>(value));
    }
  }
  return all;
}

FormulaGraph::Id FormulaLaw::build(FormulaGraph& graph, std::size_t component,
                                   const std::array<bool, 3>& moves, std::size_t count,
                                   std::vector<FormulaGraph::Id>* steps) const {
  FormulaGraph::Lookup names;
  for (const Expression::Name& used : parts_[component].names()) {
    for (const auto& [name, value] : parameters_[component]) {
      if (name == used.name) names[used.name] = graph.constant(Quad(value));
    }
  }
  for (std::uint32_t index = 0; index <= variable::time; ++index) {
    FormulaGraph::Id node = graph.variable(index);
    const bool is_position =
        index < variable::velocity || (index >= variable::centre && index < variable::distance);
    if (is_position && moves[index % 3]) {
      node = graph.add(node, graph.variable(variable::origin + index % 3));
    }
    names[formula_variable_name(index)] = node;
  }
  if (element() == FormulaElement::particle) {
    names.emplace(formula_variable_name(variable::index), graph.variable(variable::index));
    names.emplace(formula_variable_name(variable::count),
                  graph.constant(Quad(static_cast<double>(count))));
  }

  FormulaGraph::Given given;
  for (const auto& [step, number] : number_at_[component]) {
    given[step] = graph.variable(variable::particle_number + static_cast<std::uint32_t>(number));
  }
  Values at{};
  at[variable::count] = static_cast<double>(count);
  for (const auto& [step, expression] : constant_at_[component]) {
    const auto value = evaluate(component, expression, at);
    const double* number = std::get_if<double>(&value);  // what has none is refused elsewhere
    given[step] = graph.constant(Quad(number != nullptr ? *number : 0.0));
  }
  return graph.build(parts_[component], names, given, steps);
}

FormulaCodes FormulaLaw::compiled(int dimension, const std::array<bool, 3>& moves,
                                  std::size_t count) const {
  if (numbers_.size() > kMostParticleNumbers) throw std::length_error("too many numbers");
  FormulaGraph graph;
  FormulaInputs inputs;
  inputs.blocks = blocks_of(*this);
  for (std::uint32_t k = 0; k < numbers_.size(); ++k) {
    inputs.blocks.push_back(variable::particle_number + k);
  }
  inputs.uniforms = {variable::time, variable::origin, variable::origin + 1, variable::origin + 2};
  FormulaCodes codes;
  codes.inputs = inputs.blocks;
  const auto code_of = [&](const std::vector<FormulaGraph::Id>& nodes) {
    FormulaCode code = compile(graph, nodes, inputs);
    if (!code.fits()) throw std::length_error("the formula is too large");
    return code;
  };

  std::vector<FormulaGraph::Id> parts;
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    parts.push_back(build(graph, k, moves, count));
  }
  if (!is_energy_) {
    codes.force = code_of(parts);
    return codes;
  }

  const FormulaElement over = element();
  const auto coordinates = coordinates_of(over, dimension);
  const bool scalar = over == FormulaElement::pair || over == FormulaElement::angle;
  std::vector<FormulaGraph::Id> slopes;
  slopes.reserve(coordinates.size());
  for (const std::uint32_t along : coordinates) slopes.push_back(graph.derivative(parts[0], along));
  graph.keep_domain(parts[0], slopes);
  std::vector<FormulaGraph::Id> curvatures;
  if (scalar) curvatures.push_back(slopes[0]);
  for (std::size_t a = 0; a < slopes.size(); ++a) {
    for (std::size_t b = a; b < slopes.size(); ++b) {
      curvatures.push_back(graph.derivative(slopes[a], coordinates[b]));
    }
  }
  if (!scalar) {
    for (FormulaGraph::Id& slope : slopes) slope = graph.negate(slope);
  }
  codes.force = code_of(slopes);
  codes.energy = code_of(parts);
  codes.curvature = code_of(curvatures);
  if (depends_on_time()) codes.power = code_of({graph.derivative(parts[0], variable::time)});
  return codes;
}

std::variant<double, ExpressionError> FormulaLaw::evaluate(std::size_t component,
                                                           const Values& at) const {
  return evaluate(component, parts_[component], at);
}

std::variant<double, ExpressionError> FormulaLaw::evaluate(std::size_t component,
                                                           const Expression& expression,
                                                           const Values& at) const {
  return expression.evaluate([&](std::string_view name) -> std::optional<double> {
    for (const auto& [parameter, value] : parameters_[component]) {
      if (parameter == name) return value;
    }
    for (std::uint32_t index = 0; index < at.size(); ++index) {
      if (formula_variable_name(index) == name) return at[index];
    }
    return std::nullopt;
  });
}

std::optional<FormulaLaw::Trouble> FormulaLaw::trouble_at(const Values& at) const {
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    const auto value = evaluate(k, at);
    if (const auto* error = std::get_if<ExpressionError>(&value)) {
      return Trouble{k, error->column, error->why};
    }
    if (!is_energy_) continue;
    if (auto trouble = trouble_of_slopes(k, at)) return trouble;
  }
  return std::nullopt;
}

std::string FormulaLaw::why_no_period(const Values& about, std::uint32_t along, double length,
                                      int periods) const {
  constexpr int kPoints = 4;             // in a period
  constexpr double kPart = 0.252439024;  // of a length between them: no symmetry links all
  constexpr double kUnlike = 1e-9;       // of how much the formula changes there
  constexpr double kRounding = 1e-13;    // of its size, and of a phase in periods
  for (std::size_t component = 0; component < parts_.size(); ++component) {
    struct Pair {
      double at, here, there;
    };
    std::vector<Pair> seen;
    for (int k = -kPoints * periods; k < kPoints * periods; ++k) {
      Values at = about;
      at[along] += k * kPart * length;
      Values after = at;
      after[along] += length;
      const auto here = evaluate(component, at);
      const auto there = evaluate(component, after);
      if (here.index() != 0 || there.index() != 0) continue;
      seen.push_back({at[along], std::get<double>(here), std::get<double>(there)});
    }
    double size = 0.0;
    double change = 0.0;
    for (const Pair& one : seen) {
      size = std::max({size, std::abs(one.here), std::abs(one.there)});
      change = std::max(change, std::abs(one.here - seen.front().here));
    }
    for (const Pair& one : seen) {
      const double phase = 1.0 + std::abs(one.at) / length;
      const double allowed = kUnlike * change + kRounding * phase * size;
      if (std::abs(one.here - one.there) <= allowed) continue;
      return fmt::format(
          "\"{}\" is not periodic: it is {:.9g} at {} = {:.6g} and {:.9g} one period later",
          text(component), one.here, formula_variable_name(along), one.at, one.there);
    }
  }
  return {};
}

/// The first part of the formula whose derivative is not finite.
std::optional<FormulaLaw::Trouble> FormulaLaw::trouble_of_slopes(std::size_t component,
                                                                 const Values& at) const {
  FormulaGraph graph;
  std::vector<FormulaGraph::Id> steps;
  build(graph, component, {}, static_cast<std::size_t>(at[variable::count]), &steps);
  std::vector<Quad> values(variable::particle_number, Quad(0.0));
  for (std::size_t k = 0; k < at.size(); ++k) values[k] = Quad(at[k]);
  for (const Number& number : numbers_) {
    const auto value = evaluate(number.component, number.expression, at);
    const double* finite = std::get_if<double>(&value);
    values.push_back(Quad(finite != nullptr ? *finite : 0.0));
  }
  for (std::size_t step = 0; step < steps.size(); ++step) {
    for (std::uint32_t index = 0; index < variable::time; ++index) {
      if (!uses(index)) continue;
      const auto slope =
          static_cast<double>(graph.value(graph.derivative(steps[step], index), values));
      if (std::isfinite(slope)) continue;
      return Trouble{component, parts_[component].nodes()[step].column,
                     fmt::format("its derivative with respect to {} is not finite",
                                 formula_variable_name(index))};
    }
  }
  return std::nullopt;
}

}  // namespace tomlin
