#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/scenarios/scenario_fixture.hpp"
#include "tests/scenarios/trace.hpp"

/// The Prandtl-Tomlinson tip against its closed forms.
namespace tomlin::test {
namespace {

constexpr const char* kSmooth = "prandtl_tomlinson/smooth.toml";
constexpr const char* kStickSlip = "prandtl_tomlinson/stick_slip.toml";
constexpr const char* kMultipleSlip = "prandtl_tomlinson/multiple_slip.toml";
constexpr const char* kOverdamped = "prandtl_tomlinson/overdamped.toml";

/// All three scenes share these parameters.
constexpr double kAmplitude = 0.1;
constexpr double kPeriod = 1.0;
constexpr double kLargestForce = 2.0 * kPi * kAmplitude / kPeriod;  // F_c

double stiffness_of(double s) { return 4.0 * kPi * kPi * kAmplitude / (s * kPeriod * kPeriod); }

/// Slow driving: the tip sits on its stable branch, slips where that folds, and comes to rest in
/// the next well.
struct QuasiStatic {
  double fold_position;  ///< of the tip, in the well around a/2
  double fold_force;
  double mean_force;  ///< what a slip loses, per period
  double slip;        ///< from the fold to the next well

  explicit QuasiStatic(double s) {
    const double k = stiffness_of(s);
    const auto substrate = [](double x) { return kLargestForce * std::sin(2.0 * kPi * x); };
    const auto driver = [&](double x) { return x - substrate(x) / k; };  // holds the tip at x
    fold_position = 1.0 - std::acos(1.0 / s) / (2.0 * kPi);
    fold_force = kLargestForce * std::sqrt(1.0 - 1.0 / (s * s));
    const double pulled = driver(fold_position);
    double low = 2.0 - fold_position;  // the next stable branch
    double high = 1.0 + fold_position;
    for (int pass = 0; pass < 100; ++pass) {
      const double middle = 0.5 * (low + high);
      (driver(middle) < pulled ? low : high) = middle;
    }
    const auto energy = [&](double x) {
      return 0.5 * k * (x - pulled) * (x - pulled) + kAmplitude * std::cos(2.0 * kPi * x);
    };
    mean_force = (energy(fold_position) - energy(low)) / kPeriod;
    slip = low - fold_position;
  }
};

TEST(PrandtlTomlinson, SlidesSmoothlyAtViscousCost) {
  const double xi = parameter_of(kSmooth, "xi");
  struct Case {
    double s;
    double slowest;  ///< close to s = 1 the tip jumps ahead ever faster: slow is slower there
  };
  for (const auto& [s, slowest] : {Case{0.3, 1e-3}, Case{0.5, 1e-3}, Case{0.8, 1e-4}}) {
    const std::vector<double> speeds = {slowest, 2.0 * slowest, 4.0 * slowest};
    std::vector<double> beyond;
    for (const double v : speeds) {
      const auto result = run_shipped(kSmooth, {{"s", text_of(s)}, {"v", text_of(v)}});
      const double limit = xi * v / std::sqrt(1.0 - s * s);
      beyond.push_back(mean_force(result) / limit - 1.0);
    }
    // The limit is that of v -> 0; what is missing is of relative order v^2.
    EXPECT_LT(std::abs(beyond.front()), 2e-5) << "s = " << s;
    EXPECT_NEAR(fitted_power(speeds, beyond), 2.0, 0.05) << "s = " << s;
  }
}

TEST(PrandtlTomlinson, SlidesNoLongerSmoothlyBeyondOne) {
  // At s = 1.5 the same damping costs far more than viscosity, so the test can fail.
  const auto result = run_shipped(kSmooth, {{"s", "1.5"}});
  EXPECT_GT(mean_force(result), 5.0 * parameter_of(kSmooth, "xi") * 1e-3);
}

TEST(PrandtlTomlinson, StaticForceIsTheSteepestSlopeAndDrag) {
  const double xi = parameter_of(kStickSlip, "xi");
  for (const double v : {1e-4, 2e-4}) {
    const auto result = run_shipped(
        kStickSlip, {{"v", text_of(v)}, {"run.duration", "4 * a / v"}, {"measure.to", "4"}});
    const double beyond = *result.driver(0)["static_force"] - kLargestForce;
    // First order in v; the next is v * sqrt(v) and falls short by some per cent here.
    EXPECT_NEAR(beyond / (xi * v), 1.0, 0.05) << "v = " << v;
    EXPECT_GT(std::abs(beyond), 1e-4 * kLargestForce);  // the drag is really seen
  }
}

TEST(PrandtlTomlinson, LosesItsHoldAtTheFold) {
  const double s = 1.5;
  const QuasiStatic slow(s);
  const std::vector<double> speeds = {1e-4, 3e-4, 1e-3};
  std::vector<double> beyond;
  for (const double v : speeds) {
    Trace trace;
    run_shipped(kStickSlip,
                {{"s", text_of(s)},
                 {"v", text_of(v)},
                 {"run.duration", "4 * a / v"},
                 {"measure.to", "4"},
                 {"output.every", "1e-3 * a / v"}},
                &trace);
    const auto& x = trace["tip.centre_of_mass.x"];
    const auto& force = trace["driver.force.x"];
    // The second time that the tip comes to the fold, in the well around 3a/2.
    std::size_t n = 0;
    while (n + 1 < x.size() && x[n + 1] < 1.0 + slow.fold_position) ++n;
    ASSERT_LT(n + 1, x.size());
    const double part = (1.0 + slow.fold_position - x[n]) / (x[n + 1] - x[n]);
    beyond.push_back(force[n] + part * (force[n + 1] - force[n]) - slow.fold_force);
  }
  // At the fold the tip already moves: its drag, which falls as v^(2/3).
  EXPECT_NEAR(fitted_power(speeds, beyond), 2.0 / 3.0, 0.07);
  EXPECT_LT(std::abs(beyond.front()), 0.02 * slow.fold_force);
  // The largest force is another one, well apart at this s.
  EXPECT_GT(kLargestForce - slow.fold_force, 0.1 * kLargestForce);
}

TEST(PrandtlTomlinson, MeanForceExceedsItsSlowLimitAsTwoThirds) {
  const QuasiStatic slow(parameter_of(kStickSlip, "s"));
  const std::vector<double> speeds = {1e-4, 3e-4, 1e-3};
  std::vector<double> beyond;
  for (const double v : speeds) {
    beyond.push_back(mean_force(run_shipped(kStickSlip, {{"v", text_of(v)}})) - slow.mean_force);
  }
  for (const double excess : beyond) EXPECT_GT(excess, 0.0);
  EXPECT_NEAR(fitted_power(speeds, beyond), 2.0 / 3.0, 0.02);
}

TEST(PrandtlTomlinson, OverdampedSlipsGoOnePeriod) {
  Trace trace;
  run_shipped(kStickSlip, {}, &trace);
  const auto lengths = slips(trace["tip.centre_of_mass.x"], kPeriod);
  EXPECT_GE(lengths.size(), 5U);
  for (const double length : lengths) EXPECT_LT(length, 1.0);
}

TEST(PrandtlTomlinson, UnderdampedSlipsGoSeveralPeriods) {
  Trace trace;
  run_shipped(kMultipleSlip, {}, &trace);
  const auto lengths = slips(trace["tip.centre_of_mass.x"], kPeriod);
  ASSERT_GE(lengths.size(), 5U);
  for (const double length : lengths) EXPECT_GT(length, 1.5);

  // Damping of the same spring beyond the critical one brings back single slips.
  Trace damped;
  run_shipped(kMultipleSlip, {{"damping", "2"}}, &damped);
  const auto single = slips(damped["tip.centre_of_mass.x"], kPeriod);
  ASSERT_GE(single.size(), 20U);
  for (const double length : single) EXPECT_LT(length, 1.0);
}

TEST(PrandtlTomlinson, WithoutInertiaAConstantForceGivesTheKnownSpeed) {
  for (const double force : {0.629, 0.65, 0.7, 1.0, 2.0, 10.0}) {
    const auto result = run_shipped(kOverdamped, {{"F", text_of(force)}});
    const double speed = std::sqrt(force * force - kLargestForce * kLargestForce);  // xi = 1
    // 1e-11 per step, a thousand steps; close to F_c an error in force counts 30 times.
    EXPECT_NEAR(result.body(0)["mean_velocity"].at(0) / speed, 1.0, 1e-7) << "F = " << force;
  }
  const auto held = run_shipped(kOverdamped, {{"F", "0.6"}, {"run.duration", "100"}});
  const double rest = 0.5 + std::asin(0.6 / kLargestForce) / (2.0 * kPi);
  EXPECT_NEAR(held.body(0)["centre_of_mass"].at(0), rest,
              1e-9);  // decays at 1.2 per time
}

/// The stick-slip scene without inertia.
RunResult run_without_inertia(double v) {
  return run_shipped(kStickSlip, {{"run.dynamics", "\"overdamped\""}, {"v", text_of(v)}});
}

TEST(PrandtlTomlinson, WithoutInertiaTheLargestForceIsTheSteepestSlopeAndDrag) {
  const double xi = parameter_of(kStickSlip, "xi");
  const std::vector<double> speeds = {1e-4, 2e-4, 4e-4};
  std::vector<double> short_by;
  for (const double v : speeds) {
    const auto result = run_without_inertia(v);
    short_by.push_back(kLargestForce + xi * v - result.driver(0)["max_force"].at(0));
    EXPECT_LT(std::abs(short_by.back()), 0.05 * xi * v) << "v = " << v;
  }
  EXPECT_NEAR(fitted_power(speeds, short_by), 2.0, 0.2);  // drag is there to first order
}

TEST(PrandtlTomlinson, WithoutInertiaSlipsComeLateAsAirysEquationSays) {
  const double s = parameter_of(kStickSlip, "s");
  const double xi = parameter_of(kStickSlip, "xi");
  const QuasiStatic slow(s);
  const double k = stiffness_of(s);
  const double bend = kLargestForce * 2.0 * kPi * kPi * std::sqrt(1.0 - 1.0 / (s * s));
  constexpr double kAiryZero = 2.338107410459767;
  for (const double v : {2.5e-5, 1e-4, 4e-4}) {
    const double late = kAiryZero * std::pow(xi * v, 2.0 / 3.0) / std::cbrt(bend * k);
    const double excess = mean_force(run_without_inertia(v)) - slow.mean_force;
    // The leading order: the fold is not quite a parabola.
    EXPECT_NEAR(excess / (k * slow.slip * late), 1.0, 0.005) << "v = " << v;
  }
}

const std::string kReleased = tables(R"toml(
[parameters] | damping = 1.0 | m = 4.0 | V0 = 0.1
[[body]] | name = "tip" | type = "point" | position = [0.501] | particle_mass = "m"
[[force]] | type = "viscous_damping" | coefficient = "damping * 4 * pi * sqrt(m * V0)"
[[force]] | type = "sinusoidal_substrate" | amplitude = "V0" | period = 1.0
[run] | duration = 60.0
integrator = { type = "dopri5", absolute_tolerance = 1e-12, relative_tolerance = 1e-12 }
[output] | every = 0.1
)toml");

TEST(PrandtlTomlinson, UnderdampedMeansBelowTheRootOfMassTimesAmplitude) {
  // With m = 4 the criterion with sqrt(V0/m) would be off by a factor of four.
  for (const bool underdamped : {true, false}) {
    Trace trace;
    RunOptions options;
    options.sink = &trace;
    const std::vector<Setting> settings = {{"damping", underdamped ? "0.9" : "1.1"}};
    finished(run(parse_scene(kReleased, "released.toml", registry(), settings), options));
    const auto& x = trace["tip.centre_of_mass.x"];
    const double farthest = *std::min_element(x.begin(), x.end()) - 0.5;
    if (underdamped) {
      EXPECT_LT(farthest, -1e-7);  // overshoots by exp(-pi 0.9/sqrt(1 - 0.81)) = 1.5e-3 of 1e-3
    } else {
      EXPECT_GT(farthest, -1e-11);
    }
  }
}

const std::string kWashboard = tables(R"(
[parameters] | m = 1e-2 | F = 1.0 | T = 1.0
[[body]] | type = "point" | position = [0.0] | particle_mass = "m"
[[force]] | type = "constant_force" | force = ["F"]
[[force]] | type = "viscous_damping" | coefficient = 1.0
[[force]] | type = "sinusoidal_substrate" | amplitude = 0.1 | period = 1.0
[run] | duration = "12 * T"
integrator = { type = "dopri5", absolute_tolerance = 1e-11, relative_tolerance = 1e-11 }
[measure] | from = "2 * T" | to = "12 * T"
)");

TEST(PrandtlTomlinson, RunsDownTheWashboardAtTheKnownSpeed) {
  for (const double force : {0.7, 1.0, 2.0}) {
    const double speed = std::sqrt(force * force - kLargestForce * kLargestForce);  // xi = 1
    const auto measured = [&](double mass) {
      // Ten periods of the massless tip.
      const auto result = run_text(
          kWashboard, {{"m", text_of(mass)}, {"F", text_of(force)}, {"T", text_of(1.0 / speed)}});
      return result.body(0)["mean_velocity"].at(0);
    };
    // The closed form has no mass. To first order in m the mass changes the drag by m F'(x)/xi,
    // which cancels over a period; what remains is of second order, and two masses remove it.
    const double heavy = measured(4e-3);
    const double light = measured(2e-3);
    EXPECT_NEAR((heavy - speed) / (light - speed), 4.0, 0.15) << "F = " << force;
    EXPECT_NEAR((4.0 * light - heavy) / 3.0 / speed, 1.0, 2e-6) << "F = " << force;
    EXPECT_GT(std::abs(heavy / speed - 1.0), 5e-5) << "F = " << force;
  }
}

/// The mean of the driver's pull on a damped oscillator, started at rest with a slack spring:
/// u = v t - x obeys m u'' + xi u' + k u = xi v, u(0) = 0, u'(0) = v.
double exact_pull(double m, double k, double xi, double v, double from, double to) {
  using Complex = std::complex<double>;
  const double rest = xi * v / k;
  const Complex root = std::sqrt(Complex(xi * xi - 4.0 * m * k, 0.0));
  const Complex r1 = (-xi + root) / (2.0 * m);
  const Complex r2 = (-xi - root) / (2.0 * m);
  const Complex c1 = (v + rest * r2) / (r1 - r2);
  const Complex c2 = -rest - c1;
  const auto integral = [&](double t) {
    return rest * t + (c1 / r1 * std::exp(r1 * t) + c2 / r2 * std::exp(r2 * t)).real();
  };
  return k * (integral(to) - integral(from)) / (to - from);
}

TEST(PrandtlTomlinson, WithoutCorrugationIsTheDrivenOscillator) {
  const double k = stiffness_of(parameter_of(kSmooth, "s"));
  for (const double xi : {0.1, 2.0, 20.0}) {  // critical: 5.6
    const auto result = run_shipped(kSmooth, {{"force.sinusoidal_substrate.amplitude", "0.0"},
                                              {"xi", text_of(xi)},
                                              {"run.duration", "12"},
                                              {"measure.from", "0.5"},
                                              {"measure.to", "7.0"},
                                              {"measure.in", "time"}});
    const double exact = exact_pull(1.0, k, xi, 1e-3, 0.5, 7.0);
    // 1e-11 per step in u of order 1e-3, some hundred steps.
    EXPECT_NEAR(mean_force(result) / exact, 1.0, 1e-6) << "xi = " << xi;
    // Not just the steady drag, xi v: the transient is in it.
    EXPECT_GT(std::abs(exact / (xi * 1e-3) - 1.0), 1e-3) << "xi = " << xi;
  }
}

}  // namespace
}  // namespace tomlin::test
