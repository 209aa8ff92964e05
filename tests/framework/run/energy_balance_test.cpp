#include "framework/run/guard/energy_balance.hpp"

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "forcefields/sinusoidal_substrate.hpp"
#include "tests/forcefields/planted.hpp"
#include "tests/support/ring_scenes.hpp"
#include "tests/support/spoilt_registry.hpp"

// Runs without a ledger know from a sample of their steps whether their energy balance closes.

namespace tomlin::test {
namespace {

/// Standard errors that a sample may be off: with these seeds and so many scenes 3 come up.
constexpr double kErrors = 4.0;
/// Relative to the work: if every step is sampled, only rounding is left, far below this.
constexpr double kRounding = 1e-7;

bool warned(const RunResult& result) {
  return count_of(FaultCode::run_energy_balance, result.warnings) > 0;
}

struct Case {
  std::string name;
  std::string text;
};

TipScene tip_with(const std::string& integrator, double duration, const std::string& more = "") {
  return {.stiffness = 0.7,
          .damping = 0.3,
          .amplitude = 0.3,
          .duration = duration,
          .integrator = integrator,
          .more = more};
}

std::string with_noise(std::string text) {
  const std::string friction = "type = \"viscous_damping\"\n";
  return text.replace(text.find(friction), friction.size(),
                      "type = \"langevin\"\ntemperature = 0.01\n");
}

/// Stick-slip of a tip and of rings with steps from sensible to coarse.
std::vector<Case> cases() {
  std::vector<Case> all;
  const auto add_tip = [&](const std::string& integrator, const std::string& more,
                           double duration = 80.0) {
    const TipScene tip = tip_with(integrator, duration, more);
    all.push_back({"tip, " + integrator + ", " + more, tip.text()});
  };
  for (const double dt : {0.02, 0.1, 0.3, 0.4}) add_tip(fixed_step(dt), "");
  for (const double dt : {0.05, 0.3}) {
    for (const char* type : {"velocity_verlet", "baoab", "gjf"}) add_tip(held_to(type, dt), "");
  }
  for (const char* type : {"baoab", "gjf"}) {
    add_tip(held_to(type, 0.05), "");
    all.back().name += ", with noise";
    all.back().text = with_noise(all.back().text);
  }
  // Other schemes are looked into now and then, for which a run has to be long enough.
  for (const double dt : {0.02, 0.05})
    add_tip(fixed_step(dt), "dynamics = \"overdamped\"\n", 800.0);
  for (const double tolerance : {1e-6, 1e-2}) add_tip(adaptive(tolerance), "", 400.0);
  add_tip(adaptive(1e-4, "radau9"), "", 400.0);
  add_tip(adaptive(1e-6, "dop853"), "", 400.0);
  add_tip(fixed_step(0.3), "number_type = \"quadruple\"\n", 400.0);
  for (const std::string coordinates : {"particles", "rigid"}) {
    const RingScene ring{.coordinates = coordinates,
                         .duration = 40.0,
                         .integrator = fixed_step(coordinates == "rigid" ? 0.1 : 0.01)};
    all.push_back({"ring, " + coordinates, ring.text()});
  }
  return all;
}

std::string with_ledger(std::string text) {
  return text.replace(text.find("[run]\n"), 6, "[run]\nledger = true\n");
}

/// A sample agrees with the ledger within its own uncertainty, and sampling changes nothing that it
/// looks at.
TEST(EnergyBalance, OfASampleIsThatOfTheLedger) {
  for (const Case& one : cases()) {
    SCOPED_TRACE(one.name);
    const auto scene = scene_of(one.text);
    Engine engine(scene, {});
    const RunResult watched = engine.run();
    ASSERT_EQ(watched.status, RunStatus::finished);
    const std::optional<SampledWork> found = engine.context().outcome.sampled_work;
    ASSERT_TRUE(found);
    const ResultGroup exact = run_text(with_ledger(one.text)).group("energy");
    EXPECT_NEAR(found->numerical, *exact["numerical_work"],
                kErrors * found->uncertainty + kRounding * *exact["work_in"]);
    EXPECT_GT(found->work, 0.5 * *exact["work_in"]);
    EXPECT_LT(found->work, 2.0 * *exact["work_in"]);

    RunOptions blind;
    blind.watches_energy = false;
    const RunResult alone = run_as_bound(scene, blind);
    EXPECT_EQ(alone.steps, watched.steps);
    EXPECT_EQ(alone.force_evaluations, watched.force_evaluations);
    EXPECT_EQ(alone.driver(0)["mean_force"], watched.driver(0)["mean_force"]);
    EXPECT_EQ(alone.body(0)["centre_of_mass"], watched.body(0)["centre_of_mass"]);
    EXPECT_EQ(alone.body(0)["velocity"], watched.body(0)["velocity"]);
  }
}

/// Steps that are too long for what they should resolve are warned of, with and without a ledger,
/// and good ones are not.
TEST(EnergyBalance, ThatDoesNotCloseIsWarnedOf) {
  for (const auto& [type, longest] : {std::pair("rk4", 0.4), std::pair("velocity_verlet", 0.3)}) {
    for (const bool coarse : {false, true}) {
      const TipScene tip = tip_with(held_to(type, coarse ? longest : 0.1), 80.0);
      SCOPED_TRACE(tip.integrator);
      EXPECT_EQ(warned(run_text(tip.text())), coarse);
      EXPECT_EQ(warned(run_text(with_ledger(tip.text()))), coarse);
    }
  }
}

/// A substrate that pulls on beside its energy, by so many thousandths of its slope. One part in a
/// hundred is less than the twentieth that a coarse fixed step may cost.
template <int thousandths>
struct PullsOn : SinusoidalSubstrate {
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    Vec<T, D> force = SinusoidalSubstrate::force(p, site);
    force[0] = force[0] + T(0.001 * thousandths) * p.slope;
    return force;
  }
};

/// Runs of a scene with a registry that is spoilt and with a valid one are warned of, and are not.
void expect_warned_of(const SpoiltRegistry& spoilt, const std::string& text) {
  static const SpoiltRegistry valid("sinusoidal_substrate", planted<SinusoidalSubstrate>);
  EXPECT_TRUE(warned(run(parse_scene(text, "test.toml", spoilt.registry()), {})));
  EXPECT_FALSE(warned(run(parse_scene(text, "test.toml", valid.registry()), {})));
}

/// An adaptive scheme says how exact it is, and its numerical work is held against that.
TEST(EnergyBalance, OfAnAdaptiveSchemeIsHeldAgainstItsTolerance) {
  const SpoiltRegistry spoilt("sinusoidal_substrate", planted<PullsOn<10>>);
  for (const char* type : {"dopri5", "dop853"}) {
    for (const double tolerance : {1e-7, 1e-9, 1e-12}) {
      const TipScene tip = tip_with(adaptive(tolerance, type), 80.0);
      SCOPED_TRACE(tip.integrator);
      expect_warned_of(spoilt, with_ledger(tip.text()));
      EXPECT_FALSE(warned(run_text(tip.text())));
    }
  }
}

/// Friction that a scheme splits off heats most within its steps, also where nothing is driven.
TEST(EnergyBalance, OfLongStepsWithSplitFrictionCloses) {
  for (const char* type : {"velocity_verlet", "baoab", "gjf"}) {
    const std::string text =
        "[[body]]\ntype = \"point\"\nposition = [0.0]\nparticle_mass = 1.0\n[[force]]\ntype = "
        "\"constant_force\"\nforce = [1.0]\n[[force]]\ntype = \"viscous_damping\"\n"
        "coefficient = 1.0\n[run]\nduration = 1e4\nallow_unstable = true\nintegrator = " +
        held_to(type, 1.0) + "\n";
    Engine engine(scene_of(text), {});
    EXPECT_FALSE(warned(engine.run())) << type;
    ASSERT_TRUE(engine.context().outcome.sampled_work) << type;
    EXPECT_NEAR(engine.context().outcome.sampled_work->numerical, 0.0,
                kRounding * engine.context().outcome.sampled_work->heat);
  }
}

/// A steady torque by a formula puts in what a drag takes out: net heat is rounding, and without
/// inertia no energy is stored that it would be small beside.
TEST(EnergyBalance, IsHeldAgainstFlowsAndNotTheirDifference) {
  const auto spun = [](const std::string& integrator, bool ledger) {
    const std::string text =
        "[[body]]\nname = \"ring\"\ntype = \"ring\"\nradius = 1.0\ncount = 8\n"
        "particle_mass = 0.125\ncentre = [0.0, 0.0]\ncoordinates = \"rigid\"\n"
        "hold = [\"x\", \"y\"]\n[[force]]\ntype = \"viscous_damping\"\ncoefficient = 0.3\n"
        "[[force]]\ntype = \"expression\"\nforce = [\"-0.2*y\", \"0.2*x\"]\n"
        "[run]\nduration = 300.0\ndynamics = \"overdamped\"\nintegrator = " +
        integrator + "\n[measure]\nfrom = 200.0\nto = 300.0\n";
    return warned(run_text(ledger ? with_ledger(text) : text));
  };
  for (const bool ledger : {false, true}) {
    EXPECT_FALSE(spun("{ type = \"midpoint\", dt = 0.013 }", ledger));
    EXPECT_FALSE(spun(adaptive(1e-8), ledger));
  }
}

/// A ledger of the run's own finds it, and so do samples of single steps.
TEST(EnergyBalance, FindsAForceThatIsNotTheSlopeOfItsEnergy) {
  const SpoiltRegistry spoilt("sinusoidal_substrate", planted<PullsOn<200>>);
  for (const std::string& integrator :
       {held_to("rk4", 0.01), held_to("velocity_verlet", 0.01), held_to("baoab", 0.01),
        held_to("gjf", 0.01), adaptive(1e-6), adaptive(1e-8), adaptive(1e-6, "dop853")}) {
    SCOPED_TRACE(integrator);
    const TipScene tip =
        tip_with(integrator, integrator.find("dop") == std::string::npos ? 160.0 : 640.0);
    for (const std::string& text : {tip.text(), with_ledger(tip.text())}) {
      expect_warned_of(spoilt, text);
    }
  }
}

/// A substrate that counts what is asked of it.
struct Counted : SinusoidalSubstrate {
  static inline std::size_t forces = 0;
  static inline std::size_t energies = 0;

  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    ++forces;
    return SinusoidalSubstrate::force(p, site);
  }
  template <class T, int D>
  static T energy(const Parameters<T, D>& p, const Site<T, D>& site) {
    ++energies;
    return SinusoidalSubstrate::energy(p, site);
  }
};

