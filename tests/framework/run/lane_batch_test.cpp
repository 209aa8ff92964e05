#include "framework/run/steps/lane_batch.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "framework/run/context.hpp"
#include "framework/run/results/observables.hpp"
#include "tests/support/ring_scenes.hpp"

/// Runs in lanes have the bits that they have alone: of the whole state and of every result.
namespace tomlin::test {
namespace {

struct LaneCase {
  std::string name;
  /// The text of replica k.
  std::function<std::string(int)> text;
  std::vector<std::string> observables = {"driver.mean_force.x"};
  bool by_lanes = true;  ///< more than by single steps
};

/// Returns numbers that differ between replicas: no two alike, and in no simple ratio.
double own(int k, double from, double to) {
  const double part = 0.5 + 0.5 * std::sin(1.0 + 2.3 * k);
  return from + (to - from) * part;
}

std::string tip_of(int k) {
  return TipScene{.velocity = own(k, 0.05, 0.4),
                  .stiffness = own(k + 1, 0.5, 3.0),
                  .damping = own(k + 2, 0.3, 2.0),
                  .amplitude = own(k + 3, 0.05, 0.2),
                  .period = own(k + 4, 0.8, 1.3),
                  .duration = 20.0 + k,
                  .more = "[measure]\nfrom = 5.0\n"}
      .text();
}

/// The damping before the spring, so that forces are added in another order.
std::string damped_first(std::string text) {
  const std::size_t spring = text.find("[[force]]\nname = \"driver\"");
  const std::size_t damping = text.find("[[force]]\ntype = \"viscous_damping\"");
  const std::size_t substrate = text.find("[[force]]\ntype = \"sinusoidal_substrate\"");
  return text.substr(0, spring) + text.substr(damping, substrate - damping) +
         text.substr(spring, damping - spring) + text.substr(substrate);
}

/// One force more, so that no kernel has all of them.
std::string with_load(std::string text, int k) {
  return text.insert(text.find("[run]"), "[[force]]\ntype = \"constant_force\"\nforce = [" +
                                             digits(own(k, 0.01, 0.1)) + "]\n");
}

/// It sticks and slips.
std::string slipping_tip_of(int k) {
  return TipScene{.velocity = own(k, 0.05, 0.2),
                  .stiffness = own(k + 1, 0.5, 1.5),
                  .damping = own(k + 2, 0.5, 2.0),
                  .amplitude = own(k + 3, 0.1, 0.3),
                  .period = own(k + 4, 0.8, 1.3),
                  .duration = 80.0 + k,
                  .more = "[measure]\nfrom = 5.3\n"}
      .text();
}

const std::vector<std::string> kWatched = {
    "driver.max_force.x", "driver.min_force.x", "tip.max_speed",      "driver.static_force",
    "events.slips",       "events.reversals",   "driver.mean_force.x"};

std::string ring_of(int k, const std::string& coordinates) {
  RingScene ring;
  ring.coordinates = coordinates;
  ring.velocity = own(k, 0.1, 0.6);
  ring.decay = own(k + 1, 0.1, 2.0);
  ring.period = own(k + 2, 0.7, 1.4);
  ring.bonds = own(k + 3, 500.0, 900.0);
  ring.duration = 2.0 + 0.25 * k;
  return ring.text();
}

std::string chain_of(int k, const std::string& box, const std::string& pairs) {
  return "[[body]]\nname = \"chain\"\ntype = \"chain\"\ncount = 11\nspacing = 1.0\n"
         "particle_mass = " +
         digits(own(k, 0.5, 2.0)) +
         "\n"
         "[[force]]\ntype = \"harmonic_bonds\"\npairs = " +
         pairs + "\nstiffness = " + digits(own(k + 1, 1.0, 4.0)) +
         "\n[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = " +
         digits(own(k + 2, 0.1, 0.5)) + "\nvelocity = [" + digits(own(k + 3, 0.2, 0.9)) +
         "]\nattach = \"each_particle\"\n[[force]]\ntype = \"viscous_damping\"\ncoefficient = 0.4\n"
         "[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = " +
         digits(own(k + 4, 0.02, 0.2)) + "\nperiod = 1.0\n" + box +
         "[run]\nduration = " + digits(10.0 + k) + "\nintegrator = { type = \"rk4\", dt = 0.02 }\n";
}

/// In space: a ball on two springs, one at a particle of a rigid body.
std::string dumbbells_of(int k) {
  return "[[body]]\nname = \"one\"\ntype = \"particles\"\npositions = [[0.0, 0.0, 0.5], [1.1, 0.0, "
         "0.5], [0.3, 0.9, 0.6]]\nparticle_mass = 0.7\n"
         "[[body]]\nname = \"other\"\ntype = \"particles\"\npositions = [[0.0, 0.2, 2.0], [1.2, "
         "0.0, 2.1]]\nparticle_mass = 1.3\ncoordinates = \"rigid\"\nhold = [\"rotation\"]\n"
         "[[force]]\ntype = \"harmonic_bonds\"\nbodies = [\"one\", \"other\"]\npairs = \"all\"\n"
         "stiffness = " +
         digits(own(k, 1.0, 3.0)) +
         "\n[[force]]\ntype = \"morse_bonds\"\nbody = \"one\"\npairs = [[0, 1], [1, 2]]\ndepth = "
         "1.0\n"
         "inverse_width = " +
         digits(own(k + 1, 0.4, 0.8)) +
         "\n[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nbody = \"one\"\nattach = { "
         "particle = 1 }\nstiffness = 2.0\nvelocity = [" +
         digits(own(k + 2, 0.1, 0.4)) +
         ", 0.0, 0.0]\n[[force]]\nname = \"pull\"\ntype = \"driving_spring\"\nbody = \"other\"\n"
         "stiffness = [1.0, 0.0, 2.0]\nvelocity = [0.1, 0.0, 0.0]\n"
         "[[force]]\nname = \"drag\"\ntype = \"viscous_damping\"\nbody = \"one\"\ncoefficient = "
         "0.5\n"
         "[[force]]\nname = \"drag_of_other\"\ntype = \"viscous_damping\"\nbody = "
         "\"other\"\ncoefficient = " +
         digits(own(k + 3, 0.3, 0.9)) + "\n[run]\nduration = " + digits(6.0 + k) +
         "\nintegrator = { type = \"midpoint\", dt = 0.01 }\n";
}

/// With another scheme, inertia or none.
std::string with_run(std::string text, const std::string& integrator,
                     const std::string& more = "") {
  const std::size_t from = text.find("integrator = ");
  const std::size_t to = text.find('\n', from);
  return text.replace(from, to - from, "integrator = " + integrator + more);
}

constexpr const char* kOverdamped = "\ndynamics = \"overdamped\"";

/// In a bath: with noise, each replica of a seed, a stream and a temperature of its own.
std::string warmed(std::string text, int k, double temperature) {
  const std::string friction = "type = \"viscous_damping\"";
  for (std::size_t at = 0; (at = text.find(friction, at)) != std::string::npos;) {
    text.replace(at, friction.size(),
                 "type = \"langevin\"\ntemperature = " + digits(own(k, 0.5, 2.0) * temperature));
  }
  const std::string run = "[run]\n";
  return text.replace(text.find(run), run.size(),
                      run + "seed = " + std::to_string(k / 2) +
                          "\nstream = " + std::to_string(k % 2 + 3 * k) + "\n");
}

std::string thermal(std::string text, int k, const std::string& scheme, double dt,
                    const std::string& more = "") {
  return warmed(
      with_run(std::move(text), "{ type = \"" + scheme + "\", dt = " + digits(dt) + " }", more), k,
      0.05);
}

/// In the plane, without and with what samples leave between steps.
std::string tip_in_the_plane(int k) {
  return "[[body]]\nname = \"tip\"\ntype = \"point\"\nposition = [0.1, 0.2]\nparticle_mass = "
         "1.3\n[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = 1.5\n"
         "velocity = [0.2, " +
         digits(own(k, 0.05, 0.2)) +
         "]\n[[force]]\ntype = \"viscous_damping\"\ncoefficient = 0.9\n[[force]]\ntype = "
         "\"sinusoidal_substrate\"\namplitude = 0.1\nperiod = 1.0\n[run]\nduration = " +
         digits(15.0 + k) + "\nintegrator = { type = \"rk4\", dt = 0.02 }\n";
}

const std::vector<std::string> kWithTemperature = {"driver.mean_force.x", "tip.temperature"};
const std::vector<std::string> kRingWithTemperature = {"driver.mean_force.x", "ring.temperature"};

const std::vector<LaneCase>& lane_cases() {
  static const std::vector<LaneCase> cases = {
      {"tip", &tip_of},
      {"sampled_tip",
       [](int k) { return tip_of(k) + "[output]\nevery = " + digits(own(k, 0.37, 1.1)) + "\n"; }},
      {"tip_damped_first", [](int k) { return damped_first(tip_of(k)); }},
      {"midpoint_tip",
       [](int k) { return with_run(tip_of(k), "{ type = \"midpoint\", dt = 0.01 }"); }},
      {"loaded_tip", [](int k) { return with_load(tip_of(k), k); }},
      {"watched_tip", &slipping_tip_of, kWatched},
      {"watched_loaded_tip", [](int k) { return with_load(slipping_tip_of(k), k); }, kWatched},
      {"watched_sampled_midpoint_tip",
       [](int k) {
         return with_run(damped_first(slipping_tip_of(k)), "{ type = \"midpoint\", dt = 0.01 }") +
                "[output]\nevery = " + digits(own(k, 0.37, 1.1)) + "\n";
       },
       kWatched},
      {"flexible_ring", [](int k) { return ring_of(k, "particles"); }},
      {"rigid_ring", [](int k) { return ring_of(k, "rigid"); }},
      {"chain", [](int k) { return chain_of(k, "", "\"neighbours\""); }},
      {"closed_chain",
       [](int k) {
         return chain_of(k, "[box]\nlengths = [11.0]\nperiodic = [true]\n", "\"neighbours\"");
       }},
      {"large_ring_of_pairs", [](int k) { return chain_of(k, "", "\"all\""); }},
      {"dumbbells", &dumbbells_of},
      {"slow_tip", [](int k) { return with_run(tip_of(k), fixed_step(0.02), kOverdamped); }},
      {"slow_chain",
       [](int k) {
         return with_run(chain_of(k, "", "\"neighbours\""), "{ type = \"midpoint\", dt = 0.02 }",
                         kOverdamped);
       }},
      {"adaptive_tip", [](int k) { return with_run(tip_of(k), adaptive(own(k, 1e-9, 1e-6))); }},
      {"adaptive_sampled_tip",
       [](int k) {
         return with_run(tip_of(k), adaptive(1e-8)) +
                "[output]\nevery = " + digits(own(k, 0.37, 1.1)) + "\n";
       }},
      {"adaptive_rigid_ring", [](int k) { return with_run(ring_of(k, "rigid"), adaptive(1e-8)); }},
      {"adaptive_flexible_ring",
       [](int k) { return with_run(ring_of(k, "particles"), adaptive(1e-7, "dop853")); }},
      {"adaptive_dumbbells",
       [](int k) { return with_run(dumbbells_of(k), adaptive(1e-8, "dop853")); }},
      {"adaptive_slow_tip", [](int k) { return with_run(tip_of(k), adaptive(1e-8), kOverdamped); }},
      {"damped_tip", [](int k) { return with_run(tip_of(k), verlet(0.01)); }},
      {"damped_chain",
       [](int k) {
         return with_run(chain_of(k, "", "\"neighbours\""), "{ type = \"gjf\", dt = 0.02 }");
       }},
      {"thermal_tip", [](int k) { return thermal(tip_of(k), k, "baoab", 0.02); }, kWithTemperature},
      // Errors of means are taken from parts of the window that are longer than a block of steps.
      {"long_thermal_tip",
       [](int k) {
         std::string text = thermal(tip_of(k), k, "baoab", 0.02);
         const std::size_t at = text.find("duration = ");
         return text.replace(at, text.find('\n', at) - at, "duration = " + digits(900.0 + 37 * k));
       },
       kWithTemperature},
      {"thermal_tip_by_gjf", [](int k) { return thermal(tip_of(k), k, "gjf", 0.03); },
       kWithTemperature},
      {"thermal_tip_by_verlet",
       [](int k) { return thermal(tip_of(k), k, "velocity_verlet", 0.02); }},
      {"thermal_sampled_tip",
       [](int k) {
         return thermal(tip_of(k), k, "baoab", 0.02) +
                "[output]\nevery = " + digits(0.02 * (23 + 7 * k)) + "\n";
       }},
      {"thermal_tip_in_the_plane",
       [](int k) { return thermal(tip_in_the_plane(k), k, "baoab", 0.02); }, kWithTemperature},
      {"thermal_flexible_ring",
       [](int k) {
         return warmed(with_run(ring_of(k, "particles"), "{ type = \"baoab\", dt = 0.002 }"), k,
                       1e-3);
       },
       kRingWithTemperature},
      {"thermal_rigid_ring",
       [](int k) {
         return warmed(with_run(ring_of(k, "rigid"), "{ type = \"gjf\", dt = 0.002 }"), k, 1e-3);
       },
       kRingWithTemperature},
      {"thermal_chain",
       [](int k) { return thermal(chain_of(k, "", "\"neighbours\""), k, "baoab", 0.02); }},
      {"thermal_slow_tip",
       [](int k) { return thermal(tip_of(k), k, "leimkuhler_matthews", 0.02, kOverdamped); }},
      {"thermal_slow_sampled_tip",
       [](int k) {
         return thermal(tip_of(k), k, "leimkuhler_matthews", 0.02, kOverdamped) +
                "[output]\nevery = " + digits(0.02 * (23 + 7 * k)) + "\n";
       }},
      {"thermal_slow_chain",
       [](int k) {
         return thermal(chain_of(k, "", "\"neighbours\""), k, "leimkuhler_matthews", 0.005,
                        kOverdamped);
       }},
      {"thermal_slow_tip_by_euler",
       [](int k) { return thermal(tip_of(k), k, "euler_maruyama", 0.02, kOverdamped); }},
  };
  return cases;
}

const LaneCase& lane_case(std::string_view name) {
  return *std::find_if(lane_cases().begin(), lane_cases().end(),
                       [&](const LaneCase& one) { return one.name == name; });
}

RunOptions asked_for(const LaneCase& one) {
  RunOptions options;
  options.observables = one.observables;
  options.watches_energy = false;
  return options;
}

struct Ended {
  std::vector<std::byte> state;
  RunResult result;
};

Ended alone(const LaneCase& one, int k, const RunOptions& options) {
  Engine engine(scene_of(one.text(k)), options);
  RunResult result = engine.run();
  return {engine.state().to_bytes(), std::move(result)};
}

/// Replicas 0 to n - 1 in so many lanes; those that find no room take the place of ones that end.
std::vector<Ended> in_lanes(const LaneCase& one, int n, std::size_t lanes,
                            const RunOptions& options, const Registry& registry = standard()) {
  std::vector<std::unique_ptr<Engine>> engines;
  for (int k = 0; k < n; ++k) {
    engines.push_back(
        std::make_unique<Engine>(parse_scene(one.text(k), "test.toml", registry), options));
    EXPECT_EQ(engines.back()->in_lanes().why_not(), "") << one.name;
  }
  std::vector<Ended> ended(static_cast<std::size_t>(n));
  std::uint64_t steps = 0;
  LaneBatch batch(*engines.front(), lanes);
  std::size_t next = 0;
  while (next < engines.size() || !batch.is_empty()) {
    for (; next < engines.size() && batch.room() > 0; ++next) {
      EXPECT_TRUE(batch.fits(*engines[next])) << one.name << ", replica " << next;
      batch.add(*engines[next]);
    }
    for (Engine* const engine : batch.advance()) {
      const auto found = std::find_if(engines.begin(), engines.end(),
                                      [&](const auto& some) { return some.get() == engine; });
      RunResult result = engine->end();
      steps += result.steps;
      ended[static_cast<std::size_t>(found - engines.begin())] = {engine->state().to_bytes(),
                                                                  std::move(result)};
    }
  }
  if (one.by_lanes) {
    EXPECT_GT(2 * batch.steps(), steps) << one.name << ": most steps are taken in lanes";
  }
  return ended;
}

void expect_same(const LaneCase& one, const Ended& a, const Ended& b, const std::string& where) {
  EXPECT_EQ(a.state, b.state) << one.name << ", " << where;
  EXPECT_EQ(a.result.status, b.result.status) << one.name << ", " << where;
  EXPECT_EQ(a.result.steps, b.result.steps) << one.name << ", " << where;
  EXPECT_EQ(a.result.force_evaluations, b.result.force_evaluations) << one.name << ", " << where;
  EXPECT_EQ(a.result.warnings.size(), b.result.warnings.size()) << one.name << ", " << where;
  for (const std::string& path : one.observables) {
    EXPECT_EQ(observable(a.result, path), observable(b.result, path)) << one.name << ", " << where;
  }
}

/// Runs so many replicas in lanes and each alone, which are the same. Returns the results of those
/// alone.
std::vector<RunResult> expect_as_alone(const LaneCase& one, const RunOptions& options,
                                       int replicas) {
  const std::vector<Ended> ended =
      in_lanes(one, replicas, static_cast<std::size_t>(replicas), options);
  std::vector<RunResult> results;
  for (int k = 0; k < replicas; ++k) {
    Ended expected = alone(one, k, options);
    const RunResult& here = ended[static_cast<std::size_t>(k)].result;
    expect_same(one, expected, ended[static_cast<std::size_t>(k)], "replica " + std::to_string(k));
    EXPECT_EQ(expected.result.refused_steps, here.refused_steps);
    EXPECT_EQ(expected.result.failure.has_value(), here.failure.has_value());
    if (expected.result.failure && here.failure) {
      EXPECT_EQ(to_string(*expected.result.failure), to_string(*here.failure));
    }
    results.push_back(std::move(expected.result));
  }
  return results;
}

TEST(LaneBatch, RunsHaveTheBitsOfSingleRuns) {
  for (const LaneCase& one : lane_cases()) {
    for (const RunResult& result : expect_as_alone(one, asked_for(one), 9)) {
      EXPECT_EQ(result.status, RunStatus::finished) << one.name;
    }
  }
}

const std::vector<std::string> kWithHeat = {
    "tip",           "tip_damped_first", "midpoint_tip", "loaded_tip", "watched_tip",
    "flexible_ring", "rigid_ring",       "chain",        "dumbbells"};

/// The energy balance of a short run is that of all its steps: heats are integrated in lanes, too.
TEST(LaneBatch, ShortRunsKeepALedgerInLanes) {
  for (const std::string& name : kWithHeat) {
    LaneCase one = lane_case(name);
    one.text = [text = one.text](int k) {  // of fewer than 1024 steps
      std::string all = text(k);
      const std::size_t run = all.find("[run]");
      const std::size_t from = all.find("duration = ", run) + 11;
      const std::size_t end = all.find('\n', from);
      const double fewer = 0.3 * std::stod(all.substr(from, end - from));
      return all.replace(from, end - from, digits(fewer));
    };
    RunOptions options = asked_for(one);
    options.watches_energy = true;
    expect_as_alone(one, options, 9);
  }
}

TEST(LaneBatch, TheLedgerOfASceneIsKeptInLanes) {
  for (const std::string& name : kWithHeat) {
    LaneCase one = lane_case(name);
    if (one.observables == kWatched) continue;  // a ledger needs kernels that show no steps
    one.text = [text = one.text](int k) {
      std::string with_ledger = text(k);
      return with_ledger.insert(with_ledger.find("[run]\n") + 6, "ledger = true\n");
    };
    one.observables.insert(one.observables.end(), {"energy.heat_out", "energy.numerical_work"});
    expect_as_alone(one, asked_for(one), 5);
  }
}

TEST(LaneBatch, AnyNumberOfLanesGivesTheSame) {
  const LaneCase& one = lane_case("rigid_ring");
  const RunOptions options = asked_for(one);
  constexpr int kReplicas = 8;
  std::vector<Ended> expected;
  for (int k = 0; k < kReplicas; ++k) expected.push_back(alone(one, k, options));
  for (std::size_t lanes = 1; lanes <= kReplicas; ++lanes) {
    const std::vector<Ended> ended = in_lanes(one, kReplicas, lanes, options);
    for (std::size_t k = 0; k < ended.size(); ++k) {
      expect_same(one, expected[k], ended[k], std::to_string(lanes) + " lanes");
    }
  }
}

TEST(LaneBatch, OnEveryInstructionSet) {
  for (const LaneCase& one : lane_cases()) {
    RunOptions options = asked_for(one);
    options.instruction_set = InstructionSet::baseline;
    constexpr int kReplicas = 3;
    std::vector<Ended> expected;
    for (int k = 0; k < kReplicas; ++k) expected.push_back(alone(one, k, options));
    for (const InstructionSet set :
         {InstructionSet::baseline, InstructionSet::avx2, InstructionSet::avx512}) {
      if (!is_supported(set)) continue;
      options.instruction_set = set;
      const std::vector<Ended> ended = in_lanes(one, kReplicas, kReplicas, options);
      for (std::size_t k = 0; k < ended.size(); ++k) {
        expect_same(one, expected[k], ended[k], "replica " + std::to_string(k));
      }
    }
  }
}

/// A driver that runs away at a step of its own, in the middle of a block, and at the first of one.
TEST(LaneBatch, ARunThatFailsStaysAsItWasAndDisturbsNoOther) {
  const auto text = [](int k) {
    TipScene tip{.velocity = 0.3, .duration = 40.0};
    if (k % 3 == 1) tip.velocity = own(k, 300.0, 900.0);
    if (k == 4) tip.stiffness = 1e7;  // unstable at once
    return tip.text();
  };
  for (const LaneCase& one :
       {LaneCase{"failing", text}, LaneCase{"failing_watched", text, kWatched},
        LaneCase{"failing_loaded", [&](int k) { return with_load(text(k), k); }, kWatched}}) {
    int failed = 0;
    for (const RunResult& result : expect_as_alone(one, asked_for(one), 8)) {
      failed += result.failure ? 1 : 0;
    }
    EXPECT_GE(failed, 2);
    EXPECT_LT(failed, 8);
  }
}

/// Samples of the energy balance are taken at the same steps, and lead to the same warnings.
TEST(LaneBatch, TheEnergyBalanceIsSampledAsInSingleRuns) {
  const std::vector<LaneCase> cases = {
      {"long_tip",
       [](int k) {
         TipScene tip{.velocity = own(k, 0.05, 0.4), .duration = 200.0 + k};

         tip.damping = k % 2 == 0 ? 1.0 : 0.0;
         return tip.text();
       }},
      {"long_verlet_tip",
       [](int k) {
         TipScene tip{.velocity = own(k, 0.05, 0.4), .duration = 200.0 + k};
         tip.integrator = verlet(0.01);
         return tip.text();
       }},
      {"long_overdamped_tip",
       [](int k) {
         TipScene tip{.velocity = own(k, 0.05, 0.4), .duration = 200.0 + k};
         tip.more = "dynamics = \"overdamped\"\n";
         return tip.text();
       }},
      {"long_adaptive_tip", [](int k) {
         TipScene tip{.velocity = own(k, 0.05, 0.4), .duration = 300.0 + k};
         tip.integrator = adaptive(k == 1 ? 1e-2 : 1e-8);
         return tip.text();
       }}};
  for (const LaneCase& one : cases) {
    RunOptions options = asked_for(one);
    options.watches_energy = true;
    expect_as_alone(one, options, 5);
  }
}

/// Adaptive schemes fail in ways of their own: steps too small, too many.
TEST(LaneBatch, AnAdaptiveRunThatFailsDisturbsNoOther) {
  const LaneCase one = {"failing", [](int k) {
                          TipScene tip{.velocity = own(k, 0.1, 0.5), .duration = 40.0};
                          std::string more;
                          if (k == 1) more = ", smallest_step = 0.3, initial_step = 0.3";
                          if (k == 4) more = ", most_steps = 37";
                          tip.integrator =
                              "{ type = \"dopri5\", absolute_tolerance = 1e-9, "
                              "relative_tolerance = 1e-9" +
                              more + " }";
                          return tip.text();
                        }};
  const std::vector<RunResult> results = expect_as_alone(one, asked_for(one), 6);
  for (std::size_t k = 0; k < results.size(); ++k) {
    EXPECT_EQ(results[k].failure.has_value(), k == 1 || k == 4);
  }
}

/// Two runs in lanes: the first, of which 500 steps were taken alone, and its neighbour. Returns
/// the state of the first at its end. `spoil` may change the integers of a field before.
std::vector<std::byte> resumed_in_lanes(const LaneCase& one, const std::string& field = "",
                                        std::int64_t by = 0) {
  const RunOptions options = asked_for(one);
  Engine half(scene_of(one.text(0)), options);
  half.advance(500);
  Engine resumed(scene_of(one.text(0)), options);
  resumed.resume(half.state().to_bytes());
  if (!field.empty()) *resumed.state().integers(field) += by;
  Engine other(scene_of(one.text(1)), options);
  LaneBatch batch(resumed, 2);
  batch.add(resumed);
  batch.add(other);
  while (!batch.is_empty()) batch.advance();
  resumed.end();
  return resumed.state().to_bytes();
}

/// A resumed run goes into lanes and has the state of one alone; noise goes on with the numbers of
/// the step, of a run's own stream.
TEST(LaneBatch, NoiseDependsOnTheStepAndTheStreamAlone) {
  for (const char* name : {"flexible_ring", "thermal_tip", "thermal_tip_by_verlet",
                           "thermal_tip_in_the_plane", "thermal_rigid_ring", "thermal_slow_tip"}) {
    const LaneCase& one = lane_case(name);
    EXPECT_EQ(resumed_in_lanes(one), alone(one, 0, asked_for(one)).state) << name;
  }
  // Faults that this has to find: a counter that is off by one, a neighbour's stream.
  const LaneCase& tip = lane_case("thermal_tip");
  EXPECT_NE(resumed_in_lanes(tip, "baoab.step", 1), resumed_in_lanes(tip));
  const LaneCase other_stream = {"other stream", [&](int k) {
                                   std::string text = tip.text(0);
                                   const std::string stream = "stream = 0";
                                   if (k == 1) text.replace(text.find(stream), 10, "stream = 1");
                                   return text;
                                 }};
  const std::vector<Ended> two = in_lanes(other_stream, 2, 2, asked_for(tip));
  EXPECT_NE(two[0].state, two[1].state);
}

/// `repeats` of a run: in lanes where only a mean is asked for, one by one where events are, too.
TEST(LaneBatch, RepeatsHaveTheMeanAndTheErrorOfRunsOneByOne) {
  std::string text = thermal(tip_of(0), 0, "baoab", 0.02);
  text.insert(text.find("[run]\n") + 6, "repeats = 12\n");
  RunOptions mean;
  mean.observables = {"driver.mean_force.x"};
  ASSERT_EQ(Engine(scene_of(text), mean).in_lanes().why_not(), "");
  ASSERT_NE(Engine(scene_of(text), {}).in_lanes().why_not(), "");
  const RunResult together = run(scene_of(text), mean);
  const RunResult apart = run(scene_of(text), {});
  EXPECT_EQ(observable(together, "driver.mean_force.x"), observable(apart, "driver.mean_force.x"));
  const std::string path = "drivers.driver.mean_force.x";
  EXPECT_GT(stated_error(apart, path).value_or(0.0), 0.0);
  EXPECT_EQ(stated_error(together, path), stated_error(apart, path));
}

/// The watched tips that are compared do slip.
TEST(LaneBatch, WatchedTipsSlip) {
  for (const char* const name : {"watched_tip", "watched_loaded_tip"}) {
    const LaneCase& one = lane_case(name);
    double slips = 0.0;
    for (int k = 0; k < 9; ++k) {
      slips += *observable(alone(one, k, asked_for(one)).result, "events.slips");
    }
    EXPECT_GT(slips, 9.0) << name;
  }
}

/// The comparison above has to find another replica's numbers, or a last digit.
TEST(LaneBatch, ADifferenceIsSeen) {
  const LaneCase& one = lane_case("tip");
  const RunOptions options = asked_for(one);
  const std::vector<Ended> ended = in_lanes(one, 2, 2, options);
  EXPECT_NE(ended[0].state, ended[1].state);
  const LaneCase last_digit = {"last digit", [&one](int k) {
                                 std::string text = one.text(0);
                                 if (k == 1)
                                   text.replace(text.find("0.01 }"), 6, "0.010000000000000002 }");
                                 return text;
                               }};
  EXPECT_NE(alone(last_digit, 0, options).state, alone(last_digit, 1, options).state);
  // Another step is another batch.
  Engine like(scene_of(last_digit.text(0)), options);
  Engine differs(scene_of(last_digit.text(1)), options);
  EXPECT_FALSE(LaneBatch(like, 2).fits(differs));
}

/// A tip on a spring, damped, on a sinusoidal substrate has a kernel with all of it.
TEST(LaneBatch, StepsOfATipAreTakenInRegisters) {
  const auto block_of = [](const std::string& name) -> LaneBlock {
    Engine engine(scene_of(lane_case(name).text(0)), asked_for(lane_case(name)));
    const LaneBlockFinder find = engine.context().scheme.lane_block;
    if (find == nullptr) return nullptr;
    std::vector<Kernel<double>> forces;
    for (const LaneCall& call : engine.model().assembly().lane_calls()) {
      forces.push_back(call.form.kernel);
    }
    return find(engine.model().system(), forces);
  };
  for (const char* const name : {"tip", "tip_damped_first", "midpoint_tip", "watched_tip"}) {
    EXPECT_NE(block_of(name), nullptr) << name;
  }
  EXPECT_NE(block_of("tip"), block_of("tip_damped_first"));
  EXPECT_NE(block_of("tip"), block_of("midpoint_tip"));
  for (const char* const name : {"loaded_tip", "adaptive_tip", "chain", "rigid_ring"}) {
    EXPECT_EQ(block_of(name), nullptr) << name;
  }
}

/// A kernel of steps in registers with a fault, which stands behind the valid one.
using Spoil = bool (*)(const SystemView<double>& lanes, std::size_t steps, const LaneRows& rows,
                       bool valid);

LaneBlock& valid_block() {
  static LaneBlock block = nullptr;
  return block;
}

template <Spoil spoil>
LaneBlock spoilt_block_of(const System<double>& run, std::span<const Kernel<double>> forces) {
  valid_block() = standard().integrator("rk4")->lane_block(run, forces);
  return [](const SystemView<double>& lanes, double h, std::size_t steps, const LaneRows& rows) {
    return spoil(lanes, steps, rows, valid_block()(lanes, h, steps, rows));
  };
}

bool last_digit(const SystemView<double>& lanes, std::size_t steps, const LaneRows& rows,
                bool valid) {
  double& velocity = rows.velocities[steps * lanes.dofs + 1];
  velocity = std::nextafter(velocity, 1e9);
  return valid;
}
bool integral_of_neighbour(const SystemView<double>&, std::size_t, const LaneRows& rows,
                           bool valid) {
  rows.integrals[1] = rows.integrals[0];
  return valid;
}
bool force_of_neighbour(const SystemView<double>& lanes, std::size_t, const LaneRows& rows,
                        bool valid) {
  rows.rates[5 * lanes.rates + 1] = rows.rates[5 * lanes.rates];
  return valid;
}
bool failure_unseen(const SystemView<double>&, std::size_t, const LaneRows&, bool) { return true; }

Registry with_block(LaneBlockFinder finder) {
  Registry registry;
  for (const auto& body : standard().bodies()) registry.add(*body);
  for (const auto& force : standard().forces()) registry.add(*force);
  IntegratorRecord scheme = *standard().integrator("rk4");
  scheme.lane_block = finder;
  registry.add(std::move(scheme));
  return registry;
}

TEST(LaneBatch, AFaultOfAKernelInRegistersIsSeen) {
  const LaneCase& watched = lane_case("watched_tip");
  const LaneCase failing = {"failing", [](int k) {
                              TipScene tip{.velocity = 0.3, .duration = 40.0};
                              if (k == 1) tip.velocity = 600.0;
                              return tip.text();
                            }};
  struct Planted {
    LaneBlockFinder finder;
    const LaneCase& one;
  };
  for (const Planted& planted : {Planted{&spoilt_block_of<last_digit>, watched},
                                 Planted{&spoilt_block_of<integral_of_neighbour>, watched},
                                 Planted{&spoilt_block_of<force_of_neighbour>, watched},
                                 Planted{&spoilt_block_of<failure_unseen>, failing}}) {
    const RunOptions options = asked_for(planted.one);
    const Registry registry = with_block(planted.finder);
    const std::vector<Ended> ended = in_lanes(planted.one, 3, 3, options, registry);
    EXPECT_EQ(ended[0].state, alone(planted.one, 0, options).state);
    EXPECT_NE(ended[1].state, alone(planted.one, 1, options).state);
  }
}

TEST(LaneBatch, StructuresThatDifferDoNotFit) {
  const RunOptions options = asked_for(lane_case("tip"));
  RingScene ring;
  Engine like(scene_of(ring.text()), options);
  LaneBatch batch(like, 8);
  RingScene more = ring;
  more.count = 9;
  RingScene rigid = ring;
  rigid.coordinates = "rigid";
  RingScene midpoint = ring;
  midpoint.integrator = "{ type = \"midpoint\", dt = 0.002 }";
  RingScene stiff = ring;
  stiff.bonds = 700.0;
  for (const RingScene& other : {more, rigid, midpoint}) {
    Engine engine(scene_of(other.text()), options);
    EXPECT_FALSE(batch.fits(engine));
  }
  Engine fits(scene_of(stiff.text()), options);
  EXPECT_TRUE(batch.fits(fits));
}

TEST(LaneBatch, WhatARunTakesByItselfHasAReason) {
  const auto reason = [](const std::string& text, const std::vector<std::string>& observables) {
    RunOptions options;
    options.observables = observables;
    return Engine(scene_of(text), options).in_lanes().why_not();
  };
  const std::vector<std::string> mean = {"driver.mean_force.x"};
  EXPECT_EQ(reason(TipScene{}.text(), mean), "");
  EXPECT_EQ(reason(TipScene{}.text(), {"events.slips"}), "");
  EXPECT_EQ(reason(with_load(TipScene{}.text(), 0), {"events.slips"}), "");
  EXPECT_NE(reason(ring_of(0, "rigid"), {"events.slips"}), "");
  EXPECT_NE(reason(TipScene{.integrator = adaptive(1e-8)}.text(), {"events.slips"}), "");
  EXPECT_NE(reason(TipScene{}.text(), {"driver.force_deviation.x"}), "");
  EXPECT_EQ(reason(TipScene{.integrator = adaptive(1e-8)}.text(), mean), "");
  EXPECT_EQ(reason(TipScene{.integrator = verlet(0.01)}.text(), mean), "");
  const std::string warm = thermal(tip_of(0), 0, "baoab", 0.02);
  EXPECT_EQ(reason(warm, mean), "");
  EXPECT_NE(reason(warm, {"events.slips"}), "");
  const std::string remembering = "type = \"memory_damping\"\nmemory_time = 0.5";
  std::string coloured = warm;
  coloured.replace(coloured.find("type = \"langevin\""), 17, remembering);
  EXPECT_EQ(reason(coloured, mean), "forces have internal variables");
  EXPECT_EQ(
      reason(thermal(ring_of(0, "rigid"), 0, "leimkuhler_matthews", 0.002, kOverdamped), mean),
      "bodies are prescribed, or rigid ones move without inertia");
  EXPECT_NE(reason(TipScene{.more = "number_type = \"quadruple\"\n"}.text(), mean), "");
  EXPECT_EQ(reason(TipScene{.more = "ledger = true\n"}.text(), mean), "");
  // A run that is short keeps a ledger of its own, and the drag of a formula has no kernel.
  std::string by_formula = tip_of(0);
  const std::string drag = "type = \"viscous_damping\"\ncoefficient";
  by_formula.replace(by_formula.find(drag), drag.size(),
                     "type = \"expression\"\nforce = [\"-0.5*vx\"]\n# coefficient");
  EXPECT_NE(reason(by_formula, mean), "");
}

}  // namespace
}  // namespace tomlin::test
