// Formulas that differ between the particles of a body: over the particle's index, the count of
// particles, and random numbers of these.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "framework/core/formula/formula.hpp"
#include "framework/core/system/aligned.hpp"
#include "framework/core/system/instruction_set.hpp"
#include "framework/model/properties.hpp"
#include "framework/run/engine.hpp"
#include "framework/run/results/observables.hpp"
#include "tests/support/faults.hpp"
#include "tests/support/scenes.hpp"

namespace tomlin::test {
namespace {

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size())) {
    text.replace(at, what.size(), by);
  }
  return text;
}

// ---- each particle as it is alone ---------------------------------------------------------------

constexpr int kTips = 11;  // more than one group of eight, and no multiple of it

/// Laws in which INDEX stands for the index; on a line and in a plane, with everything that a
/// formula may depend on.
struct LawOfTips {
  const char* what;
  int dimension;
  std::string law;
};

const std::vector<LawOfTips>& laws_of_tips() {
  static const std::vector<LawOfTips> all = {
      {"disordered wave", 1,
       "energy = \"V0 * (1 + 0.2*normal(7, INDEX)) * cos(2*pi*(x/a + random(3, INDEX)))\"\n"
       "period = \"a\"\n"},
      {"index alone", 1, "energy = \"0.01 * INDEX * x^4 + x^2 / (1 + INDEX)\"\n"},
      {"power of a wave", 1, "energy = \"V0*abs(2 + cos(2*pi*x/a))^(1 + 0.1*INDEX)\"\n"},
      {"in time", 1, "energy = \"V0 * (x - 0.3*sin(t + random(1, INDEX)))^2\"\n"},
      {"force", 1,
       "force = [\"-(1 + random(1, INDEX))*x - 0.1*normal(2, INDEX)^2*vx + 0.1*INDEX*cos(t)\"]\n"},
      {"force of nothing else", 1, "force = [\"0.1 * normal(5, INDEX)\"]\n"},
      {"wave in a plane", 2,
       "energy = \"V0 * random(1, INDEX) * exp(-(1 + 0.1*INDEX) * y^2) * cos(2*pi*(x/a + "
       "random(3, INDEX)))\"\nperiod = \"a\"\n"},
      {"force in a plane", 2,
       "force = [\"-x + 0.1*INDEX*vy\", \"-y*(1 + random(1, INDEX)) - 0.1*INDEX*vx\"]\n"},
  };
  return all;
}

/// Tips from one on, all in the first period, with the law's INDEX as given.
std::string tips_under(const LawOfTips& law, int first, int count, const std::string& index,
                       const std::string& number_type, const std::string& integrator) {
  std::string positions;
  std::string velocities;
  for (int i = first; i < first + count; ++i) {
    const std::string more = law.dimension == 2 ? ", " + digits(0.4 - 0.05 * i) : "";
    const std::string speed = law.dimension == 2 ? ", 0.02" : "";
    positions += (i > first ? ", [" : "[[") + digits(0.05 + 0.03 * i) + more + "]";
    velocities += (i > first ? ", [" : "[[") + digits(0.01 * i) + speed + "]";
  }
  return "[parameters]\nV0 = 0.1\na = 1.25\n[[body]]\nname = \"tips\"\ntype = \"particles\"\n"
         "positions = " +
         positions + "]\nvelocity = " + velocities +
         "]\nparticle_mass = 1.5\n[[force]]\ntype = \"expression\"\n" +
         replaced(law.law, "INDEX", index) +
         "[run]\nduration = 2.0\nallow_unstable = true\nnumber_type = \"" + number_type +
         "\"\nintegrator = " + integrator + "\n";
}

/// Positions and velocities of particle i on all axes.
std::vector<double> motion_of(Engine& engine, int dimension, int particles, int i) {
  std::vector<double> numbers;
  for (const char* field : {"position", "velocity"}) {
    const std::vector<double> all = field_of(engine, field);
    const std::size_t stride = all.size() / static_cast<std::size_t>(dimension);
    EXPECT_EQ(stride, padded(static_cast<std::size_t>(particles)));
    for (int axis = 0; axis < dimension; ++axis) {
      numbers.push_back(all[static_cast<std::size_t>(axis) * stride + static_cast<std::size_t>(i)]);
    }
  }
  return numbers;
}

