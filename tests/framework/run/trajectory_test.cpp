#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/ring_scenes.hpp"

// Positions that a run sends along with its samples: those of the table's columns, of the bodies'
// shape, and in the scene's own coordinates however far it has gone.

namespace tomlin::test {
namespace {

/// Everything that a run sends, kept.
class Rows : public RunSink {
 public:
  void begin(const RunLayout& all) override { layout = all; }
  void sample(const std::vector<double>& row) override { rows.push_back(row); }

  std::size_t column(const std::string& name) const {
    for (std::size_t k = 0; k < layout.columns.size(); ++k) {
      if (layout.columns[k].name == name) return k;
    }
    throw std::out_of_range(name);
  }
  double position(std::size_t frame, std::size_t particle, std::size_t axis) const {
    const auto axes = static_cast<std::size_t>(layout.dimension);
    return rows.at(frame).at(layout.columns.size() + particle * axes + axis);
  }

  RunLayout layout;
  std::vector<std::vector<double>> rows;
};

Rows rows_of(const std::string& text) {
  Rows rows;
  run(scene_of(text), watched_by(rows));
  return rows;
}

const std::string kTrajectory = "[output]\nevery = 0.05\ntrajectory = true\n";

/// Rounding of positions near 1, over a few operations each.
constexpr double kRounding = 1e-12;

std::vector<RingScene> rings() {
  std::vector<RingScene> all;
  for (const char* coordinates : {"particles", "rigid"}) {
    for (const char* integrator : {"{ type = \"rk4\", dt = 0.002 }", "{ type = \"dopri5\" }",
                                   "{ type = \"velocity_verlet\", dt = 0.002 }"}) {
      RingScene ring{.coordinates = coordinates, .velocity = 1.5, .duration = 3.0};
      ring.integrator = integrator;
      ring.more = kTrajectory;
      all.push_back(ring);
    }
  }
  return all;
}

TEST(Trajectory, MeansOfParticlesAreTheCentresOfTheTable) {
  for (const RingScene& ring : rings()) {
    SCOPED_TRACE(ring.coordinates + " " + ring.integrator);
    const Rows rows = rows_of(ring.text());
    ASSERT_EQ(rows.rows.size(), 61u);
    ASSERT_EQ(rows.layout.particles(), 8u);
    const std::size_t x = rows.column("ring.centre_of_mass.x");
    double way = 0.0;
    for (std::size_t f = 0; f < rows.rows.size(); ++f) {
      for (std::size_t d = 0; d < 2; ++d) {
        double mean = 0.0;
        for (std::size_t i = 0; i < 8; ++i) mean += rows.position(f, i, d) / 8.0;
        EXPECT_NEAR(mean, rows.rows[f][x + d], kRounding) << f;
      }
      way = std::max(way, rows.rows[f][x]);
    }
    EXPECT_GT(way, 0.5) << "the ring has not moved: nothing was seen";
  }
}

/// Each particle stays where the rotation of the table puts it.
TEST(Trajectory, ARigidRingIsACircle) {
  for (const RingScene& ring : rings()) {
    if (ring.coordinates != "rigid") continue;
    SCOPED_TRACE(ring.integrator);
    const Rows rows = rows_of(ring.text());
    const std::size_t x = rows.column("ring.centre_of_mass.x");
    const std::size_t rotation = rows.column("ring.rotation");
    double turned = 0.0;
    for (std::size_t f = 0; f < rows.rows.size(); ++f) {
      const double angle = rows.rows[f][rotation];
      turned = std::max(turned, std::abs(angle));
      for (std::size_t i = 0; i < 8; ++i) {
        const double dx = rows.position(f, i, 0) - rows.rows[f][x];
        const double dy = rows.position(f, i, 1) - rows.rows[f][x + 1];
        EXPECT_NEAR(std::hypot(dx, dy), 1.0, kRounding);
        const double x0 = rows.position(0, i, 0) - rows.rows[0][x];
        const double y0 = rows.position(0, i, 1) - rows.rows[0][x + 1];
        EXPECT_NEAR(dx, x0 * std::cos(angle) - y0 * std::sin(angle), kRounding);
        EXPECT_NEAR(dy, x0 * std::sin(angle) + y0 * std::cos(angle), kRounding);
      }
    }
    EXPECT_GT(turned, 0.01) << "the ring has not turned";
  }
}

/// 1e9 periods out positions are the scene's own: those at the origin, so many cells on, to the
/// rounding of such large numbers.
TEST(Trajectory, CellsAreAddedBack) {
  constexpr double kFar = 1e9;
  constexpr double kRoundingThere = 2.4e-7;  // two units in the last place of 1e9
  for (RingScene ring : rings()) {
    SCOPED_TRACE(ring.coordinates + " " + ring.integrator);
    ring.velocity = 4.0;  // several cells on: the origin moves on the way
    const Rows near = rows_of(ring.text());
    ring.centre = kFar;
    const Rows far = rows_of(ring.text());
    ASSERT_EQ(near.rows.size(), far.rows.size());
    const std::size_t last = near.rows.size() - 1;
    EXPECT_GT(near.position(last, 0, 0) - near.position(0, 0, 0), 3.0);
    for (std::size_t f = 0; f <= last; ++f) {
      for (std::size_t i = 0; i < 8; ++i) {
        EXPECT_NEAR(far.position(f, i, 0), kFar + near.position(f, i, 0), kRoundingThere);
        EXPECT_NEAR(far.position(f, i, 1), near.position(f, i, 1), 1e-9);
      }
    }
  }
}

/// A tip's position is its centre, to the bit; sampled at every step, between steps, and in any
/// number type.
TEST(Trajectory, ATipIsItsOwnCentre) {
  for (const char* number_type : {"double", "quadruple"}) {
    for (const char* every : {"0.01", "0.0037"}) {
      SCOPED_TRACE(std::string(number_type) + " every " + every);
      TipScene tip{.duration = 0.5};
      tip.more = "number_type = \"" + std::string(number_type) + "\"\n[output]\nevery = " + every +
                 "\ntrajectory = true\n";
      const Rows rows = rows_of(tip.text());
      EXPECT_GT(rows.rows.size(), 50u);
      const std::size_t x = rows.column("tip.centre_of_mass.x");
      for (std::size_t f = 0; f < rows.rows.size(); ++f) {
        EXPECT_EQ(rows.position(f, 0, 0), rows.rows[f][x]);
      }
    }
  }
}

/// A sample on a step's end comes from the state, one next to it from dense output: they agree to
/// the order of that.
TEST(Trajectory, SamplesOnStepsAndBesideThemAgree) {
  constexpr double kBeside = 1e-7;
  constexpr double kStep = 0.01;
  TipScene tip{.velocity = 1.5, .duration = 2.0};
  for (const char* integrator :
       {"{ type = \"rk4\", dt = 0.01 }", "{ type = \"velocity_verlet\", dt = 0.01 }"}) {
    tip.integrator = integrator;
    tip.more = "[output]\nevery = " + digits(kStep) + "\ntrajectory = true\n";
    const Rows on = rows_of(tip.text());
    tip.more = "[output]\nevery = " + digits(kStep * (1.0 - kBeside)) + "\ntrajectory = true\n";
    const Rows beside = rows_of(tip.text());
    ASSERT_GE(beside.rows.size(), on.rows.size());
    for (std::size_t f = 0; f < on.rows.size(); ++f) {
      for (std::size_t k = 0; k < on.rows[f].size(); ++k) {
        // Samples lie up to 2 kBeside apart, and no number changes faster than 10 per time.
        EXPECT_NEAR(on.rows[f][k], beside.rows[f][k], 20.0 * kBeside) << f << ' ' << k;
      }
    }
  }
}

}  // namespace
}  // namespace tomlin::test
