#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/framework/cli/cli_fixture.hpp"

namespace tomlin::test {
namespace {

constexpr const char* kGnuplot = "TOMLIN_GNUPLOT";

/// The tip's scene, run into `tip`.
class Plot : public Cli {
 protected:
  void SetUp() override {
    Cli::SetUp();
    ASSERT_EQ(tomlin({"run", "tip.toml", "-o", "tip", "--quiet"}).status, 0);
  }
  void TearDown() override { ::unsetenv(kGnuplot); }

  void run_with(const std::string& setting, const std::string& folder) {
    ASSERT_EQ(tomlin({"run", "tip.toml", "--set", setting, "-o", folder, "--quiet"}).status, 0);
  }

  /// A program of the test's own in gnuplot's place.
  void use(const std::string& script) {
    write(folder_ / "program", "#!/bin/sh\n" + script);
    fs::permissions(folder_ / "program", fs::perms::owner_all);
    ::setenv(kGnuplot, (folder_ / "program").c_str(), 1);
  }

  bool gnuplot_is_absent() {
    const bool absent = tomlin({"plot", "tip", "-o", "try.svg"}).status == 2;
    fs::remove(folder_ / "try.svg");
    return absent;
  }

  /// The script that gnuplot would get.
  std::string script(std::vector<std::string> arguments) {
    use("cat");
    arguments.insert(arguments.begin(), "plot");
    arguments.insert(arguments.end(), {"-o", "script.svg"});
    const Ended ended = tomlin(arguments);
    EXPECT_EQ(ended.status, 0) << ended.err;
    EXPECT_EQ(ended.out, "");
    return ended.status == 0 ? file("script.svg") : "";
  }
};

#define SKIP_WITHOUT_GNUPLOT() \
  if (gnuplot_is_absent()) GTEST_SKIP() << "there is no gnuplot"

TEST_F(Plot, DrawsEveryFormat) {
  SKIP_WITHOUT_GNUPLOT();
  for (const auto& [name, magic] : {std::pair<std::string, std::string>{"a.svg", "<?xml "},
                                    {"a.png", "\x89PNG"},
                                    {"a.pdf", "%PDF-"}}) {
    const Ended ended = tomlin({"plot", "tip", "-o", name});
    EXPECT_EQ(ended.status, 0) << ended.err;
    EXPECT_EQ(ended.out + ended.err, "");
    EXPECT_EQ(file(name).substr(0, magic.size()), magic);
    EXPECT_FALSE(exists(name + ".part"));
  }
  EXPECT_TRUE(contains(file("a.svg"), "lateral force "));
  EXPECT_FALSE(contains(file("a.svg"), "[force]"));
  EXPECT_TRUE(contains(file("a.svg"), "</svg>"));
}

TEST_F(Plot, TheSameRunGivesTheSamePicture) {
  SKIP_WITHOUT_GNUPLOT();
  ASSERT_EQ(tomlin({"plot", "tip", "hysteresis", "-o", "a.svg"}).status, 0);
  ::setenv("LC_ALL", "C", 1);
  ASSERT_EQ(tomlin({"plot", "tip/", "hysteresis", "-o", "b.svg"}).status, 0);
  ::unsetenv("LC_ALL");
  EXPECT_EQ(file("a.svg"), file("b.svg"));
}

TEST_F(Plot, EveryFigureOfARingIsDrawn) {
  SKIP_WITHOUT_GNUPLOT();
  ASSERT_EQ(tomlin({"new", "ring"}).status, 0);
  ASSERT_EQ(tomlin({"run", "ring.toml", "--quiet"}).status, 0);
  for (const char* what : {"force", "force_size", "position", "height", "rotation", "speed",
                           "hysteresis", "path", "ring", "surface"}) {
    const Ended ended = tomlin({"plot", "ring.out", what, "-o", "a.svg"});
    EXPECT_EQ(ended.status, 0) << what << ": " << ended.err;
    EXPECT_EQ(ended.err, "");
    EXPECT_TRUE(contains(tomlin({"plot", "--help"}).out, std::string("\n  ") + what + " "));
  }
}

/// A force that is a driver has no support: its trace is over time.
TEST_F(Plot, ADriverWithoutASupportIsDrawnOverTime) {
  SKIP_WITHOUT_GNUPLOT();
  write(folder_ / "tip/observables.csv", "time [time],driver.force.x [force]\n0,1\n1,2\n");
  const Ended ended = tomlin({"plot", "tip", "-o", "a.svg"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_TRUE(contains(script({"tip"}), "time {/:Italic t}"));
}

TEST_F(Plot, ALongRunGivesASmallPicture) {
  SKIP_WITHOUT_GNUPLOT();
  constexpr int kRows = 200000;
  constexpr std::size_t kSmall = 100000;  // bytes; as many digits of all rows are 4 MB
  std::string table = "time [time],driver.force.x [force],driver.position.x [length]\n";
  for (int i = 0; i < kRows; ++i) {
    table += std::to_string(i);
    table += i == 77777 ? ",1000," : i % 2 == 0 ? ",1," : ",-1,";
    table += std::to_string(i);
    table += '\n';
  }
  write(folder_ / "tip/observables.csv", table);
  ASSERT_EQ(tomlin({"plot", "tip", "-o", "a.svg"}).status, 0);
  EXPECT_LT(file("a.svg").size(), kSmall);
  EXPECT_TRUE(contains(script({"tip"}), "77777 1000\n"));
}

TEST_F(Plot, RunsAreNamedByWhatDiffers) {
  run_with("v=2e-2", "faster");
  const std::string both = script({"tip", "faster"});
  EXPECT_TRUE(contains(both, "title \"v = 0.01\"")) << both;
  EXPECT_TRUE(contains(both, "title \"v = 0.02\"")) << both;
  EXPECT_FALSE(contains(both, "two_v"));
  run_with("force.viscous_damping.coefficient=3.0", "damped");
  const std::string same = script({"tip", "damped"});
  EXPECT_TRUE(contains(same, "title \"tip\"")) << same;
  EXPECT_TRUE(contains(same, "title \"damped\"")) << same;
  EXPECT_FALSE(contains(script({"tip"}), " title \"t"));
  const std::string own =
      script({"tip", "damped", "--label", "free, so to say", "--label", "damped"});
  EXPECT_TRUE(contains(own, "title \"free, so to say\"")) << own;
  expect_refused({"plot", "tip", "damped", "--label", "one", "-o", "a.svg"},
                 "tomlin: --label [command.invalid_value]\n", {" 1 ", " 2 "});
}

TEST_F(Plot, CurvesStandInTheOrderOfTheParameter) {
  run_with("v=2e-2", "faster");
  run_with("v=1e-1", "fastest");
  const std::string sorted = script({"fastest", "tip", "faster"});
  const auto slow = sorted.find("title \"v = 0.01\"");
  const auto fast = sorted.find("title \"v = 0.02\"");
  const auto last = sorted.find("title \"v = 0.1\"");
  EXPECT_LT(slow, fast);
  EXPECT_LT(fast, last);
  EXPECT_NE(last, std::string::npos);
  EXPECT_EQ(sorted, script({"tip", "faster", "fastest"}));
  // With labels the order is that of the words.
  const std::string own = script({"faster", "tip", "--label", "first", "--label", "second"});
  EXPECT_LT(own.find("title \"first\""), own.find("title \"second\""));
  EXPECT_NE(own, script({"tip", "faster", "--label", "first", "--label", "second"}));
}

TEST_F(Plot, UnitsAreThoseOfTheScene) {
  EXPECT_FALSE(contains(script({"tip"}), "[length]"));
  const std::string scene =
      R"(scene.axes={ length = "a", force = "V_0/a", velocity = "v_0", time = "" })";
  run_with(scene, "named");
  EXPECT_TRUE(contains(file("named/summary.json"), R"("force": "V_0/a")"));
  EXPECT_FALSE(contains(file("tip/summary.json"), "axes"));
  EXPECT_TRUE(contains(file("named/scene.toml"), R"(axes = { length = "a", )"));
  EXPECT_FALSE(contains(file("tip/scene.toml"), "axes"));
  const std::string named = script({"named"});
  EXPECT_TRUE(contains(named, "{/:Italic F_x} / (V_0/a)\" enhanced"));
  EXPECT_TRUE(contains(named, "{/:Italic vt} / a\" enhanced"));
  EXPECT_TRUE(
      contains(script({"named", "--x", "time", "--y", "speed"}), "{/:Italic t}\" enhanced"));
  EXPECT_EQ(tomlin({"run", "named/scene.toml", "-o", "again", "--quiet"}).status, 0);
  EXPECT_EQ(file("again/scene.toml"), file("named/scene.toml"));
  expect_refused({"plot", "tip", "named", "-o", "a.svg"},
                 "tip/summary.json: scene.axes [command.conflict]\n",
                 {"unit of length", "no name"});
  expect_refused(
      {"check", "tip.toml", "--set", "scene.axes.lenght=a"},
      "--set scene.axes.lenght=a: scene.axes.lenght [scene.unknown_key] did you mean length\n");
  expect_refused({"check", "tip.toml", "--set", "scene.axes=3"},
                 "--set scene.axes=3: scene.axes = 3 [scene.wrong_type]\n");
}

TEST_F(Plot, ADriverThatReversesHasALoop) {
  expect_refused({"plot", "tip", "loop", "-o", "a.svg"}, "tip/observables.csv: [plot.no_data]\n",
                 {"reverses"});
  ASSERT_EQ(tomlin({"run", "tip.toml", "--set",
                    "force.driver.reverse={ when = \"bodies.tip.centre_of_mass.x\", above = 1.0, "
                    "below = 0.5, times = 2 }",
                    "-o", "loop", "--quiet"})
                .status,
            0);
  const std::string loop = script({"loop", "loop"});
  EXPECT_TRUE(contains(loop, "$panel0_arrow1"));
  EXPECT_TRUE(contains(loop, "\"support position {/:Italic X}\""));
  EXPECT_TRUE(contains(script({"loop"}), "\"support position {/:Italic X}\""));
  EXPECT_TRUE(contains(script({"tip"}), "\"driver position {/:Italic vt}\""));
}

TEST_F(Plot, ResultsAreDrawnOverAParameter) {
  run_with("v=2e-2", "faster");
  fs::remove(folder_ / "tip/observables.csv");  // not needed
  const std::string points =
      script({"faster", "tip", "--result", "driver.mean_force.x", "--against", "v", "--log=xy"});
  EXPECT_TRUE(contains(points, "<< END\n0.01 0."));
  EXPECT_LT(points.find("\n0.01 0."), points.find("\n0.02 0."));
  EXPECT_TRUE(contains(points, "set logscale x\nset logscale y\n"));
  EXPECT_TRUE(contains(points, "\"mean force along {/:Italic x}\" enhanced"));
  expect_refused({"plot", "tip", "--result", "driver.mean_force.x", "-o", "a.svg"},
                 "tomlin: --against [command.missing_argument]\n");
  expect_refused({"plot", "tip", "speed", "--result", "driver.mean_force.x", "-o", "a.svg"},
                 "tomlin: speed [command.conflict]\n", {"--result"});
  expect_refused(
      {"plot", "tip", "--result", "driver.mean_forse.x", "--against", "v", "-o", "a.svg"},
      "tip/summary.json: [plot.no_data] did you mean driver.mean_force.x\n");
}

TEST_F(Plot, SlipsAreCounted) {
  const std::string slips = script({"tip", "slips", "--value", "peak_force", "--bins", "3"});
  EXPECT_TRUE(contains(slips, "\"peak force of a slip\""));
  EXPECT_TRUE(contains(slips, "filledcurves y=0"));
  expect_refused({"plot", "tip", "slips", "--value", "height", "-o", "a.svg"},
                 "tomlin: [command.invalid_value]\n", {"--value height", "peak_force"});
  expect_refused({"plot", "tip", "slips", "--bins", "0", "-o", "a.svg"},
                 "tomlin: --bins [command.invalid_value]\n", {"1 to 1000"});
}

TEST_F(Plot, ARasterNeedsItsThreeColumns) {
  const std::string raster =
      script({"tip", "raster", "--x", "driver.position.x", "--y", "tip.centre_of_mass.x",
              "--value=driver.force.x", "--pixels=20x10"});
  EXPECT_TRUE(contains(raster, "with image notitle"));
  EXPECT_TRUE(contains(raster, "set cblabel \"force {/:Italic F_x}\" enhanced"));
  expect_refused({"plot", "tip", "raster", "--x", "time", "--y", "speed", "-o", "a.svg"},
                 "tomlin: --value [command.missing_argument]\n");
  expect_refused({"plot", "tip", "raster", "--pixels", "0x3", "-o", "a.svg"},
                 "tomlin: --pixels [command.invalid_value]\n", {"1 to 1000"});
  expect_refused({"plot", "tip", "raster", "--scan", "up", "-o", "a.svg"},
                 "tomlin: --scan [command.invalid_value]\n", {"forward"});
}

TEST_F(Plot, TheFigureHasTheSizeAndFontAskedFor) {
  const std::string sized = script({"tip", "--size", "400x300", "--font", "Liberation Serif,10"});
  EXPECT_TRUE(contains(sized, "set terminal svg size 400,300 font \"Liberation Serif,10\""));
  EXPECT_TRUE(contains(script({"tip", "--font", ",20"}), "font \"sans-serif,20\""));
  for (const char* size : {"400", "x", "400x", "10x300", "400x300x2", "1e9x300"}) {
    expect_refused({"plot", "tip", "--size", size, "-o", "a.svg"},
                   "tomlin: --size [command.invalid_value]\n");
  }
  expect_refused({"plot", "tip", "--size", "100x100", "-o", "a.svg"},
                 "--size: 100x100 [command.invalid_value]\n", {"at least"});
  expect_refused({"plot", "tip", "--font", "Times,1000", "-o", "a.svg"},
                 "tomlin: --font [command.invalid_value]\n", {"NAME,SIZE"});
  expect_refused({"plot", "tip", "--log", "z", "-o", "a.svg"},
                 "tomlin: --log [command.invalid_value]\n", {"x, y, xy or none"});
}

TEST_F(Plot, AxesPanelsAndRangesAreChosen) {
  EXPECT_EQ(script({"tip"}), script({"tip", "force"}));
  EXPECT_EQ(script({"tip"}), script({"tip", "--y", "force", "--x", "driver_position"}));
  EXPECT_NE(script({"tip"}), script({"tip", "--x", "time"}));
  const std::string panels =
      script({"tip", "--x", "time", "--y", "driver.force.x", "--y=tip.velocity.x,speed", "--from",
              "100", "--to=200.5", "--title", "it's"});
  EXPECT_TRUE(contains(panels, "set xrange [100:200.5]"));
  EXPECT_TRUE(contains(panels, "$panel1_curve1"));
  EXPECT_FALSE(contains(panels, "$panel0_curve1"));
  EXPECT_TRUE(contains(panels, "\"driver.force.x\" noenhanced"));
  EXPECT_TRUE(contains(panels, "\"it\\047s\""));
  EXPECT_TRUE(contains(script({"tip", "--from", "-0.5"}), "set xrange [-0.5:2.99"));
}

TEST_F(Plot, ARunThatIsNotFinishedIsDrawnWithANote) {
  std::string summary = file("tip/summary.json");
  summary.replace(summary.find("finished"), 8, "interrupted");
  write(folder_ / "tip/summary.json", summary);
  use("cat");
  const Ended ended = tomlin({"plot", "tip", "-o", "a.svg"});
  EXPECT_EQ(ended.status, 0);
  EXPECT_EQ(ended.err, "note: tip: the run is not finished but interrupted\n");
  EXPECT_TRUE(exists("a.svg"));
}

TEST_F(Plot, WordsAreFoldersOrAFigure) {
  expect_refused({"plot", "tpi", "-o", "a.svg"}, "tomlin: tpi [file.invalid] did you mean tip\n");
  expect_refused({"plot", "tip", "hysteresys", "-o", "a.svg"},
                 "tomlin: hysteresys [file.invalid] did you mean hysteresis\n");
  expect_refused({"plot", "tip", "force", "speed", "-o", "a.svg"},
                 "tomlin: speed [command.conflict]\n", {" force "});
  // The first word is a folder, and a later one that names a figure is no folder.
  EXPECT_EQ(tomlin({"plot", "force", "tip", "-o", "a.svg"}).status, 2);
  fs::create_directory(folder_ / "empty");
  expect_refused({"plot", "empty", "-o", "a.svg"}, "empty: [file.invalid]\n", {"summary.json"});
  fs::copy(folder_ / "tip", folder_ / "speed");
  EXPECT_EQ(script({"speed"}), script({"tip"}));
  EXPECT_EQ(script({"speed", "speed"}), script({"tip", "speed"}));
  EXPECT_TRUE(contains(script({"tip", "speed/"}), "title \"speed\""));
}

TEST_F(Plot, TheFileSaysWhatKindOfPicture) {
  expect_refused({"plot", "tip", "-o", "a.gif"}, "-o: a.gif [command.invalid_value]\n",
                 {".svg, .png, .pdf"});
  fs::create_directory(folder_ / "a.svg");
  expect_refused({"plot", "tip", "-o", "a.svg"}, "-o: a.svg [file.invalid]\n");
  expect_refused({"plot", "tip"}, "tomlin: [command.missing_argument]\n", {"--output"});
}

TEST_F(Plot, OptionsThatDoNotGoTogetherAreRefused) {
  expect_refused({"plot", "tip", "--at", "1", "-o", "a.svg"}, "tomlin: --at [command.conflict]\n",
                 {"--from", "--to"});
  expect_refused({"plot", "tip", "ring", "--y", "time", "-o", "a.svg"},
                 "tomlin: --y [command.conflict]\n", {"ring"});
  expect_refused({"plot", "tip", "--value", "size", "-o", "a.svg"},
                 "tomlin: --value [command.conflict]\n", {"curves"});
  expect_refused({"plot", "tip", "loop", "--log", "x", "-o", "a.svg"},
                 "tomlin: --log [command.conflict]\n", {"loop"});
  expect_refused({"plot", "tip", "speed", "--y", "force", "-o", "a.svg"},
                 "tomlin: speed [command.conflict]\n", {"--y"});
  expect_refused({"plot", "tip", "--from", "2", "--to", "2", "-o", "a.svg"},
                 "tomlin: --from [command.invalid_value]\n", {"--to 2"});
  expect_refused({"plot", "tip", "--from", "nan", "-o", "a.svg"},
                 "tomlin: [command.invalid_value]\n", {"--from"});
  expect_refused({"plot", "tip", "ring", "--at", "1,x", "-o", "a.svg"},
                 "tomlin: --at [command.invalid_value]\n", {"\"x\""});
  expect_refused({"plot", "tip", "--y", "force,", "-o", "a.svg"},
                 "tomlin: --y [command.invalid_value]\n", {"\"force,\""});
}

/// Folders of sweeps in place of a run.
class PlotOfSweep : public Plot {
 protected:
  void SetUp() override {
    Plot::SetUp();
    ASSERT_EQ(tomlin({"sweep", "tip.toml", "--set", "run.duration=30.0", "--set", "measure.to=1.2",
                      "--over", "v=1e-1:1:4:log", "--over", "run.integrator.dt=1e-2,2e-2,-1",
                      "--observable", "driver.mean_force.x", "-o", "map", "--quiet"})
                  .status,
              0);
    ASSERT_EQ(tomlin({"sweep", "tip.toml", "--set", "run.duration=30.0", "--over", "v=1e-1:1:4:log",
                      "--observable", "driver.mean_force.x", "-o", "line", "--quiet"})
                  .status,
              0);
  }
};

TEST_F(PlotOfSweep, CurvesAndMapsAreDrawn) {
  SKIP_WITHOUT_GNUPLOT();
  for (const std::vector<std::string>& options :
       {std::vector<std::string>{"line"},
        {"map"},
        {"map", "--minimum-along", "v"},
        {"map", "--at", "run.integrator.dt=0.01", "--log", "xy"},
        {"map", "--result", "driver.mean_force.x", "--against", "v"}}) {
    for (const char* name : {"a.svg", "a.png", "a.pdf"}) {
      std::vector<std::string> arguments = {"plot"};
      arguments.insert(arguments.end(), options.begin(), options.end());
      arguments.insert(arguments.end(), {"-o", name});
      const Ended ended = tomlin(arguments);
      EXPECT_EQ(ended.status, 0) << ended.err;
      EXPECT_FALSE(contains(ended.err, "warning")) << ended.err;
    }
  }
  // A number of the table is a cell, and one that is undefined is none.
  const std::string script_of_map = script({"map"});
  EXPECT_TRUE(contains(script_of_map, "set logscale x\n")) << script_of_map;
  EXPECT_FALSE(contains(script_of_map, "set logscale y\n"));
  std::size_t white = 0;
  for (std::size_t at = 0; (at = script_of_map.find(" NaN\n", at)) != std::string::npos; ++at) {
    ++white;
  }
  EXPECT_EQ(white, 4U);
  const std::string of_line = script({"line"});
  const std::string table = file("line/sweep.csv");
  const std::size_t row = table.find('\n') + 1;
  const std::size_t comma = table.find(',', row);
  const double force = std::stod(table.substr(comma + 1));
  EXPECT_TRUE(contains(of_line, fmt::format("\n{} {}\n", 0.1, force))) << of_line;
}

TEST_F(PlotOfSweep, WhatDoesNotFitIsRefused) {
  const auto refused = [this](std::vector<std::string> arguments, const std::string& errors,
                              const std::vector<std::string>& parts = {}) {
    arguments.insert(arguments.begin(), "plot");
    arguments.insert(arguments.end(), {"-o", "a.svg"});
    expect_refused(arguments, errors, parts);
  };
  refused({"map", "line"}, "tomlin: line [command.conflict]\n");
  refused({"map", "raster"}, "tomlin: raster [command.conflict]\n");
  refused({"map", "--from", "1"}, "tomlin: --from [command.conflict]\n", {"--minimum-along"});
  refused({"map", "--at", "1"}, "tomlin: --at [command.invalid_value]\n", {"NAME=VALUE"});
  refused({"tip", "ring", "--at", "v=1"}, "tomlin: --at [command.invalid_value]\n", {"sweep"});
  refused({"tip", "--minimum-along", "v"}, "tomlin: --minimum-along [command.conflict]\n");
  refused({"map", "--against", "v"}, "tomlin: --result [command.missing_argument]\n");
  refused({"map", "--result", "driver.mean_force.x", "--y", "v"},
          "tomlin: --y [command.conflict]\n");
  refused({"map", "--value", "driver.mean_forse.x"},
          "map: driver.mean_forse.x [plot.no_data] did you mean driver.mean_force.x\n");
  fs::remove(folder_ / "map/sweep.csv");
  refused({"map"}, "map: [plot.no_data]\n", {"not finished", "`tomlin sweep`"});
}

TEST_F(Plot, WhatTheRunHasNotLeftIsNamed) {
  expect_refused(
      {"plot", "tip", "rotation", "-o", "a.svg"}, "tip/observables.csv: [plot.no_data]\n",
      {"no body has a column rotation", "driver.force.x, driver.position.x, tip.centre_of_mass.x"});
  fs::remove(folder_ / "tip/observables.csv");
  expect_refused({"plot", "tip", "-o", "a.svg"}, "tip: [plot.no_data]\n", {"observables.csv"});
}

TEST_F(Plot, WithoutGnuplotItSaysWhatToInstall) {
  ::setenv(kGnuplot, "./no_such_program", 1);
  expect_refused({"plot", "tip", "-o", "a.svg"}, "tomlin: ./no_such_program [plot.no_gnuplot]\n",
                 {"gnuplot-nox", "TOMLIN_GNUPLOT"});
}

TEST_F(Plot, AFailureLeavesTheEarlierPicture) {
  write(folder_ / "a.svg", "earlier");
  use("echo '<half'; echo 'no such terminal' >&2; exit 3");
  const Ended ended = tomlin({"plot", "tip", "-o", "a.svg"});
  EXPECT_EQ(ended.status, 1);
  EXPECT_EQ(abridged(ended.err), "tomlin: gnuplot [plot.no_gnuplot]\n");
  EXPECT_TRUE(contains(ended.err, "status 3: no such terminal ")) << ended.err;
  EXPECT_EQ(file("a.svg"), "earlier");
  EXPECT_FALSE(exists("a.svg.part"));
  use("cat");
  EXPECT_EQ(tomlin({"plot", "tip", "-o", "a.svg"}).status, 0);
  EXPECT_NE(file("a.svg"), "earlier");
}

TEST_F(Plot, APictureThatCannotBeWrittenIsReported) {
  use("cat");
  // Found before the work.
  expect_refused({"plot", "tip", "-o", "nowhere/a.svg"}, "-o: nowhere/a.svg [file.cannot_write]\n");
}

}  // namespace
}  // namespace tomlin::test
