#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/system/state_layout.hpp"
#include "tests/support/resumed.hpp"
#include "tests/support/ring_scenes.hpp"

// Everything that changes during a run is in one declared layout: it can be written as bytes, and a
// run resumed from it.

namespace tomlin::test {
namespace {

StateLayout some_layout() {
  StateLayout layout;
  layout.add_reals("position", 5);
  layout.add_integers("counts", 3);
  layout.add_reals("velocity", 11);
  layout.add_reals("nothing", 0);
  layout.add_integers("cells", 1);
  return layout;
}

/// A state whose numbers say where they stand.
RunState marked() {
  RunState state(some_layout());
  for (const auto& field : state.layout().reals()) {
    for (std::size_t k = 0; k < field.count; ++k) {
      state.reals(field.name)[k] = 1000.0 + static_cast<double>(field.first + k);
    }
  }
  for (const auto& field : state.layout().integers()) {
    for (std::size_t k = 0; k < field.count; ++k) {
      state.integers(field.name)[k] = static_cast<std::int64_t>(field.first + k);
    }
  }
  return state;
}

TEST(RunState, BytesAreTheWholeOfIt) {
  const RunState state = marked();
  RunState read(some_layout());
  EXPECT_NE(read.to_bytes(), state.to_bytes());
  read.from_bytes(state.to_bytes());
  EXPECT_EQ(read.to_bytes(), state.to_bytes());
  EXPECT_EQ(read.reals("velocity")[0], state.reals("velocity")[0]);
  EXPECT_EQ(read.integers("counts")[2], state.integers("counts")[2]);
}

TEST(RunState, FieldsDoNotOverlap) {
  RunState state = marked();
  const RunState before = marked();
  for (std::size_t k = 0; k < 5; ++k) state.reals("position")[k] = -1.0;
  for (std::size_t k = 0; k < 11; ++k) {
    EXPECT_EQ(state.reals("velocity")[k], before.reals("velocity")[k]);
  }
  // Kernels load whole groups: each field starts on one.
  EXPECT_GT(state.layout().reals().size(), 1u);
  for (const auto& field : state.layout().reals()) EXPECT_EQ(field.first % kGroup, 0u);
}

TEST(RunState, WhatDoesNotFitIsRefused) {
  RunState state = marked();
  StateLayout other = some_layout();
  other.add_reals("more", 1);
  EXPECT_THROW(state.copy_numbers(RunState(other)), std::invalid_argument);
  EXPECT_THROW(state.from_bytes(RunState(other).to_bytes()), std::invalid_argument);
  EXPECT_THROW(state.reals("no such field"), std::invalid_argument);
}

// ---- going on from a state

struct Case {
  std::string what;
  std::string text;
};

/// Every scheme with every number type and dynamics, the ledger kept.
std::vector<Case> combinations() {
  constexpr double kDt = 0.02;
  const std::string window = "[measure]\nin = \"time\"\nfrom = 1.5\nto = 9.0\n";
  std::vector<Case> all;
  for (const std::string dynamics : {"inertial", "overdamped"}) {
    for (const std::string type : {"double", "quadruple"}) {
      for (const std::string& integrator : {fixed_step(kDt), verlet(kDt), adaptive(1e-6)}) {
        if (dynamics == "overdamped" && integrator == verlet(kDt)) continue;
        const std::string keys = "dynamics = \"" + dynamics + "\"\nnumber_type = \"" + type +
                                 "\"\nledger = true\n" + window;
        const std::string what = dynamics + ", " + type + ", " + integrator;
        all.push_back({"tip, " + what,
                       TipScene{.duration = 10.0, .integrator = integrator, .more = keys}.text()});
        RingScene ring{.coordinates = "rigid",
                       .velocity = 0.9,
                       .duration = 10.0,
                       .integrator = integrator,
                       .more = keys};
        all.push_back({"rigid ring, " + what, ring.text()});
        if (type == "quadruple") continue;  // slow, and no other path
        ring.coordinates = "particles";
        ring.bonds = 1.0;  // soft enough for this step without inertia
        all.push_back({"flexible ring, " + what, ring.text()});
      }
    }
  }
  return all;
}

std::vector<Case> cases() {
  const std::string window = "[measure]\nin = \"time\"\nfrom = 1.5\nto = 9.0\n";
  const TipScene tip{.duration = 10.0, .more = window};
  const TipScene fast{.velocity = 4.0, .duration = 10.0, .more = window};  // many cells
  const RingScene flexible{.duration = 10.0, .more = window};
  std::vector<Case> all = {{"tip, without a ledger", tip.text()},
                           {"fast tip", fast.text()},
                           {"flexible ring of stiff bonds", flexible.text()}};
  for (Case& one : combinations()) all.push_back(std::move(one));
  return all;
}

/// Wherever a run is stopped, another engine goes on from its bytes and ends with the same bits:
/// before, in and after the window, at and between the steps where forces are anchored.
TEST(Resume, EndsWithTheSameBits) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.what);
    const auto scene = scene_of(c.text);
    Engine whole(scene, {});
    const RunResult expected = whole.run();
    ASSERT_EQ(expected.status, RunStatus::finished);
    ASSERT_FALSE(expected.driver(0)["mean_force"].empty());
    for (const std::uint64_t stop : {1u, 16u, 37u, 160u, 411u}) {
      if (stop >= expected.steps) continue;
      SCOPED_TRACE(stop);
      Engine first(scene, {});
      first.advance(stop);
      const std::vector<std::byte> numbers = first.state().to_bytes();
      Engine second(scene, {});
      second.resume(numbers);
      EXPECT_EQ(second.state().to_bytes(), numbers);
      const RunResult resumed = second.run();
      EXPECT_TRUE(Motion(second) == Motion(whole));
      EXPECT_EQ(second.state().to_bytes(), whole.state().to_bytes());
      expect_same_numbers(resumed, expected);
      EXPECT_EQ(resumed.force_evaluations, expected.force_evaluations);
    }
  }
}

