#include "framework/plot/gnuplot.hpp"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/text/fault.hpp"
#include "framework/plot/figure.hpp"
#include "framework/plot/figure_layout.hpp"
#include "framework/plot/gnuplot_script.hpp"
#include "tests/framework/output/temporary_folder.hpp"
#include "tests/support/faults.hpp"

namespace tomlin {
namespace {

Figure small_figure() {
  Curve curve;
  curve.label = "k = 2";
  curve.pieces = {{{0.0, 0.1}, {1.0, 0.5}}, {{2.0, 1.0}, {3.0, -1e-300}}};
  Panel panel;
  panel.y_label = {"force [force]"};
  panel.height = 300.0;
  panel.curves = {curve};
  Figure figure;
  figure.x_label = {"time [time]"};
  figure.panels = {panel};
  return figure;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(GnuplotString, IsOneQuotedWord) {
  EXPECT_EQ(gnuplot_string("plain"), "\"plain\"");
  EXPECT_EQ(gnuplot_string(""), "\"\"");
  EXPECT_EQ(gnuplot_string("{/:Italic F_x} [force]"), "\"{/:Italic F_x} [force]\"");
  EXPECT_EQ(gnuplot_string("it's \"1\""), "\"it\\047s \\042\\061\\042\"");
  EXPECT_EQ(gnuplot_string("\\n`a` @b $c"), "\"\\134n\\140a\\140 \\100b \\044c\"");
  EXPECT_EQ(gnuplot_string("two\nlines\r\tand\vmore"), "\"two lines and more\"");
  EXPECT_EQ(gnuplot_string("\xff!\xfe"), "\"?!?\"");
  EXPECT_EQ(gnuplot_string("\u03bb"), "\"\u03bb\"");
  EXPECT_LT(gnuplot_string(std::string(100000, '`')).size(), 1000U);
}

TEST(GnuplotScript, HasTheDataAndBreaksLines) {
  const std::string script = gnuplot_script(small_figure(), PictureFormat::svg);
  EXPECT_TRUE(contains(script, "<< END\n0 0.1\n1 0.5\n\n2 1\n3 -1e-300\n\nEND\n")) << script;
  EXPECT_TRUE(contains(script, "set terminal svg "));
  EXPECT_EQ(script, gnuplot_script(small_figure(), PictureFormat::svg));
  EXPECT_TRUE(contains(gnuplot_script(small_figure(), PictureFormat::pdf), "pdfcairo"));
  EXPECT_TRUE(contains(gnuplot_script(small_figure(), PictureFormat::png), "pngcairo"));
}

TEST(GnuplotScript, LogarithmicAxesEndBeforeTheKeys) {
  Figure figure = small_figure();
  EXPECT_FALSE(contains(gnuplot_script(figure, PictureFormat::svg), "\nset logscale"));
  figure.log_x = true;
  EXPECT_TRUE(contains(gnuplot_script(figure, PictureFormat::svg), "\nset logscale x\n"));
  figure.log_y = true;
  const std::string script = gnuplot_script(figure, PictureFormat::svg);
  const auto on = script.find("\nset logscale x\nset logscale y\n");
  ASSERT_NE(on, std::string::npos);
  EXPECT_LT(on, script.find("plot NaN"));
  EXPECT_LT(script.find("unset logscale\n"), script.find("keyentry"));
}

TEST(GnuplotScript, AShortLogarithmicAxisHasNumbersBetweenPowersOfTen) {
  Figure figure = small_figure();
  figure.log_x = true;
  figure.x_from = 0.9;
  figure.x_to = 21.0;
  EXPECT_TRUE(contains(gnuplot_script(figure, PictureFormat::svg),
                       "set xtics (\"1\" 1, \"2\" 2, \"5\" 5, \"10\" 10, \"20\" 20)\n"));
  figure.x_to = 2100.0;
  EXPECT_TRUE(contains(gnuplot_script(figure, PictureFormat::svg), "set format x '10^{%L}'\n"));
}

/// All numbers along it were the same in six digits.
TEST(GnuplotScript, AShortAxisFarFromZeroHasDigitsThatDiffer) {
  Figure figure = small_figure();
  figure.x_from = 0.64824922;
  figure.x_to = 0.64824926;
  const std::string script = gnuplot_script(figure, PictureFormat::svg);
  for (const char* number :
       {"\"0.64824923\" 0.648249", "\"0.64824924\" 0.648249", "\"0.64824925\" 0.648249"}) {
    EXPECT_TRUE(contains(script, number)) << number << '\n' << script;
  }
  EXPECT_FALSE(contains(script, "\"0.64824926\"")) << "at the edge, where it would be cut";
  figure.x_from = 0.64;
  EXPECT_TRUE(contains(gnuplot_script(figure, PictureFormat::svg), "set xtics autofreq"));
  // No digit of a double lies between.
  figure.x_from = 1.0;
  figure.x_to = 1.0 + 4e-16;
  EXPECT_TRUE(contains(gnuplot_script(figure, PictureFormat::svg), "set xtics autofreq"));
}

TEST(GnuplotScript, HasTheSizeAndTheFont) {
  Figure figure = small_figure();
  figure.size = FigureSize{700.0, 500.0};
  figure.font = {"Liberation Serif", 14.0};
  EXPECT_TRUE(contains(gnuplot_script(figure, PictureFormat::svg),
                       "set terminal svg size 700,500 font \"Liberation Serif,14\""));
  EXPECT_TRUE(contains(gnuplot_script(figure, PictureFormat::png), "size 1400,1000 "));
  figure.size = FigureSize{100.0, 500.0};
  try {
    gnuplot_script(figure, PictureFormat::svg);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(test::briefs(error), std::vector<std::string>{"100x500 [command.invalid_value]"});
  }
}

TEST(GnuplotScript, AFigureToScaleKeepsItsScaleAtAnySize) {
  Figure figure = small_figure();
  figure.to_scale = true;
  const FigureLayout own(figure);
  const auto ratio = [&](const FigureLayout& layout) {
    return (layout.right() - layout.left()) * layout.width() /
           ((layout.top_of(0) - layout.bottom_of(0)) * layout.height());
  };
  constexpr double kRounding = 1e-12;
  for (const FigureSize size : {FigureSize{400.0, 900.0}, FigureSize{900.0, 400.0}}) {
    figure.size = size;
    const FigureLayout layout(figure);
    EXPECT_EQ(layout.width(), size.width);
    EXPECT_NEAR(ratio(layout), ratio(own), kRounding);
  }
  figure.to_scale = false;  // the negative control: the panel fills the size
  EXPECT_GT(std::abs(ratio(FigureLayout(figure)) - ratio(own)), 0.1);
}

TEST(GnuplotScript, ARasterHasItsPixelsAndABar) {
  Figure figure = small_figure();
  figure.panels[0].raster = Raster{0.0, 4.0, 0.0, 2.0, 2, {1.0, 2.0, std::nan(""), 4.5}, {"force"}};
  const std::string script = gnuplot_script(figure, PictureFormat::svg);
  EXPECT_TRUE(contains(script, "<< END\n1 0.5 1\n3 0.5 2\n1 1.5 NaN\n3 1.5 4.5\nEND\n")) << script;
  EXPECT_TRUE(contains(script, "set cblabel \"force\""));
  EXPECT_TRUE(contains(script, "'#440154'"));
  figure.panels[0].raster->grey = true;
  EXPECT_FALSE(contains(gnuplot_script(figure, PictureFormat::svg), "'#440154'"));
}

TEST(GnuplotScript, CellsOfARasterMayDifferInSize) {
  Figure figure = small_figure();
  Raster raster{1.0, 100.0, 0.0, 2.0, 2, {1.0, std::nan(""), 3.0, 4.5}, {"force"}};
  raster.x_edges = {1.0, 5.0, 100.0};
  raster.y_edges = {0.0, 0.5, 2.0};
  figure.panels[0].raster = raster;
  const std::string script = gnuplot_script(figure, PictureFormat::svg);
  EXPECT_TRUE(contains(script,
                       "$panel0_raster << END\n1 0 1 5 0 0.5 1\n5 0 5 100 0 0.5 NaN\n"
                       "1 0.5 1 5 0.5 2 3\n5 0.5 5 100 0.5 2 4.5\nEND\n"))
      << script;
  EXPECT_TRUE(contains(script, "$panel0_raster using 1:2:3:4:5:6:7 with boxxyerror"));
  EXPECT_FALSE(contains(script, "with image"));
}

std::size_t keys_in(const std::string& script) {
  std::size_t count = 0;
  for (auto at = script.find("keyentry"); at != std::string::npos;
       at = script.find("keyentry", at + 1)) {
    ++count;
  }
  return count;
}

TEST(GnuplotScript, TheKeyIsSaidOnceUnlessItChanges) {
  Figure figure = small_figure();
  figure.panels.push_back(figure.panels.front());
  EXPECT_EQ(keys_in(gnuplot_script(figure, PictureFormat::svg)), 1U);
  figure.panels[1].curves[0].label = "k = 3";
  EXPECT_EQ(keys_in(gnuplot_script(figure, PictureFormat::svg)), 2U);
  figure.panels[0].curves[0].label = "";
  figure.panels[1].curves[0].label = "";
  EXPECT_EQ(keys_in(gnuplot_script(figure, PictureFormat::svg)), 0U);
}

/// Runs the gnuplot that there is, or one of the test's own.
class Gnuplot : public testing::Test {
 protected:
  void TearDown() override { ::unsetenv(kGnuplotVariable); }

  void use(const std::string& program) { ::setenv(kGnuplotVariable, program.c_str(), 1); }

  std::string program_of(const std::string& text) {
    const auto file = folder_ / "program";
    test::write(file, "#!/bin/sh\n" + text);
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
    return file.string();
  }

  static bool absent() {
    try {
      run_gnuplot("print 1\n");
    } catch (const InputError&) {
      return true;
    } catch (const GnuplotError&) {
      return false;
    }
    return false;
  }

  test::TemporaryFolder folder_;
};

#define SKIP_WITHOUT_GNUPLOT() \
  if (absent()) GTEST_SKIP() << "there is no gnuplot"

TEST_F(Gnuplot, DrawsTheSamePictureEveryTime) {
  SKIP_WITHOUT_GNUPLOT();
  const std::string script = gnuplot_script(small_figure(), PictureFormat::svg);
  const std::string picture = run_gnuplot(script);
  EXPECT_TRUE(contains(picture, "</svg>"));
  EXPECT_TRUE(contains(picture, ">k = 2<"));
  EXPECT_EQ(run_gnuplot(script), picture);
}

/// The script chooses the terminal; the user's own choice may be one that this gnuplot lacks.
TEST_F(Gnuplot, TakesNoTerminalFromTheEnvironment) {
  SKIP_WITHOUT_GNUPLOT();
  const std::string script = gnuplot_script(small_figure(), PictureFormat::svg);
  const std::string picture = run_gnuplot(script);
  ::setenv("GNUTERM", "no_such_terminal", 1);
  EXPECT_EQ(run_gnuplot(script), picture);
  use(program_of("printenv GNUTERM; echo drawn\n"));
  EXPECT_EQ(run_gnuplot(script), "drawn\n");
  ::unsetenv("GNUTERM");
}

TEST_F(Gnuplot, AKeyIsShownWholeBesideALowPanel) {
  SKIP_WITHOUT_GNUPLOT();
  Figure figure = small_figure();
  figure.panels[0].height = 60.0;
  for (int k = 0; k < 20; ++k) {
    figure.panels[0].curves.push_back(figure.panels[0].curves[0]);
    figure.panels[0].curves.back().label = "entry " + std::to_string(k);
  }
  const std::string picture = run_gnuplot(gnuplot_script(figure, PictureFormat::svg));
  for (int k = 0; k < 20; ++k) {
    EXPECT_TRUE(contains(picture, "<text>entry " + std::to_string(k) + "</text>")) << k;
  }
}

TEST_F(Gnuplot, CarriesOutNothingOfATitle) {
  SKIP_WITHOUT_GNUPLOT();
  const std::string bait = (folder_ / "bait").string();
  const std::string touch = "touch " + bait;
  for (const std::string& text :
       {"`" + touch + "`", "'; system('" + touch + "'); '", "\"; system(\"" + touch + "\") #",
        "x\nsystem('" + touch + "')\n", "$(" + touch + ")", "\\'\nsystem '" + touch + "'",
        std::string("@bait %s {/:Bold b} a_b^c ~ & <i>"), std::string("\\")}) {
    Figure figure = small_figure();
    figure.title = text;
    figure.panels[0].title = text;
    figure.panels[0].y_label = {text};
    figure.x_label = {text};
    figure.panels[0].curves[0].label = text;
    const std::string picture = run_gnuplot(gnuplot_script(figure, PictureFormat::svg));
    EXPECT_TRUE(contains(picture, "</svg>")) << text;
    EXPECT_FALSE(std::filesystem::exists(bait)) << text;
  }
  // The bait is one: where text is not quoted so, gnuplot does take it.
  run_gnuplot("set terminal svg\nset title \"`" + touch + "`\"\nplot x\n");
  EXPECT_TRUE(std::filesystem::exists(bait));
}

TEST_F(Gnuplot, ShowsATextAsItIs) {
  SKIP_WITHOUT_GNUPLOT();
  Figure figure = small_figure();
  figure.title = "'It's 5 % \\n \"x\" 'a_b' `c` $d @e #7 \u03bb";
  const std::string picture = run_gnuplot(gnuplot_script(figure, PictureFormat::svg));
  EXPECT_TRUE(contains(picture, "<text>" + figure.title + "</text>")) << picture;
}

TEST_F(Gnuplot, ItsComplaintIsHandedOn) {
  SKIP_WITHOUT_GNUPLOT();
  try {
    run_gnuplot("set terminal svg\nset nonsense\nplot x\n");
    FAIL();
  } catch (const GnuplotError& error) {
    EXPECT_TRUE(contains(error.what(), "gnuplot: status 1: ")) << error.what();
    EXPECT_TRUE(contains(error.what(), "set nonsense")) << error.what();
  }
}

TEST_F(Gnuplot, KnowsWhenItIsMissing) {
  use((folder_ / "nothing").string());
  try {
    run_gnuplot("");
    FAIL();
  } catch (const InputError& error) {
    const std::string absent = (folder_ / "nothing").string();
    EXPECT_EQ(test::briefs(error), std::vector<std::string>{absent + " [plot.no_gnuplot]"});
    for (const char* part : {"gnuplot-nox", "TOMLIN_GNUPLOT"}) {
      EXPECT_TRUE(contains(error.what(), part)) << error.what();
    }
  }
}

TEST_F(Gnuplot, FailsAsItFails) {
  const auto complaint = [&](const std::string& program) -> std::string {
    use(program_of(program));
    try {
      return run_gnuplot("script\n");
    } catch (const GnuplotError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(complaint("cat\n"), "script\n");  // what goes in and out when all is well
  EXPECT_EQ(complaint("echo half; echo no disk >&2; exit 3\n"), "gnuplot: status 3: no disk ");
  EXPECT_EQ(complaint("true\n"), "gnuplot: drew nothing");
  EXPECT_EQ(complaint("kill -9 $$\n"), "gnuplot: killed by signal 9");
  // More than fits a pipe, both ways.
  EXPECT_EQ(complaint("head -c 300000 /dev/zero; head -c 300000 /dev/zero >&2\n").size(), 300000U);
}

TEST_F(Gnuplot, TakesNoSettingsOfAUser) {
  SKIP_WITHOUT_GNUPLOT();
  const std::string script = gnuplot_script(small_figure(), PictureFormat::svg);
  const std::string picture = run_gnuplot(script);
  const char* home = std::getenv("HOME");
  const std::string before = home == nullptr ? "" : home;
  test::write(folder_ / ".gnuplot", "set grid lw 9\nset label 7 'mine' at screen 0.5,0.5\n");
  ::setenv("HOME", folder_.path().c_str(), 1);
  const std::string again = run_gnuplot(script);
  ::setenv("HOME", before.c_str(), 1);
  EXPECT_EQ(again, picture);
}

}  // namespace
}  // namespace tomlin