struct WayOfComputing {
  const char* number_type;
  const char* integrator;
};

/// Forces that depend on velocities, by schemes that would fall to first order.
bool is_refused(const LawOfTips& law, const std::string& integrator) {
  const bool by_velocity = law.law.starts_with("force") && law.law.find('v') != std::string::npos;
  return by_velocity && integrator.find("verlet") != std::string::npos;
}

class FormulaOfParticles : public testing::TestWithParam<WayOfComputing> {};

/// A particle alone has the index 0, and `i + 5` is what the sixth has among others: the same code
/// with the same numbers. On a line it moves in registers.
TEST_P(FormulaOfParticles, MovesEachAsOneAloneToTheLastBit) {
  const auto [number_type, integrator] = GetParam();
  for (const LawOfTips& law : laws_of_tips()) {
    SCOPED_TRACE(law.what);
    if (is_refused(law, integrator)) continue;
    Engine together(scene_of(tips_under(law, 0, kTips, "i", number_type, integrator)), {});
    ASSERT_EQ(together.run().status, RunStatus::finished);
    std::vector<std::vector<double>> ends;
    for (int i = 0; i < kTips; ++i) {
      SCOPED_TRACE(i);
      const std::string index = fmt::format("(i + {})", i);
      Engine alone(scene_of(tips_under(law, i, 1, index, number_type, integrator)), {});
      ASSERT_EQ(alone.run().status, RunStatus::finished);
      ends.push_back(motion_of(alone, law.dimension, 1, 0));
      EXPECT_TRUE(same_bits(motion_of(together, law.dimension, kTips, i), ends.back()));
    }
    EXPECT_FALSE(same_bits(ends[0], ends[1]));
  }
}

