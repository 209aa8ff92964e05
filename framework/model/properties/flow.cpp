#include "framework/core/system/flow.hpp"

#include <cmath>
#include <optional>
#include <vector>

#include "framework/model/properties/flow_check.hpp"
#include "framework/model/properties/force_under_test.hpp"

/// Operators that forces hand out, against the forces that they stand for.
namespace tomlin::properties {
namespace {

/// Looks at an operator at each state near the start, with a coordinate held that moves: schemes
/// leave held ones to the operator.
template <class Look>
std::optional<PropertyResult> look_at_operator(ForceUnderTest& e, const char* property,
                                               const char* meaning, Look&& look) {
  const auto twin = e.twin();
  Flow<double> flow;
  if (!twin->force().exact_flow->flow(flow)) return std::nullopt;
  e.begin(property, meaning);
  Random random(e.seed());
  const SystemView<double>& view = twin->view();
  for (const State& state : e.near()) {
    e.put(state, *twin);
    std::vector<double> inverse_mass(view.inverse_mass, view.inverse_mass + view.dofs);
    if (e.count() > 1) {
      const std::size_t held = e.variable(random.below(e.count())).at;
      inverse_mass[held] = twin->velocity(held) = 0.0;
    }
    FlowStage<double> at;
    at.position = &twin->position(0);
    at.inverse_mass = inverse_mass.data();
    at.velocity = &twin->velocity(0);
    at.own = &twin->own(0);
    const auto slopes = [&] {
      twin->evaluate(state.time);
      std::vector<double> all;
      for (std::size_t i = 0; i < view.dofs; ++i) {
        all.push_back(twin->force_at(i) * inverse_mass[i]);
      }
      // Its own variables follow those of prescribed motions, which no operator advances.
      const std::size_t steered = view.own_count - twin->force().variables->own_count();
      for (std::size_t k = 0; k < view.own_count; ++k) {
        all.push_back(k < steered ? 0.0 : twin->rate(k));
      }
      return all;
    };
    FlowCheck check(
        flow, at, view.dofs, view.own_count, slopes, [&] { return twin->energy(); },
        [&](double found, double expected, double allowed) {
          e.note(found, expected, std::abs(expected), allowed, state);
        });
    look(check);
    e.count_state();
  }
  return e.end();
}

}  // namespace

std::optional<PropertyResult> flow(ForceUnderTest& e) {
  return look_at_operator(e, "flow", "its operator is the exact solution of its force alone",
                          [&](FlowCheck& check) { check.look_at_flow(e.traits().stochastic); });
}

std::optional<PropertyResult> flow_repeats(ForceUnderTest& e) {
  return look_at_operator(e, "flow repeats", "its operator gives the same bits from the same stage",
                          [](FlowCheck& check) { check.look_at_repetition(); });
}

std::optional<PropertyResult> heat_of_flow(ForceUnderTest& e) {
  return look_at_operator(e, "heat of flow", "its operator's heat is the energy that is gone",
                          [](FlowCheck& check) { check.look_at_heat(); });
}

}  // namespace tomlin::properties
