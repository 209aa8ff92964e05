#include "framework/run/events/events.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/numbers/random.hpp"
#include "tests/support/order.hpp"
#include "tests/support/resumed.hpp"
#include "tests/support/ring_scenes.hpp"

// Slips, reversals, hops and turns, against what fine samples of the same run show.

namespace tomlin::test {
namespace {

constexpr double kPi = 3.14159265358979323846;

// The polynomial through the last points.

struct Points {
  std::vector<double> reals = std::vector<double>(LastPoints::kReals);
  std::vector<std::int64_t> integers = std::vector<std::int64_t>(LastPoints::kIntegers);
  LastPoints points{reals.data(), integers.data()};
};

TEST(LastPoints, ArePassedThroughByTheirPolynomial) {
  const auto quartic = [](double t) { return 1.0 + t * (2.0 + t * (-3.0 + t * (0.5 - t))); };
  const auto slope = [](double t) { return 2.0 + t * (-6.0 + t * (1.5 - 4.0 * t)); };
  Points all;
  for (const double t : {-9.0, -7.0, 0.1, 0.3, 0.35, 0.7, 1.0}) all.points.add(t, quartic(t));
  constexpr double kRounding = 1e-12;
  for (const double t : {0.2, 0.5, 0.9, 1.1}) {
    EXPECT_NEAR(all.points.at(t), quartic(t), kRounding);
    EXPECT_NEAR(all.points.slope_at(t), slope(t), kRounding);
  }
  EXPECT_NEAR(all.points.when_value_is(quartic(0.8), 0.7, 1.0), 0.8, kRounding);
  EXPECT_NEAR(all.points.when_slope_is(slope(0.85), 0.7, 1.0), 0.85, kRounding);
  // A polynomial that does not pass the level has the nearer end.
  EXPECT_EQ(all.points.when_value_is(1e3, 0.7, 1.0), 0.7);
}

/// A block of points leaves the same bits, and the same events, as the points one by one.
TEST(DriverWatch, OfBlocksIsThatOfTheirPoints) {
  Drive drive;
  drive.velocity = {0.1};
  drive.stiffness = {2.0};
  constexpr double kStep = 0.01;
  struct One {
    explicit One(const Drive& drive) : watch(0, drive, 1.0, 2.3e-16, DriverWatch::Slips::detected) {
      watch.attach(reals.data(), integers.data());
      watch.start();
    }
    std::vector<double> reals = std::vector<double>(DriverWatch::kReals);
    std::vector<std::int64_t> integers = std::vector<std::int64_t>(DriverWatch::kIntegers);
    DriverWatch watch;
    std::vector<double> events;
  };
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    One blocks(drive);
    One points(drive);
    const DriverWatch::Heat heat = [](double time) { return DriverWatch::HeatAt{time, 1.0}; };
    const auto keep = [](One& one) {
      return [&one](const Event& event) {
        one.events.insert(one.events.end(), {event.time, event.duration, event.size});
      };
    };
    double force = 0.0;
    std::size_t step = 0;
    for (std::uint64_t block = 0; block < 2000; ++block) {
      const auto random = [&](std::uint64_t k) {
        return uniform_symmetric({seed, 1}, {block, k, 0, 0});
      };
      const auto count = static_cast<std::size_t>(8.5 + 8.4 * random(0));
      std::vector<double> times;
      std::vector<double> forces;
      for (std::size_t n = 0; n < count; ++n, ++step) {
        // It sticks, and now and then slips or is pushed back.
        const double rare = random(n + 1);
        force += drive.stiffness.front() * drive.velocity[0] * kStep *
                 (rare > 0.995   ? -400.0
                  : rare < -0.99 ? 1.5
                                 : 0.9);
        times.push_back(kStep * static_cast<double>(step));
        forces.push_back(force);
      }
      blocks.watch.add_block(times.data(), forces.data(), count, keep(blocks), heat);
      for (std::size_t n = 0; n < count; ++n) {
        points.watch.add(times[n], forces[n], keep(points), heat);
      }
      ASSERT_EQ(blocks.reals, points.reals) << "block " << block;
      ASSERT_EQ(blocks.integers, points.integers) << "block " << block;
    }
    EXPECT_EQ(blocks.events, points.events);
    EXPECT_GT(blocks.events.size(), 30u);
  }
}

TEST(LastPoints, FindMomentsToTheFourthOrder) {
  std::vector<double> steps, errors;
  // sin t exp(-t/3) is highest where tan t = 3.
  const double highest = std::atan(3.0);
  for (const double h : {0.2, 0.1, 0.05, 0.025}) {
    Points all;
    for (int k = -3; k < 3; ++k) {
      const double t = highest + (k + 0.3) * h;
      all.points.add(t, std::sin(t) * std::exp(-t / 3.0));
    }
    steps.push_back(h);
    errors.push_back(std::abs(all.points.when_slope_is(0.0, highest - h, highest + h) - highest));
  }
  EXPECT_TRUE((Window{3.5, 5.5}).holds(fitted_order(steps, errors))) << fitted_order(steps, errors);
}

// A tip.

struct Watched {
  KeptSamples kept;
  RunResult result;

