#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "framework/cli/command.hpp"
#include "framework/cli/exit_status.hpp"
#include "framework/cli/new_file.hpp"
#include "framework/cli/options.hpp"
#include "framework/cli/print_result.hpp"
#include "framework/cli/printable.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/core/text/nearest_name.hpp"
#include "framework/output/output_file.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/plot/body_figure.hpp"
#include "framework/plot/curve_labels.hpp"
#include "framework/plot/curves_figure.hpp"
#include "framework/plot/gnuplot.hpp"
#include "framework/plot/gnuplot_script.hpp"
#include "framework/plot/loop_figure.hpp"
#include "framework/plot/quantities.hpp"
#include "framework/plot/raster_figure.hpp"
#include "framework/plot/result_figure.hpp"
#include "framework/plot/sample_table.hpp"
#include "framework/plot/slips_figure.hpp"
#include "framework/plot/stored_run.hpp"
#include "framework/plot/stored_sweep.hpp"
#include "framework/plot/surface_figure.hpp"
#include "framework/plot/sweep_figure.hpp"
#include "framework/run/run.hpp"
#include "framework/scene/text.hpp"
#include "framework/standard_registry.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

struct PlotArguments {
  std::vector<std::string> words;  ///< DIRs and WHAT
  std::string file;
  std::string x;                            ///< empty: WHAT's own
  std::vector<std::string> panels;          ///< --y as given
  std::vector<std::vector<std::string>> y;  ///< the same taken apart; empty: WHAT's own
  std::optional<double> from;
  std::optional<double> to;
  std::vector<std::string> moments;                        ///< --at as given
  std::vector<double> at;                                  ///< the same as numbers
  std::vector<std::pair<std::string, std::string>> fixed;  ///< those that are NAME=VALUE
  std::string driver;                                      ///< empty: the only one
  std::string body;
  std::string title;
  std::vector<std::string> labels;  ///< one for each DIR; empty: by what differs
  std::string value;                ///< of a raster or of slips
  std::string scan;                 ///< which strokes of a raster; empty: both
  std::string grid;                 ///< --pixels as given
  std::optional<PixelGrid> pixels;  ///< the same taken apart
  std::optional<std::size_t> bins;
  std::string result;
  std::string against;
  std::string minimum_along;
  std::string logarithmic;  ///< "x", "y", "xy" or "none"; empty: not given
  std::string extent;       ///< --size as given
  std::string font;         ///< --font as given
  std::optional<FigureSize> size;
  FigureFont named_font;

  bool log_x() const { return logarithmic.find('x') != std::string::npos; }
  bool log_y() const { return logarithmic.find('y') != std::string::npos; }
  /// In which curves are to be fine.
  double width() const { return size ? std::max(size->width, kPanelWidth) : kPanelWidth; }
};

// Figures that are not one quantity over another.
constexpr std::string_view kBodyFigure = "ring";
constexpr std::string_view kLoopFigure = "loop";
constexpr std::string_view kSurfaceFigure = "surface";
constexpr std::string_view kRasterFigure = "raster";
constexpr std::string_view kSlipsFigure = "slips";

struct SpecialFigure {
  std::string_view name;
  std::string_view options;  ///< that it takes, each with a space behind it
  std::string_view summary;
};

constexpr std::array kSpecialFigures = {
    SpecialFigure{kLoopFigure, "--driver --label ",
                  "friction loop of a driver that reverses: force over support position"},
    SpecialFigure{kBodyFigure, "--x --at --driver --body --label ",
                  "particles of a ring, or another planar body, at the moments --at"},
    SpecialFigure{kSurfaceFigure, "--body --from --to ",
                  "the path of a body over the potential of its substrates"},
    SpecialFigure{kRasterFigure, "--x --y --value --scan --pixels --driver --body ",
                  "--value in colours over --x and --y: an image of scan lines"},
    SpecialFigure{kSlipsFigure, "--value --bins --log --driver --label ",
                  "histogram of slips by --value"},
};
constexpr std::string_view kOptionsOfCurves = "--x --y --from --to --log --driver --body --label ";
constexpr std::string_view kOptionsOfResults = "--result --against --log ";
constexpr std::string_view kOptionsOfSweeps =
    "--x --y --value --minimum-along --at --result --against --log ";

