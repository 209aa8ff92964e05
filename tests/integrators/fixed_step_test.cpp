#include "integrators/fixed_step.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/order.hpp"
#include "tests/support/oscillator.hpp"
#include "tests/support/tableaus.hpp"

// A tableau and a record are a scheme: of its order, in every form of the kernels.

namespace tomlin::test {
namespace {

template <class Tableau, class Real>
constexpr FixedStepTable<Real> kFurther = FixedStepKernels<Tableau>::template kernels<Real>();
template <class Tableau>
constexpr TablesByType<FixedStepTable> kFurtherTables = {{&kFurther<Tableau, double>},
                                                         {&kFurther<Tableau, Quad>}};

template <class Tableau>
IntegratorRecord further_record() {
  IntegratorRecord record = fixed_step_record<Tableau, kFurtherTables<Tableau>>();
  const IntegratorRecord& rk4 = *standard().integrator("rk4");
  record.summary = rk4.summary;
  record.equation = rk4.equation;
  record.source = rk4.source;
  record.example = rk4.example;
  return record;
}

const Registry& with_further() {
  static const Registry registry = [] {
    Registry all = standard_registry();
    all.add(further_record<HeunTableau>());
    all.add(further_record<RalstonTableau>());
    all.add(further_record<ThreeEighthsTableau>());
    return all;
  }();
  return registry;
}

struct FurtherScheme {
  std::string name;
  Window order;
};
const FurtherScheme kFurtherSchemes[] = {
    {"heun", {1.9, 2.2}}, {"ralston", {2.8, 3.2}}, {"three_eighths", {3.8, 4.3}}};
constexpr double kLongest = 0.05;

RunResult run_further(const Oscillator& o, const FurtherScheme& scheme, double h,
                      std::vector<Setting> settings = {}, const std::string& more = "") {
  const std::string integrator = "{ type = \"" + scheme.name + "\", dt = " + digits(h) + " }";
  settings.push_back({"run.allow_unstable", "true"});
  return run(parse_scene(o.scene(integrator, more), "test.toml", with_further(), settings));
}

/// Orders over three halvings, of what `error` makes of a result.
template <class Error>
void check_order(const FurtherScheme& scheme, const Oscillator& o,
                 const std::vector<Setting>& settings, const Error& error) {
  std::vector<double> steps, errors;
  for (double h = kLongest; h > 0.1 * kLongest; h *= 0.5) {
    steps.push_back(h);
    errors.push_back(error(run_further(o, scheme, h, settings)));
  }
  const double order = fitted_order(steps, errors);
  EXPECT_TRUE(scheme.order.holds(order)) << scheme.name << ": " << order;
}

TEST(FixedStep, FurtherTableausHaveTheirOrder) {
  const Oscillator o;
  for (const FurtherScheme& scheme : kFurtherSchemes) {
    for (const char* number_type : {"\"double\"", "\"quadruple\""}) {
      const std::vector<Setting> settings = {{"run.number_type", number_type}};
      check_order(scheme, o, settings,
                  [&](const RunResult& r) { return error_at_end(r, o.at(o.duration)); });
      check_order(scheme, o, settings, [&](const RunResult& r) {
        return std::abs(r.driver(0)["mean_force"][0] - o.mean_force());
      });
    }
  }
}

/// c x' = k (V t - x).
TEST(FixedStep, FurtherTableausHaveTheirOrderWithoutInertia) {
  const Oscillator o{.c = 2.5};
  const double rate = o.k / o.c;
  const double end =
      o.pull * (o.duration - 1.0 / rate) + (o.x0 + o.pull / rate) * std::exp(-rate * o.duration);
  for (const FurtherScheme& scheme : kFurtherSchemes) {
    check_order(scheme, o, {{"run.dynamics", "\"overdamped\""}},
                [&](const RunResult& r) { return std::abs(r.body(0)["centre_of_mass"][0] - end); });
  }
}

/// Samples within every step leave the registers for the arrays; at its ends they do not.
TEST(FixedStep, RegistersAndArraysHaveTheSameBits) {
  const Oscillator o;
  for (const FurtherScheme& scheme : kFurtherSchemes) {
    const RunResult in_registers = run_further(o, scheme, kLongest);
    for (const double every : {kLongest, 0.5 * kLongest}) {
      const RunResult sampled =
          run_further(o, scheme, kLongest, {}, "[output]\nevery = " + digits(every) + "\n");
      EXPECT_EQ(in_registers.body(0)["centre_of_mass"][0], sampled.body(0)["centre_of_mass"][0]);
      EXPECT_EQ(in_registers.body(0)["velocity"][0], sampled.body(0)["velocity"][0]);
      EXPECT_EQ(in_registers.driver(0)["mean_force"][0], sampled.driver(0)["mean_force"][0]);
    }
  }
}

}  // namespace
}  // namespace tomlin::test