  explicit Watched(const std::string& text, const std::vector<Setting>& settings = {}) {
    result = run(scene_of(text, settings), watched_by(kept));
  }
  std::vector<double> column(const std::string& name) const {
    std::vector<double> values;
    for (const auto& row : kept.rows) values.push_back(row[kept.column(name)]);
    return values;
  }
  /// A column at a time, by the parabola through three samples about it.
  double at(const std::string& name, double time, double every) const {
    const std::size_t c = kept.column(name);
    const auto k = std::clamp<std::size_t>(static_cast<std::size_t>(std::llround(time / every)), 1,
                                           kept.rows.size() - 2);
    const double u = time / every - static_cast<double>(k);
    const double y0 = kept.rows[k - 1][c], y1 = kept.rows[k][c], y2 = kept.rows[k + 1][c];
    return y1 + 0.5 * u * (y2 - y0) + 0.5 * u * u * (y2 - 2.0 * y1 + y0);
  }
};

constexpr double kEvery = 0.02;
const std::string kSampled = "[output]\nevery = " + digits(kEvery) + "\n";

/// Slips once a period, without or with swings after it.
TipScene slipping(double damping) {
  return {.velocity = 0.01,
          .stiffness = 1.0,
          .damping = damping,
          .amplitude = 0.1,
          .position = 0.5,
          .duration = 600.0,
          .integrator = fixed_step(0.02),
          .more = kSampled};
}

TEST(Slips, AreToldOneAPeriodWhateverTheSwingsAfterThem) {
  for (const double damping : {4.0, 1.5, 0.5}) {
    for (const std::string& integrator : {fixed_step(0.02), verlet(0.02), adaptive(1e-9)}) {
      TipScene tip = slipping(damping);
      tip.integrator = integrator;
      const Watched run(tip.text());
      const auto slips = run.kept.of(EventKind::slip);
      // Six periods of the driver; the first slip needs F_c/k = 0.63 of the first.
      EXPECT_GE(slips.size(), 5u) << damping << integrator;
      EXPECT_LE(slips.size(), 6u) << damping << integrator;
      EXPECT_EQ(run.result.group("events")["slips"], slips.size());
      for (const Event& slip : slips) {
        EXPECT_EQ(slip.name, "driver");
        EXPECT_GT(slip.size, 0.6);  // of a period, before what the spring draws it on by
        EXPECT_LT(slip.size, 1.1);
      }
    }
  }
}

TEST(Slips, HaveThePeakTheLengthAndTheMomentThatSamplesShow) {
  // Samples are 0.02 apart, the motion takes about 1: parabolas through them are good to 1e-6.
  constexpr double kOfSamples = 3e-6;
  for (const std::string& integrator : {fixed_step(0.02), adaptive(1e-10)}) {
    TipScene tip = slipping(1.5);
    tip.integrator = integrator;
    const Watched run(tip.text());
    const auto force = run.column("driver.force.x");
    const auto slips = run.kept.of(EventKind::slip);
    ASSERT_GE(slips.size(), 5u);
    for (const Event& slip : slips) {
      const auto k = static_cast<std::size_t>(slip.time / kEvery);
      const double highest = *std::max_element(force.begin() + k - 50, force.begin() + k + 50);
      EXPECT_NEAR(slip.peak_force, highest, kOfSamples);
      EXPECT_NEAR(slip.peak_force, run.at("driver.force.x", slip.time, kEvery), kOfSamples);
      const double way = run.at("tip.centre_of_mass.x", slip.time + slip.duration, kEvery) -
                         run.at("tip.centre_of_mass.x", slip.time, kEvery);
      EXPECT_NEAR(slip.size, way, kOfSamples);
      // It is ten times as fast as the driver for the last time when it ends.
      EXPECT_NEAR(std::abs(run.at("tip.velocity.x", slip.time + slip.duration, kEvery)), 0.1, 2e-3);
      // The tip is as fast as the driver at the highest force.
      EXPECT_NEAR(run.at("tip.velocity.x", slip.time, kEvery), 0.01, 1e-4);
    }
  }
}

/// A driver so fast that the tip is never ten times as fast, at a stick-slip parameter of 3.9 under
/// strong drag; and one as fast over a substrate that is too weak for wells.
TEST(Slips, AreCountedFromWellToWellAtAnySpeed) {
  constexpr double kPeriods = 12.0;
  for (const bool wells : {true, false}) {
    for (const std::string& integrator : {fixed_step(0.01), adaptive(1e-9)}) {
      TipScene tip = slipping(4.0);
      tip.velocity = 0.1;
      tip.amplitude = wells ? 0.1 : 0.02;
      tip.duration = kPeriods / tip.velocity;
      tip.integrator = integrator;
      const Watched run(tip.text());
      double fastest = 0.0;
      for (const double v : run.column("tip.velocity.x")) fastest = std::max(fastest, v);
      EXPECT_LT(fastest, 10.0 * tip.velocity) << "the test by speed would see them";
      const double slips = static_cast<double>(run.result.group("events")["slips"].value());
      EXPECT_GE(slips, wells ? kPeriods - 2.0 : 0.0) << integrator;
      EXPECT_LE(slips, wells ? kPeriods : 0.0) << integrator;
      for (const Event& slip : run.kept.of(EventKind::slip)) {
        EXPECT_GT(slip.size, 0.5);
        EXPECT_LT(slip.size, 1.2);
        EXPECT_GT(slip.energy_lost, 0.0);
      }
    }
  }
}

/// Tips in a row, each with its spring; a tip's period, and bonds that are relaxed in the wells.
std::string row_of(const TipScene& tip, int count, bool bonds) {
  std::string text = tip.text();
  const auto replace = [&text](const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
  };
  replace("type = \"point\"",
          "type = \"chain\"\ncount = " + std::to_string(count) + "\nspacing = 1.0");
  replace("position", "origin");
  replace("velocity = [0]\n", "");
  replace("type = \"driving_spring\"", "type = \"driving_spring\"\nattach = \"each_particle\"");
  if (bonds) {
    replace("[[force]]",
            "[[force]]\ntype = \"harmonic_bonds\"\npairs = \"neighbours\"\nstiffness = 5.0\n"
            "[[force]]");
  }
  return text;
}

/// A body whose particles do all the same slips as one of them does, at any speed: as often, as
/// far, and each particle loses as much. At the second speed no test by speed sees its slips.
TEST(Slips, OfAFlexibleBodyAreThoseOfEachParticle) {
  constexpr int kCount = 3;
  constexpr double kOfSteps = 1e-6;  // steps of either scheme, and heat between their ends
  for (const double velocity : {0.01, 0.1}) {
    for (const bool bonds : {false, true}) {
      for (const std::string& integrator : {fixed_step(0.01), adaptive(1e-10)}) {
        TipScene tip = slipping(4.0);
        tip.velocity = velocity;
        tip.duration = 8.0 / velocity;
        tip.integrator = integrator;
        const Watched one(tip.text());
        const Watched row(row_of(tip, kCount, bonds));
        const std::string which = digits(velocity) + integrator + (bonds ? " bonds" : "");
        const auto slips = row.kept.of(EventKind::slip);
        const auto of_one = one.kept.of(EventKind::slip);
        ASSERT_EQ(slips.size(), of_one.size()) << which;
        EXPECT_GE(slips.size(), 6u) << which;
        for (std::size_t k = 0; k < slips.size(); ++k) {
          EXPECT_NEAR(slips[k].time, of_one[k].time, kOfSteps * tip.duration) << which;
          EXPECT_NEAR(slips[k].size, of_one[k].size, kOfSteps) << which;
          EXPECT_NEAR(slips[k].energy_lost, kCount * of_one[k].energy_lost, kOfSteps) << which;
          EXPECT_NEAR(slips[k].peak_force, kCount * of_one[k].peak_force, kOfSteps) << which;
        }
        EXPECT_NEAR(*row.result.driver(0)["effective_stiffness"],
                    kCount * *one.result.driver(0)["effective_stiffness"], 0.02)
            << which << "; of chords over a twentieth of a period";
      }
    }
  }
}

/// However it swings between them, and none at the washboard resonance over a substrate that is too
/// weak for wells, where it stops in every period.
TEST(Slips, OfAFlexibleBodyAreOneAPeriod) {
  constexpr double kPeriods = 12.0;
  for (const double damping : {4.0, 1.5, 0.5}) {
    TipScene tip = slipping(damping);
    tip.velocity = 0.05;
    tip.amplitude = 0.15;
    tip.duration = kPeriods / tip.velocity;
    const Watched row(row_of(tip, 2, true));
    const auto slips = row.kept.of(EventKind::slip);
    const double moved = row.column("tip.centre_of_mass.x").back() - 1.0;
    EXPECT_NEAR(static_cast<double>(slips.size()), moved, 1.0) << damping;
  }
  TipScene tip = slipping(0.1);
  tip.velocity = 1.0 / (2.0 * kPi);
  tip.amplitude = 0.02;
  tip.duration = 100.0 / tip.velocity;
  EXPECT_EQ(Watched(row_of(tip, 2, true)).result.group("events")["slips"], 0u);
}

/// A ring that slides, or rolls over a substrate that only its lowest particles feel: flexible or
/// rigid, it slips once a period, or once a particle, at speeds that no test by speed sees.
TEST(Slips, OfARingAreAlikeInAllCoordinates) {
  constexpr double kPeriods = 8.0;
  for (const double decay : {0.0, 0.1}) {
    for (const char* coordinates : {"particles", "rigid"}) {
      RingScene ring;
      ring.coordinates = coordinates;
      ring.bonds = 100.0;
      ring.velocity = 0.05;
      ring.decay = decay;
      ring.duration = kPeriods / ring.velocity;
      ring.integrator = adaptive(1e-8);
      std::string text = ring.text();
      text.replace(text.find("2.0\nvelocity"), 3, "0.3");
      text.replace(text.find("2 * sqrt(2)"), 11, "1");
      const Watched run(text);
      const auto slips = run.kept.of(EventKind::slip);
      EXPECT_GE(slips.size(), 7u) << decay << coordinates;
      EXPECT_LE(slips.size(), 8u) << decay << coordinates;
    }
  }
}

/// At the washboard resonance the tip of a stick-slip parameter of 0.8 stops in every period, and
/// yet there is one well only. Its static force is then its largest, found between steps as that
/// is.
TEST(Slips, ResonantSlidingWithoutWellsHasNone) {
  constexpr double kRounding = 1e-13;
  for (const std::string& integrator : {fixed_step(0.1), adaptive(1e-7)}) {
    TipScene tip = slipping(0.1);
    tip.velocity = 1.0 / (2.0 * kPi);
    tip.amplitude = 0.02;
    tip.duration = 100.0 / tip.velocity;
    tip.integrator = integrator;
    const Watched run(tip.text());
    const auto speeds = run.column("tip.velocity.x");
    EXPECT_LT(*std::min_element(speeds.begin(), speeds.end()), 0.5 * tip.velocity);
    EXPECT_EQ(run.result.group("events")["slips"], 0u) << integrator;
    const ResultGroup& driver = run.result.driver(0);
    EXPECT_NEAR(*driver["static_force"], driver["max_force"][0], kRounding) << integrator;
    const auto forces = run.column("driver.force.x");
    EXPECT_GT(*driver["static_force"], *std::max_element(forces.begin(), forces.end()) - kRounding);
  }
}

/// Sizes of the slips of a point with these positions, under a driver of the speed 0.01.
template <class Position, class SetWells>
std::vector<double> slips_of(const Position& position, const SetWells& set_wells) {
  constexpr double kSpeed = 0.01;
  Drive drive;
  drive.velocity = {kSpeed};
  drive.stiffness = {1.0};
  DriverWatch watch(0, drive, 1.0, 1e-16, DriverWatch::Slips::detected);
  std::vector<double> reals(DriverWatch::kReals);
  std::vector<std::int64_t> integers(DriverWatch::kIntegers);
  watch.attach(reals.data(), integers.data());
  watch.start();
  set_wells(watch);
  std::vector<double> sizes;
  for (int k = 0; k < 1000; ++k) {
    const double t = 0.1 * k;
    watch.add(
        t, kSpeed * t - position(t),
        [&](const Event& event) {
          if (event.kind == EventKind::slip) sizes.push_back(event.size);
        },
        [](double time) {
          return DriverWatch::HeatAt{time, 0.0};
        });
  }
  return sizes;
}

constexpr double kOfAStep = 0.05;  // at most: corners of the way lie between two points

/// A point that comes to a halt on a barrier, for eight times the calm between two slips, and then
/// goes on to the next well: one slip, but two where wells are not known.
TEST(Slips, DoNotEndOnABarrier) {
  const auto position = [](double t) {
    if (t < 50.0) return 0.002 * t;
    if (t < 52.0) return 0.1 + 0.2 * (t - 50.0);
    if (t < 68.0) return 0.5 + 0.001 * (t - 52.0);
    if (t < 70.0) return 0.516 + 0.242 * (t - 68.0);
    return 1.0 + 0.002 * (t - 70.0);
  };
  for (const bool wells : {true, false}) {
    const std::vector<double> slips = slips_of(position, [&](DriverWatch& watch) {
      if (wells) watch.set_wells(0.0);
    });
    ASSERT_EQ(slips.size(), wells ? 1u : 2u);
    EXPECT_NEAR(slips[0], wells ? 0.9 : 0.4, kOfAStep);
  }
}

/// If wells are not known, slow motion is a slip if it leads about half a period further: not the
/// passage of one particle of several, and not motion that follows from the start.
TEST(Slips, ThatAreSlowLeadHalfAPeriodFurther) {
  // At rest, then 5.5 times as fast as the driver for this far.
  const auto slips_over = [](double size, double start) {
    return slips_of(
        [&](double t) { return 0.001 * t + 0.054 * std::clamp(t - start, 0.0, size / 0.054); },
        [](DriverWatch& watch) { watch.set_unknown_wells(); });
  };
  const auto slips = slips_over(0.7, 20.0);
  ASSERT_EQ(slips.size(), 1u);
  EXPECT_NEAR(slips.front(), 0.7, kOfAStep);
  EXPECT_TRUE(slips_over(0.35, 20.0).empty());
  EXPECT_TRUE(slips_over(0.7, 0.5).empty());
}

/// It only rolls to where it can stick: the static force is what the substrate can hold.
TEST(Slips, AStartOnTopOfABarrierIsNone) {
  TipScene tip = slipping(1.5);
  tip.position = 1e-3;
  const RunResult result = run_text(tip.text());
  const double strongest = 2.0 * kPi * tip.amplitude / tip.period;
  EXPECT_GT(*result.driver(0)["static_force"], strongest);
  EXPECT_LT(*result.driver(0)["static_force"], 1.05 * strongest);
  EXPECT_GE(*result.group("events")["slips"], 5u);
  EXPECT_LE(*result.group("events")["slips"], 6u);
}

/// Thrown back over some barriers at the start, the tip stretches its spring by far more than the
/// substrate holds: that is no static force.
TEST(Slips, WhatStretchesTheSpringInFlightIsNoStaticForce) {
  for (const std::string& integrator : {fixed_step(0.02), adaptive(1e-9)}) {
    TipScene tip = slipping(0.5);
    tip.start_velocity = -3.0;
    tip.integrator = integrator;
    const RunResult result = run_text(tip.text());
    const double strongest = 2.0 * kPi * tip.amplitude / tip.period;
    EXPECT_GT(result.driver(0)["max_force"][0], 1.5 * strongest);
    EXPECT_GT(*result.driver(0)["static_force"], strongest);
    EXPECT_LT(*result.driver(0)["static_force"], 1.05 * strongest);
  }
}

TEST(Slips, LoseTheEnergyThatTheDamperTakes) {
  // The sum is over whole samples: at the ends of a slip it lacks a part of one, in which an energy
  // of damping times speed squared times the time is lost.
  constexpr double kOfSamples = 1.5 * 0.1 * 0.1 * kEvery;
  const TipScene tip = slipping(1.5);
  const Watched run(tip.text());
  const auto v = run.column("tip.velocity.x");
  const auto slips = run.kept.of(EventKind::slip);
  ASSERT_FALSE(slips.empty());
  for (const Event& slip : slips) {
    double heat = 0.0;
    const auto first = static_cast<std::size_t>(slip.time / kEvery);
    const auto last = static_cast<std::size_t>((slip.time + slip.duration) / kEvery);
    for (std::size_t k = first; k < last; ++k) {
      heat += 0.5 * kEvery * 1.5 * (v[k] * v[k] + v[k + 1] * v[k + 1]);
    }
    EXPECT_NEAR(slip.energy_lost, heat, kOfSamples);
    EXPECT_GT(heat, 0.05);
  }
}

/// Whatever takes the steps of the scheme, and whatever the scheme.
TEST(Slips, LoseTheSameEnergyInEveryScheme) {
  // Errors of rk4 at this step, and of heat on the polynomial through adaptive steps' ends.
  constexpr double kOfTheSteps = 1e-5;
  for (const double velocity : {0.01, 0.1}) {  // told by speed, and from well to well
    const auto energies = [&](const std::string& integrator, const std::vector<Setting>& settings) {
      TipScene tip = slipping(1.5);
      tip.velocity = velocity;
      tip.duration = 4.0 / velocity;
      tip.integrator = integrator;
      tip.more = "";
      std::vector<double> all;
      for (const Event& slip : Watched(tip.text(), settings).kept.of(EventKind::slip)) {
        all.push_back(slip.energy_lost);
      }
      return all;
    };
    const std::vector<double> exact = energies(adaptive(1e-12, "dop853"), {});
    const std::vector<double> fine = energies(fixed_step(1e-3), {});
    ASSERT_GE(fine.size(), 3u);
    const auto expect_near = [&](const std::vector<double>& all, double tolerance) {
      ASSERT_EQ(all.size(), fine.size());
      for (std::size_t k = 0; k < all.size(); ++k) {
        EXPECT_NEAR(all[k], fine[k], tolerance * fine[k]) << velocity << " " << k;
      }
    };
    expect_near(energies(fixed_step(0.02), {}), kOfTheSteps);
    expect_near(energies(fixed_step(0.02), {{"run.ledger", "true"}}), kOfTheSteps);
    expect_near(energies(fixed_step(0.02), {{"output.every", "0.1"}}), kOfTheSteps);
    expect_near(energies(adaptive(1e-9), {}), kOfTheSteps);
    expect_near(exact, kOfTheSteps);
  }
}

// Loops.

struct Loop {
  double velocity = 0.1;
  double stiffness = 1.0;
  double amplitude = 0.15;
  double periods = 60.0;  ///< that the driver moves
  double low = 0.4;
  double high = 5.6;

