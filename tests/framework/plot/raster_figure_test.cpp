#include "framework/plot/raster_figure.hpp"

#include <cmath>
#include <deque>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/framework/plot/figure_folder.hpp"
#include "tests/support/faults.hpp"

namespace tomlin {
namespace {

constexpr const char* kHeader =
    "time [time],d.force.x [force],d.position.x [length],d.position.y [length]\n";

/// Three scan lines at y = 0, 0.5 and 1, forward with a force of x + 10 y and back with -1.
class RasterFigure : public testing::Test {
 protected:
  void SetUp() override {
    for (const double y : {1.0, 0.0, 0.5}) {
      std::string rows;
      for (int i = 0; i <= 16; ++i) {
        const double x = i <= 8 ? 0.5 * i : 0.5 * (16 - i);
        rows += fmt::format("{},{},{},{}\n", i, i <= 8 ? x + 10.0 * y : -1.0, x, y);
      }
      folders_.emplace_back(kHeader + rows);
      runs_.push_back(folders_.back().run());
    }
  }

  Figure drawn(const RasterRequest& request) { return raster_figure(runs_, request, notes_); }

  std::deque<test::RunFolderOfTexts> folders_;
  std::vector<StoredRun> runs_;
  std::vector<std::string> notes_;
  RasterRequest request_{"d.position.x",         "d.position.y", "d.force.x", {},
                         ScanDirection::forward, PixelGrid{2, 3}};
};

TEST_F(RasterFigure, PixelsHaveTheMeanOfTheirSamples) {
  const Figure figure = drawn(request_);
  ASSERT_TRUE(figure.panels[0].raster);
  const Raster& raster = *figure.panels[0].raster;
  EXPECT_EQ(raster.columns, 2U);
  // x = 0 to 1.5 and 2 to 4, on lines from below; the means are exact in binary.
  EXPECT_EQ(raster.values, (std::vector<double>{0.75, 3.0, 5.75, 8.0, 10.75, 13.0}));
  // The lines are in the middle of their rows.
  EXPECT_EQ(raster.y_from, -0.25);
  EXPECT_EQ(raster.y_to, 1.25);
  EXPECT_TRUE(figure.to_scale);
  EXPECT_EQ(raster.label.text, "force {/:Italic F_x}");
  EXPECT_EQ(figure.panels[0].y_label.text, "support position {/:Italic y}");
  EXPECT_TRUE(notes_.empty());
}

TEST_F(RasterFigure, StrokesAreToldApart) {
  request_.direction = ScanDirection::backward;
  const Figure back = drawn(request_);
  for (const double value : back.panels[0].raster->values) EXPECT_EQ(value, -1.0);
  request_.direction = ScanDirection::both;
  const Figure figure = drawn(request_);
  EXPECT_LT(figure.panels[0].raster->values[0], 0.75);
  EXPECT_GT(figure.panels[0].raster->values[0], -1.0);
}

TEST_F(RasterFigure, EmptyPixelsStayEmptyAndAreReported) {
  request_.pixels = PixelGrid{40, 3};
  const Figure figure = drawn(request_);
  std::size_t empty = 0;
  for (const double value : figure.panels[0].raster->values) empty += std::isnan(value) ? 1 : 0;
  EXPECT_EQ(empty, 120U - 27U);
  ASSERT_EQ(notes_.size(), 1U);
  EXPECT_EQ(notes_[0].find("93 of 120 pixels (40x3)"), 0U) << notes_[0];
}

TEST_F(RasterFigure, TheGridFollowsFromTheSamples) {
  request_.pixels.reset();
  const Raster lines = *drawn(request_).panels[0].raster;
  EXPECT_EQ(lines.columns, 4U);  // 27 samples in 3 rows, two to a pixel
  EXPECT_EQ(lines.values.size(), 12U);
  // A run with a slow axis: as many rows as strokes.
  std::string rows;
  constexpr int kStrokes = 10;
  constexpr int kPerStroke = 60;
  for (int i = 0; i <= kStrokes * kPerStroke; ++i) {
    const int phase = i % (2 * kPerStroke);
    const int x = phase <= kPerStroke ? phase : 2 * kPerStroke - phase;
    rows += fmt::format("{},{},{},{}\n", i, x, x, 0.001 * i);
  }
  const test::RunFolderOfTexts scan(kHeader + rows);
  runs_ = {scan.run()};
  const Raster slow = *drawn(request_).panels[0].raster;
  EXPECT_EQ(slow.values.size() / slow.columns, static_cast<std::size_t>(kStrokes / 2));
  request_.direction = ScanDirection::both;
  const Raster all = *drawn(request_).panels[0].raster;
  EXPECT_EQ(all.values.size() / all.columns, static_cast<std::size_t>(kStrokes));
}

TEST_F(RasterFigure, RefusesWhatIsNoImage) {
  const auto refused = [&] { return test::brief(test::refusal_of([&] { drawn(request_); })); };
  runs_.resize(1);
  EXPECT_EQ(refused(), "d.position.y [plot.no_data]");  // one line
  request_.y = "time";
  request_.value = "d.forse.x";
  EXPECT_EQ(refused(), "--value d.forse.x [plot.no_data] did you mean d.force.x");
  request_.value = "d.force.x";
  request_.x = "time";
  request_.direction = ScanDirection::backward;
  EXPECT_EQ(refused(), "backward [plot.no_data]");
}

TEST_F(RasterFigure, IsToScaleForTwoLengthsOnly) {
  request_.x = "time";
  EXPECT_FALSE(drawn(request_).to_scale);
}

}  // namespace
}  // namespace tomlin
