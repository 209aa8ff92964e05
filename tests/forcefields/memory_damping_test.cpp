#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/model/model.hpp"
#include "framework/model/stability.hpp"
#include "framework/run/results/observables.hpp"
#include "tests/support/order.hpp"
#include "tests/support/scenes.hpp"

// Drag with an exponential memory against the exact solutions of the linear systems that it makes:
// a free particle, one in a harmonic trap, a rigid ring, and the limit without memory.

namespace tomlin::test {
namespace {

using Complex = std::complex<double>;

struct Memory {
  double coefficient = 0.0;
  double time = 0.0;
  double stiffness() const { return coefficient / time; }
};

struct Motion1D {
  double position = 0.0;
  double velocity = 0.0;
};

constexpr double kMass = 1.3;
constexpr double kTrap = 2.1;
// A tolerance of 1e-12 on a run of some ten oscillations.
constexpr double kToTolerance = 1e-9;

/// x = sum A_j exp(lambda_j t) with the given value, slope and curvature at 0; a rate may be zero,
/// none may be twice.
Motion1D of_modes(const std::array<Complex, 3>& rate, const std::array<double, 3>& start,
                  double t) {
  Complex x = 0.0;
  Complex v = 0.0;
  for (int j = 0; j < 3; ++j) {
    const Complex a = rate[(j + 1) % 3];
    const Complex b = rate[(j + 2) % 3];
    const Complex amplitude =
        (start[0] * a * b - start[1] * (a + b) + start[2]) / ((rate[j] - a) * (rate[j] - b));
    x += amplitude * std::exp(rate[j] * t);
    v += amplitude * rate[j] * std::exp(rate[j] * t);
  }
  return {x.real(), v.real()};
}

/// m x'' = -k q, q' = x' - q/tau: rates 0 and the two roots of s^2 + s/tau + k/m.
Motion1D free_particle(const Memory& memory, double v0, double t) {
  const double half = 0.5 / memory.time;
  const Complex root = std::sqrt(Complex(half * half - memory.stiffness() / kMass, 0.0));
  return of_modes({0.0, -half + root, -half - root}, {0.0, v0, 0.0}, t);
}

/// m x'' = -K x - k q besides: the roots of s^3 + s^2/tau + (K + k)/m s + K/(m tau), found by
/// Newton's method on all at once (Durand and Kerner).
Motion1D trapped_particle(const Memory& memory, double x0, double t) {
  const double c2 = 1.0 / memory.time;
  const double c1 = (kTrap + memory.stiffness()) / kMass;
  const double c0 = kTrap / (kMass * memory.time);
  std::array<Complex, 3> rate = {Complex(1.0, 0.0), Complex(0.4, 0.9), Complex(-0.65, 0.72)};
  constexpr int kPasses = 200;
  for (int pass = 0; pass < kPasses; ++pass) {
    for (int j = 0; j < 3; ++j) {
      const Complex s = rate[j];
      rate[j] -=
          (((s + c2) * s + c1) * s + c0) / ((s - rate[(j + 1) % 3]) * (s - rate[(j + 2) % 3]));
    }
  }
  return of_modes(rate, {x0, 0.0, -kTrap / kMass * x0}, t);
}

std::string memory_force(const Memory& memory) {
  return "[[force]]\ntype = \"memory_damping\"\ncoefficient = " + digits(memory.coefficient) +
         "\nmemory_time = " + digits(memory.time) + "\n";
}

std::string run_of(double duration, const std::string& integrator, const std::string& more = "") {
  return "[run]\nduration = " + digits(duration) + "\nintegrator = " + integrator + "\n" + more;
}

std::string particle(double x, double v) {
  return "[[body]]\nname = \"p\"\ntype = \"point\"\nposition = [" + digits(x) + "]\nvelocity = [" +
         digits(v) + "]\nparticle_mass = " + digits(kMass) + "\n";
}

const std::string kTrapForce =
    "[[force]]\nname = \"trap\"\ntype = \"driving_spring\"\nstiffness = " + digits(kTrap) +
    "\nvelocity = [0.0]\nstart = [0.0]\n";

Motion1D end_of(const std::string& text) {
  const RunResult result = run_text(text);
  EXPECT_EQ(result.status, RunStatus::finished);
  return {observable(result, "p.centre_of_mass.x").value(),
          observable(result, "p.velocity.x").value()};
}

/// Weak and strong, short and long: both oscillating and creeping motion.
const std::vector<Memory> kMemories = {{0.5, 0.3}, {0.5, 4.0}, {3.0, 0.05}, {3.0, 1.0}};

TEST(MemoryDamping, AFreeParticleFollowsItsTwoRates) {
  for (const Memory& memory : kMemories) {
    for (const double t : {0.1, 1.0, 7.3}) {
      const Motion1D exact = free_particle(memory, 0.8, t);
      const Motion1D found =
          end_of(particle(0.0, 0.8) + memory_force(memory) + run_of(t, adaptive(1e-12)));
      EXPECT_NEAR(found.position, exact.position, kToTolerance);
      EXPECT_NEAR(found.velocity, exact.velocity, kToTolerance);
    }
  }
}

TEST(MemoryDamping, ATrappedParticleFollowsItsThreeRates) {
  for (const Memory& memory : kMemories) {
    for (const double t : {0.4, 9.1}) {
      const Motion1D exact = trapped_particle(memory, 0.6, t);
      const Motion1D found = end_of(particle(0.6, 0.0) + kTrapForce + memory_force(memory) +
                                    run_of(t, adaptive(1e-12)));
      EXPECT_NEAR(found.position, exact.position, kToTolerance);
      EXPECT_NEAR(found.velocity, exact.velocity, kToTolerance);
    }
  }
}

struct Scheme {
  const char* name;
  std::function<std::string(double)> held_to;
  double longest;
  Window order;
};

/// The error is that of the position at the end; rounding takes over below 1e-13.
TEST(MemoryDamping, ConvergesWithTheOrderOfTheScheme) {
  constexpr double kFloor = 1e-13;
  const std::vector<Scheme> schemes = {
      {"rk4", fixed_step, 0.1, {3.8, 4.3}},
      {"dopri5", adaptive_held_to, 0.2, {4.7, 5.5}},
      {"dop853", [](double h) { return adaptive_of("dop853", h); }, 0.8, {7.5, 9.0}},
      {"velocity_verlet", verlet, 0.1, {1.9, 2.1}},
      {"baoab", [](double h) { return held_to("baoab", h); }, 0.1, {1.9, 2.1}},
      {"gjf", [](double h) { return held_to("gjf", h); }, 0.1, {1.9, 2.1}}};
  const Memory memory{0.9, 0.6};
  for (const Scheme& scheme : schemes) {
    SCOPED_TRACE(scheme.name);
    const Motion1D exact = trapped_particle(memory, 0.6, 6.4);
    std::vector<double> steps, errors;
    for (int k = 0; k < 4; ++k) {
      const double h = scheme.longest / (1 << k);
      const Motion1D found = end_of(particle(0.6, 0.0) + kTrapForce + memory_force(memory) +
                                    run_of(6.4, scheme.held_to(h)));
      steps.push_back(h);
      errors.push_back(std::abs(found.position - exact.position) +
                       std::abs(found.velocity - exact.velocity));
    }
    EXPECT_PRED2([](const Window& window, double order) { return window.holds(order); },
                 scheme.order, fitted_order(steps, errors, kFloor))
        << errors[0] << " " << errors[3];
  }
}

/// The energy stored in its spring and that dissipated in its dashpot add up with the kinetic
/// energy; the rest is the error of the scheme, and falls with its order or better.
TEST(MemoryDamping, TheLedgerBalancesToTheOrderOfTheScheme) {
  const Memory memory{0.9, 0.6};
  std::vector<double> steps, errors;
  for (const double h : {0.1, 0.05, 0.025, 0.0125}) {
    const RunResult result = run_text(particle(0.6, 0.9) + kTrapForce + memory_force(memory) +
                                      run_of(6.4, fixed_step(h), "ledger = true\n"));
    ASSERT_EQ(result.status, RunStatus::finished);
    EXPECT_GT(result.group("energy")["heat_out"].value(), 0.3);
    steps.push_back(h);
    errors.push_back(std::abs(result.group("energy")["numerical_work"].value()));
  }
  const double order = fitted_order(steps, errors, 1e-14);
  EXPECT_GT(order, 3.8);
  EXPECT_LT(order, 5.5);

  // Everything that it had ends up as heat.
  const RunResult rested = run_text(particle(0.0, 0.9) + memory_force(memory) +
                                    run_of(200.0, adaptive(1e-12), "ledger = true\n"));
  EXPECT_NEAR(rested.group("energy")["heat_out"].value(), 0.5 * kMass * 0.9 * 0.9, kToTolerance);
}

/// exp(-c t/m), to first order in the memory.
TEST(MemoryDamping, IsViscousWithoutMemory) {
  std::vector<double> times, errors;
  for (const double time : {0.02, 0.01, 0.005, 0.0025}) {
    const Memory memory{0.7, time};
    const Motion1D found =
        end_of(particle(0.0, 1.0) + memory_force(memory) + run_of(2.0, adaptive(1e-12)));
    times.push_back(time);
    errors.push_back(std::abs(found.velocity - std::exp(-0.7 * 2.0 / kMass)));
  }
  EXPECT_LT(errors.back(), 2e-3);
  EXPECT_NEAR(fitted_order(times, errors), 1.0, 0.05);
}

/// Two alike are one of twice the coefficient; two different ones are a Prony series.
TEST(MemoryDamping, AddsUpToAPronySeries) {
  const std::string one =
      "[[force]]\nname = \"one\"\ntype = \"memory_damping\"\ncoefficient = 0.4\n"
      "memory_time = 0.6\n";
  const std::string two =
      "[[force]]\nname = \"two\"\ntype = \"memory_damping\"\ncoefficient = 0.4\n"
      "memory_time = 0.6\n";
  const std::string run = run_of(5.0, adaptive(1e-12));
  const Motion1D sum = end_of(particle(0.0, 1.0) + one + two + run);
  const Motion1D exact = free_particle({0.8, 0.6}, 1.0, 5.0);
  EXPECT_NEAR(sum.position, exact.position, kToTolerance);
  EXPECT_NEAR(sum.velocity, exact.velocity, kToTolerance);
}

std::string ring(const std::string& coordinates, const std::string& hold = "") {
  return "[[body]]\nname = \"p\"\ntype = \"ring\"\nradius = 1.0\ncentre = [0.0, 0.0]\ncount = "
         "11\nparticle_mass = " +
         digits(kMass) + "\nvelocity = [0.8, 0.0]\ncoordinates = \"" + coordinates + "\"\n" + hold;
}

/// All particles of a rigid body go the same way, each with its own share of drag.
TEST(MemoryDamping, ARigidRingMovesAsOneOfItsParticles) {
  const Memory memory{0.5, 0.9};
  const Motion1D exact = free_particle(memory, 0.8, 4.0);
  for (const char* coordinates : {"rigid", "particles"}) {
    const Motion1D found =
        end_of(ring(coordinates) + memory_force(memory) + run_of(4.0, adaptive(1e-12)));
    EXPECT_NEAR(found.position, exact.position, kToTolerance) << coordinates;
    EXPECT_NEAR(found.velocity, exact.velocity, kToTolerance) << coordinates;
  }
}

TEST(MemoryDamping, RunsInEveryNumberType) {
  const Memory memory{0.5, 0.9};
  const Motion1D exact = free_particle(memory, 0.8, 2.0);
  const auto in_type = [&](const char* type, double tolerance) {
    return end_of(particle(0.0, 0.8) + memory_force(memory) +
                  run_of(2.0, adaptive(tolerance, "dop853"),
                         "number_type = \"" + std::string(type) + "\"\n"));
  };
  EXPECT_NEAR(in_type("double", 1e-13).position, exact.position, kToTolerance);
  EXPECT_NEAR(in_type("quadruple", 1e-15).position, exact.position, 1e-13);
}

/// Schemes that do not advance variables of forces say so, and dynamics without inertia have no
/// use for a memory of velocities.
TEST(MemoryDamping, IsRefusedWhereItWouldBeWrong) {
  const Memory memory{0.5, 0.9};
  for (const char* integrator :
       {"{ type = \"blanes_moan\", dt = 0.01 }", "{ type = \"exponential_verlet\", dt = 0.01 }",
        "{ type = \"radau9\", absolute_tolerance = 1e-8, relative_tolerance = 1e-8 }"}) {
    EXPECT_THROW(run_text(particle(0.0, 0.8) + memory_force(memory) + run_of(1.0, integrator)),
                 InputError)
        << integrator;
  }
  EXPECT_THROW(run_text(particle(0.0, 0.8) + memory_force(memory) +
                        run_of(1.0, fixed_step(0.01), "dynamics = \"overdamped\"\n")),
               InputError);
}

/// Schemes that take operators take its exact flow: the velocity of a free particle is exact at any
/// step.
TEST(MemoryDamping, AsAnOperatorItIsExact) {
  constexpr double kRounding = 1e-13;
  for (const Memory& memory : kMemories) {
    const Motion1D exact = free_particle(memory, 0.8, 5.0);
    for (const std::string scheme : {"velocity_verlet", "baoab", "gjf"}) {
      for (const double h : {0.5, 2.5}) {
        const Motion1D found = end_of(particle(0.0, 0.8) + memory_force(memory) +
                                      run_of(5.0, held_to(scheme, h), "ledger = true\n"));
        EXPECT_NEAR(found.velocity, exact.velocity, kRounding) << scheme << " " << h;
      }
    }
  }
}

/// A bath of temperature 0 is one without: the same bits in every scheme that takes it, and refused
/// for the same reason by the others.
TEST(MemoryDamping, TemperatureZeroIsNone) {
  struct Pair {
    std::string without;
    std::string cold;
  };
  const std::string drag = "[[force]]\nname = \"bath\"\ncoefficient = 0.7\n";
  const std::string memory = drag + "type = \"memory_damping\"\nmemory_time = 0.8\n";
  const std::vector<Pair> pairs = {
      {memory, memory + "temperature = 0.0\n"},
      {drag + "type = \"viscous_damping\"\n", drag + "type = \"langevin\"\ntemperature = 0.0\n"}};
  const auto codes_of = [](const std::string& scene) {
    std::string codes;
    try {
      Engine engine(scene_of(scene), {});
    } catch (const InputError& error) {
      for (const Fault& fault : error.faults()) codes += std::string(id_of(fault.code)) + " ";
    }
    return codes;
  };
  int taken = 0;
  int refused = 0;
  for (const auto& record : standard().integrators()) {
    if (record->follows_equilibria) continue;
    for (const char* dynamics : {"inertial", "overdamped"}) {
      for (const Pair& pair : pairs) {
        SCOPED_TRACE(record->name + ", " + dynamics + "\n" + pair.cold);
        const auto text = [&](const std::string& force) {
          return particle(0.6, 0.3) + kTrapForce + force +
                 run_of(3.0, held_to(record->name, 0.05),
                        "dynamics = \"" + std::string(dynamics) + "\"\n");
        };
        const std::string why = codes_of(text(pair.without));
        EXPECT_EQ(codes_of(text(pair.cold)), codes_of(text(pair.without)));
        ++(why.empty() ? taken : refused);
        if (!why.empty()) continue;
        const RunResult cold = run_text(text(pair.cold));
        const RunResult without = run_text(text(pair.without));
        EXPECT_EQ(cold.status, without.status);  // midpoint gains too much energy
        for (const char* what : {"p.centre_of_mass.x", "p.velocity.x"}) {
          EXPECT_TRUE(same_bits(observable(cold, what).value(), observable(without, what).value()));
        }
      }
    }
  }
  EXPECT_GT(taken, 15);
  EXPECT_GT(refused, 10);
}

/// A memory shorter than the step would grow without bound: rk4 takes decays up to 2.785 of them.
TEST(MemoryDamping, HasASayInTheStableStep) {
  constexpr double kRk4 = 2.785;
  const Memory fast{1e-9, 1e-3};
  Model model(scene_of(particle(0.0, 0.8) + memory_force(fast) + run_of(1.0, fixed_step(1e-3))));
  StateLayout layout;
  model.declare(layout);
  RunState state(layout);
  model.attach(state);
  model.start();
  EXPECT_NEAR(stable_step_of(model, *model.scene().run.integrator.record), kRk4 * 1e-3, 1e-5);
  const RunResult refused =
      run_text(particle(0.0, 0.8) + memory_force(fast) + run_of(1.0, fixed_step(4e-3)));
  EXPECT_EQ(refused.status, RunStatus::failed);
  EXPECT_EQ(refused.steps, 0u);
  // Strong coupling swings: the spring's frequency counts as any other.
  const Memory stiff{4e3, 1.0};
  const RunResult swinging =
      run_text(particle(0.0, 0.8) + memory_force(stiff) + run_of(1.0, fixed_step(0.06)));
  EXPECT_EQ(swinging.status, RunStatus::failed);
  EXPECT_EQ(swinging.steps, 0u);
}

TEST(MemoryDamping, PerturbedRunsAgree) {
  const Memory memory{0.5, 0.9};
  const RunResult result = run_text(
      particle(0.3, 0.0) + kTrapForce + memory_force(memory) +
      run_of(2.0, adaptive(1e-10),
             "perturb = { size = 1e-9, repeats = 3, observables = [\"p.velocity.x\"] }\n"));
  ASSERT_EQ(result.status, RunStatus::finished);
  ASSERT_EQ(result.determined.size(), 1u);
  EXPECT_GT(result.determined.front().spread, 0.0);
  EXPECT_LT(result.determined.front().spread, 1e-8);
}

}  // namespace
}  // namespace tomlin::test