constexpr const char* kPlotFooter = R"(
The first word is a folder; another folder that is called like a figure is written with a slash, ring/.
X and Y are such a quantity or any column of observables.csv. Commas put curves on one axis, another
--y makes another panel below. Several DIRs are curves of one figure, named by the parameters in
which their scenes differ, and in the order of their values, or else by their folders; --label names
them otherwise, in the order given.

With --result and --against each DIR is a point: a result of summary.json over a parameter or another
result. Runs that differ in a second parameter are on curves of their own.

The folder of a sweep is drawn alone and without WHAT. Over one axis it is a curve of the first
observable; --y names others, and panels, as above. Over two axes it is a map with a cell around each
point and the first axis along x: --x and --y name other axes, --value another observable, and
--minimum-along an axis: a line joins the points of least value along it, one for each value of the
other axis. With an observable as --y, or --result and --against, it is curves over one axis, one for
each value of the others. --at NAME=VALUE shows one value of an axis alone. Axes are logarithmic where
the grids of their values are, unless --log is given. Where points have no number, cells stay white
and curves break.

A raster has the mean of all samples in each pixel: a row for each value of Y, or for each stroke
along X, and two samples to a pixel on average, unless --pixels says otherwise. Pixels without a
sample stay white. A potential is that of one particle on the periodic forces of scene.toml.

An axis has a unit where the scene names it, [scene] axes = { length = "a" }, and in metal units.

Examples:

  tomlin plot pt.out -o force.svg
      the friction trace.
  tomlin plot k_2.out k_8.out hysteresis -o loops.pdf
      two runs on the same axes.
  tomlin plot ring.out --y force_size --y position --y height --from 2 --to 4 -o steps.svg
      three panels versus v t from 2 to 4.
  tomlin plot ring.out ring --at 2500,3000,3500 -o places.png
      a ring at three times.
  tomlin plot v_1.out v_2.out ring --x driver_position --at 2,2.5,3 -o places.svg
      two rings, when their drivers have come so far.
  tomlin plot pt.out --x time --y tip.velocity.x -o velocity.svg
      a column over another.
  tomlin plot v_1.out v_2.out v_3.out --result driver.mean_force.x --against v --log x -o law.svg
      the mean force over the velocity.
  tomlin plot line_1.out line_2.out raster --x driver.position.x --y driver.position.y \
      --value driver.force.x --scan forward -o image.png
      an image of the lateral force, from one run for each scan line.
  tomlin plot pt.out slips --value peak_force -o slips.svg
      how many slips there are of each peak force.
  tomlin plot pt.sweep.out -o law.svg
      an observable over the axis of a sweep.
  tomlin plot map --x v --y lambda --value driver.mean_force.x --minimum-along lambda -o map.svg
      a sweep over two axes as a map, and for each v where along lambda the mean force is least.

gnuplot 5.4 draws (Debian: gnuplot-nox); TOMLIN_GNUPLOT names another one than the one in PATH. An
earlier FILE is replaced. The same runs give the same SVG.

Exit status: 0 done; 1 gnuplot failed or FILE could not be written; 2 invalid input, or
there is no gnuplot.)";

void add_line(std::string& text, std::string_view name, std::string_view summary) {
  fmt::format_to(std::back_inserter(text), "  {:<17} {}\n", name, summary);
}

/// The figures, the quantities, examples.
std::string plot_footer() {
  std::string text = "\nWHAT:\n\n";
  for (const FigureKind& kind : figure_kinds()) add_line(text, kind.name, kind.summary);
  for (const SpecialFigure& figure : kSpecialFigures) add_line(text, figure.name, figure.summary);
  text += "\nQuantities for --x and --y:\n\n";
  for (const Quantity& quantity : quantities()) add_line(text, quantity.name, quantity.summary);
  return text + kPlotFooter;
}

