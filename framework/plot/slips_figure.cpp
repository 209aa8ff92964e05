#include "framework/plot/slips_figure.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string_view>
#include <system_error>
#include <tuple>

#include <fmt/format.h>

#include "framework/core/text/fault.hpp"
#include "framework/core/text/text_file.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/plot/axis_text.hpp"
#include "framework/scene/text.hpp"

namespace tomlin {
namespace {

constexpr double kHistogramHeight = 330.0;  // of the panel, in points of the screen
constexpr std::size_t kFewestBins = 8;
constexpr std::size_t kMostByThemselves = 60;
constexpr double kRoomAbove = 1.08;  // the highest bar
constexpr double kBelowOne = 0.7;    // where a logarithmic axis of counts begins

/// A column of events.csv, and what an axis calls it.
struct SlipColumn {
  const char* name;
  const char* words;
  const char* dimension;
};

SlipColumn column_of(SlipMeasure measure) {
  switch (measure) {
    case SlipMeasure::size:
      return {"size", "size of a slip", "length"};
    case SlipMeasure::peak_force:
      return {"peak_force", "peak force of a slip", "force"};
    case SlipMeasure::energy:
      break;
  }
  return {"energy_lost", "energy lost in a slip", "energy"};
}

/// The fields of a line; those in quotes may hold commas.
std::vector<std::string> fields_of(std::string_view line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

/// "peak_force" of "peak_force [force]"
std::string_view name_of_heading(std::string_view heading) {
  return heading.substr(0, heading.find(" ["));
}

class EventReader {
 public:
  explicit EventReader(const StoredRun& run) : file_(file_of(run, kEventsFile)) {
    const TextFile start = read_text_file(file_, 0);
    if (!start.why.empty()) {
      refuse_input(FaultCode::plot_no_data, file_, "", "there are no events: " + start.why,
                   "a run in which slips can happen");
    }
    stream_.open(file_, std::ios::binary);
    std::string line;
    std::getline(stream_, line);
    headings_ = fields_of(line);
    ++line_;
  }

  std::size_t column(std::string_view name) const {
    for (std::size_t k = 0; k < headings_.size(); ++k) {
      if (name_of_heading(headings_[k]) == name) return k;
    }
    throw InputError(
        {Fault(FaultCode::file_invalid, {file_, 1, 1}, "", "",
               fmt::format("there is no column {}: this is no table of events", name))});
  }

  /// False at the end.
  bool next(std::vector<std::string>& fields) {
    std::string line;
    if (!std::getline(stream_, line)) return false;
    ++line_;
    fields = fields_of(line);
    if (fields.size() == headings_.size()) return true;
    throw InputError({Fault(
        FaultCode::file_damaged, {file_, line_, 1}, "", "",
        fmt::format("{} fields in a table of {} columns", fields.size(), headings_.size()))});
  }

  double number(const std::string& text) const {
    double value = 0.0;
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    if (error == std::errc() && stop == end && std::isfinite(value)) return value;
    throw InputError({Fault(FaultCode::file_damaged, {file_, line_, 1},
                            shortened(text, kLongestShownValue), "", "not a finite number")});
  }

  const std::string& file() const { return file_; }

 private:
  std::string file_;
  std::ifstream stream_;
  std::vector<std::string> headings_;
  int line_ = 0;
};

/// The numbers of a run's slips; those without one, which happened before it could be known, are
/// left out.
std::vector<double> read_slips(const StoredRun& run, const SlipsRequest& request) {
  EventReader reader(run);
  const std::size_t kind = reader.column("event");
  const std::size_t name = reader.column("name");
  const std::size_t value = reader.column(column_of(request.measure).name);
  std::vector<std::string> drivers;
  std::vector<double> values;
  std::vector<std::string> fields;
  while (reader.next(fields)) {
    if (fields[kind] != "slip") continue;
    if (std::find(drivers.begin(), drivers.end(), fields[name]) == drivers.end()) {
      drivers.push_back(fields[name]);
    }
    if (!request.driver.empty() && fields[name] != request.driver) continue;
    if (!fields[value].empty()) values.push_back(reader.number(fields[value]));
  }
  if (request.driver.empty() && drivers.size() > 1) {
    refuse_input(FaultCode::command_missing_argument, reader.file(), "",
                 "there are slips of several drivers",
                 fmt::format("--driver {}", fmt::join(drivers, ", --driver ")));
  }
  return values;
}

/// Where bins end, one more than there are bins.
std::vector<double> edges_of(double from, double to, std::size_t bins, bool logarithmic) {
  if (from == to) std::tie(from, to) = with_margin(from, to, logarithmic);
  std::vector<double> edges;
  for (std::size_t k = 0; k <= bins; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(bins);
    edges.push_back(logarithmic ? from * std::pow(to / from, share) : from + share * (to - from));
  }
  edges.back() = to;
  return edges;
}

/// Counts by bin: an edge belongs to the bin above it, the last one to the bin below.
std::vector<std::size_t> counts_of(const std::vector<double>& values,
                                   const std::vector<double>& edges) {
  std::vector<std::size_t> counts(edges.size() - 1, 0);
  for (const double value : values) {
    const auto above = std::upper_bound(edges.begin(), edges.end(), value);
    const auto bin = std::clamp<std::ptrdiff_t>(above - edges.begin() - 1, 0,
                                                static_cast<std::ptrdiff_t>(counts.size()) - 1);
    ++counts[static_cast<std::size_t>(bin)];
  }
  return counts;
}

/// The outline of the bars.
Polyline outline(const std::vector<double>& edges, const std::vector<std::size_t>& counts,
                 double floor) {
  Polyline line = {{edges.front(), floor}};
  for (std::size_t k = 0; k < counts.size(); ++k) {
    const double top = std::max(static_cast<double>(counts[k]), floor);
    line.push_back({edges[k], top});
    line.push_back({edges[k + 1], top});
  }
  line.push_back({edges.back(), floor});
  return line;
}

}  // namespace

Figure slips_figure(const std::vector<StoredRun>& runs, const std::vector<std::string>& labels,
                    const SlipsRequest& request, std::vector<std::string>& notes) {
  std::vector<std::vector<double>> all;
  double from = HUGE_VAL;
  double to = -HUGE_VAL;
  std::size_t most = 0;
  for (const StoredRun& run : runs) {
    std::vector<double> values = read_slips(run, request);
    const std::size_t before = values.size();
    if (request.log_x) std::erase_if(values, [](double value) { return !(value > 0.0); });
    if (values.size() < before) {
      notes.push_back(fmt::format("{}: {} slips are not positive, and not on a logarithmic axis",
                                  run.folder, before - values.size()));
    }
    for (const double value : values) {
      from = std::min(from, value);
      to = std::max(to, value);
    }
    most = std::max(most, values.size());
    all.push_back(std::move(values));
  }
  if (most == 0) {
    refuse_input(FaultCode::plot_no_data, file_of(runs.front(), kEventsFile), "",
                 "there are no slips to count", "a run that slips; another --driver");
  }
  const SlipColumn column = column_of(request.measure);
  check_unit_names(runs, column.dimension);
  const auto root = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(most))));
  const std::size_t bins = request.bins.value_or(std::clamp(root, kFewestBins, kMostByThemselves));
  const std::vector<double> edges = edges_of(from, to, bins, request.log_x);
  Panel panel;
  panel.height = kHistogramHeight;
  panel.y_label = {"number of slips"};
  panel.y_from = request.log_y ? kBelowOne : 0.0;
  double highest = 1.0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const std::vector<std::size_t> counts = counts_of(all[r], edges);
    highest =
        std::max(highest, static_cast<double>(*std::max_element(counts.begin(), counts.end())));
    Curve curve;
    curve.label = labels[r];
    curve.colour = static_cast<int>(r);
    curve.filled = true;
    curve.pieces = {outline(edges, counts, panel.y_from)};
    panel.curves.push_back(std::move(curve));
  }
  panel.y_to = kRoomAbove * highest * (request.log_y ? 1.5 : 1.0);
  Figure figure;
  figure.x_label = axis_text(column.words, "", unit_name(runs.front(), column.dimension));
  figure.log_x = request.log_x;
  figure.log_y = request.log_y;
  std::tie(figure.x_from, figure.x_to) = with_margin(edges.front(), edges.back(), request.log_x);
  figure.panels.push_back(std::move(panel));
  return figure;
}

}  // namespace tomlin
