#include "framework/plot/curves_figure.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "framework/core/text/fault.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/plot/axis_text.hpp"
#include "framework/plot/equal_scale.hpp"
#include "framework/plot/sample_table.hpp"
#include "framework/plot/series_reader.hpp"

namespace tomlin {
namespace {

constexpr double kHeightAlone = 330.0;  // of a panel, in points of the screen
constexpr double kHeightOfSeveral = 170.0;
constexpr const char* kSupportPosition = "support position";
constexpr double kPathMargin = 0.04;  // around what is drawn to scale, as a share of the width

struct Range {
  double from = std::numeric_limits<double>::infinity();
  double to = -std::numeric_limits<double>::infinity();

  void take(double value) {
    from = std::min(from, value);
    to = std::max(to, value);
  }
  bool holds(double value) const { return from <= value && value <= to; }
};

/// One run's numbers, by panel and curve.
struct RunCurves {
  Series x;
  std::vector<std::vector<Series>> y;
  std::vector<double> x_values;
  std::vector<std::vector<std::vector<double>>> y_values;
};

/// Is the support at v t, from the beginning?
bool is_at_v_t(const std::vector<double>& position, const std::vector<double>& time) {
  // Of the distance travelled: positions are rounded to less than that.
  constexpr double kRounding = 1e-9;
  if (!(time.back() > 0.0)) return true;
  const double velocity = position.back() / time.back();
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (std::abs(position[i] - velocity * time[i]) > kRounding * std::abs(position.back())) {
      return false;
    }
  }
  return true;
}

RunCurves read_curves(const StoredRun& run, const CurvesRequest& request) {
  const SampleTable table(file_of(run, kTableFile));
  RunCurves curves;
  SeriesReader needed;
  curves.x = find_series(table, request.x, request.owners, "--x");
  needed.add(curves.x);
  for (const auto& panel : request.y) {
    curves.y.emplace_back();
    for (const std::string& name : panel) {
      curves.y.back().push_back(find_series(table, name, request.owners, "--y"));
      needed.add(curves.y.back().back());
    }
  }
  const Series time = column_series(table, "time");
  needed.add(time);
  needed.read(table);
  curves.x_values = needed.values(curves.x);
  for (const auto& panel : curves.y) {
    curves.y_values.emplace_back();
    for (const Series& series : panel) curves.y_values.back().push_back(needed.values(series));
  }
  const auto rename = [&](Series& series) {
    if (series.name != "driver_position") return;
    if (is_at_v_t(needed.values(series), needed.values(time))) return;
    series.words = kSupportPosition;
    series.symbol = "{/:Italic X}";
  };
  rename(curves.x);
  for (auto& panel : curves.y) std::for_each(panel.begin(), panel.end(), rename);
  return curves;
}

/// Numbers of different units have no axis in common.
void check_unit(const StoredRun& run, const std::string& option, const Series& first,
                const Series& other) {
  if (first.unit == other.unit) return;
  refuse_input(FaultCode::command_invalid_value, file_of(run, kTableFile),
               option + " " + other.name,
               fmt::format("[{}], on one axis with {} [{}]", other.unit, first.name, first.unit),
               "one unit to an axis; another --y makes another panel");
}

void check_units(const std::vector<StoredRun>& runs, const std::vector<RunCurves>& all) {
  check_unit_names(runs, all.front().x.unit);
  for (const auto& panel : all.front().y) check_unit_names(runs, panel.front().unit);
  for (std::size_t r = 0; r < runs.size(); ++r) {
    check_unit(runs[r], "--x", all.front().x, all[r].x);
    for (std::size_t p = 0; p < all[r].y.size(); ++p) {
      for (const Series& series : all[r].y[p]) {
        check_unit(runs[r], "--y", all.front().y[p].front(), series);
      }
    }
  }
}

/// One name for all runs: v t only where the support is there in each.
const Series& common_x(const std::vector<RunCurves>& all) {
  const auto other = std::find_if(
      all.begin(), all.end(), [](const RunCurves& run) { return run.x.words == kSupportPosition; });
  return other == all.end() ? all.front().x : other->x;
}

/// Several curves' axis has only their dimension in common; a low panel has no room for words.
FigureText y_label(const StoredRun& run, const std::vector<Series>& panel, bool alone) {
  Series shown = panel.front();
  if (panel.size() > 1) {
    return axis_text(dimension_words(run, shown.unit), "", unit_name(run, shown.unit));
  }
  if (!alone) shown.words.clear();
  return axis_label(run, shown);
}

/// The part of the x axis that is shown.
Range shown_range(const std::vector<RunCurves>& all, const CurvesRequest& request) {
  Range whole;
  for (const RunCurves& run : all) {
    for (const double x : run.x_values) {
      if (!request.log_x || x > 0.0) whole.take(x);
    }
  }
  if (whole.from > whole.to) {
    refuse_input(FaultCode::plot_no_data, "--log", request.x, "no number is positive",
                 "a linear axis");
  }
  if (request.log_x && request.from && !(*request.from > 0.0)) {
    refuse_input(FaultCode::command_invalid_value, "--from", fmt::format("{:g}", *request.from),
                 "a logarithmic axis begins above zero", "a positive number");
  }
  Range shown{request.from.value_or(whole.from), request.to.value_or(whole.to)};
  bool any = false;
  for (const RunCurves& run : all) {
    any = any || std::any_of(run.x_values.begin(), run.x_values.end(),
                             [&](double x) { return shown.holds(x); });
  }
  if (!any) {
    refuse_input(FaultCode::plot_no_data, request.from ? "--from" : "--to", "",
                 fmt::format("there is no sample from {:g} to {:g}", shown.from, shown.to),
                 fmt::format("{} from {:g} to {:g}", request.x, whole.from, whole.to));
  }
  return shown;
}

/// What the range shows of a curve, with the neighbours that its lines lead to. Logarithmic axes
/// have no place for numbers that are not positive: the curve breaks there.
std::vector<Polyline> cut(const std::vector<double>& x, const std::vector<double>& y,
                          const Range& range, const CurvesRequest& request, std::size_t& left_out) {
  std::vector<Polyline> pieces;
  const auto fits = [&](std::size_t i) {
    return (!request.log_x || x[i] > 0.0) && (!request.log_y || y[i] > 0.0);
  };
  bool inside = false;  // was the last point, or does the next follow on it?
  for (std::size_t i = 0; i < x.size(); ++i) {
    const bool before = i > 0 && range.holds(x[i - 1]);
    const bool here = range.holds(x[i]);
    const bool after = i + 1 < x.size() && range.holds(x[i + 1]);
    const bool wanted = before || here || after;
    if (wanted && !fits(i)) ++left_out;
    const bool kept = wanted && fits(i);
    if (kept && !inside) pieces.emplace_back();
    if (kept) pieces.back().push_back({x[i], y[i]});
    inside = kept;
  }
  return pieces;
}

Window window_of(const std::vector<std::vector<Polyline>>& curves, const Range& x, double height,
                 const CurvesRequest& request) {
  Range y;
  for (const auto& curve : curves) {
    for (const Polyline& piece : curve) {
      for (const Point& point : piece) {
        if (x.holds(point.x)) y.take(point.y);
      }
    }
  }
  const double finer = request.width / kPanelWidth;
  return {x.from,         x.to,          y.from,       y.to, finer * kPanelWidth,
          finer * height, request.log_x, request.log_y};
}

/// Where the spring is not stretched: x_c = v t.
Curve unstretched(const Range& x) {
  Curve line;
  line.pieces = {{{x.from, x.from}, {x.to, x.to}}};
  line.colour = kGrey;
  line.dashed = true;
  return line;
}

std::string curve_label(const std::string& run, const std::vector<Series>& panel,
                        const Series& series) {
  if (panel.size() == 1) return run;
  return key_text_of(series) + (run.empty() ? "" : ", " + run);
}

Panel panel_of(const std::vector<StoredRun>& runs, const std::vector<RunCurves>& all,
               const std::vector<std::string>& labels, std::size_t index, const Range& x,
               const CurvesRequest& request, std::size_t& left_out) {
  const bool alone = all.front().y.size() == 1;
  const std::vector<Series>& first = all.front().y[index];
  std::vector<std::vector<Polyline>> curves;
  Panel panel;
  panel.y_label = y_label(runs.front(), first, alone);
  panel.height = alone ? kHeightAlone : kHeightOfSeveral;
  for (std::size_t r = 0; r < all.size(); ++r) {
    for (std::size_t c = 0; c < first.size(); ++c) {
      Curve curve;
      curve.label = curve_label(labels[r], first, first[c]);
      curve.colour = static_cast<int>(curves.size());
      panel.curves.push_back(std::move(curve));
      curves.push_back(cut(all[r].x_values, all[r].y_values[index][c], x, request, left_out));
    }
  }
  const Window window = window_of(curves, x, panel.height, request);
  for (std::size_t c = 0; c < curves.size(); ++c) {
    panel.curves[c].pieces = reduced(curves[c], window);
  }
  if (window.y_from > window.y_to) {
    refuse_input(FaultCode::plot_no_data, "--log", first.front().name, "no number is positive",
                 "a linear axis");
  }
  std::tie(panel.y_from, panel.y_to) = with_margin(window.y_from, window.y_to, request.log_y);
  const bool against_driver = all.front().x.name == "driver_position" && first.size() == 1 &&
                              first.front().name == "position";
  if (against_driver) panel.curves.insert(panel.curves.begin(), unstretched(x));
  return panel;
}

}  // namespace

Figure curves_figure(const std::vector<StoredRun>& runs, const std::vector<std::string>& labels,
                     const CurvesRequest& request, std::vector<std::string>& notes) {
  std::vector<RunCurves> all;
  all.reserve(runs.size());
  for (const StoredRun& run : runs) all.push_back(read_curves(run, request));
  check_units(runs, all);
  const Range x = shown_range(all, request);
  Figure figure;
  figure.x_label = axis_label(runs.front(), common_x(all));
  figure.x_from = x.from;
  figure.x_to = x.to;
  figure.log_x = request.log_x;
  figure.log_y = request.log_y;
  std::size_t left_out = 0;
  for (std::size_t p = 0; p < request.y.size(); ++p) {
    figure.panels.push_back(panel_of(runs, all, labels, p, x, request, left_out));
  }
  if (left_out > 0) {
    notes.push_back(
        fmt::format("{} samples are not positive, and not on a logarithmic axis", left_out));
  }
  if (request.to_scale && all.front().x.unit == all.front().y.front().front().unit) {
    scale_equally(figure, kPathMargin);
  }
  return figure;
}

}  // namespace tomlin
