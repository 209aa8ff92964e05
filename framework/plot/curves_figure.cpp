#include "framework/plot/curves_figure.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "framework/core/text/fault.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/plot/sample_table.hpp"

namespace tomlin {
namespace {

constexpr double kHeightAlone = 330.0;  // of a panel, in points of the screen
constexpr double kHeightOfSeveral = 170.0;
constexpr double kCurveMargin = 0.04;  // above and below, as a share of what is between

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

/// The columns that series need, each once.
class Needed {
 public:
  void add(const Series& series) {
    for (const std::size_t column : series.columns) {
      if (std::find(columns_.begin(), columns_.end(), column) == columns_.end()) {
        columns_.push_back(column);
      }
    }
  }

  void read(const SampleTable& table) { numbers_ = table.read(columns_); }

  std::vector<double> values(const Series& series) const {
    std::vector<const std::vector<double>*> parts;
    for (const std::size_t column : series.columns) {
      const auto found = std::find(columns_.begin(), columns_.end(), column);
      parts.push_back(&numbers_[static_cast<std::size_t>(found - columns_.begin())]);
    }
    std::vector<double> result(parts.front()->size());
    std::vector<double> components(parts.size());
    for (std::size_t row = 0; row < result.size(); ++row) {
      for (std::size_t k = 0; k < parts.size(); ++k) components[k] = (*parts[k])[row];
      result[row] = value_of(series.measure, components);
    }
    return result;
  }

 private:
  std::vector<std::size_t> columns_;
  std::vector<std::vector<double>> numbers_;
};

RunCurves read_curves(const StoredRun& run, const CurvesRequest& request) {
  const SampleTable table(file_of(run, kTableFile));
  RunCurves curves;
  Needed needed;
  curves.x = find_series(table, request.x, request.owners, "--x");
  needed.add(curves.x);
  for (const auto& panel : request.y) {
    curves.y.emplace_back();
    for (const std::string& name : panel) {
      curves.y.back().push_back(find_series(table, name, request.owners, "--y"));
      needed.add(curves.y.back().back());
    }
  }
  needed.read(table);
  curves.x_values = needed.values(curves.x);
  for (const auto& panel : curves.y) {
    curves.y_values.emplace_back();
    for (const Series& series : panel) curves.y_values.back().push_back(needed.values(series));
  }
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
  for (std::size_t r = 0; r < runs.size(); ++r) {
    check_unit(runs[r], "--x", all.front().x, all[r].x);
    for (std::size_t p = 0; p < all[r].y.size(); ++p) {
      for (const Series& series : all[r].y[p]) {
        check_unit(runs[r], "--y", all.front().y[p].front(), series);
      }
    }
  }
}

FigureText axis_label(const Series& series, bool with_words) {
  std::string text = series.symbol;
  if (with_words && !series.words.empty()) text = series.words + " " + text;
  if (!series.unit.empty()) text += " [" + series.unit + "]";
  return {text, series.enhanced};
}

/// Several curves' axis has only their unit in common; a low panel has no room for words.
FigureText y_label(const std::vector<Series>& panel, bool alone) {
  if (panel.size() > 1) return {"[" + panel.front().unit + "]"};
  return axis_label(panel.front(), alone);
}

/// The part of the x axis that is shown.
Range shown_range(const std::vector<RunCurves>& all, const CurvesRequest& request) {
  Range whole;
  for (const RunCurves& run : all) {
    for (const double x : run.x_values) whole.take(x);
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

/// What the range shows of a curve, with the neighbours that its lines lead to.
std::vector<Polyline> cut(const std::vector<double>& x, const std::vector<double>& y,
                          const Range& range) {
  std::vector<Polyline> pieces;
  bool inside = false;  // was the last point, or does the next follow on it?
  for (std::size_t i = 0; i < x.size(); ++i) {
    const bool before = i > 0 && range.holds(x[i - 1]);
    const bool here = range.holds(x[i]);
    const bool after = i + 1 < x.size() && range.holds(x[i + 1]);
    const bool kept = before || here || after;
    if (kept && !inside) pieces.emplace_back();
    if (kept) pieces.back().push_back({x[i], y[i]});
    inside = kept;
  }
  return pieces;
}

Window window_of(const std::vector<std::vector<Polyline>>& curves, const Range& x, double height) {
  Range y;
  for (const auto& curve : curves) {
    for (const Polyline& piece : curve) {
      for (const Point& point : piece) {
        if (x.holds(point.x)) y.take(point.y);
      }
    }
  }
  return {x.from, x.to, y.from, y.to, kPanelWidth, height};
}

/// Room above and below the curves, also where they are level.
double margin_of(const Window& window) {
  const double extent = window.y_to - window.y_from;
  if (extent > 0.0) return kCurveMargin * extent;
  return window.y_to == 0.0 ? 1.0 : kCurveMargin * std::abs(window.y_to);
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
  return run.empty() ? series.name : series.name + ", " + run;
}

Panel panel_of(const std::vector<RunCurves>& all, const std::vector<std::string>& labels,
               std::size_t index, const Range& x) {
  const bool alone = all.front().y.size() == 1;
  const std::vector<Series>& first = all.front().y[index];
  std::vector<std::vector<Polyline>> curves;
  Panel panel;
  panel.y_label = y_label(first, alone);
  panel.height = alone ? kHeightAlone : kHeightOfSeveral;
  for (std::size_t r = 0; r < all.size(); ++r) {
    for (std::size_t c = 0; c < first.size(); ++c) {
      Curve curve;
      curve.label = curve_label(labels[r], first, first[c]);
      curve.colour = static_cast<int>(curves.size());
      panel.curves.push_back(std::move(curve));
      curves.push_back(cut(all[r].x_values, all[r].y_values[index][c], x));
    }
  }
  const Window window = window_of(curves, x, panel.height);
  for (std::size_t c = 0; c < curves.size(); ++c) {
    panel.curves[c].pieces = reduced(curves[c], window);
  }
  const double margin = margin_of(window);
  panel.y_from = window.y_from - margin;
  panel.y_to = window.y_to + margin;
  const bool against_driver = all.front().x.name == "driver_position" && first.size() == 1 &&
                              first.front().name == "position";
  if (against_driver) panel.curves.insert(panel.curves.begin(), unstretched(x));
  return panel;
}

}  // namespace

Figure curves_figure(const std::vector<StoredRun>& runs, const std::vector<std::string>& labels,
                     const CurvesRequest& request) {
  std::vector<RunCurves> all;
  all.reserve(runs.size());
  for (const StoredRun& run : runs) all.push_back(read_curves(run, request));
  check_units(runs, all);
  const Range x = shown_range(all, request);
  Figure figure;
  figure.x_label = axis_label(all.front().x, true);
  figure.x_from = x.from;
  figure.x_to = x.to;
  for (std::size_t p = 0; p < request.y.size(); ++p) {
    figure.panels.push_back(panel_of(all, labels, p, x));
  }
  return figure;
}

}  // namespace tomlin
