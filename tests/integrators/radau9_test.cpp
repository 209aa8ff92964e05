#include "integrators/radau9.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/records/integrator.hpp"
#include "integrators/radau9_tableau.hpp"
#include "tests/support/order.hpp"
#include "tests/support/oscillator.hpp"
#include "tests/support/quadratic_drag.hpp"
#include "tests/support/ring_scenes.hpp"

// The implicit scheme: its coefficients, its order, what L-stability buys, its cost, its refusals.

namespace tomlin::test {
namespace {

using Tableau = Radau9Tableau;
constexpr int kStages = Tableau::stages;

// Sums of some products of numbers of order one to twenty.
constexpr double kRounding = 2e-13;
// Fitted over three halvings of long steps; the next term bends them.
constexpr Window kOrder{8.5, 9.6};
constexpr Window kDenseOrder{5.0, 7.5};

std::string implicit(double tolerance) { return adaptive(tolerance, "radau9"); }

/// For linear forces one iteration meets every tolerance.
std::string implicit_held_to(double h) { return adaptive_of("radau9", h); }

std::uint64_t cost(const RunResult& result) {
  return result.force_evaluations + result.jacobian_columns;
}

// ---- coefficients

TEST(Radau9, CollocatesAtItsNodes) {
  for (int i = 0; i < kStages; ++i) {
    for (int k = 0; k < kStages; ++k) {
      double integral = 0.0;
      double value = 0.0;
      for (int j = 0; j < kStages; ++j) {
        integral += Tableau::a[i][j] * std::pow(Tableau::c[j], k);
        value += Tableau::basis[k][j] * std::pow(Tableau::c[i], j);
      }
      EXPECT_NEAR(integral, std::pow(Tableau::c[i], k + 1) / (k + 1), kRounding);
      EXPECT_NEAR(value, i == k ? 1.0 : 0.0, kRounding);
    }
  }
  // The last row is a quadrature of degree 8, and of no higher one.
  for (int k = 0; k <= 9; ++k) {
    double integral = 0.0;
    for (int j = 0; j < kStages; ++j) {
      integral += Tableau::a[kStages - 1][j] * std::pow(Tableau::c[j], k);
    }
    const double error = std::abs(integral - 1.0 / (k + 1));
    EXPECT_TRUE(k <= 8 ? error < kRounding : error > 1e-6) << k;
  }
}

TEST(Radau9, FallsApartIntoModes) {
  double blocks[kStages][kStages] = {};
  blocks[0][0] = Tableau::real_mode;
  for (int p = 0; p < 2; ++p) {
    const int i = 1 + 2 * p;
    blocks[i][i] = blocks[i + 1][i + 1] = Tableau::pairs[p][0];
    blocks[i][i + 1] = Tableau::pairs[p][1];
    blocks[i + 1][i] = -Tableau::pairs[p][1];
  }
  for (int i = 0; i < kStages; ++i) {
    for (int j = 0; j < kStages; ++j) {
      double left = 0.0, right = 0.0, one = 0.0, unit = 0.0;
      for (int k = 0; k < kStages; ++k) {
        left += Tableau::inverse[i][k] * Tableau::from_modes[k][j];
        right += Tableau::from_modes[i][k] * blocks[k][j];
        one += Tableau::from_modes[i][k] * Tableau::to_modes[k][j];
        unit += Tableau::inverse[i][k] * Tableau::a[k][j];
      }
      EXPECT_NEAR(left, right, kRounding);
      EXPECT_NEAR(one, i == j ? 1.0 : 0.0, kRounding);
      EXPECT_NEAR(unit, i == j ? 1.0 : 0.0, kRounding);
    }
  }
}

/// start f(y) + sum error_j (Y_j - y)/h, plus the step, is a scheme of order 5 and no better.
TEST(Radau9, ComparesItselfWithOrderFive) {
  for (int k = 0; k <= 5; ++k) {
    double difference = k == 0 ? Tableau::start : 0.0;
    for (int j = 0; j < kStages; ++j) {
      difference += Tableau::error[j] * std::pow(Tableau::c[j], k + 1) / (k + 1);
    }
    EXPECT_TRUE(k <= 4 ? std::abs(difference) < kRounding : std::abs(difference) > 1e-6) << k;
  }
}

// ---- order

std::vector<double> halved(double h) { return {h, 0.5 * h, 0.25 * h}; }

TEST(Radau9, IsOfOrderNine) {
  const double longest = 1.6;
  const std::vector<Oscillator> problems = {
      {.c = 0.0, .pull = 0.0}, {.pull = 0.0}, {}, {.c = 4.0, .pull = 0.0}};
  for (const Oscillator& o : problems) {
    SCOPED_TRACE("c = " + digits(o.c) + ", V = " + digits(o.pull));
    std::vector<double> errors;
    for (const double h : halved(longest)) {
      const RunResult result = run_text(o.scene(implicit_held_to(h)));
      ASSERT_EQ(result.steps, static_cast<std::uint64_t>(std::llround(o.duration / h)));
      errors.push_back(error_at_end(result, o.at(o.duration)));
    }
    const double order = fitted_order(halved(longest), errors, kRounding);
    EXPECT_TRUE(kOrder.holds(order)) << order;
    EXPECT_GT(errors.front(), 1e3 * kRounding) << "nothing to fit";
  }
}

TEST(Radau9, HasDenseOutputOfOrderSix) {
  const Oscillator o;
  for (const bool inertial : {true, false}) {
    std::vector<double> x_errors, force_errors;
    for (const double h : halved(1.6)) {
      KeptSamples kept;
      std::string text = o.scene(implicit_held_to(h), "[output]\nevery = 0.0377\n");
      if (!inertial) text.insert(text.find("[run]\n") + 6, "dynamics = \"overdamped\"\n");
      run(scene_of(text), watched_by(kept));
      double x_error = 0.0, force_error = 0.0;
      for (const auto& row : kept.rows) {
        // Without inertia x' = (k (V t - x))/c.
        const double rate = o.k / o.c;
        const double lag = o.pull / rate;
        const double exact = inertial
                                 ? o.at(row[0]).x
                                 : o.pull * row[0] - lag + (o.x0 + lag) * std::exp(-rate * row[0]);
        x_error = std::max(x_error, std::abs(row[kept.column("tip.centre_of_mass.x")] - exact));
        force_error = std::max(force_error, std::abs(row[kept.column("driver.force.x")] -
                                                     o.k * (o.pull * row[0] - exact)));
      }
      x_errors.push_back(x_error);
      force_errors.push_back(force_error);
    }
    // Modes as fast as the longest steps bend the fit, the more without inertia.
    const double low = inertial ? kDenseOrder.low : 4.0;
    for (const auto& errors : {x_errors, force_errors}) {
      const double order = fitted_order(halved(1.6), errors, kRounding);
      EXPECT_GT(order, low) << inertial;
      EXPECT_LT(order, kDenseOrder.high) << inertial;
    }
  }
}

/// A tip that sticks and slips, where each step needs several iterations.
TEST(Radau9, KeepsItsToleranceOnACorrugation) {
  TipScene tip{.velocity = 0.05, .duration = 60.0};
  tip.integrator = adaptive(1e-13);
  const RunResult reference = run_text(tip.text());
  std::vector<double> steps, errors;
  for (const double tolerance : {1e-5, 1e-7, 1e-9, 1e-11}) {
    tip.integrator = implicit(tolerance);
    const RunResult result = run_text(tip.text());
    const double error =
        std::abs(result.driver(0)["mean_force"][0] - reference.driver(0)["mean_force"][0]);
    EXPECT_LT(error, 3.0 * tolerance);
    EXPECT_LT(error_at_end(result, {reference.body(0)["centre_of_mass"][0],
                                    reference.body(0)["velocity"][0]}),
              30.0 * tolerance);
    steps.push_back(1.0 / static_cast<double>(result.steps));
    errors.push_back(error);
  }
  // Steps follow from an estimate of order 6.
  const double per_decade = std::log(steps.front() / steps.back()) / std::log(1e6);
  EXPECT_GT(per_decade, 1.0 / 9.0);
  EXPECT_LT(per_decade, 1.0 / 5.0);
}

TEST(Radau9, WithoutInertiaToo) {
  TipScene tip{.velocity = 0.05, .duration = 60.0};
  const auto overdamped = [&] {
    std::string text = tip.text();
    return text.insert(text.find("[run]\n") + 6, "dynamics = \"overdamped\"\n");
  };
  tip.integrator = adaptive(1e-13);
  const RunResult reference = run_text(overdamped());
  tip.integrator = implicit(1e-9);
  const RunResult result = run_text(overdamped());
  EXPECT_NEAR(result.driver(0)["mean_force"][0], reference.driver(0)["mean_force"][0], 1e-9);
  EXPECT_NEAR(result.body(0)["velocity"][0], reference.body(0)["velocity"][0], 1e-7);
  EXPECT_LT(cost(result), cost(reference));
}

/// From the top of the potential, where all scenes start by default: an L-stable scheme that steps
/// over the growth stays there, and its error estimate sees nothing. Corrugation strong, driver
/// slow.
TEST(Radau9, FallsOffTheTop) {
  for (const double amplitude : {1.0, 100.0}) {
    for (const double velocity : {0.1, 1e-3, 1e-5}) {
      for (const double tolerance : {1e-5, 1e-7}) {
        const std::vector<Setting> settings = {
            {"force.sinusoidal_substrate.amplitude", digits(amplitude)},
            {"force.driver.velocity", "[" + digits(velocity) + "]"},
            {"run.duration", "20.0"}};
        const auto with = [&](const std::string& integrator) {
          std::vector<Setting> all = settings;
          all.push_back({"run.integrator", integrator});
          return run_text(TipScene{.position = 0.0}.text(), all);
        };
        const RunResult reference = with(adaptive(1e-11));
        const RunResult result = with(implicit(tolerance));
        const double size = std::abs(reference.driver(0)["mean_force"][0]);
        EXPECT_NEAR(result.driver(0)["mean_force"][0], reference.driver(0)["mean_force"][0],
                    1e-3 * size)
            << amplitude << " " << velocity << " " << tolerance;
      }
    }
  }
}

/// A spring so stiff that the tolerance of positions is more than all of the substrate's force.
TEST(Radau9, IsDoubtedWhereASpringIsTooStiffForItsTolerance) {
  const auto doubts = [](const char* stiffness) {
    const RunResult result =
        run_text(TipScene{.duration = 1.0, .integrator = implicit(1e-7)}.text(),
                 {{"force.driver.stiffness", stiffness}});
    return count_of(FaultCode::run_stiff_driver, result.warnings);
  };
  EXPECT_EQ(doubts("1e8"), 1U);
  EXPECT_EQ(doubts("1e3"), 0U);
}

// ---- stiffness

/// Fast relaxation, a million times faster than a step: after it motion is on the slow manifold,
/// where k (V t - x) = c x' to the last term.
TEST(Radau9, StepsOverFastModes) {
  const Oscillator o{.m = 1e-6, .k = 0.01, .c = 1.0, .pull = 0.3, .v0 = 5.0, .duration = 40.0};
  const RunResult result = run_text(o.scene(implicit_held_to(1.0)));
  EXPECT_EQ(result.steps, 40U);
  const double fast = 0.5 * (o.c + std::sqrt(o.c * o.c - 4.0 * o.k * o.m)) / o.m;
  const double slow = o.k / o.m / fast;
  // x = V t - c V/k + A exp(-slow t) + B exp(-fast t)
  const double lag = o.c * o.pull / o.k;
  const double b = (o.pull - o.v0 - slow * (o.x0 + lag)) / (fast - slow);
  const double a = o.x0 + lag - b;
  const double rest = a * std::exp(-slow * o.duration);
  EXPECT_NEAR(result.body(0)["centre_of_mass"][0], o.pull * o.duration - lag + rest, 1e-8);
  EXPECT_NEAR(result.body(0)["velocity"][0], o.pull - slow * rest, 1e-10);
  Engine engine(scene_of(o.scene(fixed_step(1e-6))), {});
  EXPECT_LT(stable_step_of(engine), 1e-5) << "nothing stiff about it";
}

/// |R| vanishes far out to the left and nowhere exceeds 1 there.
TEST(Radau9, IsLStable) {
  const IntegratorRecord record = radau9_record();
  EXPECT_LT(record.growth({-1e8, 0.0}), 1e-6);
  EXPECT_LT(record.growth({0.0, 1e8}), 1e-6);
  for (const double y : {0.0, 0.1, 1.0, 5.0, 20.0, 300.0}) {
    EXPECT_LE(record.growth({0.0, y}), 1.0 + kRounding) << y;
  }
  EXPECT_NEAR(record.growth({-0.5, 0.3}), std::exp(-0.5), 1e-11);
  EXPECT_GT(record.growth({9.0, 0.0}), 1.0);
}

// ---- what it is for

std::string table_1(double lambda, const std::string& coordinates, const std::string& integrator,
                    double periods = 10.0) {
  RingScene ring{.coordinates = coordinates, .bonds = 1e4, .velocity = 1e-3, .decay = lambda};
  ring.duration = 1e3 * periods;
  ring.integrator = integrator;
  ring.more = "[measure]\nin = \"driver_periods\"\nfrom = 1.0\nto = " + digits(periods) + "\n";
  return ring.text();
}

struct Row {
  double lambda;
  double mean_force;
  double tolerance;  ///< that reaches 1e-5
  double times_fewer;
};

/// The rolling ring in steady motion: at 1e-5 of the mean force so many times fewer evaluations and
/// columns than dopri5 at the tolerance that is cheapest for it.
TEST(Radau9, RollsTheRingOfTableOneForLess) {
  constexpr double kAccuracy = 1e-5;
  for (const Row& row :
       {Row{100.0, 4.692426411e-3, 1e-5, 13.0}, Row{10.0, 4.587780405e-3, 2e-7, 15.0},
        Row{1.0, 4.628633704e-3, 2e-7, 15.0}, Row{0.1, 9.434048101e-3, 1e-6, 4.0},
        Row{0.01, 2.878089991e-2, 1e-6, 4.0}, Row{0.001, 3.803893595e-2, 1e-6, 4.0}}) {
    const RunResult result = run_text(table_1(row.lambda, "rigid", implicit(row.tolerance)));
    EXPECT_NEAR(result.driver(0)["mean_force"][0] / row.mean_force, 1.0, kAccuracy) << row.lambda;
    // Wide tolerances cost dopri5 no less: its steps are as long as they are stable.
    const RunResult widest = run_text(table_1(row.lambda, "rigid", adaptive(1e-4)));
    EXPECT_NEAR(widest.driver(0)["mean_force"][0] / row.mean_force, 1.0, kAccuracy) << row.lambda;
    EXPECT_GT(static_cast<double>(cost(widest)),
              row.times_fewer * static_cast<double>(cost(result)))
        << row.lambda;
  }
}

/// The ring of particles with stiff bonds is the rigid one, at a cost far below that of stability.
TEST(Radau9, TakesStiffBondsInItsStride) {
  constexpr double kPeriods = 2.0;
  const RunResult flexible = run_text(table_1(1.0, "particles", implicit(1e-6), kPeriods));
  const RunResult rigid = run_text(table_1(1.0, "rigid", implicit(1e-7), kPeriods));
  // The bonds give way by about amplitude/(bonds R^2), 1e-6.
  EXPECT_NEAR(flexible.driver(0)["mean_force"][0] / rigid.driver(0)["mean_force"][0], 1.0, 2e-5);
  Engine engine(scene_of(table_1(1.0, "particles", fixed_step(1e-4), kPeriods)), {});
  const double explicit_cost = 4.0 * kPeriods * 1e3 / stable_step_of(engine);
  EXPECT_LT(20.0 * static_cast<double>(cost(flexible)), explicit_cost);
}

/// A band, closed by the box, with a driver on the centre of mass besides.
TEST(Radau9, AdvancesALongChain) {
  const auto chain = [](const std::string& integrator) {
    return "[box]\nlengths = [130.0]\nperiodic = [true]\n[[body]]\nname = \"chain\"\ntype = "
           "\"chain\"\ncount = 210\nspacing = \"13 / 21\"\nparticle_mass = 1.0\n[[force]]\ntype = "
           "\"harmonic_bonds\"\npairs = \"neighbours\"\nstiffness = 1.0\n[[force]]\nname = "
           "\"driver\"\ntype = \"driving_spring\"\nstiffness = 2.0\nvelocity = [0.1]\n[[force]]\n"
           "type = \"viscous_damping\"\ncoefficient = 0.5\n[[force]]\ntype = "
           "\"sinusoidal_substrate\"\namplitude = 0.004\nperiod = 1.0\n[run]\nduration = 20.0\n"
           "integrator = " +
           integrator + "\n";
  };
  const RunResult reference = run_text(chain(adaptive(1e-11)));
  const RunResult result = run_text(chain(implicit(1e-8)));
  EXPECT_NEAR(result.driver(0)["mean_force"][0], reference.driver(0)["mean_force"][0], 1e-8);
  EXPECT_NEAR(result.body(0)["centre_of_mass"][0], reference.body(0)["centre_of_mass"][0], 1e-7);
}

/// A body that is moved along, by a law of time: variables of its own.
TEST(Radau9, FollowsPrescribedMotion) {
  const auto scene = [](const std::string& integrator) {
    return "[[body]]\nname = \"pusher\"\ntype = \"point\"\nposition = [0.0]\nparticle_mass = 1.0\n"
           "coordinates = \"prescribed\"\nmotion = { velocity = [\"0.3 * cos(1.7 * t)\"] }\n"
           "[[body]]\nname = \"tip\"\ntype = \"point\"\nposition = [1.0]\nparticle_mass = 0.4\n"
           "[[force]]\ntype = \"harmonic_bonds\"\nbodies = [\"pusher\", \"tip\"]\npairs = "
           "\"all\"\nstiffness = 5.0\n[[force]]\ntype = \"viscous_damping\"\nbody = \"tip\"\n"
           "coefficient = 0.6\n[run]\nduration = 9.0\nintegrator = " +
           integrator + "\n";
  };
  const RunResult reference = run_text(scene(adaptive(1e-12)));
  const RunResult result = run_text(scene(implicit(1e-9)));
  EXPECT_NEAR(body_of(result, "tip")["centre_of_mass"][0],
              body_of(reference, "tip")["centre_of_mass"][0], 1e-8);
  EXPECT_NEAR(*driver_of(result, "pusher")["work"], *driver_of(reference, "pusher")["work"], 1e-8);
}

// ---- accounts and refusals

const std::string kUnsuitable = "run.integrator.type = \"radau9\" [integrator.unsuitable]";

/// One evaluation and the columns of a Jacobian for each attempt, five evaluations an iteration.
TEST(Radau9, CountsWhatItAsksFor) {
  const RunResult result = run_text(table_1(0.1, "rigid", implicit(1e-6), 2.0));
  const std::uint64_t attempts = result.steps + result.refused_steps;
  EXPECT_GT(result.refused_steps, 0U);
  EXPECT_EQ(result.jacobian_columns, 3 * attempts);
  EXPECT_GE(result.force_evaluations, 6 * result.steps);
  EXPECT_LE(result.force_evaluations, 52 * attempts + 1);
}

TEST(Radau9, RefusesWhatItCannotDoByName) {
  const std::string wide = RingScene{.count = 400, .integrator = implicit(1e-7)}.text();
  EXPECT_EQ(brief_refusal(wide), "28:14 " + kUnsuitable);
  EXPECT_NE(refusal(wide).find("800"), std::string::npos) << refusal(wide);
  EXPECT_EQ(refusal(RingScene{.count = 40, .integrator = implicit(1e-7)}.text()), "");
  TipScene tip;
  tip.integrator = implicit(1e-7) + "\nnumber_type = \"quadruple\"";
  EXPECT_EQ(brief_refusal(tip.text()),
            "22:15 run.number_type = \"quadruple\" [number_type.unsuitable]");
}

/// Its matrices would lack what such a force changes with velocity.
TEST(Radau9, RefusesForcesThatDependOnVelocityOtherwise) {
  const Registry registry = drag_registry();
  const std::string text = with_drag("integrator = " + implicit(1e-7));
  EXPECT_EQ(brief_refusal(text, registry), "11:14 " + kUnsuitable);
  EXPECT_NE(refusal(text, registry).find("\"wind\""), std::string::npos);
  EXPECT_EQ(refusal(with_drag("integrator = " + adaptive(1e-7)), registry), "");
}

TEST(Radau9, FailsWithACauseWhereNoStepIsShortEnough) {
  TipScene tip;
  tip.integrator =
      "{ type = \"radau9\", absolute_tolerance = 1e-12, smallest_step = 5.0, initial_step = 10.0 }";
  Engine engine(scene_of(tip.text()), {});
  const Motion before(engine);
  const StepReport report = engine.context().integrator->step(DoubleDouble(0.0), 20.0, false);
  EXPECT_EQ(report.fault, StepFault::step_too_small);
  EXPECT_EQ(report.taken, 0.0);
  EXPECT_TRUE(Motion(engine) == before) << "a failed step leaves the state as it was";
  EXPECT_EQ(run_text(tip.text()).status, RunStatus::failed);
}

}  // namespace
}  // namespace tomlin::test
