#include "framework/plot/sweep_figure.hpp"

#include <cmath>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "framework/plot/gnuplot_script.hpp"
#include "framework/plot/stored_sweep.hpp"
#include "tests/framework/plot/figure_folder.hpp"
#include "tests/support/faults.hpp"

namespace tomlin {
namespace {

constexpr const char* kOverTwo = "v = \"1:100:3:log\"\nk = [4.0, 1.0, 2.0]\n";
constexpr const char* kForceOfSweep = "d.mean_force.x [force]";

/// The folder of a sweep, made of texts.
class SweepFigure : public testing::Test {
 protected:
  /// `axes` are lines of [sweep.over], `rows` what follows the header.
  StoredSweep sweep(const std::string& axes, const std::string& header, const std::string& rows,
                    const std::string& zip = "") {
    test::write(folder_ / "scene.toml",
                "[scene]\naxes = { force = \"V_0/a\" }\n[sweep]\n"
                "observables = [\"drivers.d.mean_force.x\"]\n" +
                    zip + "[sweep.over]\n" + axes);
    test::write(folder_ / "sweep.csv", header + ",status,reason\n" + rows);
    return read_stored_sweep(folder_.path().string());
  }

  /// Over v = 1, 10, 100 and k = 4, 1, 2; where the number is NaN the point has failed.
  StoredSweep two_axes(const std::function<double(double, double)>& force) {
    std::string rows;
    for (const double v : {1.0, 10.0, 100.0}) {
      for (const double k : {4.0, 1.0, 2.0}) {
        const double number = force(v, k);
        rows += std::isnan(number)
                    ? fmt::format("{},{},,failed,\"step 0, a \"\"cause\"\"\"\n", v, k)
                    : fmt::format("{},{},{},finished,\n", v, k, number);
      }
    }
    return sweep(kOverTwo, std::string("v,k,") + kForceOfSweep, rows);
  }

  Figure figure(const StoredSweep& from) { return sweep_figure(from, request_, notes_); }
  std::string refused(const StoredSweep& from) {
    return test::brief(test::refusal_of([&] { figure(from); }));
  }

