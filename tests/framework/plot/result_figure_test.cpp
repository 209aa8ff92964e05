#include "framework/plot/result_figure.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/framework/plot/figure_folder.hpp"
#include "tests/support/faults.hpp"

namespace tomlin {
namespace {

StoredRun run_at(double v, double k, double force) {
  StoredRun run;
  run.folder = "runs";
  run.parameters = {{"v", v}, {"k", k}};
  run.results = {{"drivers.d.mean_force.x", force}, {"events.slips", 10.0 * v}};
  return run;
}

TEST(ResultFigure, HasAPointForEachRunInTheOrderOfTheParameter) {
  std::vector<std::string> notes;
  const Figure figure = result_figure({run_at(10.0, 2.0, 0.3), run_at(9.0, 2.0, 0.2)},
                                      {"d.mean_force.x", "v"}, notes);
  const Panel& panel = figure.panels.front();
  ASSERT_EQ(panel.curves.size(), 1U);
  EXPECT_EQ(panel.curves[0].pieces, (std::vector<Polyline>{{{9.0, 0.2}, {10.0, 0.3}}}));
  EXPECT_EQ(panel.curves[0].label, "");
  EXPECT_NE(panel.curves[0].mark, Mark::none);
  EXPECT_EQ(figure.x_label.text, "{/:Italic v}");
  EXPECT_EQ(panel.y_label.text, "mean force along {/:Italic x}");
}

TEST(ResultFigure, AnotherParameterMakesCurves) {
  std::vector<std::string> notes;
  const std::vector<StoredRun> runs = {run_at(1.0, 10.0, 1.0), run_at(2.0, 9.0, 4.0),
                                       run_at(2.0, 10.0, 2.0), run_at(1.0, 9.0, 3.0)};
  const Figure figure = result_figure(runs, {"drivers.d.mean_force.x", "v"}, notes);
  ASSERT_EQ(figure.panels[0].curves.size(), 2U);
  EXPECT_EQ(figure.panels[0].curves[0].label, "k = 9");
  EXPECT_EQ(figure.panels[0].curves[0].pieces, (std::vector<Polyline>{{{1.0, 3.0}, {2.0, 4.0}}}));
  EXPECT_EQ(figure.panels[0].curves[1].label, "k = 10");
  EXPECT_EQ(figure.panels[0].curves[1].pieces, (std::vector<Polyline>{{{1.0, 1.0}, {2.0, 2.0}}}));
  // Along a result the parameter with the most values varies.
  std::vector<StoredRun> more = runs;
  more.push_back(run_at(3.0, 9.0, 5.0));
  const Figure results = result_figure(more, {"d.mean_force.x", "events.slips"}, notes);
  ASSERT_EQ(results.panels[0].curves.size(), 2U);
  EXPECT_EQ(results.panels[0].curves[0].label, "k = 9");
  EXPECT_EQ(results.panels[0].curves[0].pieces[0][2], (Point{30.0, 5.0}));
  EXPECT_TRUE(notes.empty());
}

/// Runs that differ in another parameter alone are not joined.
TEST(ResultFigure, AParameterThatIsTheSameInAllRunsJoinsNone) {
  std::vector<std::string> notes;
  const Figure figure =
      result_figure({run_at(1.0, 2.0, 0.3), run_at(3.0, 2.0, 0.2)}, {"d.mean_force.x", "k"}, notes);
  ASSERT_EQ(figure.panels[0].curves.size(), 2U);
  EXPECT_EQ(figure.panels[0].curves[0].label, "v = 1");
  EXPECT_EQ(figure.panels[0].curves[1].label, "v = 3");
  EXPECT_EQ(figure.panels[0].curves[1].pieces, (std::vector<Polyline>{{{2.0, 0.2}}}));
}

TEST(ResultFigure, LeavesOutWhatHasNoPlace) {
  std::vector<std::string> notes;
  const std::vector<StoredRun> runs = {run_at(1.0, 2.0, std::nan("")), run_at(2.0, 2.0, -1.0),
                                       run_at(3.0, 2.0, 1.0)};
  const Figure figure = result_figure(runs, {"d.mean_force.x", "v", true, true}, notes);
  EXPECT_TRUE(figure.log_x && figure.log_y);
  EXPECT_EQ(figure.panels[0].curves[0].pieces, (std::vector<Polyline>{{{3.0, 1.0}}}));
  EXPECT_EQ(notes.size(), 2U);
  EXPECT_EQ(test::brief(test::refusal_of([&] {
              result_figure({runs[0]}, {"d.mean_force.x", "v"}, notes);
            })),
            "d.mean_force.x [plot.no_data]");
}

TEST(ResultFigure, NamesWhatThereIs) {
  std::vector<std::string> notes;
  const auto refused = [&](const ResultRequest& request) {
    return test::brief(
        test::refusal_of([&] { result_figure({run_at(1.0, 2.0, 3.0)}, request, notes); }));
  };
  EXPECT_EQ(refused({"d.mean_forse.x", "v"}),
            "--result d.mean_forse.x [plot.no_data] did you mean d.mean_force.x");
  EXPECT_EQ(refused({"d.mean_force.x", "vv"}), "--against vv [plot.no_data]");
}

}  // namespace
}  // namespace tomlin
