#include <cmath>

#include "tests/extremes/scenes.hpp"

namespace tomlin::test {
namespace {

/// A chain on no corrugation moves as one: a mass on the driver's spring.
Value moves_as_one(double count, double mass) {
  const double omega = 1.0 / std::sqrt(count * mass);
  return is("drivers.driver.final_force.x", 0.1 / omega * std::sin(omega), 1e-9,
            "one mass on the driver's spring");
}

/// The bond swings with the reduced mass from a stretch of 0.1.
double potential_of_bond(double reduced_mass, double duration) {
  const double stretch = 0.1 * std::cos(duration / std::sqrt(reduced_mass));
  return 0.5 * stretch * stretch;
}

}  // namespace

Subject size() {
  const std::vector<Setting> one_on_the_line = {
      {"x0", "0"}, {"c", "2 * sqrt(2)"}, {"v", "0.1"}, {"T", "30"}};
  return {
      "size",
      "Size: numbers of particles, masses",
      {finishes(kRing, "ring_of_one", "a ring of one particle", {{"N", "1"}, {"lambda", "0"}},
                {is_that_of("drivers.driver.mean_force.x", kTip, one_on_the_line, 1e-7,
                            "a tip, one period off")},
                {FaultCode::run_few_slips}),
       finishes(kChain, "chain_of_one", "a chain of one particle", {{"N", "1"}, {"V0", "0"}},
                {moves_as_one(1.0, 1.0)}, {FaultCode::run_window_not_whole}),
       finishes(kChain, "chain_of_1e5", "a chain of 1e5", {{"N", "100000"}, {"V0", "0"}, rk4(0.1)},
                {moves_as_one(1e5, 1.0)}, {FaultCode::run_window_not_whole}),
       finishes(kChain, "all_pairs_of_2000", "all pairs of 2000",
                {{"N", "2000"},
                 {"V0", "0"},
                 {"K", "1e-6"},
                 {"force.harmonic_bonds.pairs", "all"},
                 rk4(0.1)},
                {moves_as_one(2e3, 1.0)}, {FaultCode::run_window_not_whole}),
       refused(kChain, "chain_of_0", "a chain of none", {{"N", "0"}}, {"count", "> 0"}),
       refused(kChain, "chain_of_1e9", "a chain of 1e9", {{"N", "1000000000"}},
               {"420 GB", "at most"}),
       refused(kChain, "chain_of_2_to_63", "a chain of 2^63 - 1",
               {{"body.chain.count", "9223372036854775807"}}, {"GB", "at most"}),
       refused(kChain, "all_pairs_of_1e6", "all pairs of 1e6",
               {{"N", "1000000"}, {"force.harmonic_bonds.pairs", "all"}}, {"pairs would take"}),
       finishes(kPair, "mass_ratio_1e12", "a partner 1e12 times heavier",
                {{"m2", "1e12"}, {"d", "1.1"}},
                {is("energy.potential", potential_of_bond(1.0, 10.0), 1e-8,
                    "a bond's swings with the reduced mass")}),
       finishes(kPair, "mass_ratio_1e_12", "a partner 1e12 times lighter",
                {{"m2", "1e-12"}, {"d", "1.1"}, {"T", "1e-4"}, rk4(1e-9)},
                {is("energy.potential", potential_of_bond(1e-12, 1e-4), 1e-8,
                    "a bond's swings with the reduced mass")}),
       fails(kPair, "mass_ratio_1e_12_long_step", "the same with a step for the heavy one",
             {{"m2", "1e-12"}, {"d", "1.1"}, rk4(1e-2)}, {"stability limit of rk4", "2.828e-06"}),
       finishes(kTip, "mass_1e12", "a tip of mass 1e12", {{"m", "1e12"}, {"V0", "0"}},
                {is("drivers.driver.final_force.x", 2.0, 1e-7, "it stays where it is")}),
       fails(kTip, "mass_1e_12", "a tip of mass 1e-12", {{"m", "1e-12"}},
             {"would take at least", "inertia"}),
       finishes(kTip, "mass_1e_12_implicit", "the same, the implicit scheme",
                {{"m", "1e-12"}, {"T", "200"}, {"run.integrator", "{ type = \"radau9\" }"}},
                {is_that_of("drivers.driver.mean_force.x", kTip,
                            {{"T", "200"}, {"run.dynamics", "overdamped"}}, 1e-6,
                            "dynamics without inertia")},
                {FaultCode::run_few_slips}),
       refused(kTip, "mass_0", "a tip of no mass", {{"m", "0"}}, {"particle_mass", "> 0"}),
       fails(kTip, "mass_1e_320", "a tip of mass 1e-320", {{"m", "1e-320"}},
             {"not a finite number"})}};
}

}  // namespace tomlin::test
