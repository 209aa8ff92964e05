#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "framework/core/numbers/quad.hpp"
#include "framework/core/records/force.hpp"
#include "tests/support/force_bench.hpp"
#include "tests/support/random_description.hpp"

/// A force in float, double and quadruple numbers: the same force, each to its own rounding.
///
/// How far two number types may differ is measured, not assumed. In quadruple numbers every input
/// (positions, velocities, times, masses, parameters, where particles started) is changed a little
/// at random; what a result moves by, per relative change, is its condition. A sound evaluation in
/// a type of precision eps is off by some eps times that: by k r eps for a stiff bond of length r,
/// by slope times 2 pi x/a times eps for a substrate.
namespace tomlin::test {

// Rounding of the inputs and of the operations: twice what the worst force shows, a spring on a
// centre of mass.
inline constexpr double kMostUnits = 8.0;
// A type whose rounding never shows is another type under its name. A single product is off by
// a third of a unit on average; the worst of many results is not far below that.
inline constexpr double kFewestUnits = 0.05;
// Relative change of the inputs: small enough to be linear, far above the digits of a Quad.
inline constexpr double kShake = 1e-9;
inline constexpr int kShakes = 8;  // all small by chance once in 10^8 results
// The gradient in quadruple numbers, by differences whose error is h^4 times a fifth derivative:
// what is left is rounding, 1e-34/h. A constant good to double only is off by some 1e-17.
inline constexpr double kQuadDifference = 1e-8;
inline constexpr double kQuadGradient = 1e-22;
inline constexpr double kQuadSum = 1e-31;  // some hundred units of 2^-112

class NumberTypeCheck {
 public:
  explicit NumberTypeCheck(const ForceRecord& record) : record_(record) {}

  /// One set of parameters on one arrangement, at one random state. A force without quadruple
  /// numbers has nothing to be held against.
  void examine(const void* description, const Arrangement& arrangement, std::uint64_t seed,
               double time) {
    if (!record_.bind.in_quadruple) return;
    Random random(seed);
    ForceBench<Quad> bench(record_, description, arrangement, seed);
    const State state = random_state(bench, random, time);
    const Results exact = results_at(bench, state);
    const Spread spread = spread_of(bench, description, state, exact, seed, random);
    compare<double>(description, state, exact, spread, bench, seed);
    if (record_.bind.in_float) compare<float>(description, state, exact, spread, bench, seed);
    look_at_gradient(bench, state, random);
    look_at_heat(bench, state);
  }

  /// The claims that do not hold, each once.
  std::vector<std::string> broken() const {
    std::set<std::string> all = broken_;
    for (std::size_t q = 0; q < kQuantities; ++q) {
      const std::string name = kNames[q];
      if (in_double_[q].never_rounds()) all.insert(name + " in quadruple is no better than double");
      if (in_float_[q].never_rounds()) all.insert(name + " in float has the digits of quadruple");
    }
    return {all.begin(), all.end()};
  }

  /// Largest error seen, in units of rounding.
  double worst_in_double() const { return worst(in_double_); }
  double worst_in_float() const { return worst(in_float_); }

 private:
  enum Quantity : std::size_t { force, rates, energy, heat, kQuantities };
  static constexpr const char* kNames[kQuantities] = {"force", "rates", "energy", "heat"};

  using Results = std::array<std::vector<Quad>, kQuantities>;
  /// Root mean squares of what results move by, per relative change.
  struct Spread {
    std::array<std::vector<double>, kQuantities> by_state, by_binding;
  };
  struct State {
    std::vector<double> x, v, own;
    double time = 0.0;
    double elapsed = 0.0;
  };
  struct Seen {
    double worst = 0.0;
    bool of_the_state = false;  ///< more than a copy of a parameter, which may be exact
    bool never_rounds() const { return of_the_state && worst < kFewestUnits; }
  };
  using SeenOfType = std::array<Seen, kQuantities>;

  static double worst(const SeenOfType& seen) {
    double most = 0.0;
    for (const Seen& quantity : seen) most = std::max(most, quantity.worst);
    return most;
  }

  /// Numbers that each type has exactly.
  static State random_state(ForceBench<Quad>& bench, Random& random, double time) {
    State state;
    bench.disturb(random);
    for (std::size_t k = 0; k < bench.variables(); ++k) {
      state.x.push_back(static_cast<float>(bench.x(k)));
      state.v.push_back(static_cast<float>(bench.v(k)));
    }
    for (std::size_t k = 0; k < bench.own_count(); ++k) {
      state.own.push_back(static_cast<float>(bench.own(k)));
    }
    state.time = time;
    state.elapsed = 0.125;
    return state;
  }

  static State shaken(State state, Random& random) {
    const auto shake = [&](double& x) { x *= 1.0 + kShake * uniform(random, -1.0, 1.0); };
    // Positions by the size of the whole: distances between particles round by it, whichever of
    // the two stands near the origin.
    double reach = 0.0;
    for (const double x : state.x) reach = std::max(reach, std::abs(x));
    for (double& x : state.x) x += kShake * reach * uniform(random, -1.0, 1.0);
    for (double& v : state.v) shake(v);
    for (double& own : state.own) shake(own);
    shake(state.time);
    shake(state.elapsed);
    return state;
  }

  template <class Real>
  static void put(ForceBench<Real>& bench, const State& state) {
    for (std::size_t k = 0; k < bench.variables(); ++k) {
      bench.x(k) = Real(state.x[k]);
      bench.v(k) = Real(state.v[k]);
    }
    for (std::size_t k = 0; k < state.own.size(); ++k) bench.own(k) = Real(state.own[k]);
    bench.begin_step(state.time, state.elapsed);
  }

