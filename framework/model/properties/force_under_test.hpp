#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "framework/core/records/force.hpp"
#include "framework/model/force_twin.hpp"
#include "framework/model/properties.hpp"
#include "framework/model/single_force.hpp"

/// One force and the states at which its properties are looked at.
namespace tomlin::properties {

/// A sum of some hundred terms loses some tens of units in the last place of its size.
inline constexpr double kRounding = 64.0 * std::numeric_limits<double>::epsilon();
/// Rounding of a sum over so many terms, each as large as the largest.
inline double rounding_of_sum(std::size_t terms) {
  constexpr double kSomeHundred = 256.0;
  return kRounding * std::max(1.0, static_cast<double>(terms) / kSomeHundred);
}
/// Rounding of an energy in quadruple precision, of 113 bits.
inline constexpr double kExactRounding = 64.0 * 0x1p-112;
/// Below it numbers have fewer digits, and 1/eps of them vanish.
inline constexpr double kSmallest =
    std::numeric_limits<double>::min() / std::numeric_limits<double>::epsilon();
inline constexpr std::size_t kNone = static_cast<std::size_t>(-1);

/// Random numbers, the same with every library: distributions of the standard library differ.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  /// Between -1 and 1.
  double symmetric() {
    constexpr double kSteps = 9007199254740992.0;  // 2^53
    return 2.0 * (static_cast<double>(engine_() >> 11) / kSteps) - 1.0;
  }
  std::size_t below(std::size_t n) { return engine_() % n; }

 private:
  std::mt19937_64 engine_;
};

/// Instruction sets that this machine can run.
std::vector<InstructionSet> supported_sets();

enum class StateKind { start, near, far, high, contact };
const char* name_of(StateKind kind);

struct State {
  std::vector<double> x;  ///< of each variable
  std::vector<double> v;
  std::vector<double> own;
  double time = 0.0;
  StateKind kind = StateKind::near;

  bool is_close() const { return kind == StateKind::near || kind == StateKind::start; }
};

using Variable = SingleForce::Variable;
using Direction = std::vector<double>;  ///< one number for each variable

class ForceUnderTest;

/// A row of the table of properties.
struct Property {
  const char* name;
  const char* meaning;  ///< the equation or statement that is compared
  /// Near the start; the same backwards; three of these; all, the extreme ones too.
  enum class States { near, backwards, three, everywhere } states;
  bool (*applies)(ForceUnderTest&);
  /// Compares at one state, within a tolerance that is derived there; true where something was
  /// compared.
  bool (*compare)(ForceUnderTest&, const State&);
  /// Runs before the first state; false where a contradiction leaves nothing to compare.
  bool (*prepare)(ForceUnderTest&) = nullptr;
};

class ForceUnderTest {
 public:
  /// `length` is the scene's shortest, or the force's own.
  ForceUnderTest(const Scene& scene, std::size_t force, double length,
                 const PropertyOptions& options);

  /// False when there is nothing to look at: not built, or nothing moves.
  bool worthwhile() const { return alone_.built() && count() > 0; }

  // ---- the force

  SingleForce& alone() { return alone_; }
  const ForceRecord& record() const { return *alone_.force().record; }
  const Traits& traits() const { return alone_.force().traits; }
  const Model::Force& force() { return alone_.force(); }
  const SceneForce& described() { return alone_.model().scene().forces.front(); }
  bool on_prescribed() const;
  /// Some coordinates of its bodies are no variables: see Terms.
  double length() const { return length_; }
  std::size_t count() const { return alone_.variables().size(); }
  const Variable& variable(std::size_t i) const { return alone_.variables()[i]; }
  /// So many pairs and particles that few states are looked at.
  bool takes_long() const;

  /// The force bound once more, by this plan, on this instruction set or on that of the model: one
  /// for each instruction set while a property is compared.
  ForceTwin<double>& twin(const AssemblyPlan& plan);
  ForceTwin<double>& twin(InstructionSet set);
  ForceTwin<double>& twin() { return twin(alone_.model().plan()); }
  /// In quadruple precision; null where it is not available.
  ForceTwin<Quad>* exact();

  // ---- states

  /// Displaced ones, and last the start: where forces balance there, sizes are known by then.
  const std::vector<State>& near() const { return near_; }
  /// The states of near() and the extreme ones; few where evaluations take long.
  std::vector<const State*> everywhere() const;
  std::vector<const State*> states_of(Property::States which) const;