/// "A,B" as A and B.
std::vector<std::string> parts_of(const std::string& list, const char* option) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    if (end == begin) {
      refuse_command(FaultCode::command_invalid_value,
                     fmt::format("{}: \"{}\" has an empty part", option, list));
    }
    parts.push_back(list.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

double finite_number(const std::string& text, const char* option) {
  double number = 0.0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || stop != end || !std::isfinite(number)) {
    refuse_command(FaultCode::command_invalid_value,
                   fmt::format("{}: \"{}\" is not a number", option, text));
  }
  return number;
}

/// "AxB" as two numbers in a range.
std::pair<double, double> two_numbers(const std::string& text, const char* option, double least,
                                      double most) {
  const std::size_t cross = text.find('x');
  if (cross == std::string::npos) {
    refuse_command(FaultCode::command_invalid_value,
                   fmt::format("{}: \"{}\" is not WIDTHxHEIGHT", option, text));
  }
  const std::pair numbers{finite_number(text.substr(0, cross), option),
                          finite_number(text.substr(cross + 1), option)};
  for (const double number : {numbers.first, numbers.second}) {
    if (number >= least && number <= most) continue;
    refuse_command(FaultCode::command_invalid_value,
                   fmt::format("{}: {:g} is out of range", option, number),
                   fmt::format("{:g} to {:g}", least, most));
  }
  return numbers;
}

/// "NAME,SIZE"; either may be left out.
FigureFont font_of(const std::string& text) {
  constexpr double kSmallest = 4.0;
  constexpr double kLargest = 72.0;
  FigureFont font;
  const std::size_t comma = std::min(text.rfind(','), text.size());
  if (comma > 0) font.name = text.substr(0, comma);
  if (comma < text.size()) font.size = finite_number(text.substr(comma + 1), "--font");
  if (text.empty() || font.size < kSmallest || font.size > kLargest) {
    refuse_command(
        FaultCode::command_invalid_value, fmt::format("--font: \"{}\"", text),
        fmt::format("NAME,SIZE with a size of {:g} to {:g} points", kSmallest, kLargest));
  }
  return font;
}

constexpr const char* kWhatByDefault = "force";
constexpr const char* kPathFigure = "path";
constexpr int kMostNeighbours = 1000;  // folders looked at for a nearest name

[[noreturn]] void refuse_option(FaultCode code, const std::string& key, std::string why,
                                std::string admissible = "", std::string nearest = "",
                                std::string file = "tomlin") {
  refuse_input(code, std::move(file), shortened(key, kLongestShownValue), std::move(why),
               std::move(admissible), std::move(nearest));
}

std::vector<std::string> all_whats() {
  std::vector<std::string> names;
  for (const FigureKind& kind : figure_kinds()) names.emplace_back(kind.name);
  for (const SpecialFigure& figure : kSpecialFigures) names.emplace_back(figure.name);
  return names;
}

const SpecialFigure* find_special(const std::string& word) {
  const auto* const found =
      std::find_if(kSpecialFigures.begin(), kSpecialFigures.end(),
                   [&](const SpecialFigure& figure) { return figure.name == word; });
  return found == kSpecialFigures.end() ? nullptr : found;
}

bool is_what(const std::string& word) {
  return find_special(word) != nullptr || find_figure_kind(word) != nullptr;
}

/// Folders of runs and sweeps beside the one that is not there, in the same spelling.
std::vector<std::string> neighbours_of(const std::string& word) {
  const fs::path above = fs::path(word).parent_path();
  std::vector<std::string> names;
  std::error_code error;
  fs::directory_iterator entry(above.empty() ? fs::path(".") : above, error);
  for (int k = 0; !error && k < kMostNeighbours && entry != fs::directory_iterator(); ++k) {
    if (holds_run(entry->path().string()) || holds_sweep(entry->path().string())) {
      names.push_back((above / entry->path().filename()).string());
    }
    entry.increment(error);
  }
  return names;
}