  template <class Real>
  static Results results_at(ForceBench<Real>& bench, const State& state) {
    put(bench, state);
    Results results;
    for (const Real& f : bench.evaluate()) results[force].push_back(Quad(f));
    for (std::size_t k = 0; k < bench.force().rate_count(); ++k) {
      results[rates].push_back(Quad(bench.rate(k)));
    }
    results[energy].push_back(Quad(bench.energy()));
    if (const std::optional<Real> lost = bench.heat()) results[heat].push_back(Quad(*lost));
    return results;
  }

  Spread spread_of(ForceBench<Quad>& bench, const void* description, const State& state,
                   const Results& exact, std::uint64_t seed, Random& random) {
    Spread spread;
    for (std::size_t q = 0; q < kQuantities; ++q) {
      spread.by_state[q].assign(exact[q].size(), 0.0);
      spread.by_binding[q].assign(exact[q].size(), 0.0);
    }
    const auto add = [&](std::array<std::vector<double>, kQuantities>& squares,
                         const Results& moved) {
      for (std::size_t q = 0; q < kQuantities; ++q) {
        for (std::size_t k = 0; k < exact[q].size(); ++k) {
          const double change = static_cast<double>(moved[q][k] - exact[q][k]) / kShake;
          squares[q][k] += change * change / kShakes;
        }
      }
    };
    for (int shake = 0; shake < kShakes; ++shake) {
      add(spread.by_state, results_at(bench, shaken(state, random)));
      const auto other = test::shaken(record_, description, kShake, random);
      ForceBench<Quad> rebound(record_, other.get(), bench.arrangement(), seed,
                               InstructionSet::baseline, {kShake, random()});
      add(spread.by_binding, results_at(rebound, state));
    }
    return spread;
  }

  template <class Real>
  void compare(const void* description, const State& state, const Results& exact,
               const Spread& spread, ForceBench<Quad>& reference, std::uint64_t seed) {
    constexpr bool in_float = std::is_same_v<Real, float>;
    constexpr double eps = std::numeric_limits<Real>::epsilon();
    // Below it numbers have fewer digits.
    constexpr double smallest = std::numeric_limits<Real>::min() / eps;
    ForceBench<Real> bench(record_, description, reference.arrangement(), seed);
    const Results results = results_at(bench, state);
    SeenOfType& seen = in_float ? in_float_ : in_double_;
    for (std::size_t q = 0; q < kQuantities; ++q) {
      if (results[q].size() != exact[q].size()) {
        fault(kNames[q], in_float);
        continue;
      }
      for (std::size_t k = 0; k < exact[q].size(); ++k) {
        const double size = std::abs(static_cast<double>(exact[q][k])) +
                            std::sqrt(spread.by_state[q][k]) + std::sqrt(spread.by_binding[q][k]);
        const double error = std::abs(static_cast<double>(results[q][k] - exact[q][k]));
        const double units = error / (eps * (size + smallest));
        if (!(units <= kMostUnits)) fault(kNames[q], in_float);
        seen[q].worst = std::max(seen[q].worst, units);
        if (spread.by_state[q][k] > 0.0) seen[q].of_the_state = true;
      }
    }
  }

  void fault(const std::string& quantity, bool in_float) {
    broken_.insert(quantity + (in_float ? " in float is another" : " in double is another"));
  }

  /// Force = -gradient of the energy to all digits: no constant in either is good to double only.
  void look_at_gradient(ForceBench<Quad>& bench, const State& state, Random& random) {
    if (!record_.traits.conservative) return;
    put(bench, state);
    const std::vector<Quad> f = bench.evaluate();
    std::vector<double> direction;
    Quad work(0.0);
    double size = 1.0 + std::abs(static_cast<double>(bench.energy()));
    for (std::size_t k = 0; k < f.size(); ++k) {
      direction.push_back(uniform(random, -1.0, 1.0));
      work += f[k] * direction[k];
      size += std::abs(static_cast<double>(f[k]));
    }
    const auto energy_at = [&](Quad h) {
      for (std::size_t k = 0; k < f.size(); ++k) bench.x(k) = state.x[k] + h * direction[k];
      return bench.energy();
    };
    const auto slope = [&](Quad h) { return (energy_at(h) - energy_at(-h)) / (Quad(2.0) * h); };
    const Quad h(kQuadDifference);
    const Quad gained = (Quad(4.0) * slope(h) - slope(Quad(2.0) * h)) / Quad(3.0);
    if (std::abs(static_cast<double>(gained + work)) > kQuadGradient * size) {
      broken_.insert("gradient in quadruple");
    }
  }

  void look_at_heat(ForceBench<Quad>& bench, const State& state) {
    put(bench, state);
    const std::optional<Quad> lost = bench.heat();
    if (!lost || record_.traits.conservative) return;
    const std::vector<Quad> f = bench.evaluate();
    Quad difference = *lost + bench.stored_by_own();
    double size = std::abs(static_cast<double>(*lost));
    for (std::size_t k = 0; k < f.size(); ++k) {
      difference += f[k] * bench.v(k);
      size += std::abs(static_cast<double>(f[k] * bench.v(k)));
    }
    if (std::abs(static_cast<double>(difference)) > kQuadSum * size) {
      broken_.insert("heat in quadruple");
    }
  }

  const ForceRecord& record_;
  std::set<std::string> broken_;
  SeenOfType in_double_{};
  SeenOfType in_float_{};
};

}  // namespace tomlin::test