  void put(const State& state);
  void put_moved(const State& state, const Direction& direction, double h);
  template <class Real>
  void put(const State& state, ForceTwin<Real>& twin) const {
    for (std::size_t i = 0; i < count(); ++i) {
      twin.position(variable(i).at) = Real(state.x[i]);
      twin.velocity(variable(i).at) = Real(state.v[i]);
    }
    for (std::size_t k = 0; k < state.own.size(); ++k) twin.own(k) = Real(state.own[k]);
  }

  /// Forces on each variable, at this state.
  std::vector<double> forces(const State& state);
  /// A rotation's as a force at the body's edge, so that all are alike.
  double at_edge(std::size_t i, double force) const { return force * variable(i).unit; }
  double largest(const std::vector<double>& forces) const;

  /// All coordinates at once, where a fault of any part shows.
  Direction random_direction(Random& random) const;
  Direction along(std::size_t i) const;

  /// How much the largest force changes, per relative change of all that it reads: what the
  /// rounding of inputs makes of it. Infinite where it leaves the finite numbers; where even a
  /// perturbation as small as rounding turns the force over, so much that everything is allowed.
  double sensitivity(const State& state);
  /// Change of any other number likewise, or of several, each by itself.
  double change_of(const State& state, const std::function<double(const State&)>& number);
  std::vector<double> changes_of(const State& state,
                                 const std::function<std::vector<double>(const State&)>& numbers);
  /// Allowances cover forces at positions that are no variables: those of particles of rigid and
  /// prescribed bodies, which are rounded one by one, without regard to signs, also where their sum
  /// vanishes, and held coordinates. As a force at a body's edge.
  struct Terms {
    double size = 0.0;
    double change = 0.0;  ///< per relative change of each position
    double speed = 0.0;   ///< the fastest of those of prescribed bodies
    double heat = 0.0;    ///< change of the heat, per relative change of each position
  };
  Terms terms(const State& state);
  /// How large the numbers are that positions are made of.
  double reach(const State& state) const;

  // ---- the answer

  /// Numbers that a property keeps from one state to the next.
  struct Memory {
    Random random{1};
    double largest = 0.0;   ///< size of the forces at the states so far
    bool searched = false;  ///< one by one for the variable at fault
    std::map<const State*, std::vector<double>> numbers;
    std::map<InstructionSet, std::unique_ptr<ForceTwin<double>>> twins;
  };
  Memory& memory() { return memory_; }

  /// Compares a property at its states; nothing where it does not apply.
  std::optional<PropertyResult> check(const Property& property);
  /// Ends the check in the middle: the property turns out not to apply.
  bool withdraw();
  /// Notes where something is seen that has to be seen at one state at least; returns `shown`.
  bool note_shown(bool shown, const State& state);
  /// A contradiction within what is declared, which no state shows: `found` of something for
  /// `expected`.
  void contradict(double found, double expected);
  /// `found` against `expected`, at a state where `size` is the size of what is compared.
  void note(double found, double expected, double size, double allowed, const State& state,
            std::size_t variable = kNone);
  /// Vectors of forces; `allowed` of a force at a body's edge.
  void note(const std::vector<double>& found, const std::vector<double>& expected, double size,
            double allowed, const State& state);
  /// Bits that must be the same.
  void note_same(const std::vector<double>& found, const std::vector<double>& expected,
                 const State& state);
  void note_same(double found, double expected, const State& state);
  /// Bits that must be the same, of numbers that are no forces on variables.
  void note_same_numbers(const std::vector<double>& found, const std::vector<double>& expected,
                         const State& state);
  bool holds() const { return now_.holds; }

 private:
  State perturbed(const State& state, double size, Random& random) const;
  struct Change {
    double size = 0.0;
    double nonlinearity = 0.0;
    bool linear = true;
  };
  Change change_by(const State& state, double perturbation);
  double exact_change(const State& state, double perturbation);
  double sensitivity_at(const State& state);
  /// Coordinates of one axis of a body of the force that are no variables.
  struct Hidden {
    std::size_t body = 0;
    bool mapped = false;
    std::vector<std::size_t> at;  ///< among the mapped positions, or among the coordinates
  };
  void list_hidden();
  double gathered(const std::vector<double>& hidden_forces) const;
  void make_states();
  State displaced(double size, Random& random) const;
  std::optional<State> touching(double distance, Random& random) const;
  double latest_time();
  PropertyPoint point(const State& state, std::size_t variable) const;