[[noreturn]] void refuse_word(const std::string& word) {
  std::error_code error;
  if (fs::is_directory(word, error)) {
    refuse_option(FaultCode::file_invalid, "",
                  fmt::format("there is no {} in it: it is not the folder of a run that has ended",
                              kSummaryFile),
                  "", "", shortened(word, kLongestShownValue));
  }
  std::vector<std::string> known = all_whats();
  const std::vector<std::string> folders = neighbours_of(word);
  known.insert(known.end(), folders.begin(), folders.end());
  refuse_option(
      FaultCode::file_invalid, word, "neither the folder of a run nor a figure",
      fmt::format(
          "folders that tomlin run has left, and one of {}; or one that tomlin sweep has left",
          fmt::join(all_whats(), ", ")),
      nearest_name(word, known).value_or(""));
}

struct Words {
  std::vector<std::string> folders;
  std::string what;  ///< empty when not given
};

/// DIRs and WHAT, told apart: the first word is a DIR, and a later one that names a figure is WHAT,
/// whatever folders there are.
Words sorted(const std::vector<std::string>& words) {
  Words result;
  for (const std::string& word : words) {
    if (!result.folders.empty() && is_what(word)) {
      if (!result.what.empty()) {
        refuse_option(FaultCode::command_conflict, word,
                      "only one figure can be drawn, and " + result.what + " is requested already");
      }
      result.what = word;
    } else if (holds_run(word)) {
      result.folders.push_back(word);
    } else {
      refuse_word(word);
    }
  }
  return result;
}

/// By the file's suffix.
PictureFormat format_of(const std::string& file) {
  static constexpr std::array kFormats = {std::pair{".svg", PictureFormat::svg},
                                          std::pair{".png", PictureFormat::png},
                                          std::pair{".pdf", PictureFormat::pdf}};
  const std::string suffix = fs::path(file).extension().string();
  for (const auto& [name, format] : kFormats) {
    if (suffix == name) return format;
  }
  refuse_option(FaultCode::command_invalid_value, file,
                "the suffix does not say what kind of picture", ".svg, .png, .pdf", "", "-o");
}

std::vector<StoredRun> read_runs(const std::vector<std::string>& folders, bool with_samples,
                                 std::vector<std::string>& notes) {
  std::vector<StoredRun> runs;
  for (const std::string& folder : folders) {
    StoredRun run = read_stored_run(folder);
    std::error_code error;
    if (with_samples && !fs::exists(file_of(run, kTableFile), error)) {
      refuse_option(
          FaultCode::plot_no_data, "",
          fmt::format("there is no {}: a run leaves one when its scene has [output] every",
                      kTableFile),
          "", "", folder);
    }
    if (run.status != to_string(RunStatus::finished)) {
      notes.push_back(fmt::format("{}: the run is not finished but {}", folder, run.status));
    }
    runs.push_back(std::move(run));
  }
  return runs;
}

std::vector<std::string> labels_of(const std::vector<StoredRun>& runs,
                                   const PlotArguments& arguments) {
  if (arguments.labels.empty()) return curve_labels(runs);
  if (arguments.labels.size() != runs.size()) {
    refuse_option(FaultCode::command_invalid_value, "--label",
                  fmt::format("{} for {} folders", arguments.labels.size(), runs.size()),
                  "one for each");
  }
  return arguments.labels;
}