  test::TemporaryFolder folder_;
  SweepRequest request_;
  std::vector<std::string> notes_;
};

double sum_of(double v, double k) { return v + k; }

TEST_F(SweepFigure, OneAxisIsACurve) {
  const Figure drawn = figure(sweep("v = \"1:100:3:log\"\n", std::string("v,") + kForceOfSweep,
                                    "1,3,finished,\n10,5,finished,\n100,4,finished,\n"));
  ASSERT_EQ(drawn.panels.size(), 1U);
  ASSERT_EQ(drawn.panels[0].curves.size(), 1U);
  EXPECT_EQ(drawn.panels[0].curves[0].pieces,
            (std::vector<Polyline>{{{1.0, 3.0}, {10.0, 5.0}, {100.0, 4.0}}}));
  EXPECT_EQ(drawn.panels[0].curves[0].label, "");
  EXPECT_EQ(drawn.panels[0].y_label.text, "mean force along {/:Italic x} / (V_0/a)");
  EXPECT_EQ(drawn.x_label.text, "{/:Italic v}");
  EXPECT_TRUE(drawn.log_x);
  EXPECT_FALSE(drawn.log_y);
  EXPECT_TRUE(notes_.empty());
}

TEST_F(SweepFigure, AxesAreLogarithmicAsGridsAre) {
  const StoredSweep two = two_axes(sum_of);
  const auto axes_with = [&](const std::optional<std::string>& log) {
    request_.log = log;
    const Figure drawn = figure(two);
    return std::string(drawn.log_x ? "x" : "") + (drawn.log_y ? "y" : "");
  };
  EXPECT_EQ(axes_with({}), "x");
  EXPECT_EQ(axes_with("none"), "");
  EXPECT_EQ(axes_with("y"), "y");
  request_.y = {{"d.mean_force.x"}};
  EXPECT_EQ(axes_with({}), "x");
  EXPECT_EQ(axes_with("xy"), "xy");
}

TEST_F(SweepFigure, TwoAxesAreAMapWithACellAroundEachPoint) {
  const Figure drawn = figure(two_axes(sum_of));
  ASSERT_TRUE(drawn.panels[0].raster);
  const Raster& map = *drawn.panels[0].raster;
  EXPECT_EQ(map.columns, 3U);
  // Upwards k = 1, 2, 4, whatever their order in the sweep.
  EXPECT_EQ(map.values,
            (std::vector<double>{2.0, 11.0, 101.0, 3.0, 12.0, 102.0, 5.0, 14.0, 104.0}));
  EXPECT_EQ(map.y_edges, (std::vector<double>{0.5, 1.5, 3.0, 5.0}));
  constexpr double kRounding = 1e-12;  // of logarithms and back, relative
  ASSERT_EQ(map.x_edges.size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) {
    const double edge = std::pow(10.0, static_cast<double>(k) - 0.5);
    EXPECT_NEAR(map.x_edges[k], edge, kRounding * edge);
  }
  EXPECT_EQ(drawn.x_from, map.x_edges.front());
  EXPECT_EQ(drawn.panels[0].y_to, map.y_edges.back());
  EXPECT_EQ(map.label.text, "mean force along {/:Italic x} / (V_0/a)");
  EXPECT_EQ(drawn.panels[0].y_label.text, "{/:Italic k}");
}

TEST_F(SweepFigure, TheAxesOfAMapAreChosen) {
  request_.x = "k";
  const Figure by_x = figure(two_axes(sum_of));
  EXPECT_EQ(by_x.panels[0].raster->values,
            (std::vector<double>{2.0, 3.0, 5.0, 11.0, 12.0, 14.0, 101.0, 102.0, 104.0}));
  EXPECT_TRUE(by_x.log_y);
  EXPECT_FALSE(by_x.log_x);
  request_.x = "";
  request_.y = {{"v"}};
  EXPECT_EQ(figure(two_axes(sum_of)).panels[0].raster->values, by_x.panels[0].raster->values);
}

TEST_F(SweepFigure, CellsOfPointsWithoutANumberStayWhite) {
  const StoredSweep holes =
      two_axes([](double v, double k) { return v == 10.0 && k == 2.0 ? std::nan("") : v + k; });
  const Figure drawn = figure(holes);
  const std::vector<double>& values = drawn.panels[0].raster->values;
  for (std::size_t k = 0; k < values.size(); ++k) EXPECT_EQ(std::isnan(values[k]), k == 4) << k;
  ASSERT_EQ(notes_.size(), 1U);
  EXPECT_EQ(notes_[0], "1 of 9 numbers are undefined, and their cells stay white");
  const std::string script = gnuplot_script(drawn, PictureFormat::svg);
  EXPECT_NE(script.find(" NaN\n"), std::string::npos);
  EXPECT_EQ(script.find(" NaN\n"), script.rfind(" NaN\n"));
  EXPECT_NE(script.find("boxxyerror"), std::string::npos);
  // As a curve it breaks there.
  request_.y = {{"d.mean_force.x"}};
  request_.at = {{"k", "2"}};
  const Panel panel = figure(holes).panels[0];
  EXPECT_EQ(panel.curves[0].pieces, (std::vector<Polyline>{{{1.0, 3.0}}, {{100.0, 102.0}}}));
  EXPECT_EQ(panel.title, "k = 2");
  EXPECT_EQ(notes_.back(), "1 of 3 numbers are undefined, and left out");
  EXPECT_EQ(refused(two_axes([](double, double) { return std::nan(""); })), "[plot.no_data]");
}

/// (log k - log_10 v log 2)^2 is least where k = 2^(log_10 v).
TEST_F(SweepFigure, TheLineGoesThroughTheLeastValues) {
  const auto valley = [](double v, double k) {
    return std::pow(std::log2(k) - std::log10(v), 2.0);
  };
  request_.minimum_along = "k";
  const Figure along_k = figure(two_axes(valley));
  ASSERT_EQ(along_k.panels[0].curves.size(), 1U);
  EXPECT_EQ(along_k.panels[0].curves[0].label, "minimum along k");
  EXPECT_EQ(along_k.panels[0].curves[0].pieces,
            (std::vector<Polyline>{{{1.0, 1.0}, {10.0, 2.0}, {100.0, 4.0}}}));
  ASSERT_EQ(notes_.size(), 1U);
  EXPECT_EQ(notes_[0], "at 2 of 3 values of v the least number is at an end of k");
  // k falls, and v is the other one: nothing but the order is another.
  request_.minimum_along = "v";
  EXPECT_EQ(figure(two_axes(valley)).panels[0].curves[0].pieces,
            along_k.panels[0].curves[0].pieces);
  // Failed points are no minimum; where all have failed, the line breaks.
  request_.minimum_along = "k";
  const Figure broken = figure(two_axes([&](double v, double k) {
    return v == 10.0 || (v == 1.0 && k == 1.0) ? std::nan("") : valley(v, k);
  }));
  EXPECT_EQ(broken.panels[0].curves[0].pieces,
            (std::vector<Polyline>{{{1.0, 2.0}}, {{100.0, 4.0}}}));
}

TEST_F(SweepFigure, CurvesOverOneAxisOneForEachValueOfTheOther) {
  request_.y = {{"drivers.d.mean_force.x"}};
  request_.x = "k";
  const Panel panel = figure(two_axes(sum_of)).panels[0];
  ASSERT_EQ(panel.curves.size(), 3U);
  EXPECT_EQ(panel.curves[1].label, "v = 10");
  EXPECT_EQ(panel.curves[1].pieces,
            (std::vector<Polyline>{{{1.0, 11.0}, {2.0, 12.0}, {4.0, 14.0}}}));
}

TEST_F(SweepFigure, WordsNameCurves) {
  const StoredSweep words = sweep(
      "type = [\"'a, b'\", \"'c'\"]\nv = [1.0, 2.0]\n", std::string("type,v,") + kForceOfSweep,
      "\"a, b\",1,3,finished,\n\"a, b\",2,4,finished,\n\"c\",1,5,finished,\n"
      "\"c\",2,6,finished,\n");
  const Panel panel = figure(words).panels[0];
  ASSERT_EQ(panel.curves.size(), 2U);
  EXPECT_EQ(panel.curves[0].label, "type = a, b");
  EXPECT_EQ(panel.curves[1].pieces, (std::vector<Polyline>{{{1.0, 5.0}, {2.0, 6.0}}}));
  request_.x = "type";
  EXPECT_EQ(refused(words), "type [command.conflict]");
}

TEST_F(SweepFigure, ZippedAxesAreOne) {
  const StoredSweep zipped =
      sweep("v = [3.0, 1.0, 2.0]\nk = [5.0, 5.0, 7.0]\n", std::string("v,k,") + kForceOfSweep,
            "3,5,9,finished,\n1,5,7,finished,\n2,7,8,finished,\n", "zip = [[\"v\", \"k\"]]\n");
  EXPECT_EQ(figure(zipped).panels[0].curves[0].pieces,
            (std::vector<Polyline>{{{1.0, 7.0}, {2.0, 8.0}, {3.0, 9.0}}}));
  request_.x = "k";
  EXPECT_EQ(figure(zipped).x_label.text, "{/:Italic k}");
  request_.y = {{"v"}};
  EXPECT_EQ(refused(zipped), "v [command.conflict]");
}

/// Points that bisection has added are on the curves of their lines, and in no map.
TEST_F(SweepFigure, RefinedSweepsAreCurves) {
  const std::string axes = "q = [\"a, b\", \"c\"]\nv = \"8:0:3\"\nk = [5.0, 7.0]\n";
  const std::string refine = "refine = \"drivers.d.mean_force.x=3\"\nrefine_along = \"v\"\n";
  const std::string rows =
      "\"a, b\",8,5,1,finished,\n\"a, b\",8,7,2,finished,\n\"a, b\",6,7,9,finished,\n"
      "\"a, b\",4,5,3,finished,\n\"a, b\",4,7,4,finished,\n\"a, b\",0,5,5,finished,\n"
      "\"a, b\",0,7,6,finished,\n\"c\",8,5,7,finished,\n\"c\",8,7,8,finished,\n"
      "\"c\",4,5,,failed,\"x\"\n\"c\",4,7,2,finished,\n\"c\",2,7,1,finished,\n"
      "\"c\",0,5,0,finished,\n\"c\",0,7,3,finished,\n";
  const std::string header = std::string("q,v,k,") + kForceOfSweep;
  const StoredSweep refined = sweep(axes, header, rows, refine);
  EXPECT_EQ(refined.points, 14U);
  const Panel panel = figure(refined).panels[0];
  ASSERT_EQ(panel.curves.size(), 4U);
  EXPECT_EQ(panel.curves[0].label, "q = a, b, k = 5");
  EXPECT_EQ(panel.curves[0].pieces, (std::vector<Polyline>{{{0.0, 5.0}, {4.0, 3.0}, {8.0, 1.0}}}));
  EXPECT_EQ(panel.curves[1].pieces,
            (std::vector<Polyline>{{{0.0, 6.0}, {4.0, 4.0}, {6.0, 9.0}, {8.0, 2.0}}}));
  EXPECT_EQ(panel.curves[2].pieces, (std::vector<Polyline>{{{0.0, 0.0}}, {{8.0, 7.0}}}));
  EXPECT_EQ(panel.curves[3].pieces,
            (std::vector<Polyline>{{{0.0, 3.0}, {2.0, 1.0}, {4.0, 2.0}, {8.0, 8.0}}}));
  request_.at = {{"q", "c"}, {"k", "7"}};
  EXPECT_EQ(figure(refined).panels[0].curves.size(), 1U);
  // Over another axis a point that has no other value of it is a curve by itself.
  request_.x = "k";
  request_.at = {{"q", "c"}};
  const Panel over_k = figure(refined).panels[0];
  ASSERT_EQ(over_k.curves.size(), 4U);
  EXPECT_EQ(over_k.curves[2].label, "v = 2");
  EXPECT_EQ(over_k.curves[2].pieces, (std::vector<Polyline>{{{7.0, 1.0}}}));
  request_ = {};
  request_.value = "d.mean_force.x";
  EXPECT_EQ(refused(refined), "v [command.conflict]");
  request_ = {};
  request_.y = {{"k"}};
  EXPECT_EQ(refused(refined), "v [command.conflict]");
  EXPECT_EQ(test::brief(test::refusal_of(
                [&] { sweep(axes, header, rows + "\"c\",0,8,3,finished,\n", refine); })),
            "[file.damaged]");
}

TEST_F(SweepFigure, OfMoreAxesTheOthersAreFixed) {
  std::string rows;
  for (const int a : {1, 2}) {
    for (const double b : {0.01, 0.0316227766, 0.1}) {
      for (const int c : {1, 2}) rows += fmt::format("{},{},{},{},finished,\n", a, b, c, a + b + c);
    }
  }
  const StoredSweep three = sweep("a = [1, 2]\nb = \"0.01:0.1:3:log\"\nc = [1, 2]\n",
                                  std::string("a,b,c,") + kForceOfSweep, rows);
  const Fault fault = test::refusal_of([&] { figure(three); });
  EXPECT_EQ(test::brief(fault), "[command.missing_argument]");
  EXPECT_NE(fault.why.find("a (2 values), b (3 values), c (2 values)"), std::string::npos);
  EXPECT_NE(fault.admissible.find("--at"), std::string::npos);
  request_.at = {{"b", "0.0316"}};
  const Panel panel = figure(three).panels[0];
  EXPECT_EQ(panel.title, "b = 0.0316228");
  EXPECT_EQ(panel.raster->values[1], 2.0 + 0.0316227766 + 1.0);
  request_.x = "b";
  EXPECT_EQ(refused(three), "b [command.conflict]");
  request_.x = "";
  request_.at = {{"b", "0.03"}};
  EXPECT_EQ(refused(three), "b=0.03 [plot.no_data]");
  request_.at = {{"b", "0.1"}, {"b", "0.01"}};
  EXPECT_EQ(refused(three), "--at [command.conflict]");
  request_.at.clear();
  request_.y = {{"d.mean_force.x"}};
  EXPECT_EQ(figure(three).panels[0].curves.back().label, "b = 0.1, c = 2");
}

TEST_F(SweepFigure, PanelsAndUnits) {
  const StoredSweep wide =
      sweep("v = [1.0, 2.0]\n",
            std::string("v,") + kForceOfSweep + ",d.max_force.x [force],events.slips [1],error." +
                kForceOfSweep,
            "1,3,4,5,0.25,finished,\n2,4,6,7,0.5,finished,\n");
  request_.y = {{"d.mean_force.x", "d.max_force.x"}, {"events.slips"}, {"error.d.mean_force.x"}};
  const Figure drawn = figure(wide);
  ASSERT_EQ(drawn.panels.size(), 3U);
  EXPECT_EQ(drawn.panels[0].curves[1].label, "d.max_force.x");
  EXPECT_EQ(drawn.panels[0].y_label.text, "force / (V_0/a)");
  EXPECT_EQ(drawn.panels[1].curves[0].pieces, (std::vector<Polyline>{{{1.0, 5.0}, {2.0, 7.0}}}));
  EXPECT_EQ(drawn.panels[2].y_label.text, "error of the mean force along {/:Italic x} / (V_0/a)");
  request_.y = {{"d.mean_force.x", "events.slips"}};
  EXPECT_EQ(refused(wide), "--y events.slips [command.invalid_value]");
}

TEST_F(SweepFigure, NamesWhatThereIs) {
  const StoredSweep two = two_axes(sum_of);
  request_.value = "d.mean_forse.x";
  EXPECT_EQ(refused(two), "d.mean_forse.x [plot.no_data] did you mean d.mean_force.x");
  request_ = {};
  request_.x = "vv";
  EXPECT_EQ(refused(two), "vv [plot.no_data]");
  request_ = {};
  request_.minimum_along = "d";
  EXPECT_EQ(refused(two), "d [plot.no_data]");
  request_ = {};
  request_.y = {{"d.mean_force.x"}};
  request_.value = "d.mean_force.x";
  EXPECT_EQ(refused(two), "--value [command.conflict]");
  request_ = {};
  request_.x = "k";
  request_.y = {{"k"}};
  EXPECT_EQ(refused(two), "k [command.conflict]");
}

TEST_F(SweepFigure, ALogarithmicAxisHasNoPlaceForZero) {
  const StoredSweep from_zero =
      sweep("v = [0.0, 1.0]\nk = [1.0, 2.0]\n", std::string("v,k,") + kForceOfSweep,
            "0,1,1,finished,\n0,2,2,finished,\n1,1,-3,finished,\n1,2,4,finished,\n");
  request_.log = "x";
  EXPECT_EQ(refused(from_zero), "v [command.conflict]");
  request_.log = "xy";
  request_.y = {{"d.mean_force.x"}};
  EXPECT_EQ(figure(from_zero).panels[0].curves[1].pieces, (std::vector<Polyline>{{{1.0, 4.0}}}));
  EXPECT_EQ(notes_.back(), "3 of 4 numbers are not positive, and not on a logarithmic axis");
}

TEST_F(SweepFigure, FilesThatDoNotBelongTogetherAreRefused) {
  const std::string header = std::string("v,k,") + kForceOfSweep;
  EXPECT_EQ(refused(sweep(kOverTwo, header, "1,4,5,finished,\n")), "[file.damaged]");
  const auto unread = [](const std::function<void()>& read) {
    return test::brief(test::refusal_of(read));
  };
  EXPECT_EQ(unread([&] { sweep(kOverTwo, "v,k", ""); }), "[file.damaged]");
  EXPECT_EQ(unread([&] { sweep("k = [1.0]\nv = [1.0, 2.0]\nw = [1.0]\n", header, ""); }),
            "[file.damaged]");
  test::write(folder_ / "sweep.csv", "time [time]\n");
  EXPECT_EQ(unread([&] { read_stored_sweep(folder_.path().string()); }),
            "1:1 time [time] [file.invalid]");
  test::write(folder_ / "scene.toml", "[scene]\n");
  EXPECT_EQ(unread([&] { read_stored_sweep(folder_.path().string()); }), "[file.invalid]");
  EXPECT_TRUE(holds_sweep(folder_.path().string()));
  std::filesystem::remove(folder_ / "sweep.csv");
  EXPECT_FALSE(holds_sweep(folder_.path().string()));
}

}  // namespace
}  // namespace tomlin
