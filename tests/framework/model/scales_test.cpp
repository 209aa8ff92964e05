#include "framework/model/scales.hpp"

#include <cmath>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "tests/support/ring_scenes.hpp"

// The scales of a scene against closed forms.

namespace tomlin::test {
namespace {

const double kTau = 2.0 * std::acos(-1.0);
constexpr double kRounding = 1e-12;  // of a few operations on numbers of order one
// A scan of 200 positions meets the largest slope of a sinusoid to (pi/200)^2/2.
constexpr double kScan = 2e-4;
// Slopes of a linear spring by differences over a thousandth of a period, some lengths away.
constexpr double kDifferences = 1e-11;

Scales scales(const std::string& text) { return scales_of(scene_of(text)); }

const ForceScale& of(const Scales& scales, std::string_view force) {
  for (const ForceScale& scale : scales.forces) {
    if (scale.force == force) return scale;
  }
  throw std::logic_error("no force " + std::string(force));
}

TEST(Scales, OfATip) {
  const TipScene tip{.velocity = 0.25, .stiffness = 2.0, .damping = 1.5, .period = 0.5};
  const Scales found = scales(tip.text());
  const double curvature = 0.1 * kTau * kTau / 0.25;
  EXPECT_NEAR(of(found, "driver").frequency, std::sqrt(2.0), kRounding);
  EXPECT_NEAR(of(found, "sinusoidal_substrate").frequency, std::sqrt(curvature), 10 * kRounding);
  EXPECT_NEAR(of(found, "viscous_damping").damping_rate, 1.5, kRounding);
  EXPECT_NEAR(found.frequency, std::sqrt(2.0 + curvature), 10 * kRounding);
  EXPECT_NEAR(found.shortest_time, 1.0 / found.frequency, kRounding);
  EXPECT_EQ(found.stiffest_force, "sinusoidal_substrate");
  EXPECT_TRUE(found.misfits.empty());

  ASSERT_EQ(found.sliding.size(), 1u);
  const Sliding& sliding = found.sliding.front();
  EXPECT_EQ(sliding.body, "tip");
  EXPECT_EQ(sliding.driver, "driver");
  EXPECT_EQ(sliding.substrate, "sinusoidal_substrate");
  EXPECT_NEAR(sliding.stick_slip(), curvature / 2.0, 10 * kRounding);
  EXPECT_NEAR(sliding.stick_slip_as_placed(), curvature / 2.0, kScan * curvature);
  EXPECT_NEAR(sliding.washboard_frequency, kTau * 0.25 / 0.5, kRounding);
}

TEST(Scales, AWashboardMayBeTheFastestOfAll) {
  const Scales found = scales(TipScene{.velocity = 100.0}.text());
  EXPECT_NEAR(found.shortest_time, 1.0 / (kTau * 100.0), kRounding);
}

TEST(Scales, RegimeAgainstTheCriticalDamping) {
  const double omega = std::sqrt(0.1) * kTau;  // of the substrate, which is faster than the driver
  const auto damping = [&](double parts) {
    return scales(TipScene{.damping = 2.0 * omega * parts}.text()).damping;
  };
  EXPECT_EQ(damping(0.0).regime, Regime::undamped);
  EXPECT_EQ(damping(0.99).regime, Regime::underdamped);
  EXPECT_EQ(damping(1.0).regime, Regime::critically_damped);
  EXPECT_EQ(damping(1.01).regime, Regime::overdamped);
  EXPECT_EQ(damping(1.01).oscillator, "sinusoidal_substrate");
  EXPECT_NEAR(damping(1.01).critical, 2.0 * omega, 10 * kRounding);
}

/// A turned lattice has no period along the axis, one whose waves decay with height no bound on its
/// curvature: as the tip is placed, on an atom, both have the curvature of the closed form.
TEST(Scales, ALatticeWithoutAPeriodOrABoundHasItsCurvatureAsPlaced) {
  constexpr double kAmplitude = 0.3;
  constexpr double kDecay = 3.0;
  constexpr double kHeight = 0.5;
  constexpr double kSpring = 2.0;
  const auto found = [&](const std::string& position, const std::string& rest) {
    const std::string across = position == "0, 0" ? ", 0.0" : ", 0.0, 0.0";
    return scales(
        "[[body]]\nname = \"tip\"\ntype = \"point\"\nparticle_mass = 1.0\nposition = [" + position +
        "]\n[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nvelocity = " + "[0.1" +
        across + "]\nstiffness = " + digits(kSpring) +
        "\n[[force]]\nname = \"surface\"\ntype = \"lattice_substrate\"\nlattice = "
        "\"square\"\nperiod = 1.0\namplitude = " +
        digits(kAmplitude) + "\n" + rest +
        "[run]\nduration = 1.0\nintegrator = " + fixed_step(1e-3) + "\n");
  };
  const double curvature = kAmplitude * kTau * kTau;
  const Scales turned = found("0, 0", "misfit = 0.3\n");
  const Scales high = found("0, 0, " + digits(kHeight), "decay = " + digits(kDecay) + "\n");
  EXPECT_TRUE(turned.sliding.empty() && high.sliding.empty());
  ASSERT_EQ(turned.sliding_as_placed.size(), 1u);
  ASSERT_EQ(high.sliding_as_placed.size(), 1u);
  EXPECT_EQ(turned.sliding_as_placed.front().period, 0.0);
  EXPECT_EQ(high.sliding_as_placed.front().period, 1.0);
  EXPECT_NEAR(turned.sliding_as_placed.front().stick_slip_as_placed(), curvature / kSpring,
              kScan * curvature);
  EXPECT_NEAR(high.sliding_as_placed.front().stick_slip_as_placed(),
              curvature * std::exp(-kDecay * kHeight) / kSpring, kScan * curvature);
}

/// Dry friction has no rate of its own, but near rest it is the fastest of all. A rigid body moves
/// by the mean of its particles.
TEST(Scales, DryFrictionIsFastestNearRest) {
  const std::string friction =
      "[[force]]\ntype = \"coulomb_friction\"\nforce = 0.5\nwidth = 1e-3\n";
  for (const char* coordinates : {"particles", "rigid"}) {
    const std::string ring = RingScene{.coordinates = coordinates}.text();
    const Scales found = scales(friction + ring);
    constexpr double kRate = 0.5 / 1e-3 * 8.0;  // of a mass of 1/8
    EXPECT_NEAR(of(found, "coulomb_friction").rate_at_rest, kRate, kRounding * kRate);
    EXPECT_EQ(of(found, "coulomb_friction").damping_rate, 0.0);
    EXPECT_EQ(of(found, "viscous_damping").rate_at_rest, 0.0);
    EXPECT_NEAR(found.shortest_time, 1.0 / kRate, kRounding);
    EXPECT_EQ(found.damping.rate, scales(ring).damping.rate);
  }
}

/// Stiff bonds shake within the ring; its position does not feel them.
TEST(Scales, BondsAreNotWhatTheBodySlidesBy) {
  const Scales found = scales(RingScene{.bonds = 1e6}.text());
  EXPECT_TRUE(of(found, "harmonic_bonds").internal);
  EXPECT_NEAR(of(found, "harmonic_bonds").frequency, std::sqrt(8.0 * 1e6 * 8.0), 1e-6);
  EXPECT_EQ(found.stiffest_force, "harmonic_bonds");
  EXPECT_EQ(found.damping.oscillator, "sinusoidal_substrate");
}

TEST(Scales, ARingsBoundHoldsWhateverItsHeightAndCoordinates) {
  const double bound = 0.1 * kTau * kTau / 2.0;
  for (const char* coordinates : {"particles", "rigid"}) {
    for (const double decay : {0.0, 0.5, 3.0}) {
      const Scales found = scales(RingScene{.coordinates = coordinates, .decay = decay}.text());
      ASSERT_EQ(found.sliding.size(), 1u) << "pulled along x only";
      const Sliding& sliding = found.sliding.front();
      EXPECT_NEAR(sliding.stick_slip(), bound, 10 * kRounding);
      EXPECT_GT(sliding.stick_slip_as_placed(), 0.0);
      EXPECT_LE(sliding.stick_slip_as_placed(), bound * (1.0 + kScan));
      EXPECT_EQ(sliding.rolling_radius, 1.0);
    }
  }
}

std::string driven_chain(const std::string& spacing, int count, const std::string& velocity) {
  return "[parameters]\nb = \"" + spacing +
         "\"\n[[body]]\nname = \"chain\"\ntype = \"chain\"\nspacing = \"b\"\nparticle_mass = 1.0\n"
         "count = " +
         std::to_string(count) +
         "\n[[force]]\ntype = \"driving_spring\"\nname = \"driver\"\nstiffness = 0.5\n"
         "attach = \"each_particle\"\nvelocity = [" +
         velocity +
         "]\n[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = 0.2\nperiod = 2.0\n"
         "[run]\nduration = 1.0\nintegrator = { type = \"rk4\", dt = 1e-3 }\n";
}

TEST(Scales, AChainInStepMeetsTheBoundAndOneOutOfStepCancels) {
  const double bound = 0.2 * kTau * kTau / 4.0 / 0.5;
  const Sliding in_step = scales(driven_chain("2.0", 8, "0.1")).sliding.at(0);
  EXPECT_NEAR(in_step.stick_slip(), bound, 10 * kRounding);
  EXPECT_NEAR(in_step.stick_slip_as_placed(), bound, kScan * bound);
  const Sliding cancelled = scales(driven_chain("2.0 * 5 / 8", 8, "0.1")).sliding.at(0);
  EXPECT_NEAR(cancelled.stick_slip(), bound, 10 * kRounding);
  EXPECT_LT(cancelled.stick_slip_as_placed(), 1e-9);
}

TEST(Scales, ADriverAtRestPullsOverNothing) {
  EXPECT_TRUE(scales(driven_chain("2.0", 8, "0.0")).sliding.empty());
}

// ---- a driver on one body, the substrate under another

constexpr double kSpring = 2.0;
constexpr double kBond = 3.0;

struct Pulled {
  double amplitude = 0.1;
  std::string support = "position = [-1.5]";  ///< of what the driver pulls
  std::string bond =
      "type = \"harmonic_bonds\"\npairs = \"all\"\nstiffness = 3.0\nrest_lengths = 2.0";
  std::string more = {};
  std::string run = "duration = 1.0\nintegrator = { type = \"rk4\", dt = 1e-3 }";