/// Refuses options that the figure has no use for.
void check_options(const std::string& what, bool of_sweep, const PlotArguments& arguments) {
  const SpecialFigure* special = find_special(what);
  const bool results = !arguments.result.empty() || !arguments.against.empty();
  const std::string_view admissible = of_sweep             ? kOptionsOfSweeps
                                      : special != nullptr ? special->options
                                      : results            ? kOptionsOfResults
                                                           : kOptionsOfCurves;
  const auto check = [&](const char* option, bool given) {
    if (!given || admissible.find(std::string(option) + " ") != std::string_view::npos) return;
    refuse_option(FaultCode::command_conflict, option,
                  fmt::format("not for {}", of_sweep             ? "sweeps"
                                            : special != nullptr ? special->name
                                            : results            ? "results"
                                                                 : "curves"),
                  std::string(admissible.substr(0, admissible.size() - 1)));
  };
  check("--x", !arguments.x.empty());
  check("--y", !arguments.y.empty());
  check("--from", arguments.from.has_value());
  check("--to", arguments.to.has_value());
  check("--at", !arguments.moments.empty());
  check("--driver", !arguments.driver.empty());
  check("--body", !arguments.body.empty());
  check("--label", !arguments.labels.empty());
  check("--value", !arguments.value.empty());
  check("--minimum-along", !arguments.minimum_along.empty());
  check("--scan", !arguments.scan.empty());
  check("--pixels", arguments.pixels.has_value());
  check("--bins", arguments.bins.has_value());
  check("--result", !arguments.result.empty());
  check("--against", !arguments.against.empty());
  check("--log", !arguments.logarithmic.empty());
  if (of_sweep ? !arguments.at.empty() : !arguments.fixed.empty()) {
    refuse_option(FaultCode::command_invalid_value, "--at",
                  of_sweep ? "a sweep has axes, and no moments" : "only a sweep has axes",
                  of_sweep ? "NAME=VALUE" : "moments, which are numbers");
  }
  if (!what.empty() && special == nullptr && (results || !arguments.y.empty())) {
    refuse_option(
        FaultCode::command_conflict, what,
        fmt::format("this says what to draw, and so does {}", results ? "--result" : "--y"),
        "one of them");
  }
  if (arguments.from && arguments.to && !(*arguments.from < *arguments.to)) {
    refuse_option(FaultCode::command_invalid_value, "--from",
                  fmt::format("{:g} is not below --to {:g}", *arguments.from, *arguments.to));
  }
}

Figure drawn_body(const std::vector<StoredRun>& runs, const PlotArguments& arguments,
                  std::vector<std::string>& notes) {
  BodyRequest request;
  if (!arguments.x.empty()) request.x = arguments.x;
  request.at = arguments.at;
  request.owners = {arguments.driver, arguments.body};
  return body_figure(runs, labels_of(runs, arguments), request, standard_registry(), notes);
}

/// What a figure is drawn over by default: time where no support of a run has a position, as that
/// of a force that is a driver.
std::string default_x(const std::vector<StoredRun>& runs, const FigureKind& kind) {
  if (kind.x == "driver_position") {
    for (const StoredRun& run : runs) {
      if (owners_of(SampleTable(file_of(run, kTableFile)), "position.x").empty()) return "time";
    }
  }
  return std::string(kind.x);
}

Figure drawn_curves(const std::vector<StoredRun>& runs, const std::string& what,
                    const PlotArguments& arguments, std::vector<std::string>& notes) {
  const FigureKind& kind = *find_figure_kind(what.empty() ? kWhatByDefault : what);
  CurvesRequest request;
  request.x = arguments.x.empty() ? default_x(runs, kind) : arguments.x;
  request.y = arguments.y;
  if (request.y.empty()) request.y = {{std::string(kind.y)}};
  request.owners = {arguments.driver, arguments.body};
  request.from = arguments.from;
  request.to = arguments.to;
  request.log_x = arguments.log_x();
  request.log_y = arguments.log_y();
  request.to_scale = what == kPathFigure && arguments.logarithmic.empty();
  request.width = arguments.width();
  return curves_figure(runs, labels_of(runs, arguments), request, notes);
}