  std::string text(const std::string& integrator, const std::string& more = "") const {
    return TipScene{.velocity = velocity,
                    .stiffness = stiffness,
                    .damping = 2.0,
                    .amplitude = amplitude,
                    .position = 0.5,
                    .duration = periods / velocity,
                    .integrator = integrator,
                    .more = more}
        .text();
  }
  std::vector<Setting> turns() const {
    return {{"force.driver.reverse", "{ when = \"driver.position.x\", above = " + digits(high) +
                                         ", below = " + digits(low) + " }"}};
  }
};

/// How often a tip has come to the bottom of another well, the next one along its driver's way, by
/// samples. A driver that turns while the tip is on a barrier may leave it in the well behind.
std::size_t changes_of_well(const Watched& run) {
  const std::vector<double> tip = run.column("tip.centre_of_mass.x");
  const std::vector<double> driver = run.column("driver.position.x");
  std::size_t changes = 0;
  double last = 0.0;  // it starts there
  for (std::size_t k = 1; k < tip.size(); ++k) {
    const double well = std::nearbyint(tip[k] - 0.5);
    if (std::abs(tip[k] - 0.5 - well) > 0.2 || well == last) continue;
    if ((well > last) == (driver[k] > driver[k - 1])) ++changes;
    last = well;
  }
  return changes;
}

/// Strokes of 5.2 periods, of which the spring takes up 2 F_c/k before the tip follows: from well
/// to well in both directions, at any speed. The first stroke begins in a well too.
TEST(Slips, AreCountedInEveryStrokeOfALoop) {
  // The spring's stretch at a turn is another part of a period in each.
  for (const auto& [velocity, stiffness] : {std::pair(0.02, 1.0), {0.1, 1.0}, {0.1, 1.4}}) {
    for (const std::string& integrator : {fixed_step(0.02), adaptive(1e-9)}) {
      const Loop loop{.velocity = velocity, .stiffness = stiffness};
      const Watched run(loop.text(integrator, kSampled), loop.turns());
      const std::size_t changes = changes_of_well(run);
      const std::vector<Event> slips = run.kept.of(EventKind::slip);
      EXPECT_GE(changes, 30u);
      EXPECT_EQ(slips.size(), changes) << velocity << integrator;
      EXPECT_EQ(*run.result.driver(0)["slips"], static_cast<double>(changes));
      // In each stroke as many, but in the first one, which begins at rest, and the last one.
      std::vector<double> turns;
      for (const Event& turn : run.kept.of(EventKind::driver_reversal)) turns.push_back(turn.time);
      ASSERT_GE(turns.size(), 10u);
      std::vector<std::size_t> in_stroke(turns.size() + 1);
      for (const Event& slip : slips) {
        const auto stroke = std::lower_bound(turns.begin(), turns.end(), slip.time) - turns.begin();
        ++in_stroke[static_cast<std::size_t>(stroke)];
        EXPECT_GT(slip.size, 0.5);
        EXPECT_LT(slip.size, 1.3);
        EXPECT_GT(slip.peak_force, 0.5);
        EXPECT_GT(slip.energy_lost, 0.2);
        EXPECT_GT(slip.duration, 0.0);
      }
      for (std::size_t k = 2; k + 1 < in_stroke.size(); ++k) {
        EXPECT_EQ(in_stroke[k], in_stroke[1]) << velocity << integrator << " stroke " << k;
      }
      EXPECT_GE(in_stroke[1], 2u);
    }
  }
}

TEST(Slips, OfALoopGoOnFromAnyStep) {
  for (const std::string& integrator : {fixed_step(0.1), adaptive(1e-6)}) {
    const Loop loop{.periods = 16.0};
    const auto scene = scene_of(loop.text(integrator), loop.turns());
    const RunResult expected = run_as_bound(scene);
    ASSERT_GE(*expected.driver(0)["slips"], 5.0);
    expect_same_driver_from(scene, expected, 5, 43);
  }
}

// Oblique pulls.

std::string oblique(const std::string& stiffness, const std::string& velocity,
                    const std::string& hold, double amplitude = 0.3) {
  return tables(R"(
[[body]] | name = "tip" | type = "point" | position = [0.5, 0.0] | particle_mass = 1.0
)") + hold +
         tables(R"(
[[force]] | name = "driver" | type = "driving_spring" | stiffness = )") +
         stiffness + "\nvelocity = " + velocity + tables(R"(
[[force]] | type = "sinusoidal_substrate" | period = 1.0 | amplitude = )") +
         digits(amplitude) + tables(R"(
[[force]] | type = "viscous_damping" | coefficient = 2.0
[run] | duration = 200.0 | integrator = { type = "rk4", dt = 0.02 }
[output] | every = 0.02
)");
}

/// The motion of the support along an axis without a spring pulls nothing.
TEST(Slips, MotionAlongAnAxisWithoutSpringPullsNothing) {
  const std::string hold = "hold = [\"y\"]";
  const Watched along(oblique("[2.0, 0.0]", "[0.02, 0.0]", hold));
  const Watched across(oblique("[2.0, 0.0]", "[0.02, 0.02]", hold));
  ASSERT_GE(*along.result.driver(0)["slips"], 3.0);
  for (const char* key : {"slips", "mean_slip_length", "mean_slip_force", "mean_slip_energy",
                          "effective_stiffness", "static_force"}) {
    ASSERT_TRUE(along.result.driver(0)[key]);
    EXPECT_EQ(*along.result.driver(0)[key], *across.result.driver(0)[key]) << key;
  }
}

TEST(Slips, ObliquePullsByUnequalSpringsHaveTheLengthOfThePointsWay) {
  constexpr double kOfSamples = 3e-6;
  for (const std::string stiffness : {"[1.0, 1.0]", "[1.0, 3.0]", "[1.5, 0.5]"}) {
    const Watched run(oblique(stiffness, "[0.02, 0.01]", "", 0.2));
    const std::vector<Event> slips = run.kept.of(EventKind::slip);
    ASSERT_GE(slips.size(), 2u) << stiffness;
    const double n[2] = {2.0 / std::sqrt(5.0), 1.0 / std::sqrt(5.0)};
    const auto along = [&](const std::string& what, double time) {
      return n[0] * run.at(what + ".x", time, kEvery) + n[1] * run.at(what + ".y", time, kEvery);
    };
    for (const Event& slip : slips) {
      const double way = along("tip.centre_of_mass", slip.time + slip.duration) -
                         along("tip.centre_of_mass", slip.time);
      EXPECT_NEAR(slip.size, way, kOfSamples) << stiffness;
      EXPECT_NEAR(slip.peak_force, along("driver.force", slip.time), kOfSamples) << stiffness;
    }
    // The way back of the swings after it, too.
    for (const Event& reversal : run.kept.of(EventKind::reversal)) {
      if (reversal.size < 1e-3) continue;
      EXPECT_NEAR(reversal.size,
                  along("tip.centre_of_mass", reversal.time) -
                      along("tip.centre_of_mass", reversal.time + reversal.duration),
                  1e-5)
          << stiffness;
    }
  }
}

TEST(Slips, ThereAreNoneInSmoothSliding) {
  TipScene tip = slipping(1.5);
  tip.stiffness = 8.0;  // s = 0.49
  const Watched run(tip.text());
  EXPECT_EQ(run.result.group("events")["slips"], 0u);
  EXPECT_EQ(run.result.group("events")["reversals"], 0u);
}

TEST(Slips, WithoutADriverOfSteadySpeedThereIsNoCount) {
  const TipScene tip{.velocity = 0.0};
  const RunResult result = run_text(tip.text());
  EXPECT_FALSE(result.group("events")["slips"].has_value());
  EXPECT_FALSE(result.group("events")["reversals"].has_value());
  EXPECT_FALSE(result.group("events")["hops"].has_value());
  EXPECT_FALSE(result.group("events")["turns"].has_value());
  EXPECT_FALSE(result.group("events")["driver_reversals"].has_value());
}

TEST(Reversals, AreThoseOfTheVelocity) {
  // Swings after each slip take the tip back again and again.
  const Watched run(slipping(0.3).text());
  const auto v = run.column("tip.velocity.x");
  std::size_t expected = 0;
  bool back = false;
  for (const double speed : v) {
    // Motion slower than this part of the driver's speed is found or not, depending on the steps.
    if (std::abs(speed) < 2e-3 * 0.01) continue;
    if (speed < 0.0 && !back) ++expected;
    back = speed < 0.0;
  }
  EXPECT_GT(expected, 10u);
  EXPECT_NEAR(static_cast<double>(*run.result.group("events")["reversals"]),
              static_cast<double>(expected), 1.0);
  const auto reversals = run.kept.of(EventKind::reversal);
  ASSERT_EQ(reversals.size(), *run.result.group("events")["reversals"]);
  for (const Event& reversal : reversals) {
    if (reversal.size < 1e-3) continue;
    EXPECT_NEAR(run.at("tip.velocity.x", reversal.time, kEvery), 0.0, 2e-4);
    const double way = run.at("tip.centre_of_mass.x", reversal.time, kEvery) -
                       run.at("tip.centre_of_mass.x", reversal.time + reversal.duration, kEvery);
    EXPECT_NEAR(reversal.size, way, 1e-5) << reversal.time << " " << reversal.duration;
  }
}

// Rings.

TEST(Hops, AreRisesByAFifthOfTheRadius) {
  for (const std::string& coordinates : {std::string("rigid"), std::string("particles")}) {
    RingScene ring{.coordinates = coordinates,
                   .velocity = 0.05,
                   .decay = 10.0,
                   .duration = 100.0,
                   .integrator = fixed_step(0.004),
                   .more = "[output]\nevery = 0.05\n"};
    // A small one on a strong substrate.
    const std::vector<Setting> small = {{"body.ring.radius", "0.1"},
                                        {"body.ring.centre", "[0.0, 0.1]"}};
    const Watched run(ring.text(), small);
    const auto y = run.column("ring.centre_of_mass.y");
    std::vector<double> heights;
    double low = y.front(), high = y.front();
    bool risen = false;
    for (const double height : y) {
      if (!risen) {
        low = std::min(low, height);
        risen = height - low > 0.02;
        high = height;
      } else {
        high = std::max(high, height);
        if (high - height > 0.02) {
          heights.push_back(high - low);
          low = height;
          risen = false;
        }
      }
    }
    const auto hops = run.kept.of(EventKind::hop);
    ASSERT_GE(hops.size(), heights.size()) << coordinates;
    ASSERT_LE(hops.size(), heights.size() + 1);
    EXPECT_GE(heights.size(), 3u);
    EXPECT_EQ(run.result.group("events")["hops"], hops.size());
    for (std::size_t k = 0; k < heights.size(); ++k) {
      EXPECT_NEAR(hops[k].size, heights[k], 2e-3) << coordinates;
    }
  }
}

TEST(Hops, ABodyThatRisesByLessHasNotHopped) {
  for (const auto& [rise, expected] : {std::pair(0.19, 0), std::pair(0.21, 3)}) {
    std::vector<double> reals(BodyWatch::kReals);
    std::vector<std::int64_t> integers(BodyWatch::kIntegers);
    BodyWatch watch(0, 1.0);
    watch.attach(reals.data(), integers.data());
    watch.start();
    int hops = 0;
    for (int k = 0; k <= 300; ++k) {
      const double t = 0.01 * k;  // three times up and down
      watch.add_height(t, 1.0 + rise * 0.5 * (1.0 - std::cos(2.0 * kPi * t)),
                       [&](const Event&) { ++hops; });
    }
    EXPECT_EQ(hops, expected) << rise;
  }
}

TEST(Turns, AreWholeOnesAtTheirMoment) {
  constexpr double kSampling = 0.25;
  for (const std::string& integrator : {adaptive(1e-9), fixed_step(0.01)}) {
    RingScene ring{.coordinates = "rigid",
                   .velocity = 0.02,
                   .duration = 1000.0,
                   .integrator = integrator,
                   .more = "[output]\nevery = " + digits(kSampling) + "\n"};
    const Watched run(ring.text());
    const auto rotation = run.column("ring.rotation");
    const auto turns = run.kept.of(EventKind::turn);
    // An eighth of a turn a period, twenty periods.
    ASSERT_EQ(turns.size(), 2u) << integrator;
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_EQ(turns[k].size, -1.0);
      EXPECT_NEAR(run.at("ring.rotation", turns[k].time, kSampling),
                  -2.0 * kPi * static_cast<double>(k + 1), 2e-4);
    }
    EXPECT_LT(rotation.back(), -4.0 * kPi);
  }
}