/// The balance costs at most a twentieth of the evaluations of a run, however short it is; of
/// adaptive ones not much more than a look into one step, before it is known how many there are.
TEST(EnergyBalance, IsWatchedByFewEvaluations) {
  constexpr double kPart = 0.05;
  constexpr double kOneLook = 12.0;
  struct Watched {
    std::string integrator;
    std::string more;
    int fewest;  ///< steps that are looked at
    double more_evaluations = 0.0;
  };
  const SpoiltRegistry counting("sinusoidal_substrate", planted<Counted>);
  for (const Watched& one :
       {Watched{held_to("rk4", 0.1), "", 100}, Watched{held_to("velocity_verlet", 0.1), "", 100},
        Watched{held_to("baoab", 0.1), "", 100},
        Watched{held_to("rk4", 0.02), "dynamics = \"overdamped\"\n", 1000},
        Watched{adaptive(1e-6), "", 1000, kOneLook},
        Watched{adaptive(1e-6, "dop853"), "", 1000, kOneLook},
        Watched{adaptive(1e-6, "radau9"), "", 1000, kOneLook}}) {
    for (const int steps : {100, 256, 1000, 10000}) {
      SCOPED_TRACE(one.integrator + one.more + std::to_string(steps));
      const TipScene tip = tip_with(
          one.integrator, (one.more.starts_with("dynamics") ? 0.02 : 0.1) * steps, one.more);
      const auto scene = parse_scene(tip.text(), "test.toml", counting.registry());
      std::size_t evaluations[2] = {};
      for (const bool watched : {false, true}) {
        Counted::forces = Counted::energies = 0;
        RunOptions options;
        options.watches_energy = watched;
        EXPECT_EQ(run_as_bound(scene, options).status, RunStatus::finished);
        evaluations[watched ? 1 : 0] = Counted::forces + Counted::energies;
      }
      EXPECT_LE(static_cast<double>(evaluations[1] - evaluations[0]),
                kPart * static_cast<double>(evaluations[0]) + one.more_evaluations);
      if (steps >= one.fewest) {
        EXPECT_GT(evaluations[1], evaluations[0]);
      }
    }
  }
}

