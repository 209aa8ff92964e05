#include "framework/core/system/flow.hpp"

#include <cmath>
#include <vector>

#include "framework/model/properties/flow_check.hpp"
#include "framework/model/properties/force_under_test.hpp"

/// Operators that forces hand out, against the forces that they stand for.
namespace tomlin::properties {
namespace {

/// Checks an operator at a state near the start, with a coordinate held that moves: schemes leave
/// held ones to the operator.
template <class Check>
bool check_operator(ForceUnderTest& e, const State& state, Check&& check) {
  ForceTwin<double>& twin = e.twin();
  Flow<double> flow;
  twin.force().exact_flow->flow(flow);
  const SystemView<double>& view = twin.view();
  e.put(state, twin);
  std::vector<double> inverse_mass(view.inverse_mass, view.inverse_mass + view.dofs);
  if (e.count() > 1) {
    const std::size_t held = e.variable(e.memory().random.below(e.count())).at;
    inverse_mass[held] = twin.velocity(held) = 0.0;
  }
  FlowStage<double> at;
  at.position = &twin.position(0);
  at.inverse_mass = inverse_mass.data();
  at.velocity = &twin.velocity(0);
  at.own = &twin.own(0);
  const auto slopes = [&] {
    twin.evaluate(state.time);
    std::vector<double> all;
    for (std::size_t i = 0; i < view.dofs; ++i) {
      all.push_back(twin.force_at(i) * inverse_mass[i]);
    }
    // Its own variables follow those of prescribed motions, which no operator advances.
    const std::size_t steered = view.own_count - twin.force().variables->own_count();
    for (std::size_t k = 0; k < view.own_count; ++k) {
      all.push_back(k < steered ? 0.0 : twin.rate(k));
    }
    return all;
  };
  check(FlowCheck(
      flow, at, view.dofs, view.own_count, slopes, [&] { return twin.energy(); },
      [&](double found, double expected, double allowed) {
        e.note(found, expected, std::abs(expected), allowed, state);
      }));
  return true;
}

}  // namespace

bool has_operator(ForceUnderTest& e) {
  Flow<double> flow;
  return e.twin().force().exact_flow->flow(flow);
}

bool flow(ForceUnderTest& e, const State& state) {
  return check_operator(e, state,
                        [&](FlowCheck&& check) { check.check_solution(e.traits().stochastic); });
}

bool flow_repeats(ForceUnderTest& e, const State& state) {
  return check_operator(e, state, [](FlowCheck&& check) { check.check_repetition(); });
}

bool heat_of_flow(ForceUnderTest& e, const State& state) {
  return check_operator(e, state, [](FlowCheck&& check) { check.check_heat(); });
}

}  // namespace tomlin::properties