// Until it is steady.

std::string until(const std::string& more) {
  return "{ steady = \"driver.mean_force.x\", tolerance = 1e-6" + more + " }";
}

TEST(Until, ARunEndsWhenAPeriodIsLikeTheLast) {
  RingScene ring{
      .coordinates = "rigid", .velocity = 0.02, .duration = 5000.0, .integrator = adaptive(1e-10)};
  const RunResult result = run_text(ring.text(), {{"run.until", until("")}});
  ASSERT_TRUE(result.steady.has_value());
  EXPECT_TRUE(result.steady->reached);
  EXPECT_LT(result.end_time, 2000.0);
  EXPECT_NEAR(result.window_to - result.window_from, 50.0, 1e-9);
  EXPECT_EQ(result.window_to, 50.0 * static_cast<double>(result.steady->periods));
  // Against many periods much later.
  const RunResult late = run_text(
      ring.text(),
      {{"measure.from", "80"}, {"measure.to", "100"}, {"measure.in", "\"driver_periods\""}});
  const double exact = late.driver(0)["mean_force"][0];
  EXPECT_NEAR(result.driver(0)["mean_force"][0], exact, 2e-6 * exact);
  // The control: the second period is not steady to that tolerance.
  const RunResult early =
      run_text(ring.text(),
               {{"measure.from", "0"}, {"measure.to", "1"}, {"measure.in", "\"driver_periods\""}});
  EXPECT_GT(std::abs(early.driver(0)["mean_force"][0] - exact), 1e-3 * exact);
}