Figure drawn_surface(const std::vector<StoredRun>& runs, const PlotArguments& arguments) {
  if (runs.size() > 1) {
    refuse_option(FaultCode::command_conflict, std::string(kSurfaceFigure),
                  "each folder has a potential of its own", "one folder");
  }
  SurfaceRequest request;
  request.owners = {arguments.driver, arguments.body};
  request.from = arguments.from;
  request.to = arguments.to;
  request.width = arguments.width();
  return surface_figure(runs.front(), request, standard_registry());
}

void require_option(const std::string& given, const char* option, std::string_view what) {
  if (!given.empty()) return;
  refuse_option(FaultCode::command_missing_argument, option, fmt::format("missing for {}", what));
}

Figure drawn_raster(const std::vector<StoredRun>& runs, const PlotArguments& arguments,
                    std::vector<std::string>& notes) {
  require_option(arguments.x, "--x", kRasterFigure);
  require_option(arguments.y.empty() ? "" : arguments.y.front().front(), "--y", kRasterFigure);
  require_option(arguments.value, "--value", kRasterFigure);
  if (arguments.y.size() > 1 || arguments.y.front().size() > 1) {
    refuse_option(FaultCode::command_conflict, "--y", "a raster has one column upwards",
                  "one --y of one column");
  }
  RasterRequest request;
  request.x = arguments.x;
  request.y = arguments.y.front().front();
  request.value = arguments.value;
  request.owners = {arguments.driver, arguments.body};
  request.pixels = arguments.pixels;
  if (!arguments.scan.empty()) request.direction = *value_named<ScanDirection>(arguments.scan);
  return raster_figure(runs, request, notes);
}

Figure drawn_slips(const std::vector<StoredRun>& runs, const PlotArguments& arguments,
                   std::vector<std::string>& notes) {
  SlipsRequest request;
  if (!arguments.value.empty()) {
    const auto measure = value_named<SlipMeasure>(arguments.value);
    if (!measure) {
      refuse_option(FaultCode::command_invalid_value, "--value " + arguments.value,
                    "slips have no such number",
                    fmt::format("{}", fmt::join(words_of<SlipMeasure>(), ", ")));
    }
    request.measure = *measure;
  }
  request.driver = arguments.driver;
  request.bins = arguments.bins;
  request.log_x = arguments.log_x();
  request.log_y = arguments.log_y();
  return slips_figure(runs, labels_of(runs, arguments), request, notes);
}

Figure drawn_results(const std::vector<StoredRun>& runs, const PlotArguments& arguments,
                     std::vector<std::string>& notes) {
  require_option(arguments.result, "--result", "--against");
  require_option(arguments.against, "--against", "--result");
  return result_figure(
      runs, {arguments.result, arguments.against, arguments.log_x(), arguments.log_y()}, notes);
}

Figure drawn(const std::vector<StoredRun>& runs, const std::string& what,
             const PlotArguments& arguments, std::vector<std::string>& notes) {
  if (what == kBodyFigure) return drawn_body(runs, arguments, notes);
  if (what == kLoopFigure) {
    return loop_figure(runs, labels_of(runs, arguments), {arguments.driver, ""}, arguments.width());
  }
  if (what == kSurfaceFigure) return drawn_surface(runs, arguments);
  if (what == kRasterFigure) return drawn_raster(runs, arguments, notes);
  if (what == kSlipsFigure) return drawn_slips(runs, arguments, notes);
  if (!arguments.result.empty() || !arguments.against.empty()) {
    return drawn_results(runs, arguments, notes);
  }
  return drawn_curves(runs, what, arguments, notes);
}