/// A run that is stopped while it keeps a ledger goes on as if it had not been.
TEST(EnergyBalance, IsResumedWithinABlock) {
  for (const std::string& integrator :
       {held_to("rk4", 0.3), held_to("velocity_verlet", 0.3), adaptive(1e-8)}) {
    const TipScene tip = tip_with(integrator, 40.0);
    const auto scene = scene_of(tip.text());
    Engine whole(scene, {});
    whole.run();
    for (const std::uint64_t stopped_after : {1U, 2U, 16U, 50U, 64U, 99U}) {
      SCOPED_TRACE(integrator + std::to_string(stopped_after));
      Engine first(scene, {});
      first.advance(stopped_after);
      Engine second(scene, {});
      second.resume(first.state().to_bytes());
      second.run();
      ASSERT_TRUE(second.context().outcome.sampled_work && whole.context().outcome.sampled_work);
      EXPECT_EQ(second.context().outcome.sampled_work->numerical,
                whole.context().outcome.sampled_work->numerical);
      EXPECT_EQ(second.context().outcome.sampled_work->heat,
                whole.context().outcome.sampled_work->heat);
    }
  }
}

/// Without friction and drivers the kinetic energy is what numerical work is held against; that of
/// a symplectic scheme comes and goes.
TEST(EnergyBalance, OfWhatIsLeftAlone) {
  const auto left_alone = [](const std::string& integrator, double duration = 200.0) {
    return "[[body]]\nname = \"tip\"\ntype = \"point\"\nparticle_mass = 1.0\nposition = [0.2]\n"
           "velocity = [3.0]\n[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = 0.5\n"
           "period = 1.0\n[run]\nduration = " +
           digits(duration) + "\nintegrator = " + integrator + "\n";
  };
  EXPECT_FALSE(warned(run_text(left_alone(verlet(0.02)))));
  EXPECT_FALSE(warned(run_text(left_alone(fixed_step(0.02)))));
  // A few blocks of a long run: what comes and goes does not cancel, and is no more than chance.
  for (const double duration : {1e4, 1.3e4, 1.7e4}) {
    EXPECT_FALSE(warned(run_text(left_alone(verlet(0.05), duration))));
  }
  EXPECT_TRUE(warned(run_text(left_alone(fixed_step(0.2)))));
}

/// The balance holds in any number type, with internal variables and prescribed motions.
TEST(EnergyBalance, OfPrescribedWaysInEveryNumberTypeIsKept) {
  for (const char* type : {"double", "quadruple"}) {
    SCOPED_TRACE(type);
    const RunResult found = run_text(R"--(
body = [
  { name = "hand", type = "point", coordinates = "prescribed", position = [0.0, 0.0, 0.0], particle_mass = 1.0, motion = { velocity = ["0.1 + cos(0.5*t)", "0", "0"] } },
  { name = "tip", type = "point", position = [1.0, 0.0, 0.0], particle_mass = 1.0 },
]
force = [
  { type = "harmonic_bonds", bodies = ["hand", "tip"], pairs = [[0, 0]], stiffness = 10.0 },
  { type = "viscous_damping", body = "tip", coefficient = 1.0 },
]
run = { duration = 60.0, integrator = { type = "rk4", dt = 0.01 }, number_type = ")--" +
                                     std::string(type) + "\" }\n");
    EXPECT_FALSE(warned(found));
  }
}

}  // namespace
}  // namespace tomlin::test
