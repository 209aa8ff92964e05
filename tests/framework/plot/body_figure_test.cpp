#include "framework/plot/body_figure.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/text/fault.hpp"
#include "framework/standard_registry.hpp"
#include "tests/framework/output/temporary_folder.hpp"
#include "tests/support/faults.hpp"

namespace tomlin {
namespace {

// Rounding of a few operations on numbers around 1.
constexpr double kRounding = 1e-14;
constexpr double kQuarterTurn = 1.5707963267948966;

constexpr const char* kScene = R"([[body]]
name = "ring"
type = "ring"
count = 4
radius = 2.0
centre = [0.0, 2.0]
particle_mass = 1.0
coordinates = "rigid"

[[force]]
type = "constant_force"
force = [0.1, 0.0]

[run]
duration = 1.0
integrator = { type = "rk4", dt = 0.1 }
)";

// A quarter turn backwards while the ring moves by 6, the driver by 8.
constexpr const char* kTable =
    "time [time],driver.position.x [length],driver.position.y [length],"
    "ring.centre_of_mass.x [length],ring.centre_of_mass.y [length],ring.rotation [rad]\n"
    "0,0,2,0,2,0\n"
    "10,8,2,6,3,-1.5707963267948966\n";

class BodyFigure : public testing::Test {
 protected:
  void SetUp() override {
    test::write(folder_ / "summary.json", R"({"status": "finished"})");
    test::write(folder_ / "scene.toml", kScene);
    test::write(folder_ / "observables.csv", kTable);
  }

  Figure drawn(const BodyRequest& request) {
    const std::vector<StoredRun> runs = {read_stored_run(folder_.path().string())};
    return body_figure(runs, {"label"}, request, standard_registry(), notes_);
  }

  Fault refusal(const BodyRequest& request) {
    try {
      drawn(request);
    } catch (const InputError& error) {
      return error.faults().front();
    }
    throw std::logic_error("it is drawn");
  }

  static const Polyline& points(const Figure& figure, std::size_t curve) {
    return figure.panels.front().curves.at(curve).pieces.front();
  }

  static void expect_at(const Point& point, double x, double y) {
    EXPECT_NEAR(point.x, x, kRounding);
    EXPECT_NEAR(point.y, y, kRounding);
  }

  test::TemporaryFolder folder_;
  std::vector<std::string> notes_;
};

TEST_F(BodyFigure, ShowsParticlesCentreAndDriver) {
  const Figure figure = drawn({"time", {10.0}, {}});
  const Polyline& ring = points(figure, 0);
  ASSERT_EQ(ring.size(), 5U);  // the last closes the line
  expect_at(ring[0], 6.0, 1.0);
  expect_at(ring[1], 8.0, 3.0);
  expect_at(ring[2], 6.0, 5.0);
  expect_at(ring[3], 4.0, 3.0);
  EXPECT_EQ(ring[4], ring[0]);
  EXPECT_EQ(points(figure, 1), (Polyline{ring[0]}));  // the marked particle
  EXPECT_EQ(points(figure, 2), (Polyline{{6.0, 3.0}}));
  EXPECT_EQ(points(figure, 3), (Polyline{{8.0, 2.0}}));
  EXPECT_EQ(figure.panels.front().curves[0].label, "t = 10");
  EXPECT_EQ(figure.panels.front().title, "label");
  EXPECT_TRUE(notes_.empty());
}

TEST_F(BodyFigure, IsInterpolatedBetweenSamples) {
  const Figure figure = drawn({"time", {5.0}, {}});
  const double side = 2.0 * std::cos(kQuarterTurn / 2.0);
  expect_at(points(figure, 0)[0], 3.0 + side, 2.5 - side);
  expect_at(points(figure, 2)[0], 3.0, 2.5);
}

TEST_F(BodyFigure, MomentsMayGoByAnotherQuantity) {
  const Figure figure = drawn({"driver_position", {4.0}, {}});
  EXPECT_EQ(figure.panels.front().curves[0].label, "vt = 4");
  expect_at(points(figure, 2)[0], 3.0, 2.5);
  // Where the run first has the value, also when it falls: the rotation does.
  expect_at(points(drawn({"rotation", {-kQuarterTurn / 2.0}, {}}), 2)[0], 3.0, 2.5);
  test::write(folder_ / "observables.csv", std::string(kTable) + "20,0,2,100,3,0\n");
  expect_at(points(drawn({"driver_position", {4.0}, {}}), 2)[0], 3.0, 2.5);
}

TEST_F(BodyFigure, IsToScale) {
  for (const std::vector<double>& at : {std::vector<double>{0.0}, {0.0, 5.0, 10.0}}) {
    const Figure figure = drawn({"time", at, {}});
    const Panel& panel = figure.panels.front();
    EXPECT_NEAR((figure.x_to - figure.x_from) / kPanelWidth,
                (panel.y_to - panel.y_from) / panel.height, kRounding);
    for (const Curve& curve : panel.curves) {
      for (const Polyline& piece : curve.pieces) {
        for (const Point& point : piece) {
          EXPECT_TRUE(figure.x_from < point.x && point.x < figure.x_to);
          EXPECT_TRUE(panel.y_from < point.y && point.y < panel.y_to);
        }
      }
    }
  }
}

TEST_F(BodyFigure, HasFiveMomentsByDefault) {
  const Figure figure = drawn({});
  std::vector<std::string> times;
  for (const Curve& curve : figure.panels.front().curves) {
    if (curve.label.starts_with("t = ")) times.push_back(curve.label);
  }
  EXPECT_EQ(times, (std::vector<std::string>{"t = 0", "t = 2.5", "t = 5", "t = 7.5", "t = 10"}));
}

TEST_F(BodyFigure, AFlexibleBodyIsDrawnAsRigidAndTheNoteSaysSo) {
  std::string scene = kScene;
  scene.replace(scene.find("\"rigid\""), 7, "\"particles\"");
  test::write(folder_ / "scene.toml", scene);
  drawn({"time", {1.0}, {}});
  ASSERT_EQ(notes_.size(), 1U);
  EXPECT_NE(notes_[0].find("ring is flexible"), std::string::npos);
}

TEST_F(BodyFigure, RefusesTimesOutsideTheRunAndBodiesThatAreNotThere) {
  const Fault late = refusal({"time", {10.5}, {}});
  EXPECT_EQ(late.place.file, "--at");
  EXPECT_EQ(test::brief(late), "10.5 [plot.no_data]");
  EXPECT_NE(late.admissible.find("0 to 10"), std::string::npos) << late.admissible;
  EXPECT_EQ(test::brief(refusal({"time", {-1.0}, {}})), "-1 [plot.no_data]");
  EXPECT_EQ(test::brief(refusal({"time", {1.0}, {"", "rong"}})),
            "--body rong [plot.no_data] did you mean ring");
  test::write(folder_ / "scene.toml", "");
  EXPECT_EQ(test::brief(refusal({"time", {1.0}, {}})), "1:1 [file.invalid]");
}

}  // namespace
}  // namespace tomlin