Figure drawn_sweep(const PlotArguments& arguments, std::vector<std::string>& notes) {
  if (arguments.words.size() > 1) {
    refuse_option(FaultCode::command_conflict, arguments.words[1],
                  "a sweep is drawn alone, and its axes say what its figure is", "one folder");
  }
  check_options("", true, arguments);
  if (!arguments.against.empty()) require_option(arguments.result, "--result", "--against");
  for (const auto& [option, given, other] :
       {std::tuple{"--y", !arguments.y.empty(), arguments.result},
        std::tuple{"--x", !arguments.x.empty(), arguments.against}}) {
    if (!given || other.empty()) continue;
    refuse_option(FaultCode::command_conflict, option, fmt::format("{} is in its place", other),
                  "without --result and --against");
  }
  SweepRequest request;
  request.x = arguments.against.empty() ? arguments.x : arguments.against;
  request.y = arguments.y;
  if (!arguments.result.empty()) request.y = {{arguments.result}};
  request.value = arguments.value;
  request.minimum_along = arguments.minimum_along;
  request.at = arguments.fixed;
  if (!arguments.logarithmic.empty()) request.log = arguments.logarithmic;
  request.width = arguments.width();
  return sweep_figure(read_stored_sweep(arguments.words.front()), request, notes);
}

Figure drawn_runs(const PlotArguments& arguments, std::vector<std::string>& notes) {
  const Words words = sorted(arguments.words);
  check_options(words.what, false, arguments);
  const bool with_samples = words.what != kSlipsFigure && arguments.result.empty();
  std::vector<StoredRun> runs = read_runs(words.folders, with_samples, notes);
  if (arguments.labels.empty()) runs = in_order_of_parameters(std::move(runs));
  return drawn(runs, words.what, arguments, notes);
}

void add_options(CLI::App& parser, PlotArguments& arguments) {
  parser
      .add_option("DIR", arguments.words,
                  "folders of runs, and WHAT to draw, force by default; or of one sweep")
      ->option_text("... [WHAT]")
      ->required();
  parser.add_option("-o,--output", arguments.file, "the picture: .svg, .png or .pdf")
      ->type_name("FILE")
      ->required();
  parser.add_option("--x", arguments.x, "a quantity or a column, instead of WHAT's")
      ->type_name("X");
  parser.add_option("--y", arguments.panels, "the same upwards; again for another panel")
      ->type_name("Y[,Y]")
      ->option_text("Y[,Y] ...")
      ->allow_extra_args(false);
  parser.add_option("--from", arguments.from, "where the x axis begins")->type_name("X");
  parser.add_option("--to", arguments.to, "where it ends")->type_name("X");
  parser
      .add_option("--at", arguments.moments,
                  "moments to show a ring at: times, or values of --x; five by default; of a "
                  "sweep NAME=VALUE, the value of an axis that is shown")
      ->type_name("T[,T]")
      ->allow_extra_args(false);
  parser.add_option("--driver", arguments.driver, "which one, where there are several")
      ->type_name("NAME");
  parser.add_option("--body", arguments.body, "likewise")->type_name("NAME");
  parser.add_option("--label", arguments.labels, "what to call a DIR; once for each, in order")
      ->type_name("TEXT")
      ->option_text("TEXT ...")
      ->allow_extra_args(false);
  parser
      .add_option("--value", arguments.value,
                  "what a raster or the map of a sweep shows; of slips size (by default), "
                  "peak_force or energy")
      ->type_name("VALUE");
  parser
      .add_option("--minimum-along", arguments.minimum_along,
                  "a line on the map of a sweep: where VALUE is least along this axis")
      ->type_name("NAME");
  parser
      .add_option("--scan", arguments.scan,
                  "the samples of a raster at which X rises, or falls; both by default")
      ->type_name("WAY")
      ->option_text("forward|backward|both");
  parser.add_option("--pixels", arguments.grid, "of a raster; by its samples unless given")
      ->type_name("WIDTHxHEIGHT");
  parser
      .add_option("--bins", arguments.bins, "of a histogram; by the number of slips unless given")
      ->type_name("N");
  parser
      .add_option("--result", arguments.result,
                  "a result, as in driver.mean_force.x: a point for each DIR")
      ->type_name("RESULT");
  parser
      .add_option("--against", arguments.against, "the parameter or result that it is drawn over")
      ->type_name("NAME");
  parser
      .add_option("--log", arguments.logarithmic,
                  "logarithmic axes: x, y, xy or none; of a sweep as its grids are spaced")
      ->type_name("AXES");
  parser
      .add_option("--size", arguments.extent,
                  "of the whole figure in points; a PNG has two pixels to a point")
      ->type_name("WIDTHxHEIGHT");
  parser.add_option("--font", arguments.font, "of all texts; sans-serif,12 by default")
      ->type_name("NAME,SIZE");
  parser.add_option("--title", arguments.title, "above the figure; none by default")
      ->type_name("TEXT");
}