TEST(Until, AFixedStepThatDoesNotDivideThePeriodIsAsGood) {
  RingScene ring{.coordinates = "rigid", .velocity = 0.02, .duration = 5000.0};
  ring.integrator = fixed_step(0.03);
  const RunResult a = run_text(ring.text(), {{"run.until", until("")}});
  ring.integrator = adaptive(1e-10);
  const RunResult b = run_text(ring.text(), {{"run.until", until("")}});
  ASSERT_TRUE(a.steady->reached);
  EXPECT_NEAR(a.driver(0)["mean_force"][0], b.driver(0)["mean_force"][0],
              1e-6 * b.driver(0)["mean_force"][0]);
}

TEST(Until, NotSteadyInTimeIsSaid) {
  RingScene ring{
      .coordinates = "rigid", .velocity = 0.02, .duration = 5000.0, .integrator = adaptive(1e-10)};
  const RunResult result = run_text(ring.text(), {{"run.until", until(", max = 170.0")}});
  ASSERT_TRUE(result.steady.has_value());
  EXPECT_FALSE(result.steady->reached);
  EXPECT_EQ(result.end_time, 150.0);  // whole periods
  EXPECT_EQ(result.window_from, 100.0);
  EXPECT_EQ(result.window_to, 150.0);
  EXPECT_EQ(result.driver(0)["mean_force"].size(), 2u);
  EXPECT_EQ(briefs(result.warnings), std::vector<std::string>{"run.until [run.until_not_steady]"});
}

