#include "framework/plot/curves_figure.hpp"

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/text/fault.hpp"
#include "tests/framework/output/temporary_folder.hpp"
#include "tests/support/faults.hpp"

namespace tomlin {
namespace {

constexpr const char* kHeader =
    "time [time],driver.force.x [force],driver.force.y [force],driver.position.x [length],"
    "ring.centre_of_mass.x [length]\n";

/// Two runs: the first with six samples, which turns back, the second with two.
class CurvesFigure : public testing::Test {
 protected:
  void SetUp() override {
    first_ = run_with(first_folder_,
                      "0,0,0,0,0\n1,3,4,1,0.5\n2,-3,4,2,1\n3,6,8,3,2.5\n4,1,0,2,2\n5,2,0,1,1\n");
    second_ = run_with(second_folder_, "0,0,0,0,0\n1,1,1,4,3\n");
  }

  static StoredRun run_with(const test::TemporaryFolder& folder, const std::string& rows) {
    test::write(folder / "observables.csv", kHeader + rows);
    StoredRun run;
    run.folder = folder.path().string();
    return run;
  }

  Figure drawn(const CurvesRequest& request) {
    return curves_figure({first_, second_}, {"one", "two"}, request, notes_);
  }

  Fault refusal(const CurvesRequest& request) {
    try {
      drawn(request);
    } catch (const InputError& error) {
      return error.faults().front();
    }
    throw std::logic_error("it is drawn");
  }

