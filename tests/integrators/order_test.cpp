#include "tests/support/order.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/records/integrator.hpp"
#include "tests/support/oscillator.hpp"
#include "tests/support/scenes.hpp"

// The contract of each integrator: its order for forces with and without velocity, the order of
// what it integrates along the way and of its dense output, its evaluations, its limits.

namespace tomlin::test {
namespace {

// Orders are fitted over four halvings; the next term of the error bends them by a few percent.
constexpr Window kRk4Order{3.8, 4.2};
constexpr Window kDopri5Order{4.75, 5.4};
constexpr Window kSecondOrder{1.9, 2.1};
// At steps long enough for its error to show, further powers bend it more.
constexpr Window kDop853Order{7.5, 8.7};
// Cubic Hermite is of order 4 like the scheme; the continuous extension of the pair has error
// O(h^5) within a step, and its constant competes with that of the steps.
constexpr Window kRk4Dense{3.5, 4.5};
constexpr Window kDopri5Dense{4.0, 5.5};
constexpr Window kSecondDense{1.8, 2.2};
constexpr Window kDop853Dense{6.7, 8.7};
// Rounding of some hundred steps on numbers of order one.
constexpr double kRoundingFloor = 2e-13;

std::vector<double> halved(double h, int times = 4) {
  std::vector<double> steps;
  for (int k = 0; k < times; ++k) steps.push_back(h / static_cast<double>(1 << k));
  return steps;
}

constexpr double kLongStep = 0.2;

struct Scheme {
  std::string name;
  Window order;
  Window dense;
  double longest = kLongStep;  ///< of the steps that its order is fitted to
  bool takes_friction = true;
  bool exact_friction = false;  ///< as long as nothing else acts

