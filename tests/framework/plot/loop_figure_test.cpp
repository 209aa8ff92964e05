#include "framework/plot/loop_figure.hpp"

#include <array>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/framework/plot/figure_folder.hpp"
#include "tests/support/faults.hpp"

namespace tomlin {
namespace {

constexpr const char* kOnALine = "time [time],d.force.x [force],d.position.x [length]\n";
constexpr const char* kInThePlane =
    "time [time],d.force.x [force],d.force.y [force],d.position.x [length],d.position.y [length]\n";

/// Out to 4, back to 0 and out again, with a force of +-1.
const std::string kRound =
    "0,0,0\n1,1,1\n2,1,2\n3,1,3\n4,1,4\n5,-1,3\n6,-1,2\n7,-1,1\n8,-1,0\n9,1,1\n10,1,2\n";

Figure loop_of(const StoredRun& run) { return loop_figure({run}, {""}, {}, kPanelWidth); }

TEST(LoopFigure, IsTheForceOverTheSupportWithItsDirections) {
  const test::RunFolderOfTexts folder(kOnALine + kRound);
  const Figure figure = loop_of(folder.run());
  const Panel& panel = figure.panels.front();
  ASSERT_EQ(panel.curves.size(), 1U);
  ASSERT_EQ(panel.curves[0].pieces.size(), 1U);
  EXPECT_EQ(panel.curves[0].pieces[0].size(), 11U);
  EXPECT_EQ(panel.curves[0].pieces[0][5], (Point{3.0, -1.0}));
  EXPECT_EQ(figure.x_label.text, "support position {/:Italic X}");
  EXPECT_EQ(panel.y_label.text, "lateral force {/:Italic F_x}");
  ASSERT_EQ(panel.arrows.size(), 2U);
  EXPECT_LT(panel.arrows[0].from.x, panel.arrows[0].to.x);
  EXPECT_EQ(panel.arrows[0].from.y, 1.0);
  EXPECT_GT(panel.arrows[1].from.x, panel.arrows[1].to.x);
  EXPECT_EQ(panel.arrows[1].from.y, -1.0);
}

TEST(LoopFigure, IsAlongThePullWhereverThatPoints) {
  // The same along (3, 4)/5 as along x, and with a force across it that does not count.
  std::string rows;
  std::string backwards;
  for (const auto& [time, force, position] : {std::array{0.0, 0.0, 0.0},
                                              {1.0, 1.0, 2.0},
                                              {2.0, 1.0, 4.0},
                                              {3.0, -1.0, 2.0},
                                              {4.0, -1.0, 0.0}}) {
    rows += fmt::format("{},{},{},{},{}\n", time, 0.6 * force - 0.8, 0.8 * force + 0.6,
                        0.6 * position, 0.8 * position);
    backwards += fmt::format("{},{},{}\n", time, -force, -position);
  }
  const test::RunFolderOfTexts plane(kInThePlane + rows);
  const Figure figure = loop_of(plane.run());
  const Polyline& trace = figure.panels[0].curves[0].pieces[0];
  // Rounding of a few operations on numbers around 1.
  constexpr double kRounding = 1e-14;
  EXPECT_NEAR(trace[2].x, 4.0, kRounding);
  EXPECT_NEAR(trace[2].y, 1.0, kRounding);
  EXPECT_NEAR(trace[3].y, -1.0, kRounding);
  EXPECT_NE(figure.x_label.text.find("along the pull"), std::string::npos);
  // A driver that begins to the left pulls to the left.
  const test::RunFolderOfTexts left(kOnALine + backwards);
  EXPECT_EQ(loop_of(left.run()).panels[0].curves[0].pieces[0][2], (Point{4.0, 1.0}));
}

TEST(LoopFigure, RefusesWhatIsNoLoop) {
  const test::RunFolderOfTexts one_way(std::string(kOnALine) + "0,0,0\n1,1,1\n2,1,2\n");
  EXPECT_EQ(test::brief(test::refusal_of([&] { loop_of(one_way.run()); })), "[plot.no_data]");
  const test::RunFolderOfTexts at_rest(std::string(kOnALine) + "0,0,1\n1,1,1\n");
  EXPECT_EQ(test::brief(test::refusal_of([&] { loop_of(at_rest.run()); })),
            "d.position [plot.no_data]");
  const test::RunFolderOfTexts none("time [time],d.force.x [force]\n0,1\n1,2\n");
  EXPECT_EQ(test::brief(test::refusal_of([&] { loop_of(none.run()); })), "[plot.no_data]");
}

}  // namespace
}  // namespace tomlin
