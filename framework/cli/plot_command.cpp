#include <array>
#include <filesystem>
#include <iterator>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "framework/cli/commands.hpp"
#include "framework/cli/exit_status.hpp"
#include "framework/cli/new_file.hpp"
#include "framework/cli/plot_text.hpp"
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
#include "framework/scene/text.hpp"
#include "framework/standard_registry.hpp"

namespace tomlin {
namespace fs = std::filesystem;
namespace {

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

}  // namespace

int plot_command(const PlotArguments& arguments) {
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

}  // namespace tomlin