  std::string held_to(double h) const { return test::held_to(name, h); }
  std::vector<double> steps() const { return halved(longest); }
};

const std::vector<Scheme>& schemes() {
  static const std::vector<Scheme> all = {
      {"midpoint", kSecondOrder, kSecondDense, 0.1},
      {"velocity_verlet", kSecondOrder, kSecondDense},
      {"baoab", kSecondOrder, kSecondDense},
      {"gjf", kSecondOrder, kSecondDense},
      {"exponential_verlet", kSecondOrder, kSecondDense, kLongStep, true, true},
      {"rk4", kRk4Order, kRk4Dense},
      {"blanes_moan", kRk4Order, kRk4Dense, 0.4, false},
      {"dopri5", kDopri5Order, kDopri5Dense},
      {"dop853", kDop853Order, kDop853Dense, 0.8}};
  return all;
}

// ---- problems with known motion

Oscillator free_flight() { return {.k = 0.0, .c = 0.0}; }
Oscillator coasting() { return {.k = 0.0, .c = 0.9, .v0 = -8.0}; }
Oscillator undamped() { return {.c = 0.0, .pull = 0.0}; }
Oscillator damped() { return {.pull = 0.0}; }
Oscillator overdamped() { return {.c = 4.0, .pull = 0.0, .duration = 1.6}; }
Oscillator driven() { return {}; }
Oscillator driven_without_friction() { return {.c = 0.0}; }

/// The driven one that a scheme takes.
Oscillator driven_for(const Scheme& scheme) {
  return scheme.takes_friction ? driven() : driven_without_friction();
}

TEST(Order, FreeFlightIsExact) {
  for (const Scheme& scheme : schemes()) {
    const Oscillator o = free_flight();
    const RunResult result = run_text(o.scene(scheme.held_to(kLongStep)));
    EXPECT_LT(error_at_end(result, o.at(o.duration)), kRoundingFloor) << scheme.name;
  }
}

TEST(Order, OfMotionWithKnownSolutions) {
  for (const Scheme& scheme : schemes()) {
    for (const Oscillator& o :
         {coasting(), undamped(), damped(), overdamped(), driven(), driven_without_friction()}) {
      if (o.c > 0.0 && !scheme.takes_friction) continue;
      SCOPED_TRACE(scheme.name + ", k = " + digits(o.k) + ", c = " + digits(o.c) +
                   ", V = " + digits(o.pull));
      std::vector<double> errors;
      for (const double h : scheme.steps()) {
        // Oscillations without friction grow with the midpoint scheme: by a factor that is near 1.
        const RunResult result =
            run_text(o.scene(scheme.held_to(h)), {{"run.allow_unstable", "true"}});
        ASSERT_EQ(result.steps, static_cast<std::uint64_t>(std::llround(o.duration / h)));
        errors.push_back(error_at_end(result, o.at(o.duration)));
      }
      if (o.k == 0.0 && scheme.exact_friction) {
        EXPECT_LT(*std::max_element(errors.begin(), errors.end()), kRoundingFloor);
        continue;
      }
      const double order = fitted_order(scheme.steps(), errors, kRoundingFloor);
      EXPECT_TRUE(scheme.order.holds(order)) << order;
      EXPECT_GT(errors.front(), 1e3 * kRoundingFloor) << "nothing to fit";
    }
  }
}

TEST(Order, OfTheRunningIntegral) {
  for (const Scheme& scheme : schemes()) {
    const Oscillator o = driven_for(scheme);
    std::vector<double> errors;
    for (const double h : scheme.steps()) {
      const RunResult result = run_text(o.scene(scheme.held_to(h)));
      errors.push_back(std::abs(result.driver(0)["mean_force"][0] - o.mean_force()));
    }
    const double order = fitted_order(scheme.steps(), errors, 0.1 * kRoundingFloor);
    EXPECT_TRUE(scheme.order.holds(order)) << scheme.name << ": " << order;
  }
}

/// The window's edges fall within steps, so that the mean rests on dense output as well.
TEST(Order, OfAMeanBetweenStepEnds) {
  for (const Scheme& scheme : schemes()) {
    const Oscillator o = driven_for(scheme);
    const double from = 1.2345;
    const double to = 5.4321;
    const State a = o.at(from);
    const State b = o.at(to);
    const double exact = (o.m * (b.v - a.v) + o.c * (b.x - a.x)) / (to - from);
    const std::string window =
        "[measure]\nin = \"time\"\nfrom = " + digits(from) + "\nto = " + digits(to) + "\n";
    std::vector<double> errors;
    for (const double h : scheme.steps()) {
      const RunResult result = run_text(o.scene(scheme.held_to(h), window));
      errors.push_back(std::abs(result.driver(0)["mean_force"][0] - exact));
    }
    const double order = fitted_order(scheme.steps(), errors, 0.1 * kRoundingFloor);
    // The edge falls elsewhere in a step if the step changes, so the fit scatters more.
    EXPECT_GT(order, scheme.dense.low - 0.3) << scheme.name;
    EXPECT_LT(order, 1.3 * scheme.dense.high) << scheme.name;
  }
}

/// Prandtl and Tomlinson's particle, stick-slip, 1.5 periods on; without friction for schemes that
/// take none.
std::string tip_with(const std::string& friction) {
  return tables(R"([[body]] | name = "tip" | type = "point" | position = [0.1]
particle_mass = 1.0
[[force]] | name = "driver" | type = "driving_spring" | stiffness = 2.0 | velocity = [0.25]
)") + friction +
         tables(R"([[force]] | type = "sinusoidal_substrate" | amplitude = 0.1 | period = 1.0
[run] | duration = 6.4 | integrator = )");
}
const std::string kTip = tip_with("[[force]]\ntype = \"viscous_damping\"\ncoefficient = 1.0\n");

/// The reference is the same scene by another scheme, at a step whose own error is 1e-4 of the
/// smallest fitted.
void check_order_on_a_corrugation(const Scheme& scheme, const std::string& number_type,
                                  double floor) {
  const std::string tip = scheme.takes_friction ? kTip : tip_with("");
  const RunResult reference = run_text(tip + fixed_step(6.4 / 40960));
  const State end{reference.body(0)["centre_of_mass"][0], reference.body(0)["velocity"][0]};
  const std::vector<double> steps = halved(scheme.longest / 4.0);
  std::vector<double> errors;
  std::vector<double> mean_errors;
  for (const double h : steps) {
    const RunResult result =
        run_text(tip + scheme.held_to(h), {{"run.number_type", "\"" + number_type + "\""}});
    errors.push_back(error_at_end(result, end));
    mean_errors.push_back(
        std::abs(result.driver(0)["mean_force"][0] - reference.driver(0)["mean_force"][0]));
  }
  const double order = fitted_order(steps, errors, floor);
  const double mean_order = fitted_order(steps, mean_errors, floor);
  EXPECT_TRUE(scheme.order.holds(order)) << order;
  // At this end, stuck, the mean force of exact friction has next to no error of second order: some
  // 3e-6 h^2, below that of fourth order at these steps.
  if (scheme.exact_friction) {
    EXPECT_GT(mean_order, scheme.order.low);
    return;
  }
  EXPECT_TRUE(scheme.order.holds(mean_order)) << "mean force: " << mean_order;
}

TEST(Order, OfTheParticleOnACorrugation) {
  for (const Scheme& scheme : schemes()) {
    SCOPED_TRACE(scheme.name);
    check_order_on_a_corrugation(scheme, "double", kRoundingFloor);
  }
}

TEST(Order, TheSameInQuadrupleNumbers) {
  int compared = 0;
  for (const Scheme& scheme : schemes()) {
    if (standard().integrator(scheme.name)->bind.in_quadruple == nullptr) continue;
    SCOPED_TRACE(scheme.name);
    check_order_on_a_corrugation(scheme, "quadruple", kRoundingFloor);
    ++compared;
  }
  EXPECT_GT(compared, 2);
}

/// No scheme of a fixed step or of a pair is left out.
TEST(Order, OfEveryExplicitScheme) {
  for (const auto& record : standard().integrators()) {
    if (record->needs_tangent || record->follows_equilibria) continue;
    if (!record->with_inertia) continue;  // noise without inertia: langevin_scheme_test.cpp
    const bool listed = std::any_of(schemes().begin(), schemes().end(),
                                    [&](const Scheme& s) { return s.name == record->name; });
    EXPECT_TRUE(listed) << record->name;
  }
}

TEST(DenseOutput, HasTheOrderItDeclares) {
  for (const Scheme& scheme : schemes()) {
    const Oscillator o = driven_for(scheme);
    std::vector<double> x_errors, v_errors, force_errors;
    for (const double h : scheme.steps()) {
      KeptSamples kept;
      // 0.0377: no multiple of any of the steps.
      run(scene_of(o.scene(scheme.held_to(h), "[output]\nevery = 0.0377\n")), watched_by(kept));
      ASSERT_EQ(kept.rows.size(), 170u);
      double x_error = 0.0, v_error = 0.0, force_error = 0.0;
      for (const auto& row : kept.rows) {
        const State exact = o.at(row[0]);
        x_error = std::max(x_error, std::abs(row[kept.column("tip.centre_of_mass.x")] - exact.x));
        v_error = std::max(v_error, std::abs(row[kept.column("tip.velocity.x")] - exact.v));
        force_error = std::max(force_error, std::abs(row[kept.column("driver.force.x")] -
                                                     o.k * (o.pull * row[0] - exact.x)));
      }
      x_errors.push_back(x_error);
      v_errors.push_back(v_error);
      force_errors.push_back(force_error);
    }
    for (const auto& errors : {x_errors, v_errors, force_errors}) {
      const double order = fitted_order(scheme.steps(), errors, kRoundingFloor);
      EXPECT_TRUE(scheme.dense.holds(order)) << scheme.name << ": " << order;
    }
  }
}

// ---- step control

/// Error proportional to tolerance: the embedded error is of order h^5 in a step, and so is what
/// the fifth-order solution accumulates.
TEST(StepControl, ErrorIsProportionalToTolerance) {
  constexpr Window kProportional{0.75, 1.25};
  const RunResult reference = run_text(kTip + fixed_step(6.4 / 40960));
  const State end{reference.body(0)["centre_of_mass"][0], reference.body(0)["velocity"][0]};
  std::vector<double> tolerances, errors;
  for (double tolerance = 1e-5; tolerance > 2e-11; tolerance *= 0.1) {
    tolerances.push_back(tolerance);
    errors.push_back(error_at_end(run_text(kTip + adaptive(tolerance)), end));
    EXPECT_LT(errors.back(), 100.0 * tolerance) << tolerance;
  }
  const double slope = fitted_order(tolerances, errors, kRoundingFloor);
  EXPECT_TRUE(kProportional.holds(slope)) << slope;
}

TEST(StepControl, TolerancesScaleAsStated) {
  // In units a million times smaller, the relative tolerance gives the same steps, and so does an
  // absolute one that is scaled along.
  Oscillator o = damped();
  Oscillator small = o;
  constexpr double kScale = 1.0 / (1 << 20);  // a power of two: no rounding comes in
  small.x0 *= kScale;
  small.v0 *= kScale;
  const auto control = [](double absolute, double relative) {
    return "{ type = \"dopri5\", initial_step = 0.01, absolute_tolerance = " + digits(absolute) +
           ", relative_tolerance = " + digits(relative) + " }";
  };
  const RunResult a = run_text(o.scene(control(1e-7, 0.0)));
  const RunResult b = run_text(small.scene(control(1e-7 * kScale, 0.0)));
  const RunResult c = run_text(small.scene(control(1e-7, 0.0)));
  EXPECT_EQ(a.steps, b.steps);
  EXPECT_LT(2 * c.steps, a.steps) << "an absolute tolerance is absolute";
  const RunResult d = run_text(o.scene(control(0.0, 1e-7)));
  const RunResult e = run_text(small.scene(control(0.0, 1e-7)));
  EXPECT_EQ(d.steps, e.steps);
}

// ---- evaluations

/// Evaluations of a run: so many for each step taken and refused, and those at its start.
struct Evaluations {
  const char* scheme;
  std::uint64_t per_step;
  std::uint64_t per_refused;
  std::uint64_t at_start;
  int order;

