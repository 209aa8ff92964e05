#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "framework/core/formula/expression.hpp"
#include "framework/core/formula/graph.hpp"
#include "framework/core/formula/program.hpp"
#include "framework/core/records/parameter.hpp"

/// Meaning of the formulas of a force: their elements, and the code for the energy, the force and
/// the second derivatives of one element.
namespace tomlin {

/// The names in a formula decide on its elements: x, y, z a particle; xc, yc, zc the centre of
/// mass of a body; r a pair; theta an angle.
enum class FormulaElement { particle, centre, pair, angle };

/// Indices of variables in a graph: as in expression_variables(), then in particle_variables(), the
/// scene's origin, and the numbers of each particle.
namespace formula_variable {
inline constexpr std::uint32_t position = 0;  ///< x, y, z
inline constexpr std::uint32_t velocity = 3;  ///< vx, vy, vz
inline constexpr std::uint32_t centre = 6;    ///< xc, yc, zc
inline constexpr std::uint32_t distance = 9;  ///< r
inline constexpr std::uint32_t angle = 10;    ///< theta
inline constexpr std::uint32_t time = 11;     ///< t
inline constexpr std::uint32_t index = 12;    ///< i, of the particle, from 0 on
inline constexpr std::uint32_t count = 13;    ///< of the particles of the body
inline constexpr std::uint32_t origin = 14;   ///< of each axis: what is added to positions
/// First of the subexpressions that follow from the index alone, with a number for each particle.
inline constexpr std::uint32_t particle_number = 17;
static_assert(particle_number == FormulaGraph::kFirstUnboundedVariable);
}  // namespace formula_variable

/// Name of a variable as scenes write it; for indices up to the origin.
std::string_view formula_variable_name(std::uint32_t index);

/// Among the uniforms of all code for formulas: the time, then the origin of each axis.
inline constexpr std::size_t kTimeUniform = 0;
inline constexpr std::size_t kOriginUniform = 1;

/// Code for one element.
struct FormulaCodes {
  std::vector<std::uint32_t> inputs;  ///< variables, one block each; numbers of particles last
  FormulaCode force;                  ///< on each axis; of a pair dV/dr, of an angle dV/dtheta
  FormulaCode energy;                 ///< empty without one
  /// d2V of particles and centres, the upper triangle by rows; of a pair or an angle u: dV/du,
  /// d2V/du2. Empty without an energy.
  FormulaCode curvature;
  FormulaCode power;  ///< dV/dt at rest; empty where the energy does not depend on time
};

/// The energy, or the components of the force, of a scene's force: parsed.
class FormulaLaw {
 public:
  /// Blocks of numbers of particles that kernels take.
  static constexpr std::size_t kMostParticleNumbers = 26;

  /// One of the two is given.
  FormulaLaw(const Formula& energy, const FormulaList& force);

  bool has_energy() const { return is_energy_; }
  bool uses(std::uint32_t variable) const { return use_of(variable).has_value(); }
  /// The first use: which component, and the column in its text.
  struct Use {
    std::size_t component;
    std::size_t column;
  };
  std::optional<Use> use_of(std::uint32_t variable) const;
  FormulaElement element() const;
  bool depends_on_time() const { return uses(formula_variable::time); }
  bool depends_on_velocity() const;
  std::size_t components() const { return parts_.size(); }
  const std::string& text(std::size_t component) const { return parts_[component].text(); }

  /// The largest subexpressions over the index `i` of a particle, random numbers and parameters:
  /// numbers of a particle, which neither its position nor the time changes.
  std::size_t particle_numbers() const { return numbers_.size(); }
  bool depends_on_particle() const { return !numbers_.empty(); }
  /// The first random number that would change with a position, a velocity or the time.
  const std::optional<Use>& misplaced_random() const { return misplaced_; }

  /// Why there is no finite value of the formula, or of its derivatives, with the text and the
  /// column: "in 'log(y)', column 1: log(-1): ...".
  struct Trouble {
    std::size_t component = 0;
    std::size_t column = 0;
    std::string why;
  };

  /// [number][particle] of a body, or the first that has no finite value.
  using ParticleNumbers = std::vector<std::vector<double>>;
  std::variant<ParticleNumbers, Trouble> numbers_of_particles(std::size_t count) const;

  /// Code in a scene of this dimension, on a body of so many particles. Axes of which `moves` holds
  /// have an origin that is added to positions. Throws std::length_error for a formula that becomes
  /// too large when differentiated.
  FormulaCodes compiled(int dimension, const std::array<bool, 3>& moves,
                        std::size_t count = 1) const;

  /// The values of variables that a formula is asked about; indices as above.
  using Values = std::array<double, formula_variable::origin>;

  /// The value of a component, or why it has none.
  std::variant<double, ExpressionError> evaluate(std::size_t component, const Values& at) const;

  /// Empty when all are finite.
  std::optional<Trouble> trouble_at(const Values& at) const;

  /// Why `length` is no period along a variable, as seen over so many periods to either side of a
  /// position: "..." does not repeat: ... Empty when nothing is seen.
  std::string why_no_period(const Values& about, std::uint32_t along, double length,
                            int periods) const;

 private:
  /// A subexpression that is a number of a particle, or a random number that is the same for all.
  struct Number {
    std::size_t component;  ///< of its first use
    Expression expression;
  };
  class NumberSearch;

  bool is_parameter(std::size_t component, std::string_view name) const;
  std::variant<double, ExpressionError> evaluate(std::size_t component,
                                                 const Expression& expression,
                                                 const Values& at) const;
  std::optional<Trouble> trouble_of_slopes(std::size_t component, const Values& at) const;

  FormulaGraph::Id build(FormulaGraph& graph, std::size_t component,
                         const std::array<bool, 3>& moves, std::size_t count,
                         std::vector<FormulaGraph::Id>* steps = nullptr) const;

  bool is_energy_ = true;
  std::vector<Expression> parts_;
  std::vector<std::vector<std::pair<std::string, double>>> parameters_;
  std::vector<Number> numbers_;  ///< of particles, each once
  /// By component: the steps of its text that end one of these, and random numbers of all.
  std::vector<std::map<std::size_t, std::size_t>> number_at_;
  std::vector<std::map<std::size_t, Expression>> constant_at_;
  std::optional<Use> misplaced_;
};

}  // namespace tomlin