TEST(Until, TheSlowestTimeOfManyCoordinatesIsNotKnown) {
  const auto warnings_of = [](const char* count) {
    const RunResult result = run_text(
        "[[body]]\nname = \"chain\"\ntype = \"chain\"\nspacing = 1.0\norigin = [0.0]\n"
        "particle_mass = 1.0\ncount = " +
        std::string(count) +
        "\n[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = 1.0\n"
        "velocity = [1.0]\nattach = \"each_particle\"\n[[force]]\ntype = \"viscous_damping\"\n"
        "coefficient = 1.0\n[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = 1e-3\n"
        "period = 1.0\n[run]\nuntil = { steady = \"driver.mean_force.x\", tolerance = 0.1, "
        "max = 100.0 }\nintegrator = { type = \"rk4\", dt = 0.1 }\n");
    EXPECT_TRUE(result.steady->reached);
    return briefs(result.warnings);
  };
  EXPECT_EQ(warnings_of("1000"), std::vector<std::string>{});
  EXPECT_EQ(warnings_of("1001"), std::vector<std::string>{"run.until [run.until_slowest_unknown]"});
}

TEST(Until, ADurationIsNeedlessWithAMaximum) {
  std::string text =
      RingScene{.coordinates = "rigid", .velocity = 0.02, .integrator = adaptive(1e-9)}.text();
  const std::string duration = "duration = 10\n";
  const std::size_t at = text.find(duration);
  ASSERT_NE(at, std::string::npos);
  text.erase(at, duration.size());
  EXPECT_TRUE(run_text(text, {{"run.until", until(", max = 4000")}}).steady->reached);
  EXPECT_THROW(run_text(text, {{"run.until", until("")}}), InputError);
  EXPECT_THROW(run_text(text), InputError);
  EXPECT_THROW(run_text(text, {{"run.until", until(", max = 40")}}), InputError);  // no period fits
  EXPECT_THROW(run_text(text, {{"run.until",
                                "{ steady = \"driver.men_force.x\", tolerance = 1e-6, "
                                "max = 4000 }"}}),
               InputError);
}