/// A number that is typed is a constant of the formula, which is simplified with it.
TEST_P(FormulaOfParticles, MovesEachAsOneAloneWithItsNumberTyped) {
  const auto [number_type, integrator] = GetParam();
  constexpr double kRounding = 1e-12;  // some hundred steps of motions without chaos
  for (const LawOfTips& law : laws_of_tips()) {
    SCOPED_TRACE(law.what);
    if (is_refused(law, integrator)) continue;
    Engine together(scene_of(tips_under(law, 0, kTips, "i", number_type, integrator)), {});
    together.run();
    for (int i = 0; i < kTips; i += 3) {
      SCOPED_TRACE(i);
      const std::string index = std::to_string(i);
      Engine alone(scene_of(tips_under(law, i, 1, index, number_type, integrator)), {});
      alone.run();
      const auto expected = motion_of(alone, law.dimension, 1, 0);
      const auto found = motion_of(together, law.dimension, kTips, i);
      for (std::size_t k = 0; k < expected.size(); ++k) {
        EXPECT_NEAR(found[k], expected[k], kRounding);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    InEveryNumberType, FormulaOfParticles,
    testing::Values(WayOfComputing{"double", "{ type = \"rk4\", dt = 0.01 }"},
                    WayOfComputing{"quadruple", "{ type = \"rk4\", dt = 0.05 }"},
                    WayOfComputing{"double", "{ type = \"velocity_verlet\", dt = 0.01 }"}));

// ---- closed forms, and built-in forces ----------------------------------------------------------

/// A tolerance of 1e-12 over a few oscillations.
constexpr double kClosedForm = 1e-9;

TEST(FormulaOfParticles, OscillatorsHaveTheirFrequencies) {
  Engine engine(scene_of(tables(R"--(
[[body]] | name = "tips" | type = "particles" | positions = [1.0, 1.0, 1.0, 1.0, 1.0]
particle_mass = 1.0
[[force]] | type = "expression" | energy = "2.5 * (1 + i/count)^2 * x^2 / count"
[run] | duration = 3.0 | integrator = )--") +
                         adaptive(1e-12, "dop853") + "\n"),
                {});
  engine.run();
  for (int i = 0; i < 5; ++i) {
    EXPECT_NEAR(motion_of(engine, 1, 5, i)[0], std::cos(3.0 * (1.0 + i / 5.0)), kClosedForm) << i;
  }
}

/// More than one block of the interpreter, bonds between, and all in the ledger.
std::string disordered_chain(const std::string& substrate, const std::string& run) {
  return tables(R"--(
[parameters] | V0 = 0.1 | a = 1.25 | seed = 3
[[body]] | type = "chain" | count = 150 | spacing = 1.0 | particle_mass = 1.0
[[force]] | type = "harmonic_bonds" | pairs = "neighbours" | stiffness = 1.0
rest_lengths = 1.0
[[force]] | name = "substrate"
)--") + substrate +
         "[run]\nduration = 10.0\nledger = true\nintegrator = " + run + "\n";
}

const std::string kDisorderedFormula =
    "type = \"expression\"\nperiod = \"a\"\n"
    "energy = \"V0 * (1 + 0.2*normal(7, i)) * cos(2*pi*(x/a - random(seed, i)))\"\n";
const std::string kDisorderedSubstrate =
    "type = \"sinusoidal_substrate\"\nperiod = \"a\"\namplitude = \"V0 * (1 + 0.2*normal(7, i))\"\n"
    "offset = \"a * random(seed, i)\"\n";

TEST(FormulaOfParticles, DisorderIsThatOfTheBuiltInSubstrate) {
  constexpr double kRounding = 1e-11;  // of two evaluations of the same law
  Engine formula(scene_of(disordered_chain(kDisorderedFormula, fixed_step(0.02))), {});
  Engine built_in(scene_of(disordered_chain(kDisorderedSubstrate, fixed_step(0.02))), {});
  const RunResult found = formula.run();
  const RunResult expected = built_in.run();
  ASSERT_EQ(found.status, RunStatus::finished);
  const auto position = field_of(formula, "position");
  const auto wanted = field_of(built_in, "position");
  double most = 0.0;
  for (std::size_t i = 0; i < 150; ++i) {
    EXPECT_NEAR(position[i], wanted[i], kRounding) << i;
    most = std::max(most, std::abs(wanted[i] - static_cast<double>(i)));
  }
  EXPECT_GT(most, 0.01);
  for (const char* path : {"energy.potential", "energy.kinetic"}) {
    EXPECT_NEAR(observable(found, path).value(), observable(expected, path).value(),
                150 * kRounding);
  }
}

TEST(FormulaOfParticles, EnergyIsConserved) {
  const RunResult result =
      run_text(disordered_chain(kDisorderedFormula, adaptive(1e-12, "dop853")));
  EXPECT_GT(observable(result, "energy.kinetic").value(), 0.1);
  EXPECT_NEAR(observable(result, "energy.numerical_work").value(), 0.0, kClosedForm);
}

/// Every verified property of a formula: force against differences of the energy, second
/// derivatives, heat, padding, kernels on all instruction sets, bounds and origins.
TEST(FormulaOfParticles, HasTheVerifiedProperties) {
  for (const LawOfTips& law : laws_of_tips()) {
    for (const int count : {1, kTips}) {
      for (const std::uint64_t seed : {1, 2}) {
        SCOPED_TRACE(fmt::format("{}, {} particles, seed {}", law.what, count, seed));
        const auto scene =
            scene_of(tips_under(law, 0, count, "i", "double", "{ type = \"rk4\", dt = 1e-3 }"));
        const auto results = check_properties(*scene, {.seed = seed});
        EXPECT_GT(results.size(), 10U);
        for (const PropertyResult& result : results) {
          EXPECT_TRUE(result.holds) << result.property << " " << result.error << " > "
                                    << result.allowed << "; " << result.worst.text();
        }
      }
    }
  }
}

// ---- same bits ----------------------------------------------------------------------------------

TEST(FormulaOfParticles, EveryInstructionSetHasTheSameBits) {
  const auto scene = scene_of(disordered_chain(kDisorderedFormula, fixed_step(0.02)));
  RunOptions baseline;
  baseline.instruction_set = InstructionSet::baseline;
  Engine plain(scene, baseline);
  plain.run();
  for (const InstructionSet set : {InstructionSet::avx2, InstructionSet::avx512}) {
    if (!is_supported(set)) continue;
    RunOptions options;
    options.instruction_set = set;
    Engine wide(scene, options);
    wide.run();
    EXPECT_EQ(plain.state().to_bytes(), wide.state().to_bytes());
  }
}

TEST(FormulaOfParticles, AResumedRunHasTheSameBits) {
  const auto scene = scene_of(disordered_chain(kDisorderedFormula, fixed_step(0.02)));
  Engine whole(scene, {});
  whole.run();
  Engine first(scene, {});
  first.advance(137);
  const std::vector<std::byte> numbers = first.state().to_bytes();
  // A resumed run has read the effective scene.
  Engine second(scene_of(scene->effective_toml), {});
  second.resume(numbers);
  second.run();
  EXPECT_TRUE(Motion(second) == Motion(whole));
}

/// Sums of energies run over the particles in one order: a wave of one phase for all is that wave.
TEST(FormulaOfParticles, RandomNumbersOfNoParticleAreOneForAll) {
  const auto ending = [](const std::string& number, const std::string& parameters) {
    Engine engine(
        scene_of("[parameters]\n" + parameters +
                 "[[body]]\ntype = \"chain\"\ncount = 5\nspacing = 0.9\n"
                 "particle_mass = 1.0\n[[force]]\ntype = \"expression\"\nenergy = "
                 "\"0.1*cos(2*pi*(x + " +
                 number + "))\"\n[run]\nduration = 5.0\nintegrator = " + fixed_step(0.01) + "\n"),
        {});
    engine.run();
    return field_of(engine, "position");
  };
  const auto drawn = ending("random(7, count - 2)", "");
  EXPECT_TRUE(same_bits(drawn, ending("number", "number = \"random(7, 3)\"\n")));
  EXPECT_FALSE(same_bits(drawn, ending("random(8, 3)", "")));
}

TEST(FormulaOfParticles, AParameterComesBeforeTheIndex) {
  const auto ending = [](const std::string& energy, const std::string& parameters) {
    Engine engine(
        scene_of(parameters +
                 "[[body]]\ntype = \"chain\"\ncount = 3\nspacing = 0.9\n"
                 "particle_mass = 1.0\n[[force]]\ntype = \"expression\"\nenergy = \"" +
                 energy + "\"\n[run]\nduration = 5.0\nintegrator = " + fixed_step(0.01) + "\n"),
        {});
    engine.run();
    return field_of(engine, "position");
  };
  const std::string both = "[parameters]\ni = 2.0\ncount = 4.0\n";
  EXPECT_TRUE(same_bits(ending("i*x^2/count", both), ending("2*x^2/4", "")));
  EXPECT_FALSE(same_bits(ending("i*x^2/count", both), ending("i*x^2/count", "")));
  // Over pairs they are parameters, too.
  EXPECT_TRUE(same_bits(ending("i*(r - 1)^2/count", both), ending("2*(r - 1)^2/4", "")));
}

// ---- bounds, periods, drivers -------------------------------------------------------------------

std::string held_to_its_bound(const std::string& body, const std::string& energy, double dt) {
  return "[[body]]\n" + body +
         "particle_mass = 1.0\n[[force]]\ntype = \"expression\"\nperiod = 1.0\nenergy = \"" +
         energy + "\"\n[run]\nduration = " + digits(3.0 * dt) + "\nintegrator = " + fixed_step(dt) +
         "\n";
}

/// The last of 300 particles is a million times as stiff: k = 0.1 (2 pi)^2 1e6, whose limit of rk4
/// is 2.8/2e3. Where it starts it has no curvature.
TEST(FormulaOfParticles, TheStableStepIsThatOfTheStiffestParticle) {
  const std::string chain = "type = \"chain\"\ncount = 300\nspacing = 1.0\n";
  const std::string wave = "0.1 * (1 + 1e6*floor((i + 1)/count)) * cos(2*pi*(x + 0.25))";
  const RunResult refused = run_text(held_to_its_bound(chain, wave, 2e-3));
  ASSERT_EQ(refused.status, RunStatus::failed);
  EXPECT_EQ(refused.failure->code, FaultCode::run_step_unstable);
  EXPECT_EQ(run_text(held_to_its_bound(chain, wave, 1e-3)).status, RunStatus::finished);
  for (const PropertyResult& result :
       check_properties(*scene_of(held_to_its_bound(chain, wave, 1e-3)), {.seed = 1})) {
    EXPECT_TRUE(result.holds) << result.property;
  }
}

/// The wave of particle 0 has no amplitude, which is looked at elsewhere in y, but not for other
/// numbers of the particle: rk4 is stable up to 2.8.
TEST(FormulaOfParticles, TheStableStepIsThatOfTheParticlesOwnNumbers) {
  const std::string point = "type = \"point\"\nposition = [0.3, 0.2]\n";
  EXPECT_EQ(run_text(held_to_its_bound(point, "i * cos(2*pi*x) + 0.5*y^2", 1.0)).status,
            RunStatus::finished);
}

TEST(FormulaOfParticles, ADriverOfEachParticleIsASupport) {
  const RunResult result = run_text(tables(R"--(
[[body]] | name = "chain" | type = "chain" | count = 9 | spacing = 1.0 | particle_mass = 1.0
[[force]] | type = "viscous_damping" | coefficient = 1.0
[[force]] | name = "driver" | type = "expression"
energy = "0.25 * (x - i - 0.1*normal(1, i) - 0.05*t)^2" | driver = true
[run] | duration = 20.0 | ledger = true | integrator = { type = "rk4", dt = 0.01 }
)--"));
  EXPECT_NEAR(observable(result, "driver.distance").value(), 1.0, 1e-12);
  EXPECT_GT(observable(result, "driver.work").value(), 0.1);
  EXPECT_NEAR(observable(result, "driver.work").value(),
              observable(result, "energy.work_in").value(), 1e-12);
  constexpr double kOrderFour = 1e-8;  // of rk4 with a step of 0.01
  EXPECT_NEAR(observable(result, "energy.numerical_work").value(), 0.0, kOrderFour);
}

// ---- faults -------------------------------------------------------------------------------------

std::string nine_under(const std::string& force) {
  return "[[body]]\nname = \"tips\"\ntype = \"chain\"\ncount = 9\nspacing = 0.5\norigin = [0.25]\n"
         "particle_mass = 1.0\n[[force]]\ntype = \"expression\"\n" +
         force + "\n[run]\nduration = 1.0\nintegrator = { type = \"rk4\", dt = 0.01 }\n";
}

TEST(FormulaOfParticles, FaultsHaveTheirPlace) {
  struct Case {
    std::string force;
    std::string brief;
    std::string says;
  };
  const std::string invalid = "[component.invalid]";
  const std::string not_finite = "[expression.not_finite]";
  const std::string unknown = "[expression.unknown_name]";
  const std::string belongs = "belongs to a particle";
  const std::vector<Case> cases = {
      {"energy = \"x^2*log(3 - i)\"", "10:15 energy " + not_finite, "log(0): only positive"},
      {"energy = \"x^2*log(3 - i)\"", "10:15 energy " + not_finite, "for particle 3"},
      {"force = [\"-x*log(i - 4)\"]", "10:14 force " + not_finite, "for particle 0"},
      {"energy = \"x/(i - 4)\"", "10:12 energy " + not_finite, "for particle 4 of \"tips\""},
      {"energy = \"x^2*random(1, 0.5*i)\"", "10:15 energy " + not_finite, "for particle 1"},
      {"energy = \"x^2*random(1, 0.5)\"", "10:15 energy " + not_finite, "integers"},
      {"energy = \"normal(2, x)\"", "10:11 energy " + invalid, belongs},
      {"energy = \"x*normal(2, i + t)\"", "10:13 energy " + invalid, belongs},
      {"force = [\"-x + random(floor(vx), i)\"]", "10:16 force " + invalid, belongs},
      {"energy = \"random(1, i)\"", "10:10 energy " + invalid, "no coordinate"},
      {"energy = \"xc^2*i\"", "10:16 energy " + unknown, "the centre of mass"},
      {"energy = \"r^2*i\"", "10:15 energy " + unknown, "pairs (r)"},
      {"energy = \"r^2/count\"", "10:15 energy " + unknown, "pairs (r)"},
      {"energy = \"random(1, r)\"", "10:11 energy " + invalid, "belongs to a particle"},
      {"energy = \"j*x\"", "10:11 energy " + unknown, "no parameter 'j'"},
      {"energy = \"cos(2*pi*x*(1 + 0.5*floor(i/8)))\"\nperiod = 1.0", "11:10 period " + invalid,
       "does not repeat"},
      {"energy = \"cos(2*pi*x)\"\nperiod = \"1 + i\"", "11:15 period " + unknown,
       "no parameter 'i'"},
  };
  for (const Case& one : cases) {
    SCOPED_TRACE(one.force);
    const std::string message = refusal(nine_under(one.force));
    EXPECT_NE(message.find(one.says), std::string::npos) << message;
    // Without the value, which is the text above.
    const std::string found = brief_refusal(nine_under(one.force));
    const auto value = std::min(found.find(" = "), found.rfind(" ["));
    EXPECT_EQ(
        replaced(found.substr(0, value) + found.substr(found.rfind(" [")), "force.expression.", ""),
        one.brief);
  }
  EXPECT_EQ(refusal(nine_under("energy = \"cos(2*pi*x*(1 + i))\"\nperiod = 1.0")), "");
}

TEST(FormulaOfParticles, ARunThatLeavesTheRangeOfOneParticleNamesIt) {
  const RunResult found =
      run_text(replaced(nine_under("energy = \"0.1*x + 1e-3*log(x + 0.1*(8 - i))\""),
                        "duration = 1.0", "duration = 100.0"));
  ASSERT_EQ(found.status, RunStatus::failed);
  EXPECT_NE(found.failure->cause.find("particle 0 of \"tips\""), std::string::npos)
      << found.failure->cause;
}

/// The text is checked for the first particles only; the kernels find the faults of the others.
TEST(FormulaOfParticles, APhaseThatIsLostNamesTheParticle) {
  const std::string text = replaced(nine_under("energy = \"0.1*cos(2*pi*(x + 1e17*floor(i/80)))\""),
                                    "count = 9", "count = 100");
  const std::string message = refusal(text);
  EXPECT_NE(message.find("particle 80 of \"tips\""), std::string::npos) << message;
  EXPECT_NE(message.find("no phase left"), std::string::npos) << message;
}

std::string sum_of_numbers(std::size_t terms) {
  std::string sum = "energy = \"x^2";
  for (std::size_t k = 0; k < terms; ++k)
    sum += fmt::format(" + normal({}, i)*cos({}*x)", k, k + 1);
  return sum + "\"";
}

TEST(FormulaOfParticles, ManyNumbersAreTakenAndMoreAreRefused) {
  const std::size_t most = FormulaLaw::kMostParticleNumbers;
  EXPECT_EQ(run_text(nine_under(sum_of_numbers(most))).status, RunStatus::finished);
  EXPECT_NE(refusal(nine_under(sum_of_numbers(most + 1))).find("[scene.too_large]"),
            std::string::npos);
  // Equal ones count once.
  std::string same = "energy = \"x^2";
  for (std::size_t k = 0; k < 100; ++k) same += fmt::format(" + normal(1, i)*cos({}*x)", k);
  EXPECT_EQ(run_text(nine_under(same + "\"")).status, RunStatus::finished);
}

}  // namespace
}  // namespace tomlin::test
