#include "framework/run/results/observables.hpp"

#include <cmath>
#include <limits>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "framework/core/text/fault.hpp"
#include "tests/support/results.hpp"
#include "tests/support/scenes.hpp"

// The numbers of a result by dotted path.

namespace tomlin::test {
namespace {

RunResult planar_result() {
  RunResult result;
  result.end_time = 20.0;
  result.steps = 7;
  result.groups = {
      group_of("drivers", "driver", 2,
               {{"mean_force", {1.0, 2.0}}, {"final_force", {3.0, 4.0}}, {"work", {5.0}}}),
      group_of("bodies", "ring", 2,
               {{"centre_of_mass", {6.0, 7.0}}, {"velocity", {8.0, 9.0}}, {"turns", {-1.5}}}),
      group_of("bodies", "tip", 2, {{"centre_of_mass", {10.0, 11.0}}, {"velocity", {12.0, 13.0}}})};
  return result;
}

Fault fault_of(const RunResult& result, const std::string& path,
               const SourceLocation& location = {}) {
  try {
    (void)observable(result, path, location);
  } catch (const InputError& error) {
    return error.faults().front();
  }
  ADD_FAILURE() << path << " is an observable";
  return Fault(FaultCode::observable_unknown);
}

TEST(Observables, AreFoundByTheirFullPathAndWithoutTheFamily) {
  const RunResult result = planar_result();
  for (const std::string family : {"drivers.", ""}) {
    EXPECT_EQ(observable(result, family + "driver.mean_force.x"), 1.0);
    EXPECT_EQ(observable(result, family + "driver.mean_force.y"), 2.0);
    EXPECT_EQ(observable(result, family + "driver.work"), 5.0);
  }
  for (const std::string family : {"bodies.", ""}) {
    EXPECT_EQ(observable(result, family + "ring.turns"), -1.5);
    EXPECT_EQ(observable(result, family + "tip.velocity.y"), 13.0);
  }
  EXPECT_EQ(observable(result, "time.end"), 20.0);
  EXPECT_EQ(observable(result, "time.steps"), 7.0);
}

TEST(Observables, WhatIsUndefinedIsNothing) {
  RunResult result = planar_result();
  EXPECT_EQ(observable(result, "driver.static_force"), std::nullopt);
  EXPECT_EQ(observable(result, "driver.max_force.y"), std::nullopt);  // no window: an empty list
  EXPECT_EQ(observable(result, "ring.rolling"), std::nullopt);
  const double infinity = std::numeric_limits<double>::infinity();
  result.groups.front() = group_of("drivers", "driver", 2,
                                   {{"work", {std::nan("")}}, {"final_force", {infinity, 4.0}}});
  EXPECT_EQ(observable(result, "driver.work"), std::nullopt);
  EXPECT_EQ(observable(result, "driver.final_force.x"), std::nullopt);
}

TEST(Observables, PathsDoNotDependOnHowFarTheRunGot) {
  const auto paths = [](const RunResult& result) {
    std::set<std::string> all;
    for (const Observable& one : observables(result)) {
      EXPECT_TRUE(all.insert(one.path).second) << one.path;
    }
    return all;
  };
  RunResult early = planar_result();
  early.groups[0] = group_of("drivers", "driver", 2, {});
  early.groups[1] = group_of("bodies", "ring", 2, {});
  EXPECT_EQ(paths(early), paths(planar_result()));
}

TEST(Observables, UnknownNamesAreErrorsThatKnowTheNearest) {
  const RunResult result = planar_result();
  EXPECT_EQ(fault_of(result, "drivr.mean_force.x").nearest, "driver.mean_force.x");
  EXPECT_EQ(fault_of(result, "bodies.ring.turn").nearest, "bodies.ring.turns");
  EXPECT_EQ(fault_of(result, "ring.Turns").nearest, "ring.turns");
  // A list is no number, and the plane has two components.
  EXPECT_EQ(fault_of(result, "driver.mean_force").nearest, "driver.mean_force.x");
  EXPECT_EQ(fault_of(result, "driver.mean_force.z").nearest, "driver.mean_force.x");
  // The families are not interchangeable.
  EXPECT_EQ(fault_of(result, "bodies.driver.work").key, "bodies.driver.work");
  EXPECT_EQ(fault_of(result, "").nearest, "");
  EXPECT_EQ(fault_of(RunResult{}, "driver.work").nearest, "");
}

TEST(Observables, AnErrorSaysWhereThePathWasWritten) {
  const Fault fault = fault_of(planar_result(), "drivr.work", {.file = "--observable"});
  EXPECT_EQ(fault.location.file, "--observable");
  EXPECT_EQ(brief(fault), "drivr.work [observable.unknown] did you mean driver.work");
}

TEST(Observables, RotateInThePlaneOnly) {
  RunResult result;
  result.groups = {group_of("bodies", "ring", 1, {}), group_of("bodies", "tip", 1, {})};
  EXPECT_EQ(fault_of(result, "ring.turns").key, "ring.turns");
  EXPECT_EQ(fault_of(result, "ring.velocity.y").nearest, "ring.velocity.x");
}

TEST(Observables, OfARun) {
  // One unit of time under a unit force on a unit mass.
  const RunResult result =
      run_text(standard().force("constant_force")->example, {{"run.duration", "1.0"}});
  // Fourth order is exact on a parabola; a hundred steps' rounding.
  constexpr double kRounding = 1e-13;
  EXPECT_NEAR(observable(result, "point.centre_of_mass.x").value(), -0.5, kRounding);
  EXPECT_NEAR(observable(result, "point.velocity.x").value(), -1.0, kRounding);
  EXPECT_EQ(observable(result, "time.steps"), 100.0);
}

}  // namespace
}  // namespace tomlin::test
