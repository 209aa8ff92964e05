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
};

using Variable = SingleForce::Variable;
using Direction = std::vector<double>;  ///< one number for each variable

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
  std::uint64_t seed() const { return options_.seed; }
  /// So many pairs and particles that few states are looked at.
  bool takes_long() const;

  /// The force bound on this instruction set.
  std::unique_ptr<ForceTwin<double>> twin(InstructionSet set) const;
  std::unique_ptr<ForceTwin<double>> twin() const;
  /// In quadruple precision; null where it is not available.
  ForceTwin<Quad>* exact();

  // ---- states

  /// Displaced ones, and last the start: where forces balance there, sizes are known by then.
  const std::vector<State>& near() const { return near_; }
  /// The states of near() and the extreme ones; few where evaluations take long.
  std::vector<const State*> everywhere() const;

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
  /// shake as small as rounding turns the force over, so much that everything is allowed.
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

  void begin(const char* property, const char* meaning);
  PropertyResult end();
  void count_state() { ++now_.states; }
  /// Notes that something which has to be seen somewhere was seen at this state.
  void note_shown(const State& state);
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
  State shaken(const State& state, double size, Random& random) const;
  struct Change {
    double size = 0.0;
    double bend = 0.0;
    bool linear = true;
  };
  Change change_by(const State& state, double shake);
  double exact_change(const State& state, double shake);
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
  PropertyResult now_;
  double strain_ = 0.0;  ///< the largest part of what is allowed
};

/// Checks all forces of a scene together: each alone makes its part of the sum. Nothing where no
/// force acts on what moves.
std::optional<PropertyResult> sum_of_all(const Scene& scene, double length,
                                         const PropertyOptions& options);

// The properties of one force, each where it applies.

using PropertyCheck = std::optional<PropertyResult> (*)(ForceUnderTest&);

std::optional<PropertyResult> conservative(ForceUnderTest& e);
std::optional<PropertyResult> not_conservative(ForceUnderTest& e);
std::optional<PropertyResult> exact(ForceUnderTest& e);
std::optional<PropertyResult> quadruple(ForceUnderTest& e);
std::optional<PropertyResult> path(ForceUnderTest& e);
std::optional<PropertyResult> hessian(ForceUnderTest& e);
std::optional<PropertyResult> stiffness(ForceUnderTest& e);
std::optional<PropertyResult> tight(ForceUnderTest& e);
std::optional<PropertyResult> finite(ForceUnderTest& e);
std::optional<PropertyResult> internal(ForceUnderTest& e);
std::optional<PropertyResult> not_internal(ForceUnderTest& e);
std::optional<PropertyResult> dissipative(ForceUnderTest& e);
std::optional<PropertyResult> friction(ForceUnderTest& e);
std::optional<PropertyResult> friction_bound(ForceUnderTest& e);
std::optional<PropertyResult> balance(ForceUnderTest& e);
std::optional<PropertyResult> flow(ForceUnderTest& e);
std::optional<PropertyResult> flow_repeats(ForceUnderTest& e);
std::optional<PropertyResult> heat_of_flow(ForceUnderTest& e);
std::optional<PropertyResult> driver(ForceUnderTest& e);
std::optional<PropertyResult> periodic(ForceUnderTest& e);
std::optional<PropertyResult> rebase(ForceUnderTest& e);
std::optional<PropertyResult> origin(ForceUnderTest& e);
std::optional<PropertyResult> velocity(ForceUnderTest& e);
std::optional<PropertyResult> uses_velocity(ForceUnderTest& e);
std::optional<PropertyResult> time(ForceUnderTest& e);
std::optional<PropertyResult> uses_time(ForceUnderTest& e);
std::optional<PropertyResult> repeatable(ForceUnderTest& e);
std::optional<PropertyResult> its_own(ForceUnderTest& e);
std::optional<PropertyResult> set_and_add(ForceUnderTest& e);
std::optional<PropertyResult> padding(ForceUnderTest& e);
std::optional<PropertyResult> point(ForceUnderTest& e);
std::optional<PropertyResult> same_bits(ForceUnderTest& e);
std::optional<PropertyResult> number_types(ForceUnderTest& e);
std::optional<PropertyResult> digits(ForceUnderTest& e);

}  // namespace tomlin::properties