TEST(Until, GoesOnFromAnyStep) {
  for (const std::string& integrator : {adaptive(1e-8), fixed_step(0.05)}) {
    RingScene ring{
        .coordinates = "rigid", .velocity = 0.02, .duration = 2000.0, .integrator = integrator};
    const auto scene = scene_of(ring.text(), {{"run.until", until("")}});
    Engine whole(scene, {});
    const RunResult expected = whole.run();
    ASSERT_TRUE(expected.steady->reached);
    for (std::uint64_t steps = 1; steps < expected.steps; steps += 1 + expected.steps / 37) {
      Engine engine(scene, {});
      engine.advance(steps);
      const std::vector<std::byte> bytes = engine.state().to_bytes();
      RunOptions options;
      options.resume_from = &bytes;
      Engine resumed(scene, options);
      const RunResult result = resumed.run();
      ASSERT_TRUE(Motion(resumed) == Motion(whole));
      ASSERT_EQ(result.driver(0)["mean_force"], expected.driver(0)["mean_force"]);
      ASSERT_EQ(result.driver(0)["max_force"], expected.driver(0)["max_force"]);
      ASSERT_EQ(result.steady->periods, expected.steady->periods);
      ASSERT_EQ(result.group("events")["slips"], expected.group("events")["slips"]);
      ASSERT_EQ(result.group("events")["turns"], expected.group("events")["turns"]);
      ASSERT_EQ(result.group("events")["reversals"], expected.group("events")["reversals"]);
    }
  }
}

