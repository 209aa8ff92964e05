#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/run/results/observables.hpp"
#include "tests/support/ring_scenes.hpp"

// forces.NAME.on.BODY.mean_force: against the drivers' own running integrals, and against momentum,
// which all forces together change.

namespace tomlin::test {
namespace {

/// Tolerance of forces about 1, at steps of 0.01 or tolerances of 1e-10: quadrature on dense output
/// of fourth order.
constexpr double kTolerance = 1e-8;

std::string measure(const std::vector<std::string>& paths, double from, double to) {
  std::string list;
  for (const std::string& path : paths) list += (list.empty() ? "\"" : ", \"") + path + "\"";
  return "[measure]\nfrom = " + digits(from) + "\nto = " + digits(to) + "\nobservables = [" + list +
         "]\n";
}

const std::vector<std::string> kSchemes = {
    fixed_step(0.01), "{ type = \"velocity_verlet\", dt = 0.002 }",
    "{ type = \"dopri5\", absolute_tolerance = 1e-10, relative_tolerance = 1e-10 }",
    "{ type = \"radau9\", relative_tolerance = 1e-10 }"};

TEST(ForcesOnBodies, OfADriverAreItsOwn) {
  for (const std::string& scheme : kSchemes) {
    // Edges fall within steps.
    const TipScene tip{
        .integrator = scheme,
        .more = measure({"driver.on.tip.mean_force.x", "driver.mean_force.x"}, 2.0037, 17.7771)};
    const RunResult result = run(scene_of(tip.text()));
    const double tolerance = scheme.find("verlet") == std::string::npos ? kTolerance : 1e-5;
    EXPECT_NEAR(*observable(result, "forces.driver.on.tip.mean_force.x"),
                *observable(result, "drivers.driver.mean_force.x"), tolerance)
        << scheme;
  }
}

/// Extremes, samples and the last of a driver's force on its body are those of the driver.
TEST(ForcesOnBodies, OfADriverAreItsOwnAtEachMoment) {
  const std::vector<std::string> paths = {
      "driver.on.tip.max_force.x", "driver.on.tip.min_force.x", "driver.on.tip.final_force.x",
      "driver.max_force.x",        "driver.min_force.x",        "driver.final_force.x"};
  constexpr double kRounding = 1e-13;  // of the time since the last step
  constexpr double kOfNodes =
      1e-4;  // nodes lie within steps, of which there are 100 a unit of time
  for (const std::string& scheme : kSchemes) {
    const bool long_steps = scheme.find("dt") == std::string::npos;
    const TipScene tip{.integrator = scheme,
                       .more = "[output]\nevery = 0.3\n" + measure(paths, 2.0, 18.0)};
    KeptSamples kept;
    const RunResult result = run(scene_of(tip.text()), watched_by(kept));
    const auto value = [&](const std::string& key) { return *observable(result, key); };
    EXPECT_NEAR(value("driver.on.tip.final_force.x"), value("drivers.driver.final_force.x"),
                kRounding)
        << scheme;
    EXPECT_GT(value("driver.on.tip.max_force.x"), value("driver.on.tip.min_force.x"));
    if (!long_steps) {
      EXPECT_NEAR(value("driver.on.tip.max_force.x"), value("drivers.driver.max_force.x"),
                  kOfNodes);
      EXPECT_NEAR(value("driver.on.tip.min_force.x"), value("drivers.driver.min_force.x"),
                  kOfNodes);
    }
    const std::size_t own = kept.column("driver.force.x");
    const std::size_t on_tip = kept.column("driver.on.tip.force.x");
    ASSERT_GT(kept.rows.size(), 50u);
    for (const auto& row : kept.rows)
      EXPECT_NEAR(row[own], row[on_tip], kRounding) << scheme << row[0];
  }
}

TEST(ForcesOnBodies, ChangeMomentumTogether) {
  for (const std::string& scheme : kSchemes) {
    for (const char* coordinates : {"rigid", "particles"}) {
      if (coordinates == std::string("particles") && scheme == fixed_step(0.01)) continue;
      RingScene ring{.coordinates = coordinates, .bonds = 50.0, .integrator = scheme};
      std::vector<std::string> forces = {"driver", "viscous_damping", "sinusoidal_substrate"};
      if (coordinates == std::string("particles")) forces.emplace_back("harmonic_bonds");
      std::vector<std::string> paths = {"ring.velocity.x", "ring.velocity.y"};
      for (const std::string& force : forces) {
        for (const char* axis : {".x", ".y"}) {
          paths.push_back("forces." + force + ".on.ring.mean_force" + axis);
        }
      }
      ring.more = measure(paths, 0.0, ring.duration);
      const RunResult result = run(scene_of(ring.text()));
      for (const char* axis : {".x", ".y"}) {
        double mean = 0.0;
        for (const std::string& force : forces) {
          mean += *observable(result, "forces." + force + ".on.ring.mean_force" + axis);
        }
        // The ring starts at rest, and its mass is 1.
        const double tolerance = scheme.find("verlet") == std::string::npos ? 1e-7 : 1e-4;
        EXPECT_NEAR(mean, *observable(result, std::string("ring.velocity") + axis) / ring.duration,
                    tolerance)
            << scheme << coordinates << axis;
      }
    }
  }
}

TEST(ForcesOnBodies, OfOnePeriodAfterAnother) {
  TipScene tip{.more = measure({"driver.on.tip.mean_force.x", "driver.mean_force.x"}, 0.0, 1.0)};
  std::string text = tip.text();
  const std::string key = "duration = " + digits(tip.duration);
  text.replace(text.find(key), key.size(),
               "until = { steady = \"driver.mean_force.x\", tolerance = 1e-4, max = 400.0 }");
  const RunResult result = run(scene_of(text));
  ASSERT_GT(result.steady->periods, 2u);
  EXPECT_NEAR(*observable(result, "driver.on.tip.mean_force.x"),
              *observable(result, "driver.mean_force.x"), kTolerance);
}

TEST(ForcesOnBodies, GoOnFromACheckpoint) {
  const TipScene tip{.more = measure({"sinusoidal_substrate.on.tip.mean_force.x"}, 3.0, 19.0)};
  const auto scene = scene_of(tip.text());
  Engine first(scene, {});
  first.advance(700);
  const std::vector<std::byte> kept = first.state().to_bytes();
  RunOptions options;
  options.resume_from = &kept;
  const RunResult whole = run(scene);
  const RunResult resumed = run_as_bound(scene, options);
  const std::string path = "forces.sinusoidal_substrate.on.tip.mean_force.x";
  EXPECT_EQ(observable(resumed, path), observable(whole, path));
}

TEST(ForcesOnBodies, AreLookedAtOnlyWhereTheyAreAskedFor) {
  const RunResult all = run(scene_of(TipScene{}.text()));
  EXPECT_TRUE(all.family("forces").empty());
  EXPECT_NE(
      refusal(TipScene{.more = measure({"forces.driver.on.ring.mean_force.x"}, 0.0, 1.0)}.text()),
      "");
}

}  // namespace
}  // namespace tomlin::test