  test::TemporaryFolder first_folder_;
  test::TemporaryFolder second_folder_;
  StoredRun first_;
  StoredRun second_;
  std::vector<std::string> notes_;
};

TEST_F(CurvesFigure, HasACurveForEachRun) {
  const Figure figure = drawn({"driver_position", {{"force_size"}}, {}, {}, {}});
  ASSERT_EQ(figure.panels.size(), 1U);
  const Panel& panel = figure.panels.front();
  ASSERT_EQ(panel.curves.size(), 2U);
  EXPECT_EQ(panel.curves[0].label, "one");
  EXPECT_EQ(panel.curves[0].pieces,
            (std::vector<Polyline>{
                {{0.0, 0.0}, {1.0, 5.0}, {2.0, -5.0}, {3.0, 10.0}, {2.0, 1.0}, {1.0, 2.0}}}));
  EXPECT_EQ(panel.curves[1].colour, 1);
  EXPECT_EQ(figure.x_from, 0.0);
  EXPECT_EQ(figure.x_to, 4.0);
  EXPECT_LT(panel.y_from, -5.0);
  EXPECT_GT(panel.y_to, 10.0);
  EXPECT_TRUE(figure.x_label.enhanced);
  EXPECT_EQ(panel.y_label.text, "friction force {/:Italic F_f}");
}

TEST_F(CurvesFigure, ThePositionStandsBesideASpringThatIsNotStretched) {
  const Figure figure = drawn({"driver_position", {{"position"}}, {}, {}, {}});
  const Curve& aid = figure.panels.front().curves.front();
  EXPECT_EQ(aid.colour, kGrey);
  EXPECT_EQ(aid.pieces, (std::vector<Polyline>{{{0.0, 0.0}, {4.0, 4.0}}}));
  EXPECT_EQ(drawn({"time", {{"position"}}, {}, {}, {}}).panels.front().curves.size(), 2U);
}

TEST_F(CurvesFigure, PanelsAndSeveralCurvesOfOneUnit) {
  const Figure figure =
      drawn({"time", {{"driver.force.x", "driver.force.y"}, {"position"}}, {}, {}, {}});
  ASSERT_EQ(figure.panels.size(), 2U);
  ASSERT_EQ(figure.panels[0].curves.size(), 4U);
  EXPECT_EQ(figure.panels[0].curves[1].label, "driver.force.y, one");
  EXPECT_EQ(figure.panels[0].curves[3].colour, 3);
  EXPECT_EQ(figure.panels[0].y_label.text, "force");
  EXPECT_EQ(figure.panels[1].curves[1].label, "two");
}

TEST_F(CurvesFigure, ARangeCutsWithTheLinesThatLeaveIt) {
  const Figure figure = drawn({"driver_position", {{"force"}}, {}, 2.5, 3.5});
  EXPECT_EQ(figure.x_from, 2.5);
  EXPECT_EQ(figure.x_to, 3.5);
  EXPECT_EQ(figure.panels.front().curves[0].pieces,
            (std::vector<Polyline>{{{2.0, -3.0}, {3.0, 6.0}, {2.0, 1.0}}}));
  EXPECT_TRUE(figure.panels.front().curves[1].pieces.empty());
  // Only what is inside sets the scale.
  EXPECT_GT(figure.panels.front().y_from, 0.0);
  // Twice through the same range: two pieces, not joined.
  EXPECT_EQ(drawn({"driver_position", {{"force"}}, {}, -1.0, 0.5}).panels[0].curves[0].pieces,
            (std::vector<Polyline>{{{0.0, 0.0}, {1.0, 3.0}}}));
  EXPECT_EQ(drawn({"driver_position", {{"force"}}, {}, 0.5, 1.5}).panels[0].curves[0].pieces.size(),
            2U);
}

TEST_F(CurvesFigure, ALevelCurveHasRoom) {
  first_ = run_with(first_folder_, "0,2,0,0,0\n1,2,0,1,0\n");
  second_ = first_;
  const Figure figure = drawn({"time", {{"force"}, {"position"}}, {}, {}, {}});
  EXPECT_LT(figure.panels[0].y_from, 2.0);
  EXPECT_GT(figure.panels[0].y_to, 2.0);
  EXPECT_LT(figure.panels[1].y_from, 0.0);
}

TEST_F(CurvesFigure, RefusesTwoUnitsOnOneAxisAndAnEmptyRange) {
  const Fault mixed = refusal({"time", {{"force", "position"}}, {}, {}, {}});
  EXPECT_EQ(test::brief(mixed), "--y position [command.invalid_value]");
  for (const char* part : {"[length]", "force [force]"}) {
    EXPECT_NE(mixed.why.find(part), std::string::npos) << mixed.why;
  }
  const Fault empty = refusal({"driver_position", {{"force"}}, {}, 7.0, {}});
  EXPECT_EQ(empty.place.file, "--from");
  EXPECT_EQ(test::brief(empty), "[plot.no_data]");
  EXPECT_NE(empty.admissible.find("0 to 4"), std::string::npos) << empty.admissible;
  EXPECT_EQ(test::brief(refusal({"driver_position", {{"forse"}}, {}, {}, {}})),
            "--y forse [plot.no_data] did you mean force");
}

TEST_F(CurvesFigure, UnitsAreThoseThatTheSceneNames) {
  first_.units = {{"length", "a"}, {"force", "V_0/a"}, {"time", "t_0"}};
  const Fault unlike = refusal({"driver_position", {{"force"}}, {}, {}, {}});
  EXPECT_EQ(test::brief(unlike), "scene.axes [command.conflict]");
  // Each folder is named with the unit that it has, in either order.
  first_.units["length"] = "nm";
  second_.system = UnitSystem::metal;
  for (int k = 0; k < 2; ++k) {
    const Fault fault = refusal({"driver_position", {{"force"}}, {}, {}, {}});
    const bool metal_is_second = second_.system == UnitSystem::metal;
    EXPECT_TRUE(fault.place.file.starts_with(second_.folder)) << fault.place.file;
    const std::string own = metal_is_second ? "\u00C5" : "nm";
    const std::string other = metal_is_second ? "nm" : "\u00C5";
    EXPECT_TRUE(fault.why.starts_with(own + " for the unit of length")) << fault.why;
    EXPECT_TRUE(fault.why.ends_with(other + " of " + first_.folder)) << fault.why;
    std::swap(first_, second_);
  }
  second_.system = UnitSystem::reduced;
  first_.units["length"] = "a";
  second_.units = first_.units;
  Figure figure = drawn({"driver_position", {{"force"}}, {}, {}, {}});
  EXPECT_EQ(figure.panels[0].y_label.text, "lateral force {/:Italic F_x} / (V_0/a)");
  EXPECT_TRUE(figure.x_label.text.ends_with(" / a")) << figure.x_label.text;
  figure = drawn({"time", {{"driver.force.x", "force"}}, {}, {}, {}});
  EXPECT_EQ(figure.panels[0].y_label.text, "force / (V_0/a)");
  EXPECT_EQ(figure.x_label.text, "time {/:Italic t} / t_0");
  // A column's underscores are no markup, beside a unit that may have some.
  figure = drawn({"time", {{"ring.centre_of_mass.x"}}, {}, {}, {}});
  EXPECT_EQ(figure.panels[0].y_label.text, "ring.centre\\_of\\_mass.x / a");
  first_.units.clear();
  second_.units.clear();
  figure = drawn({"time", {{"ring.centre_of_mass.x"}}, {}, {}, {}});
  EXPECT_EQ(figure.panels[0].y_label.text, "ring.centre_of_mass.x");
  EXPECT_FALSE(figure.panels[0].y_label.enhanced);
}

TEST_F(CurvesFigure, TheSupportIsAtVTOnlyWhereItIs) {
  // The first run's driver reverses, the second's does not.
  EXPECT_EQ(drawn({"driver_position", {{"force"}}, {}, {}, {}}).x_label.text,
            "support position {/:Italic X}");
  first_ = second_;
  EXPECT_EQ(drawn({"driver_position", {{"force"}}, {}, {}, {}}).x_label.text,
            "driver position {/:Italic vt}");
  // Elsewhere at the start.
  second_ = run_with(second_folder_, "0,0,0,1,0\n1,1,1,5,3\n2,1,1,9,3\n");
  EXPECT_EQ(drawn({"driver_position", {{"force"}}, {}, {}, {}}).x_label.text,
            "support position {/:Italic X}");
}

TEST_F(CurvesFigure, SeveralCurvesOnAnAxisAreNamedByTheirQuantities) {
  const Figure figure = drawn({"time", {{"force", "driver.force.y"}}, {}, {}, {}});
  EXPECT_EQ(figure.panels[0].curves[0].label, "lateral force, one");
  EXPECT_EQ(figure.panels[0].curves[1].label, "driver.force.y, one");
  EXPECT_EQ(figure.panels[0].curves[2].label, "lateral force, two");
}

TEST_F(CurvesFigure, LogarithmicAxesBreakAtNumbersThatAreNotPositive) {
  CurvesRequest request{"time", {{"force"}}, {}, {}, {}};
  request.log_x = request.log_y = true;
  const Figure figure = drawn(request);
  EXPECT_TRUE(figure.log_x && figure.log_y);
  EXPECT_EQ(figure.x_from, 1.0);
  EXPECT_EQ(figure.panels[0].curves[0].pieces,
            (std::vector<Polyline>{{{1.0, 3.0}}, {{3.0, 6.0}, {4.0, 1.0}, {5.0, 2.0}}}));
  EXPECT_GT(figure.panels[0].y_from, 0.0);
  EXPECT_LT(figure.panels[0].y_from, 1.0);
  ASSERT_EQ(notes_.size(), 1U);
  EXPECT_EQ(notes_[0].find("3 samples"), 0U) << notes_[0];
  request.from = -1.0;
  EXPECT_EQ(test::brief(refusal(request)), "-1 [command.invalid_value]");
  second_ = first_ = run_with(first_folder_, "0,-1,0,0,0\n1,-1,0,1,0\n");
  request.from = {};
  EXPECT_EQ(test::brief(refusal(request)), "force [plot.no_data]");
}

TEST_F(CurvesFigure, APathIsToScale) {
  CurvesRequest request{"driver_position", {{"position"}}, {}, {}, {}};
  request.to_scale = true;
  const Figure figure = drawn(request);
  const Panel& panel = figure.panels.front();
  ASSERT_TRUE(figure.to_scale);
  // Within rounding of a few operations.
  constexpr double kRounding = 1e-12;
  EXPECT_NEAR((figure.x_to - figure.x_from) / kPanelWidth,
              (panel.y_to - panel.y_from) / panel.height, kRounding);
  request.y = {{"force"}};
  EXPECT_FALSE(drawn(request).to_scale);  // of two units there is no common scale
}

}  // namespace
}  // namespace tomlin
