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
#include "framework/plot/quantities.hpp"
#include "framework/plot/stored_run.hpp"
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
  std::vector<std::string> moments;  ///< --at as given
  std::vector<double> at;            ///< the same as numbers
  std::string driver;                ///< empty: the only one
  std::string body;
  std::string title;
  std::vector<std::string> labels;  ///< one for each DIR; empty: by what differs
};

/// The figure that shows places instead of curves.
constexpr const char* kBodyFigure = "ring";

constexpr const char* kPlotFooter = R"(
The first word is a folder; another folder that is called like a figure is written with a slash, ring/.
X and Y are such a quantity or any column of observables.csv. Commas put curves on one axis, another
--y makes another panel below. Several DIRs are curves of one figure, named by the parameters in
which their scenes differ, or else by their folders; --label names them otherwise.

Examples:

  tomlin plot pt.out -o force.svg
      the friction trace.
  tomlin plot k_2.out k_8.out hysteresis -o loops.pdf
      two runs on the same axes.
  tomlin plot ring.out --y force_size --y position --y height --from 2 --to 4 -o steps.svg
      three panels over v t from 2 to 4.
  tomlin plot ring.out ring --at 2500,3000,3500 -o places.png
      a ring at three times.
  tomlin plot v_1.out v_2.out ring --x driver_position --at 2,2.5,3 -o places.svg
      two rings, when their drivers have come so far.
  tomlin plot pt.out --x time --y tip.velocity.x -o velocity.svg
      a column over another.

gnuplot 5.4 draws (Debian: gnuplot-nox); TOMLIN_GNUPLOT names another one than the one in PATH. An
earlier FILE is replaced. The same runs give the same SVG.

Exit status: 0 done; 1 gnuplot failed or FILE could not be written; 2 the input was not right, or
there is no gnuplot.)";

void add_line(std::string& text, std::string_view name, std::string_view summary) {
  fmt::format_to(std::back_inserter(text), "  {:<17} {}\n", name, summary);
}

/// The figures, the quantities, examples.
std::string plot_footer() {
  std::string text = "\nWHAT:\n\n";
  for (const FigureKind& kind : figure_kinds()) add_line(text, kind.name, kind.summary);
  add_line(text, kBodyFigure, "particles of a ring, or another planar body, at the moments --at");
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

constexpr const char* kWhatByDefault = "force";
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
  names.emplace_back(kBodyFigure);
  return names;
}

bool is_what(const std::string& word) {
  return word == kBodyFigure || find_figure_kind(word) != nullptr;
}

/// Folders of runs beside the one that is not there, in the same spelling.
std::vector<std::string> neighbours_of(const std::string& word) {
  const fs::path above = fs::path(word).parent_path();
  std::vector<std::string> names;
  std::error_code error;
  fs::directory_iterator entry(above.empty() ? fs::path(".") : above, error);
  for (int k = 0; !error && k < kMostNeighbours && entry != fs::directory_iterator(); ++k) {
    if (holds_run(entry->path().string())) {
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
      fmt::format("folders that tomlin run has left, and one of {}", fmt::join(all_whats(), ", ")),
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

std::vector<StoredRun> read_runs(const std::vector<std::string>& folders,
                                 std::vector<std::string>& notes) {
  std::vector<StoredRun> runs;
  for (const std::string& folder : folders) {
    StoredRun run = read_stored_run(folder);
    std::error_code error;
    if (!fs::exists(file_of(run, kTableFile), error)) {
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

Figure drawn_body(const std::vector<StoredRun>& runs, const PlotArguments& arguments,
                  std::vector<std::string>& notes) {
  if (!arguments.y.empty() || arguments.from || arguments.to) {
    refuse_option(FaultCode::command_conflict, kBodyFigure,
                  "shows single times: use --at instead of --y, --from and --to");
  }
  BodyRequest request;
  if (!arguments.x.empty()) request.x = arguments.x;
  request.at = arguments.at;
  request.owners = {arguments.driver, arguments.body};
  return body_figure(runs, labels_of(runs, arguments), request, standard_registry(), notes);
}

Figure drawn_curves(const std::vector<StoredRun>& runs, const std::string& what,
                    const PlotArguments& arguments) {
  if (!arguments.at.empty()) {
    refuse_option(FaultCode::command_conflict, "--at", fmt::format("for {} only", kBodyFigure),
                  "--from and --to");
  }
  if (!what.empty() && !arguments.y.empty()) {
    refuse_option(FaultCode::command_conflict, what, "this says what to draw, and so does --y",
                  "one of them");
  }
  if (arguments.from && arguments.to && !(*arguments.from < *arguments.to)) {
    refuse_option(FaultCode::command_invalid_value, "--from",
                  fmt::format("{:g} is not below --to {:g}", *arguments.from, *arguments.to));
  }
  const FigureKind& kind = *find_figure_kind(what.empty() ? kWhatByDefault : what);
  CurvesRequest request;
  request.x = arguments.x.empty() ? std::string(kind.x) : arguments.x;
  request.y = arguments.y;
  if (request.y.empty()) request.y = {{std::string(kind.y)}};
  request.owners = {arguments.driver, arguments.body};
  request.from = arguments.from;
  request.to = arguments.to;
  return curves_figure(runs, labels_of(runs, arguments), request);
}

void add_options(CLI::App& parser, PlotArguments& arguments) {
  parser.add_option("DIR", arguments.words, "folders of runs; and WHAT to draw, force by default")
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
                  "moments to show a ring at: times, or values of --x; five by default")
      ->type_name("T[,T]")
      ->allow_extra_args(false);
  parser.add_option("--driver", arguments.driver, "which one, where there are several")
      ->type_name("NAME");
  parser.add_option("--body", arguments.body, "likewise")->type_name("NAME");
  parser.add_option("--label", arguments.labels, "what to call a DIR; once for each, in order")
      ->type_name("TEXT")
      ->option_text("TEXT ...")
      ->allow_extra_args(false);
  parser.add_option("--title", arguments.title, "above the figure; none by default")
      ->type_name("TEXT");
}

void check(PlotArguments& arguments) {
  for (const std::string& panel : arguments.panels) arguments.y.push_back(parts_of(panel, "--y"));
  for (const std::string& list : arguments.moments) {
    for (const std::string& moment : parts_of(list, "--at")) {
      arguments.at.push_back(finite_number(moment, "--at"));
    }
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
  const Words words = sorted(arguments.words);
  std::vector<std::string> notes;
  const std::vector<StoredRun> runs = read_runs(words.folders, notes);
  Figure figure = words.what == kBodyFigure ? drawn_body(runs, arguments, notes)
                                            : drawn_curves(runs, words.what, arguments);
  figure.title = arguments.title;
  const std::string picture = run_gnuplot(gnuplot_script(figure, format));
  OutputFile output(arguments.file);
  output.append(picture);
  output.publish();
  for (const std::string& note : notes) print_error_line("note: " + note);
  return kExitDone;
}

}  // namespace

CommandRecord plot_command() {
  return {"plot", "draw a figure of finished runs", plot_footer(),
          declared<PlotArguments>(add_options, check, plot)};
}

}  // namespace tomlin