  std::uint64_t of(const RunResult& result) const {
    return per_step * result.steps + per_refused * result.refused_steps + at_start;
  }
};

constexpr Evaluations kEvaluations[] = {
    {"rk4", 4, 0, 0, 4},         {"midpoint", 2, 0, 0, 2}, {"velocity_verlet", 1, 0, 1, 2},
    {"blanes_moan", 6, 0, 1, 4}, {"dopri5", 6, 6, 1, 5},   {"dop853", 12, 11, 1, 8}};

TEST(Evaluations, AreAsManyAsRecordsSay) {
  for (const Evaluations& wanted : kEvaluations) {
    SCOPED_TRACE(wanted.scheme);
    const IntegratorRecord& record = *standard().integrator(wanted.scheme);
    EXPECT_EQ(record.evaluations_per_step, static_cast<int>(wanted.per_step));
    EXPECT_EQ(record.order, wanted.order);
    EXPECT_EQ(record.adaptive, wanted.per_refused > 0);
    const std::string tip = record.conservative_only ? tip_with("") : kTip;
    EXPECT_EQ(record.conservative_only, std::string(wanted.scheme) == "blanes_moan");
    std::vector<std::string> integrators = {held_to(wanted.scheme, 0.01)};
    if (record.adaptive) {
      for (const double tolerance : {1e-4, 1e-7, 1e-12}) {
        integrators.push_back(adaptive(tolerance, wanted.scheme));
      }
      // The first step is far too long.
      integrators.push_back("{ type = \"" + std::string(wanted.scheme) +
                            "\", absolute_tolerance = 1e-9, relative_tolerance = 1e-9, "
                            "initial_step = 2.0 }");
    }
    RunResult last;
    for (const std::string& integrator : integrators) {
      last = run_text(tip + integrator);
      ASSERT_EQ(last.status, RunStatus::finished);
      EXPECT_EQ(last.force_evaluations, wanted.of(last)) << integrator;
    }
    EXPECT_EQ(last.refused_steps > 0, record.adaptive);
  }
}

/// The evaluation for a sample at the end of a step may be the first of the next step. Dense output
/// of dop853 has three evaluations more in each step that a sample falls into.
TEST(Evaluations, OfSamples) {
  const auto run_with = [](const std::string& integrator, const char* every) {
    KeptSamples kept;
    const RunResult result =
        run_text(kTip + integrator + "\n[output]\nevery = " + every + "\n", {}, watched_by(kept));
    return std::pair(result, kept.rows.size());
  };
  const auto [rk4, rows] = run_with(fixed_step(0.01), "0.037");
  // A particle on a line runs in blocks of steps, which start afresh after a sample.
  EXPECT_LE(rk4.force_evaluations, 4 * rk4.steps + rows);
  EXPECT_GE(rk4.force_evaluations, 4 * rk4.steps);
  const auto [dop853, seen] = run_with(held_to("dop853", 0.05), "0.371");
  EXPECT_EQ(dop853.force_evaluations, 12 * dop853.steps + 1 + 3 * (seen - 1));  // none at the start
  const auto [free_of_cost, many] = run_with(verlet(0.01), "0.037");
  EXPECT_EQ(free_of_cost.force_evaluations, free_of_cost.steps + 1);
  EXPECT_GT(many, 100u);
}

// ---- limits of the adaptive scheme

std::string limited(const std::string& limits) {
  return kTip + "{ type = \"dopri5\", " + limits + " }\n";
}

TEST(Limits, SmallestStep) {
  const std::string scene = limited(
      "absolute_tolerance = 1e-14, relative_tolerance = 0.0, "
      "smallest_step = 0.05, initial_step = 0.1");
  Engine engine(scene_of(scene), {});
  const Motion before(engine);
  const StepReport report = engine.context().integrator->step(DoubleDouble(0.0), 6.4, false);
  EXPECT_EQ(report.fault, StepFault::step_too_small);
  EXPECT_EQ(report.taken, 0.0);
  EXPECT_TRUE(Motion(engine) == before) << "a failed step leaves the state as it was";

  const RunResult result = run_text(scene);
  EXPECT_EQ(result.status, RunStatus::failed);
  ASSERT_TRUE(result.failure);
  EXPECT_NE(result.failure->what.find("smallest_step"), std::string::npos);
}

TEST(Limits, MostSteps) {
  const std::string scene = limited("most_steps = 5, largest_step = 0.01");
  Engine engine(scene_of(scene), {});
  double time = 0.0;
  for (int k = 0; k < 5; ++k) {
    const StepReport report =
        engine.context().integrator->step(DoubleDouble(time), 6.4 - time, false);
    ASSERT_EQ(report.fault, StepFault::none);
    time += report.taken;
  }
  const StepReport report =
      engine.context().integrator->step(DoubleDouble(time), 6.4 - time, false);
  EXPECT_EQ(report.fault, StepFault::too_many_steps);
  EXPECT_EQ(report.taken, 0.0);

  const RunResult result = run_text(scene);
  EXPECT_EQ(result.status, RunStatus::failed);
  EXPECT_EQ(result.steps, 5u);
  ASSERT_TRUE(result.failure);
  EXPECT_EQ(result.failure->step, 5u);
  EXPECT_NE(result.failure->what.find("most_steps"), std::string::npos);
}

TEST(Limits, LargestStep) {
  constexpr double kLargest = 0.02;
  Engine engine(scene_of(limited("absolute_tolerance = 1.0, largest_step = " + digits(kLargest))),
                {});
  // A remainder just above the largest step is not taken along with it.
  double time = 0.0;
  for (const double rest : {6.4, 3.0, 1.005 * kLargest, kLargest, 0.5 * kLargest}) {
    const StepReport report = engine.context().integrator->step(DoubleDouble(time), rest, false);
    ASSERT_EQ(report.fault, StepFault::none);
    EXPECT_LE(report.taken, kLargest) << "with " << rest << " to go";
    EXPECT_GT(report.taken, 0.0);
    time += report.taken;
  }
  const RunResult result =
      run_text(limited("absolute_tolerance = 1.0, largest_step = " + digits(kLargest)));
  EXPECT_GE(result.steps, 320u);
  EXPECT_LE(result.steps, 322u);
}

TEST(Limits, InitialStep) {
  Engine engine(scene_of(limited("absolute_tolerance = 1.0, initial_step = 0.003")), {});
  EXPECT_EQ(engine.context().integrator->step(DoubleDouble(0.0), 6.4, false).taken, 0.003);
}

/// A tip that starts in a position where its acceleration overflows.
TEST(Limits, LeavingTheFiniteNumbers) {
  for (const std::string& integrator : {fixed_step(0.01), verlet(0.01), adaptive(1e-9)}) {
    Engine engine(scene_of("[[body]]\ntype = \"point\"\nposition = [1.0]\nparticle_mass = 1e-200\n"
                           "[[force]]\ntype = \"constant_force\"\nforce = [1e200]\n"
                           "[run]\nduration = 1.0\nintegrator = " +
                           integrator + "\n"),
                  {});
    const Motion before(engine);
    const StepReport report = engine.context().integrator->step(DoubleDouble(0.0), 0.01, false);
    EXPECT_EQ(report.fault, StepFault::not_finite_or_too_far) << integrator;
    EXPECT_EQ(report.taken, 0.0);
    EXPECT_TRUE(Motion(engine) == before);
  }
}

// ---- growth

/// |R(h lambda)| of a real mode of the overdamped oscillator, or of the pair +-i omega.
struct Mode {
  Oscillator oscillator;
  std::complex<double> lambda;
  double amplitude(const State& s) const {
    if (lambda.imag() == 0.0) return std::hypot(s.x, s.v) / std::hypot(1.0, lambda.real());
    return std::hypot(s.x, s.v / lambda.imag());
  }
};

TEST(Growth, IsWhatAStepDoes) {
  constexpr double kTolerance = 1e-13;  // rounding of one step, in units of its coefficients
  const auto largest_coefficient = [](const std::string& name) {
    return name == "dop853" ? 40.0 : 1.0;
  };
  std::vector<Mode> modes;
  // Undamped, omega = 1.5, from (1, 0).
  modes.push_back({{.m = 1.0, .k = 2.25, .c = 0.0, .pull = 0.0, .x0 = 1.0, .v0 = 0.0}, {0.0, 1.5}});
  // Overdamped: lambda^2 + 5 lambda + 4 = 0, along the mode -4, and along the mode -1.
  for (const double lambda : {-4.0, -1.0}) {
    modes.push_back(
        {{.m = 1.0, .k = 4.0, .c = 5.0, .pull = 0.0, .x0 = 1.0, .v0 = lambda}, {lambda, 0.0}});
  }
  for (const auto& record : standard().integrators()) {
    if (record->growth == nullptr) continue;  // no function of h lambda
    if (!record->with_inertia) continue;
    for (const Mode& mode : modes) {
      for (const double z : {0.01, 0.3, 1.0, 2.0, 2.7, 3.2}) {
        const double h = z / std::abs(mode.lambda);
        Oscillator o = mode.oscillator;
        o.duration = h;
        const std::string integrator = held_to(record->name, h);
        const RunResult result = run_text(o.scene(integrator), {{"run.allow_unstable", "true"}});
        ASSERT_EQ(result.steps, 1u);
        const State end{result.body(0)["centre_of_mass"][0], result.body(0)["velocity"][0]};
        EXPECT_NEAR(mode.amplitude(end), record->growth(h * mode.lambda),
                    kTolerance * largest_coefficient(record->name) * (1 + z * z))
            << record->name << ", z = " << z << ", lambda = " << mode.lambda;
      }
    }
  }
}

TEST(Growth, HasTheKnownLimits) {
  using Complex = std::complex<double>;
  constexpr double kNear = 1e-3;
  const auto* rk4 = standard().integrator("rk4");
  const auto* dopri5 = standard().integrator("dopri5");
  // Real axis: zeros of |R| = 1 by bisection elsewhere, 2.785293563 and 3.306.
  EXPECT_LT(rk4->growth({-2.785293563 + kNear, 0.0}), 1.0);
  EXPECT_GT(rk4->growth({-2.785293563 - kNear, 0.0}), 1.0);
  EXPECT_LT(dopri5->growth({-3.30, 0.0}), 1.0);
  EXPECT_GT(dopri5->growth({-3.31, 0.0}), 1.0);
  // Imaginary axis: rk4 damps up to 2 sqrt(2).
  const double limit = 2.0 * std::sqrt(2.0);
  EXPECT_NEAR(rk4->growth({0.0, limit}), 1.0, 1e-14);
  EXPECT_LT(rk4->growth({0.0, limit - kNear}), 1.0);
  EXPECT_GT(rk4->growth({0.0, limit + kNear}), 1.0);
  for (const auto* scheme : {rk4, dopri5}) {
    EXPECT_EQ(scheme->growth({0.0, 0.0}), 1.0);
    // To its order, |R| is the exponential; one power on, it is not.
    const Complex z(-0.02, 0.03);
    const double error = std::abs(scheme->growth(z) - std::exp(z.real()));
    const double next = std::pow(std::abs(z), scheme->order + 1);
    EXPECT_LT(error, next);
    EXPECT_GT(error, 1e-5 * next);
  }
}

/// The order test detects a scheme that is not one of fourth order: the Euler step.
TEST(Order, AnotherOrderIsSeen) {
  const Oscillator o = damped();
  std::vector<double> errors;
  for (const double h : halved(0.01)) {
    State s{o.x0, o.v0};
    for (int k = 0; k < std::lround(o.duration / h); ++k) {
      const double a = (-o.k * s.x - o.c * s.v) / o.m;
      s = {s.x + h * s.v, s.v + h * a};
    }
    const State exact = o.at(o.duration);
    errors.push_back(std::hypot(s.x - exact.x, s.v - exact.v));
  }
  const double order = fitted_order(halved(0.01), errors);
  EXPECT_NEAR(order, 1.0, 0.1);
  EXPECT_FALSE(kRk4Order.holds(order));
}

}  // namespace
}  // namespace tomlin::test