  std::string text() const {
    return "[[body]]\nname = \"support\"\ntype = \"point\"\nparticle_mass = 1.0\n" + support +
           "\n[[body]]\nname = \"tip\"\ntype = \"point\"\nposition = [0.5]\nparticle_mass = 1.0\n"
           "[[force]]\ntype = \"driving_spring\"\nname = \"driver\"\nbody = \"support\"\n"
           "stiffness = 2.0\nvelocity = [0.1]\n"
           "[[force]]\nname = \"lever\"\nbodies = [\"support\", \"tip\"]\n" +
           bond +
           "\n[[force]]\ntype = \"sinusoidal_substrate\"\nname = \"substrate\"\nbody = \"tip\"\n"
           "amplitude = " +
           digits(amplitude) + "\nperiod = 1.0\n" + more + "[run]\n" + run + "\n";
  }
};

TEST(Scales, ABondBetweenTwoBodiesIsNotWithinOne) {
  const Scales found = scales(Pulled{}.text());
  EXPECT_FALSE(of(found, "lever").internal);
  EXPECT_EQ(of(found, "lever").between, (std::vector<std::string>{"support", "tip"}));
  EXPECT_TRUE(of(found, "driver").between.empty());
  // It is the fastest that the bodies' positions feel: two masses of one on a spring of three.
  EXPECT_EQ(scales(Pulled{.amplitude = 1e-3}.text()).damping.oscillator, "lever");
}

TEST(Scales, ADriverAndABondAreSpringsInSeries) {
  const double curvature = 0.1 * kTau * kTau;
  const double series = kSpring * kBond / (kSpring + kBond);
  for (const char* more :
       {"",
        "[[force]]\ntype = \"viscous_damping\"\nname = \"drag\"\nbody = \"support\"\n"
        "coefficient = 1.0\n[[force]]\ntype = \"constant_force\"\nbody = \"tip\"\n"
        "force = [0.2]\n"}) {
    const Scales found = scales(Pulled{.more = more}.text());
    ASSERT_EQ(found.sliding.size(), 1u);
    EXPECT_TRUE(found.transmissions.empty());
    const Sliding& sliding = found.sliding.front();
    EXPECT_EQ(sliding.body, "tip");
    EXPECT_EQ(sliding.driver, "driver");
    EXPECT_EQ(sliding.bond, "lever");
    EXPECT_NEAR(sliding.bond_stiffness, kBond, kBond * kDifferences);
    EXPECT_NEAR(sliding.stick_slip(), curvature / series, curvature / series * kDifferences);
    EXPECT_NEAR(sliding.washboard_frequency, kTau * 0.1, kRounding);
  }
}

/// The stick-slip number separates sliding, below one, from slips, above one.
TEST(Scales, TheSeriesStiffnessIsWhatStickSlipBeginsAt) {
  const auto slips = [](double s) {
    const double series = kSpring * kBond / (kSpring + kBond);
    Pulled pulled{.amplitude = s * series / (kTau * kTau)};
    pulled.run = "dynamics = \"quasistatic\"\nduration = 30.0";
    EXPECT_NEAR(scales(pulled.text()).sliding.at(0).stick_slip(), s, s * kDifferences);
    return run_text(pulled.text()).group("events")["slips"].value();
  };
  EXPECT_EQ(slips(0.99), 0u);
  EXPECT_GE(slips(1.01), 2u);
}

/// A second spring, a bond that is not linear, a body between, a spring askew: no number is right.
TEST(Scales, NoSeriesStiffnessWhereThereIsMoreThanOneLinearSpring) {
  const std::string spring =
      "[[force]]\ntype = \"driving_spring\"\nname = \"other\"\nvelocity = [0.0]\nstiffness = 1.0\n";
  const auto expect_none = [](const Pulled& pulled) {
    const Scales found = scales(pulled.text());
    EXPECT_TRUE(found.sliding.empty()) << pulled.text();
    ASSERT_EQ(found.transmissions.size(), 1u) << pulled.text();
    EXPECT_EQ(found.transmissions.front().driver, "driver");
    EXPECT_EQ(found.transmissions.front().body, "support");
    EXPECT_EQ(found.transmissions.front().sliding_body, "tip");
    EXPECT_EQ(found.transmissions.front().substrate, "substrate");
  };
  expect_none({.more = spring + "body = \"support\"\n"});
  expect_none({.more = spring + "body = \"tip\"\n"});
  expect_none({.bond = "type = \"morse_bonds\"\npairs = \"all\"\ndepth = 1.0\ninverse_width = 1.0\n"
                       "rest_lengths = 2.0"});
  expect_none({.bond = "type = \"expression\"\nenergy = \"(1 + t) * r^2\""});
  expect_none({.support = "position = [0.4]"});
  expect_none({.more = "[[force]]\ntype = \"expression\"\nname = \"beside\"\n"
                       "bodies = [\"support\", \"tip\"]\nenergy = \"r^2\"\n"});
}

TEST(Scales, ADriverIsNotOverTheSubstrateOfABodyThatItDoesNotPull) {
  const std::string wall = "position = [-1.5]\ncoordinates = \"fixed\"";
  EXPECT_TRUE(scales(Pulled{.support = wall}.text()).transmissions.empty());
  EXPECT_TRUE(scales(Pulled{.support = wall}.text()).sliding.empty());
  const Scales own = scales(Pulled{.more = "[[force]]\ntype = \"sinusoidal_substrate\"\n"
                                           "name = \"other\"\nbody = \"support\"\n"
                                           "amplitude = 0.3\nperiod = 1.0\n"}
                                .text());
  ASSERT_EQ(own.sliding.size(), 1u) << "its own substrate is what it is pulled over";
  EXPECT_EQ(own.sliding.front().body, "support");
  EXPECT_TRUE(own.transmissions.empty());
}

TEST(Scales, SpacingAgainstPeriod) {
  const auto misfit = [](const std::string& spacing) {
    return scales(driven_chain(spacing, 8, "0.1")).misfits.at(0);
  };
  EXPECT_NEAR(misfit("2.0").misfit(), 0.0, kRounding);
  EXPECT_NEAR(misfit("2.2").misfit(), 0.1, kRounding);
  EXPECT_NEAR(misfit("4.2").misfit(), 0.1, kRounding);
  EXPECT_NEAR(misfit("1.2").misfit(), -0.4, kRounding);
  EXPECT_NEAR(misfit("0.2").misfit(), -0.9, kRounding) << "no particles without a period";
  EXPECT_TRUE(scales(RingScene{}.text()).misfits.empty()) << "a ring has no spacing along x";
}

TEST(Fractions, AreFoundWhereThereAreAny) {
  const auto expect = [](double ratio, std::int64_t p, std::int64_t q) {
    const auto fraction = as_fraction(ratio);
    ASSERT_TRUE(fraction) << ratio;
    EXPECT_EQ(fraction->p, p);
    EXPECT_EQ(fraction->q, q);
  };
  expect(1.0, 1, 1);
  expect(0.5, 1, 2);
  expect(21.0 / 34.0, 21, 34);
  expect(610.0 / 987.0, 610, 987);
  expect(377.0 / 233.0, 377, 233);
  expect(1000.0, 1000, 1);
  EXPECT_FALSE(as_fraction(0.5 * (std::sqrt(5.0) - 1.0)));
  EXPECT_FALSE(as_fraction(std::sqrt(2.0)));
  EXPECT_FALSE(as_fraction(1597.0 / 2584.0)) << "a denominator above 1000";
  EXPECT_FALSE(as_fraction(0.5 + 1e-7));
}

}  // namespace
}  // namespace tomlin::test