void check(PlotArguments& arguments) {
  for (const std::string& panel : arguments.panels) arguments.y.push_back(parts_of(panel, "--y"));
  for (const std::string& list : arguments.moments) {
    for (const std::string& moment : parts_of(list, "--at")) {
      const std::size_t equals = moment.find('=');
      if (equals == std::string::npos) {
        arguments.at.push_back(finite_number(moment, "--at"));
      } else {
        arguments.fixed.emplace_back(moment.substr(0, equals), moment.substr(equals + 1));
      }
    }
  }
  constexpr double kSmallestFigure = 50.0;  // points
  constexpr double kLargestFigure = 5000.0;
  if (!arguments.extent.empty()) {
    const auto [width, height] =
        two_numbers(arguments.extent, "--size", kSmallestFigure, kLargestFigure);
    arguments.size = FigureSize{width, height};
  }
  if (!arguments.font.empty()) arguments.named_font = font_of(arguments.font);
  if (!arguments.grid.empty()) {
    const auto [columns, rows] = two_numbers(arguments.grid, "--pixels", 1.0, kMostPixels);
    arguments.pixels = PixelGrid{static_cast<std::size_t>(columns), static_cast<std::size_t>(rows)};
  }
  if (arguments.bins && (*arguments.bins < 1 || *arguments.bins > kMostBins)) {
    refuse_command(FaultCode::command_invalid_value,
                   fmt::format("--bins: {} is out of range", *arguments.bins),
                   fmt::format("1 to {}", kMostBins));
  }
  const std::string& axes = arguments.logarithmic;
  if (!axes.empty() && axes != "x" && axes != "y" && axes != "xy" && axes != "none") {
    refuse_command(FaultCode::command_invalid_value, fmt::format("--log: \"{}\"", axes),
                   "x, y, xy or none");
  }
  if (!arguments.scan.empty() && !value_named<ScanDirection>(arguments.scan)) {
    refuse_command(FaultCode::command_invalid_value, fmt::format("--scan: \"{}\"", arguments.scan),
                   "forward, backward or both");
  }
  for (const auto& [limit, option] :
       {std::pair{arguments.from, "--from"}, std::pair{arguments.to, "--to"}}) {
    if (limit && !std::isfinite(*limit)) {
      refuse_command(FaultCode::command_invalid_value, fmt::format("{} is not finite", option));
    }
  }
}

int plot(const PlotArguments& arguments) {
  const PictureFormat format = format_of(arguments.file);
  refuse_unwritable(arguments.file);
  std::vector<std::string> notes;
  const std::string& first = arguments.words.front();
  const bool of_sweep = !holds_run(first) && holds_sweep(first);
  Figure figure = of_sweep ? drawn_sweep(arguments, notes) : drawn_runs(arguments, notes);
  figure.title = arguments.title;
  figure.size = arguments.size;
  figure.font = arguments.named_font;
  const std::string picture = run_gnuplot(gnuplot_script(figure, format));
  OutputFile output(arguments.file);
  output.append(picture);
  output.publish();
  for (const std::string& note : notes) print_error_line("note: " + note);
  return kExitDone;
}

}  // namespace

CommandRecord plot_command() {
  return {"plot", "draw a figure of finished runs, or of a sweep", plot_footer(),
          declared<PlotArguments>(add_options, check, plot)};
}

}  // namespace tomlin
