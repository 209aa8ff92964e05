#include "forcefields/coulomb_friction.hpp"

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/run/results/observables.hpp"
#include "tests/support/order.hpp"
#include "tests/support/scenes.hpp"

// Coulomb friction against the exact motion under the regularised law, its limit without width, and
// what rest does to the order of each scheme.

namespace tomlin::test {
namespace {

constexpr double kDryForce = 0.7;
constexpr double kBlockMass = 1.3;
// A tolerance of 1e-12 a step, on some thousand steps.
constexpr double kSolved = 1e-9;

std::string block(double v0, double mass = kBlockMass) {
  return "[[body]]\nname = \"block\"\ntype = \"point\"\nposition = [0.0]\nvelocity = [" +
         digits(v0) + "]\nparticle_mass = " + digits(mass) + "\n";
}

std::string dry_friction(double force, double width) {
  return "[[force]]\nname = \"friction\"\ntype = \"coulomb_friction\"\nforce = " + digits(force) +
         "\nwidth = " + digits(width) + "\n";
}

std::string pushed_by(double force) {
  return "[[force]]\nname = \"push\"\ntype = \"constant_force\"\nforce = [" + digits(force) + "]\n";
}

std::string run_for(double duration, const std::string& integrator, const std::string& more = "") {
  return "[run]\nduration = " + digits(duration) + "\nintegrator = " + integrator + "\n" + more;
}

double number(const RunResult& result, const std::string& path) {
  EXPECT_EQ(result.status, RunStatus::finished);
  return observable(result, path).value();
}

/// m v' = -f v/s with s = sqrt(v^2 + w^2): G(v) = s + w ln(v / (w + s)) falls by f t/m, and the
/// distance is m/f times the fall of H(v) = (v s + w^2 asinh(v/w)) / 2.
double time_to_slow(double v, double w) {
  const double s = std::hypot(v, w);
  return s + w * std::log(v / (w + s));
}
double way_to_slow(double v, double w) {
  return 0.5 * (v * std::hypot(v, w) + w * w * std::asinh(v / w));
}

/// By bisection of its logarithm: near rest it decays exponentially.
double speed_after(double t, double v0, double w) {
  const double left = time_to_slow(v0, w) - kDryForce * t / kBlockMass;
  double low = -700.0;
  double high = std::log(v0);
  for (int pass = 0; pass < 100; ++pass) {
    const double middle = 0.5 * (low + high);
    (time_to_slow(std::exp(middle), w) < left ? low : high) = middle;
  }
  return std::exp(low);
}

TEST(CoulombFriction, ASlidingBlockFollowsTheExactSolution) {
  for (const double w : {1e-3, 0.1, 2.0}) {
    for (const double v0 : {0.5, 3.0}) {
      for (const double part : {0.3, 0.9, 1.1}) {  // of the time to stop
        const double t = part * kBlockMass * v0 / kDryForce;
        const RunResult result = run_text(block(v0) + dry_friction(kDryForce, w) +
                                          run_for(t, adaptive(1e-12), "ledger = true\n"));
        const double v = number(result, "block.velocity.x");
        const double exact = speed_after(t, v0, w);
        EXPECT_NEAR(v, exact, kSolved);
        EXPECT_NEAR(number(result, "block.centre_of_mass.x"),
                    kBlockMass / kDryForce * (way_to_slow(v0, w) - way_to_slow(exact, w)), kSolved);
        // All that the block has lost is heat.
        EXPECT_NEAR(number(result, "energy.heat_out"), 0.5 * kBlockMass * (v0 * v0 - exact * exact),
                    kSolved);
        EXPECT_NEAR(number(result, "energy.numerical_work"), 0.0, kSolved);
      }
    }
  }
}

/// Without a width it stops at t = m v0/f. With one it has then the speed a w, where a, the root of
/// sqrt(1 + a^2) = asinh(1/a), is the Laplace limit: G(v0) is v0 but for w^2/(2 v0).
TEST(CoulombFriction, ABlockStopsWhenCoulombsLawSays) {
  constexpr double kLaplaceLimit = 0.66274341934918;
  constexpr double kSpeed = 1.0;
  for (const double w : {1e-2, 1e-3, 1e-4}) {
    const double t = kBlockMass * kSpeed / kDryForce;
    const RunResult result =
        run_text(block(kSpeed) + dry_friction(kDryForce, w) + run_for(t, adaptive(1e-13)));
    EXPECT_NEAR(number(result, "block.velocity.x") / w, kLaplaceLimit, w + 1e-8 / w * 1e-3);
    // It has gone m v0^2/(2 f), but for the part (w/v0)^2 ln(v0/w).
    const double way = 0.5 * kBlockMass * kSpeed * kSpeed / kDryForce;
    EXPECT_NEAR(number(result, "block.centre_of_mass.x"), way, way * w * w * std::log(1.0 / w));
  }
}

/// In the plane the direction of motion stays, and the speed is that on a line.
TEST(CoulombFriction, IsAgainstTheVelocityInEveryDimension) {
  constexpr double kWidth = 0.05;
  constexpr double kSpeed = 1.5;
  constexpr double kTime = 1.0;
  const RunResult line =
      run_text(block(kSpeed) + dry_friction(kDryForce, kWidth) + run_for(kTime, adaptive(1e-13)));
  const double expected = number(line, "block.velocity.x");
  const std::vector<std::vector<double>> directions = {{0.6, 0.8}, {-2.0 / 3, 1.0 / 3, 2.0 / 3}};
  for (const std::vector<double>& direction : directions) {
    std::string velocity;
    std::string position;
    for (const double part : direction) {
      velocity += (velocity.empty() ? "" : ", ") + digits(kSpeed * part);
      position += position.empty() ? "0.0" : ", 0.0";
    }
    const RunResult result =
        run_text("[[body]]\nname = \"block\"\ntype = \"point\"\nposition = [" + position +
                 "]\nvelocity = [" + velocity + "]\nparticle_mass = " + digits(kBlockMass) + "\n" +
                 dry_friction(kDryForce, kWidth) + run_for(kTime, adaptive(1e-13)));
    for (std::size_t d = 0; d < direction.size(); ++d) {
      EXPECT_NEAR(result.body(0)["velocity"][d], expected * direction[d], kSolved);
    }
  }
}

/// Far above the width the magnitude is f, where the square of v/w is beyond all numbers; and of
/// speeds whose squares are.
template <class T>
void expect_full_friction(T speed, T width) {
  const CoulombFriction::Parameters<T, 2> p{T(0.25), width};
  Site<T, 2> site{};
  site.velocity = {{speed, T(0.0)}};
  const auto force = CoulombFriction::force(p, site);
  constexpr double kRounding = 4.0 * std::numeric_limits<T>::epsilon();
  EXPECT_NEAR(static_cast<double>(force[0]), -0.25, kRounding) << speed << " " << width;
  EXPECT_EQ(force[1], T(0.0));
}

TEST(CoulombFriction, IsThatOfCoulombHoweverSmallTheWidth) {
  expect_full_friction(1.0, 1e-200);
  expect_full_friction(1e200, 1.0);
  expect_full_friction(1e-300, 1e-320);
  expect_full_friction(1.0F, 1e-30F);
  expect_full_friction(1e30F, 1.0F);
}

/// Under P < f it creeps at w P / sqrt(f^2 - P^2); under P > f it keeps on being accelerated.
TEST(CoulombFriction, BelowThePushThatSlidesItCreeps) {
  constexpr double kWidth = 1e-2;
  constexpr double kTime = 5.0;  // hundreds of relaxation times m w/f
  for (const double part : {0.1, 0.5, 0.9}) {
    const double push = part * kDryForce;
    const RunResult result =
        run_text(block(0.0) + pushed_by(push) + dry_friction(kDryForce, kWidth) +
                 run_for(kTime, adaptive(1e-12)));
    EXPECT_NEAR(number(result, "block.velocity.x"),
                kWidth * push / std::sqrt(kDryForce * kDryForce - push * push), kSolved);
  }
  const RunResult sliding =
      run_text(block(0.0) + pushed_by(1.5 * kDryForce) + dry_friction(kDryForce, kWidth) +
               run_for(kTime, adaptive(1e-12)));
  // The full friction is missing for about the time in which w is passed.
  const double expected = 0.5 * kDryForce * kTime / kBlockMass;
  EXPECT_NEAR(number(sliding, "block.velocity.x"), expected, 5.0 * kWidth);
  EXPECT_GT(number(sliding, "block.velocity.x"), expected);
}

TEST(CoulombFriction, DeclaresWhatItIs) {
  const Traits& traits = standard().force("coulomb_friction")->traits;
  EXPECT_TRUE(traits.dissipative);
  EXPECT_TRUE(traits.depends_on_velocity);
  EXPECT_FALSE(traits.conservative);
}

/// At rest it damps at the rate f/(w m); rk4 takes steps of 2.785 over that.
TEST(CoulombFriction, ItsStiffnessAtRestLimitsTheStep) {
  constexpr double kWidth = 1e-3;
  constexpr double kRk4Limit = 2.785293563405282;
  const double limit = kRk4Limit * kWidth * kBlockMass / kDryForce;
  const auto scene = [&](double step, const std::string& more = "") {
    return block(1.0) + dry_friction(kDryForce, kWidth) + run_for(3.0, fixed_step(step), more);
  };
  EXPECT_EQ(run_text(scene(0.99 * limit)).status, RunStatus::finished);
  const RunResult beyond = run_text(scene(1.01 * limit));
  ASSERT_TRUE(beyond.failure.has_value());
  EXPECT_EQ(beyond.failure->code, FaultCode::run_step_unstable);
  EXPECT_EQ(beyond.failure->force, "friction");
  // Who insists has a chatter about rest, of a step's length times f/m.
  const RunResult insisting = run_text(scene(10.0 * limit, "allow_unstable = true\n"));
  EXPECT_EQ(count_of(FaultCode::integrator_beyond_stability, insisting.warnings), 1U);
  EXPECT_LT(std::abs(number(insisting, "block.velocity.x")), 10.0 * limit * kDryForce / kBlockMass);
}

/// Each that cannot take it says so, and which can.
TEST(CoulombFriction, SchemesAndDynamicsThatCannotTakeItRefuse) {
  const std::string start = block(1.0) + dry_friction(kDryForce, 0.1);
  const auto refused = [&](const std::string& integrator, const std::string& more = "") {
    return refusal(start + run_for(1.0, integrator, more));
  };
  for (const char* scheme : {"velocity_verlet", "exponential_verlet", "blanes_moan"}) {
    const std::string why = refused("{ type = \"" + std::string(scheme) + "\", dt = 1e-2 }");
    EXPECT_NE(why.find("friction"), std::string::npos) << scheme << why;
    EXPECT_NE(why.find("rk4"), std::string::npos) << scheme << why;
  }
  EXPECT_NE(refused(adaptive(1e-9, "radau9")).find("not linear friction"), std::string::npos);
  // Dynamics without inertia, which linear friction makes possible, do not take other friction.
  const std::string damped = start + "[[force]]\ntype = \"viscous_damping\"\ncoefficient = 1.0\n";
  for (const std::string dynamics : {"overdamped", "quasistatic"}) {
    const std::string integrator =
        dynamics == "quasistatic" ? "{ type = \"continuation\" }" : fixed_step(1e-2);
    const std::string why =
        refusal(damped + run_for(1.0, integrator, "dynamics = \"" + dynamics + "\"\n"));
    EXPECT_NE(why.find("not linear friction"), std::string::npos) << dynamics << why;
  }
}

// ---- the order of schemes where the motion reverses

/// A push against the motion, stronger than friction: the velocity passes zero, at a rate between
/// (p - f)/m and (p + f)/m, in the time w m/p.
constexpr double kReversingPush = 2.0;

constexpr double kReversalTime = 1.6;

std::string reversal(double v0, double width, const std::string& integrator) {
  return block(v0, 1.0) + pushed_by(-kReversingPush) + dry_friction(kDryForce, width) +
         run_for(kReversalTime, integrator, "allow_unstable = true\n");
}

/// Root mean square of the errors of velocities over starts, one at random in each part of a range,
/// so that reversals fall on every part of a step. `exact`: at the end, by the speed at the start.
template <class Exact>
double error_at(const std::string& scheme, double step, double width, std::uint64_t seed,
                const Exact& exact) {
  constexpr int kStarts = 60;
  std::mt19937_64 engine(seed);
  double sum = 0.0;
  for (int k = 0; k < kStarts; ++k) {
    const double part = std::uniform_real_distribution<double>(0.0, 1.0)(engine);
    const double v0 = 0.5 + (k + part) / kStarts;
    const RunResult result = run_text(reversal(v0, width, held_to(scheme, step)));
    const double error = number(result, "block.velocity.x") - exact(v0);
    sum += error * error;
  }
  return std::sqrt(sum / kStarts);
}

struct ReversalOrders {
  std::string scheme;
  Window resolved;
  double longest;  ///< of the steps that its order is fitted to, in passages of the width
};

// Steps of the passage w m/p and shorter: the scheme's own order. Of schemes of high order the
// error soon meets rounding, and before that the next powers bend it: over a smooth passage their
// first terms nearly cancel.
const std::vector<ReversalOrders>& reversal_orders() {
  static const std::vector<ReversalOrders> all = {{"midpoint", {1.8, 2.3}, 0.25},
                                                  {"rk4", {3.7, 4.5}, 0.5},
                                                  {"dopri5", {4.5, 7.0}, 0.5},
                                                  {"dop853", {7.0, 9.2}, 1.0}};
  return all;
}

/// The table in forcefields/README.md.
TEST(CoulombFriction, SchemesKeepTheirOrderWhereStepsResolveTheWidth) {
  constexpr double kWidth = 0.2;
  constexpr double kFloor = 1e-12;  // rounding, and the reference
  for (const ReversalOrders& one : reversal_orders()) {
    std::vector<double> steps;
    std::vector<double> errors;
    for (int k = 0; k < 4; ++k) {
      steps.push_back(one.longest * kWidth / kReversingPush / std::pow(2.0, k));
      errors.push_back(error_at(one.scheme, steps.back(), kWidth, 20240611, [&](double v0) {
        return number(run_text(reversal(v0, kWidth, adaptive(1e-13, "dop853"))),
                      "block.velocity.x");
      }));
    }
    const double order = fitted_order(steps, errors, kFloor);
    EXPECT_TRUE(one.resolved.holds(order)) << one.scheme << ": " << order;
  }
}

/// Steps much longer than the passage see a force that jumps: the step in which the motion reverses
/// has an error of its own length.
TEST(CoulombFriction, SchemesFallToFirstOrderWhereStepsDoNot) {
  constexpr double kWidth = 1e-9;
  const Window first{0.75, 1.25};  // of random parts of a step, over 60 starts
  // Without width, mass 1: the block reverses at v0/(p + f) and goes on by p - f.
  const auto coulombs_law = [](double v0) {
    const double reverses = v0 / (kReversingPush + kDryForce);
    return -(kReversingPush - kDryForce) * (kReversalTime - reverses);
  };
  for (const ReversalOrders& one : reversal_orders()) {
    for (const std::uint64_t seed : {20240611, 7}) {
      std::vector<double> steps;
      std::vector<double> errors;
      for (int k = 0; k < 5; ++k) {
        steps.push_back(0.1 / std::pow(2.0, k));
        errors.push_back(error_at(one.scheme, steps.back(), kWidth, seed, coulombs_law));
      }
      const double order = fitted_order(steps, errors);
      EXPECT_TRUE(first.holds(order)) << one.scheme << ": " << order;
    }
  }
}

/// Adaptive schemes find the passage by themselves, whatever the width: their error follows the
/// tolerance.
TEST(CoulombFriction, AdaptiveSchemesResolveTheReversal) {
  for (const double width : {1e-2, 1e-5}) {
    const std::string start =
        block(1.0, 1.0) + pushed_by(-kReversingPush) + dry_friction(kDryForce, width);
    const auto speed = [&](double tolerance) {
      return number(run_text(start + run_for(kReversalTime, adaptive(tolerance))),
                    "block.velocity.x");
    };
    const double exact = speed(1e-13);
    for (const double tolerance : {1e-6, 1e-8, 1e-10}) {
      // Each of the dozens of steps errs by the tolerance of velocities at most.
      EXPECT_NEAR(speed(tolerance), exact, 100.0 * tolerance) << width;
    }
  }
}

}  // namespace
}  // namespace tomlin::test
