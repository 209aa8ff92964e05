#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/model/model.hpp"
#include "framework/model/properties/flow_check.hpp"
#include "framework/run/engine.hpp"
#include "framework/scene/scene.hpp"
#include "tests/forcefields/flows.hpp"
#include "tests/support/order.hpp"
#include "tests/support/scenes.hpp"

// Operators (framework/core/system/flow.hpp): the model's own, of linear friction, and those that
// forces hand out; each alone, and in runs of velocity_verlet.

namespace tomlin::test {
namespace {

using Properties = std::vector<std::string>;

// ---- operators that forces hand out, alone

template <class Law>
Properties properties_of(void (*spoil)(ForceRecord&) = nullptr) {
  return broken_properties("viscous_damping",
                           wrapped<WithFlow<Law>::template Force, ViscousDamping>, spoil);
}

void is_stochastic(ForceRecord& record) { record.traits.stochastic = true; }

TEST(FlowFaults, SoundOperatorsAreNotAccused) {
  EXPECT_EQ(properties_of<ExactDecay>(), Properties{});
  EXPECT_EQ(properties_of<Thermal>(&is_stochastic), Properties{});
  EXPECT_EQ(broken_properties("memory_damping", MemoryWithFlow<WholeHeat>::bind), Properties{});
}

TEST(FlowFaults, WrongFlow) {
  EXPECT_TRUE(among(properties_of<DecayWithoutMass>(), "flow"));
  EXPECT_TRUE(among(properties_of<DecayToFirstOrder>(), "flow"));
  EXPECT_TRUE(among(properties_of<DecayByMidpoint>(), "flow"));
  EXPECT_TRUE(among(properties_of<DecayOfTheHeld>(), "flow"));
}

TEST(FlowFaults, WrongHeat) {
  EXPECT_EQ(properties_of<DecayWithHalfTheHeat>(), Properties{"heat of flow"});
  EXPECT_EQ(properties_of<DecayWithHeatOfItsRate>(), Properties{"heat of flow"});
  EXPECT_EQ(broken_properties("memory_damping", MemoryWithFlow<KineticHeat>::bind),
            Properties{"heat of flow"});
}

TEST(FlowFaults, NumbersThatDependOnMoreOrLessThanTheStage) {
  EXPECT_TRUE(among(properties_of<DecayThatCounts>(), "flow repeats"));
  EXPECT_EQ(properties_of<ThermalInSequence>(&is_stochastic), Properties{"flow repeats"});
  EXPECT_EQ(properties_of<ThermalWithoutStep>(&is_stochastic), Properties{"flow"});
  EXPECT_EQ(properties_of<ThermalWithoutKey>(&is_stochastic), Properties{"flow"});
}

// ---- the operator of linear friction, alone

std::string of_body(const std::string& body, const std::string& dampers,
                    const std::string& integrator) {
  return "[[body]]\nname = \"body\"\n" + body + dampers +
         "[run]\nduration = 1.0\nintegrator = " + integrator + "\n";
}

std::string damper(const std::string& name, double coefficient) {
  return "[[force]]\nname = \"" + name +
         "\"\ntype = \"viscous_damping\"\ncoefficient = " + digits(coefficient) + "\n";
}

std::vector<std::string> bodies() {
  const std::string ring = "type = \"ring\"\ncount = 4\nradius = 0.8\ncentre = [0.1, 0.8]\n";
  const std::string lopsided = ring + "particle_mass = [0.1, 0.7, 0.3, 0.2]\n";
  const std::string rigid = "coordinates = \"rigid\"\n";
  const std::string chain =
      "type = \"chain\"\ncount = 3\nspacing = 1.1\nparticle_mass = [0.4, 1.3, 2.0]\n";
  return {chain,
          chain + "origin = [0.0, 0.0, 0.0]\nvelocity = [0.1, 0.2, 0.3]\n",
          chain + "origin = [0.0, 0.0]\nvelocity = [0.1, 0.0]\nhold = [\"y\"]\n",
          chain + rigid + "velocity = [0.4]\n",
          chain + rigid + "origin = [0.0, 0.0, 0.0]\nhold = [\"rotation\"]\n",
          ring + "particle_mass = 0.3\n" + rigid,
          lopsided + rigid,
          lopsided + rigid + "hold = [\"x\"]\n",
          lopsided + rigid + "hold = [\"y\"]\n",
          lopsided + rigid + "hold = [\"rotation\"]\n"};
}

/// A model and a state to look at it in.
struct Looked {
  explicit Looked(const std::string& text) : model(scene_of(text)) {
    StateLayout layout;
    model.declare(layout);
    state = RunState(layout);
    model.attach(state);
    model.start();
  }
  const SystemView<double>& view() { return model.system().view; }
  Model model;
  RunState state;
};

TEST(FrictionFlow, IsTheExactFlowOfTheDrag) {
  for (const std::string& body : bodies()) {
    for (const double strength : {1.0, 1e-3, 50.0}) {
      SCOPED_TRACE(body + digits(strength));
      const std::string dampers = damper("one", 0.35 * strength) + damper("other", 0.2 * strength);
      Looked split(of_body(body, dampers, verlet(0.01)));
      Looked forces(of_body(body, dampers, fixed_step(0.01)));
      const SystemView<double>& view = split.view();
      ASSERT_EQ(view.flow_count, 1u) << "all friction of a body is one operator";
      Random random(5);
      for (std::size_t i = 0; i < view.dofs; ++i) {
        if (view.inverse_mass[i] == 0.0) continue;
        view.velocity[i] = uniform(random, -1.0, 1.0);
        view.position[i] += uniform(random, -0.2, 0.2);
      }
      std::vector<double> rates(view.rates + 2 * kGroup);
      const auto slopes = [&] {
        forces.model.evaluate_at(DoubleDouble(0.0), view.position, view.velocity, view.integrals,
                                 rates.data());
        std::vector<double> all(view.dofs);
        for (std::size_t i = 0; i < view.dofs; ++i) {
          all[i] = forces.view().force[i] * view.inverse_mass[i];
        }
        return all;
      };
      // The drag of the operator, as a force, equals the force of the dampers.
      const std::vector<double> wanted = slopes();
      std::fill_n(view.force, view.dofs, 0.0);
      const Flow<double>& flow = view.flows[0];
      const double power = flow.drag(
          flow.arguments, stage_of(view, view.position, view.velocity,
                                   static_cast<const double*>(view.integrals), rates.data(), 0.0));
      double taken = 0.0;
      for (std::size_t i = 0; i < view.dofs; ++i) {
        const double size = 1.0 + std::abs(wanted[i]);
        EXPECT_NEAR(view.force[i] * view.inverse_mass[i], wanted[i], 1e-13 * size) << i;
        taken -= view.force[i] * view.velocity[i];
      }
      EXPECT_NEAR(power, taken, 1e-13 * (1.0 + taken));

      FlowStage<double> at;
      at.position = view.position;
      at.inverse_mass = view.inverse_mass;
      at.velocity = view.velocity;
      at.own = view.integrals;
      int compared = 0;
      properties::FlowCheck check(
          flow, at, view.dofs, 0, slopes, [] { return 0.0; },
          [&](double found, double expected, double allowed) {
            ++compared;
            EXPECT_LE(std::abs(found - expected), allowed) << found << " for " << expected;
          });
      check.check_solution(false);
      check.check_repetition();
      check.check_heat();
      EXPECT_GT(compared, 10);
    }
  }
}

// ---- in runs

/// The components, and this force in place of the one of the same parameters.
Registry with_force(const std::string& like, const std::string& name, const ForceFactories& bind,
                    const std::string& library = "", bool stochastic = false) {
  Registry registry = standard_registry();
  ForceRecord record = *standard().force(like);
  record.name = name;
  record.bind = bind;
  record.library = library;
  record.traits.stochastic = stochastic;
  registry.add(std::move(record));
  return registry;
}

template <class Law>
ForceFactories alone() {
  return {wrapped<WithFlow<Law>::template Alone, ViscousDamping>};
}

template <class Law>
ForceFactories beside_force() {
  return {wrapped<WithFlow<Law>::template Force, ViscousDamping>};
}

std::string tip_with(const std::string& force, const std::string& integrator,
                     const std::string& more = "") {
  return tables(R"([[body]] | type = "point" | position = [0.3] | velocity = [0.8]
particle_mass = 1.3
[[force]] | name = "driver" | type = "driving_spring" | stiffness = 1.4 | velocity = [0.4]
[[force]] | type = "sinusoidal_substrate" | amplitude = 0.1 | period = 1.0
[[force]] | name = "bath"
)") + force +
         "[run]\nduration = 6.0\nledger = true\nintegrator = " + integrator + "\n" + more;
}

RunResult run_with(const Registry& registry, const std::string& text) {
  return Engine(parse_scene(text, "test.toml", registry), {}).run();
}

const std::string kDecay = "type = \"decay\"\ncoefficient = 0.6\n";
const std::string kMemory = "type = \"memory\"\ncoefficient = 0.6\nmemory_time = 0.5\n";

std::vector<double> end_of(const RunResult& result) {
  const ResultGroup& energy = result.group("energy");
  return {result.body(0)["centre_of_mass"][0], result.body(0)["velocity"][0],
          *result.driver(0)["work"], *energy["heat_out"], *energy["stored_change"]};
}

TEST(FlowRuns, TakeWhatAForceHandsOutAsTheyTakeFriction) {
  const std::string same = "type = \"viscous_damping\"\ncoefficient = 0.6\n";
  const std::vector<double> wanted = end_of(run_text(tip_with(same, verlet(0.02))));
  for (const std::string library : {"", "libflow.so"}) {
    const Registry decay =
        with_force("viscous_damping", "decay", alone<ExactDecay>(), library, true);
    const std::vector<double> found = end_of(run_with(decay, tip_with(kDecay, verlet(0.02))));
    for (std::size_t k = 0; k < wanted.size(); ++k) EXPECT_NEAR(found[k], wanted[k], 1e-12) << k;
  }
}

TEST(FlowRuns, AdvanceVariablesOfForces) {
  const Registry memory = with_force("memory_damping", "memory", {MemoryWithFlow<WholeHeat>::bind});
  const std::vector<double> exact = end_of(run_with(memory, tip_with(kMemory, adaptive(1e-12))));
  std::vector<double> steps, errors, works;
  for (double h = 0.05; h > 0.005; h *= 0.5) {
    const RunResult result = run_with(memory, tip_with(kMemory, verlet(h)));
    const std::vector<double> end = end_of(result);
    steps.push_back(h);
    errors.push_back(0.0);
    for (std::size_t k = 0; k < end.size(); ++k) {
      errors.back() = std::max(errors.back(), std::abs(end[k] - exact[k]));
    }
    works.push_back(std::abs(*result.group("energy")["numerical_work"]));
  }
  constexpr Window kSecond{1.9, 2.1};
  EXPECT_TRUE(kSecond.holds(fitted_order(steps, errors))) << fitted_order(steps, errors);
  EXPECT_TRUE(kSecond.holds(fitted_order(steps, works))) << fitted_order(steps, works);
}

/// Nothing but the operator acts: what the ledger counts is what is gone, at any step.
TEST(FlowRuns, LedgerClosesWithTheHeat) {
  const Registry thermal = with_force("viscous_damping", "decay", alone<Thermal>(), "", true);
  for (const double dt : {0.01, 0.5}) {
    const std::string text =
        "[[body]]\ntype = \"chain\"\ncount = 500\nspacing = 1.0\nparticle_mass = 0.5\n"
        "[[force]]\n" +
        kDecay +
        "[run]\nduration = 40.0\nledger = true\nallow_unstable = true\n"
        "integrator = " +
        verlet(dt) + "\n";
    const RunResult result = run_with(thermal, text);
    const ResultGroup& energy = result.group("energy");
    EXPECT_LT(*energy["heat_out"], -100.0);
    EXPECT_NEAR(*energy["numerical_work"], 0.0, 1e-11);
    // Equipartition: of 500 energies kT/2, each off by less than its size.
    const double wanted = 0.5 * 500.0 * kTemperature;
    EXPECT_NEAR(*energy["kinetic"], wanted, 5.0 * wanted / std::sqrt(500.0));
  }
}

TEST(FlowRuns, RandomNumbersFollowFromSeedNameAndStep) {
  const Registry thermal =
      with_force("viscous_damping", "decay", beside_force<Thermal>(), "", true);
  const auto scene = [&](const std::string& more, const std::string& name = "bath") {
    std::string text = tip_with(kDecay, verlet(0.02), more);
    return text.replace(text.find("\"bath\""), 6, "\"" + name + "\"");
  };
  const auto end = [&](const std::string& text) { return end_of(run_with(thermal, text)); };
  const std::vector<double> wanted = end(scene(""));
  EXPECT_EQ(end(scene("")), wanted);
  EXPECT_EQ(end(scene("[output]\nevery = 0.14\n")), wanted) << "samples";
  EXPECT_NE(end(scene("seed = 1\n")), wanted);
  EXPECT_NE(end(scene("", "other")), wanted);

  // Gone on with in the middle.
  const auto parsed = parse_scene(scene(""), "test.toml", thermal);
  Engine first(parsed, {});
  first.advance(130);
  Engine second(parsed, {});
  second.resume(first.state().to_bytes());
  EXPECT_EQ(end_of(second.run()), wanted);
}

TEST(FlowRuns, WhatAnOperatorThrowsIsItsPlugins) {
  const Registry throws =
      with_force("viscous_damping", "decay", alone<FlowThatThrows>(), "libflow.so", true);
  const RunResult result = run_with(throws, tip_with(kDecay, verlet(0.02)));
  ASSERT_EQ(result.status, RunStatus::failed);
  EXPECT_NE(result.failure->what.find("out of flow"), std::string::npos) << result.failure->what;
}

TEST(FlowRuns, SchemesThatWouldLeaveItOutRefuse) {
  const Registry only = with_force("viscous_damping", "decay", alone<ExactDecay>(), "", true);
  const Registry both = with_force("viscous_damping", "decay", beside_force<ExactDecay>());
  for (const std::string& integrator :
       {fixed_step(0.02), adaptive(1e-8), held_to("exponential_verlet", 0.02)}) {
    const std::string why = refusal(tip_with(kDecay, integrator), only);
    EXPECT_NE(why.find("[integrator.unsuitable]"), std::string::npos) << why;
    EXPECT_NE(why.find("\"bath\""), std::string::npos) << why;
    EXPECT_NE(why.find("velocity_verlet"), std::string::npos) << why;
  }
  EXPECT_EQ(refusal(tip_with(kDecay, fixed_step(0.02)), both), "") << "it is a force too";
  EXPECT_NE(refusal(tip_with(kDecay, held_to("exponential_verlet", 0.02)), both), "");
}

}  // namespace
}  // namespace tomlin::test