  SingleForce alone_;
  double length_;
  PropertyOptions options_;
  double size_ = 0.0;  ///< pairs and particles
  double latest_ = 0.0;
  State start_;
  std::vector<State> near_;
  std::vector<State> extreme_;
  std::unique_ptr<ForceTwin<Quad>> exact_;
  std::vector<Hidden> hidden_;
  double hidden_reach_ = 0.0;                    ///< of positions that do not vary, at the start
  std::unique_ptr<ForceTwin<double>> by_terms_;  ///< where some coordinates are hidden
  std::vector<Pass<double>> passes_;             ///< of it
  bool sought_exact_ = false;
  std::map<const State*, double> sensitivities_;  ///< at near_ and extreme_
  Memory memory_;
  bool withdrawn_ = false;
  PropertyResult now_;
  double strain_ = 0.0;  ///< the largest part of what is allowed
};

/// Checks all forces of a scene together: each alone makes its part of the sum. Nothing where no
/// force acts on what moves.
std::optional<PropertyResult> sum_of_all(const Scene& scene, double length,
                                         const PropertyOptions& options);

// Comparisons of the table of properties, at one state.

bool conservative(ForceUnderTest& e, const State& state);
bool not_conservative(ForceUnderTest& e, const State& state);
bool exact(ForceUnderTest& e, const State& state);
bool quadruple_gradient(ForceUnderTest& e, const State& state);
bool quadruple_heat(ForceUnderTest& e, const State& state);
bool path(ForceUnderTest& e, const State& state);
bool hessian(ForceUnderTest& e, const State& state);
bool stiffness(ForceUnderTest& e, const State& state);
bool tight(ForceUnderTest& e, const State& state);
bool finite(ForceUnderTest& e, const State& state);
bool internal(ForceUnderTest& e, const State& state);
bool not_internal(ForceUnderTest& e, const State& state);
bool dissipative(ForceUnderTest& e, const State& state);
bool friction(ForceUnderTest& e, const State& state);
bool friction_bound(ForceUnderTest& e, const State& state);
bool balance(ForceUnderTest& e, const State& state);
bool flow(ForceUnderTest& e, const State& state);
bool flow_repeats(ForceUnderTest& e, const State& state);
bool heat_of_flow(ForceUnderTest& e, const State& state);
bool driver(ForceUnderTest& e, const State& state);
bool periodic(ForceUnderTest& e, const State& state);
bool rebase(ForceUnderTest& e, const State& state);
bool origin(ForceUnderTest& e, const State& state);
bool velocity(ForceUnderTest& e, const State& state);
bool uses_velocity(ForceUnderTest& e, const State& state);
bool same_at_all_times(ForceUnderTest& e, const State& state);
bool divided_time(ForceUnderTest& e, const State& state);
bool uses_time(ForceUnderTest& e, const State& state);
bool repeatable(ForceUnderTest& e, const State& state);
bool its_own(ForceUnderTest& e, const State& state);
bool set_and_add(ForceUnderTest& e, const State& state);
bool padding(ForceUnderTest& e, const State& state);
bool point(ForceUnderTest& e, const State& state);
bool same_bits(ForceUnderTest& e, const State& state);
bool number_types(ForceUnderTest& e, const State& state);
bool digits(ForceUnderTest& e, const State& state);

// Conditions of the properties, and what they check before the first state.

bool has_operator(ForceUnderTest& e);
bool has_period(ForceUnderTest& e);
bool has_point_kernel(ForceUnderTest& e);
bool has_setting_passes(ForceUnderTest& e);
bool acts_on_all_its_bodies(ForceUnderTest& e);
bool shows_digits(ForceUnderTest& e);
bool takes_part_in_balance(ForceUnderTest& e);
bool coefficients_are_positive(ForceUnderTest& e);
bool reports_if_it_drives(ForceUnderTest& e);
bool declares_period_if_periodic(ForceUnderTest& e);
bool time_is_bound_as_declared(ForceUnderTest& e);
bool evaluate_forwards(ForceUnderTest& e);

/// No side of the box is periodic: through those partners pull from elsewhere, and torques do not
/// cancel.
bool is_open(ForceUnderTest& e);
/// The sum over the force's bodies, after an evaluation.
SingleForce::Wrench total_of(ForceUnderTest& e);

}  // namespace tomlin::properties