TEST(Resume, IntoAnEngineThatHasRunFurther) {
  const auto scene = scene_of(RingScene{.duration = 4.0}.text());
  Engine whole(scene, {});
  whole.run();
  Engine engine(scene, {});
  engine.advance(203);
  const auto numbers = engine.state().to_bytes();
  engine.advance(900);
  engine.resume(numbers);
  engine.run();
  EXPECT_TRUE(Motion(engine) == Motion(whole));
}

// ---- the same bits

TEST(SameBits, OnEveryInstructionSet) {
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.what);
    RunOptions baseline;
    baseline.instruction_set = InstructionSet::baseline;
    Engine plain(scene_of(c.text), baseline);
    const RunResult expected = plain.run();
    for (const InstructionSet set : {InstructionSet::avx2, InstructionSet::avx512}) {
      if (!is_supported(set)) continue;
      RunOptions options;
      options.instruction_set = set;
      Engine wide(scene_of(c.text), options);
      expect_same_numbers(expected, wide.run());
      EXPECT_EQ(plain.state().to_bytes(), wide.state().to_bytes());
    }
  }
}

/// A test that passes on anything: a change in the last digit of a parameter must be seen.
TEST(SameBits, ADifferenceIsSeen) {
  const TipScene tip{.duration = 10.0};
  const TipScene other{.amplitude = std::nextafter(0.1, 1.0), .duration = 10.0};
  Engine a(scene_of(tip.text()), {});
  Engine b(scene_of(other.text()), {});
  a.run();
  b.run();
  EXPECT_FALSE(Motion(a) == Motion(b));
}

// ---- independent bodies

/// Three tips of their own, which start in different cells.
std::string three_tips(const std::vector<int>& order, const std::string& integrator) {
  struct Tip {
    const char* name;
    double position, mass, stiffness, velocity, amplitude;
  };
  static const Tip tips[] = {{"one", 0.3, 1.0, 2.0, 0.8, 0.1},
                             {"two", 7.4, 1.7, 1.1, 0.6, 0.2},
                             {"three", -2.1, 0.9, 1.4, 0.7, 0.15}};
  std::string bodies;
  std::string forces;
  for (const int k : order) {
    const Tip& tip = tips[k];
    const std::string on = std::string("body = \"") + tip.name + "\"\n";
    const auto force = [&](const char* prefix, const char* type) {
      return std::string("[[force]]\nname = \"") + prefix + tip.name + "\"\ntype = \"" + type +
             "\"\n" + on;
    };
    bodies += std::string("[[body]]\nname = \"") + tip.name + "\"\ntype = \"point\"\nposition = [" +
              digits(tip.position) + "]\nparticle_mass = " + digits(tip.mass) + "\n";
    forces += force("pull_", "driving_spring") + "stiffness = " + digits(tip.stiffness) +
              "\nvelocity = [" + digits(tip.velocity) + "]\n";
    forces += force("drag_", "viscous_damping") + "coefficient = 1.0\n";
    forces += force("corrugation_", "sinusoidal_substrate") +
              "amplitude = " + digits(tip.amplitude) + "\nperiod = 1.0\n";
  }
  return bodies + forces + "[run]\nduration = 30.0\nintegrator = " + integrator + "\n";
}

/// Steps that all bodies share, too: what each adds to the error estimate is summed in no order.
TEST(IndependentBodies, TheirOrderDoesNotMatter) {
  for (const std::string& integrator : {fixed_step(0.01), adaptive(1e-8)}) {
    SCOPED_TRACE(integrator);
    const RunResult a = run_text(three_tips({0, 1, 2}, integrator));
    ASSERT_EQ(a.status, RunStatus::finished);
    for (const std::vector<int>& order : {std::vector<int>{2, 0, 1}, std::vector<int>{1, 0, 2}}) {
      const RunResult b = run_text(three_tips(order, integrator));
      EXPECT_EQ(a.steps, b.steps);
      for (const char* name : {"one", "two", "three"}) {
        SCOPED_TRACE(name);
        EXPECT_TRUE(
            same_bits(body_of(a, name)["centre_of_mass"], body_of(b, name)["centre_of_mass"]));
        EXPECT_TRUE(same_bits(body_of(a, name)["velocity"], body_of(b, name)["velocity"]));
        EXPECT_TRUE(
            same_bits(body_of(a, name)["mean_velocity"], body_of(b, name)["mean_velocity"]));
        EXPECT_TRUE(same_bits(body_of(a, name)["max_speed"], body_of(b, name)["max_speed"]));
        const std::string pull = std::string("pull_") + name;
        EXPECT_TRUE(same_bits(driver_of(a, pull)["mean_force"], driver_of(b, pull)["mean_force"]));
        EXPECT_TRUE(same_bits(driver_of(a, pull)["max_force"], driver_of(b, pull)["max_force"]));
        EXPECT_TRUE(
            same_bits(driver_of(a, pull)["static_force"], driver_of(b, pull)["static_force"]));
        EXPECT_TRUE(same_bits(driver_of(a, pull)["work"], driver_of(b, pull)["work"]));
      }
    }
  }
}

}  // namespace
}  // namespace tomlin::test