/// The force after a slip, until it is known to be one, is no static force in any scheme.
TEST(Slips, StaticForceIsThatBeforeTheFirst) {
  const auto found = [](const std::string& integrator) {
    return run_text(TipScene{.velocity = 0.27,
                             .stiffness = 0.32,
                             .damping = 5.06,
                             .amplitude = 0.1,
                             .position = 0.297,
                             .duration = 50.0,
                             .integrator = integrator}
                        .text());
  };
  const RunResult exact = found(adaptive(1e-12, "dop853"));
  ASSERT_GE(*exact.group("events")["slips"], 1.0);
  const double force = *exact.driver(0)["static_force"];
  EXPECT_LT(force, exact.driver(0)["max_force"][0]);
  for (const std::string& integrator :
       {fixed_step(1e-3), adaptive(1e-8, "radau9"), adaptive(1e-8, "dopri5")}) {
    EXPECT_NEAR(*found(integrator).driver(0)["static_force"], force, 1e-5 * force) << integrator;
  }
}

/// A chain that starts off its equilibrium relaxes there: no slip, and no static force.
TEST(Slips, RelaxationFromTheStartIsNone) {
  const RunResult found = run_text(R"(
body = [{ name = "chain", type = "chain", count = 3, spacing = 0.9, origin = [0.1], particle_mass = 1.0 }]
force = [
  { type = "harmonic_bonds", pairs = "neighbours", stiffness = 20.0 },
  { name = "driver", type = "driving_spring", stiffness = 0.5, velocity = [0.01] },
  { type = "viscous_damping", coefficient = 1.0 },
  { type = "sinusoidal_substrate", amplitude = 0.1, period = 1.0 },
]
run = { duration = 1500.0, integrator = { type = "dopri5" } }
)");
  ASSERT_EQ(found.status, RunStatus::finished);
  EXPECT_GE(*found.group("events")["slips"], 3.0);
  EXPECT_GT(*found.driver(0)["static_force"], 0.5 * found.driver(0)["max_force"][0]);
}

/// A ring that hops along y while what its driver pulls along x moves back and forth.
std::string hopping_ring(const std::string& stiffness, const std::string& run) {
  return tables(R"(
[[body]] | type = "ring" | count = 3 | radius = 1.0 | centre = [0.0, 1.4] | particle_mass = 1.0
coordinates = "rigid" | velocity = [0.4, 0.0]
[[force]] | name = "driver" | type = "driving_spring" | stiffness = 6.0 | velocity = [0.1, 0.0]
start = [0.0, 1.0]
[[force]] | type = "expression" | energy = ")") +
         stiffness + " * (yc - 1)^2\"\n[run]\n" + run + "\n";
}

/// Also where a step of an adaptive scheme holds several of them, and at the end of a run.
TEST(Events, ComeInTheOrderInWhichTheyEnd) {
  const std::vector<std::string> scenes = {
      hopping_ring("0.7",
                   "duration = 30.0\nintegrator = { type = \"dop853\", absolute_tolerance = "
                   "1e-4, relative_tolerance = 1e-4 }"),
      hopping_ring("0.5", "duration = 29.48\nintegrator = " + fixed_step(1e-2))};
  for (const std::string& scene : scenes) {
    KeptSamples kept;
    run(scene_of(scene), watched_by(kept));
    ASSERT_GE(kept.of(EventKind::hop).size(), 4u);
    ASSERT_GE(kept.of(EventKind::reversal).size(), 4u);
    double last = 0.0;
    for (const Event& event : kept.events) {
      EXPECT_GE(event.time + event.duration, last) << to_string(event.kind) << " " << event.time;
      last = event.time + event.duration;
    }
  }
}

}  // namespace
}  // namespace tomlin::test
