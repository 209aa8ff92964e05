#include "framework/plot/sweep_figure.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <tuple>
#include <variant>

#include <fmt/format.h>

#include "framework/core/text/fault.hpp"
#include "framework/core/text/nearest_name.hpp"
#include "framework/plot/axis_text.hpp"
#include "framework/plot/raster_figure.hpp"
#include "framework/plot/result_figure.hpp"
#include "framework/scene/text.hpp"

namespace tomlin {
namespace {

// Heights of panels, in points of the screen.
constexpr double kSweepHeight = 360.0;
constexpr double kSweepHeightOfSeveral = 170.0;
constexpr double kMapHeight = 400.0;
constexpr std::size_t kMostSweepCurves = 50;
constexpr std::size_t kMostMarks = 100;  // of a curve; a longer one is a line alone
constexpr int kMinimumColour = 1;        // to be seen on dark colours

struct NumberRange {
  double from = HUGE_VAL;
  double to = -HUGE_VAL;
  void take(double value) {
    from = std::min(from, value);
    to = std::max(to, value);
  }
};

std::string shown_value(const SweepAxis& axis, std::size_t k) {
  return axis.values.numeric() ? fmt::format("{:.6g}", axis.values.number(k))
                               : axis.values.plain_text(k);
}

Mark mark_of(std::size_t points) { return points > kMostMarks ? Mark::none : Mark::large_disc; }

/// Limits of cells around values that rise: halfway between neighbours, as the axis counts.
std::vector<double> edges_around(std::vector<double> values, bool logarithmic) {
  if (values.size() == 1) {
    const auto [from, to] = with_margin(values[0], values[0], logarithmic);
    return {from, to};
  }
  const auto scaled = [logarithmic](double x) { return logarithmic ? std::log(x) : x; };
  const auto back = [logarithmic](double x) { return logarithmic ? std::exp(x) : x; };
  for (double& value : values) value = scaled(value);
  const std::size_t n = values.size();
  std::vector<double> edges = {back(values[0] - 0.5 * (values[1] - values[0]))};
  for (std::size_t k = 1; k < n; ++k) edges.push_back(back(0.5 * (values[k - 1] + values[k])));
  edges.push_back(back(values[n - 1] + 0.5 * (values[n - 1] - values[n - 2])));
  return edges;
}

class SweepDrawing {
 public:
  SweepDrawing(const StoredSweep& sweep, const SweepRequest& request,
               std::vector<std::string>& notes)
      : sweep_(sweep), request_(request), notes_(notes), fixed_(sweep.dimensions.size()) {
    for (const auto& [name, value] : request.at) fix(name, value);
  }

  Figure figure() {
    const bool has_map_options = !request_.value.empty() || !request_.minimum_along.empty();
    const bool upwards =
        request_.y.size() == 1 && request_.y[0].size() == 1 && find_axis(request_.y[0][0]);
    const std::vector<std::size_t> free = free_axes();
    const auto many = std::count_if(free.begin(), free.end(), [this](std::size_t axis) {
      return sweep_.axes[axis].values.size() > 1;
    });
    const bool is_map = request_.y.empty() && (has_map_options || (many > 1 && !sweep_.refined));
    if (upwards || is_map) return map(upwards);
    if (has_map_options) {
      refuse_input(FaultCode::command_conflict, "tomlin",
                   request_.value.empty() ? "--minimum-along" : "--value",
                   "not for curves of observables", "--y with an axis, or without --y");
    }
    return curves();
  }

 private:
  /// One axis of the figure.
  struct Drawn {
    std::size_t axis = 0;
    std::size_t dimension = 0;
    std::vector<std::size_t> order;  ///< indices of its values, as they rise
    std::vector<double> values;      ///< in this order
    bool logarithmic = false;
  };

  std::vector<std::string> axis_names() const {
    std::vector<std::string> names;
    for (const SweepAxis& axis : sweep_.axes) names.push_back(axis.name);
    return names;
  }

  std::optional<std::size_t> find_axis(const std::string& name) const {
    for (std::size_t k = 0; k < sweep_.axes.size(); ++k) {
      if (sweep_.axes[k].name == name) return k;
    }
    return std::nullopt;
  }

  [[noreturn]] void refuse_name(const std::string& name, std::string why,
                                const std::vector<std::string>& known) const {
    refuse_input(FaultCode::plot_no_data, sweep_.run.folder, shortened(name, kLongestShownValue),
                 std::move(why), listed(known), nearest_name(name, known).value_or(""));
  }

  std::size_t axis_named(const std::string& name) const {
    const auto axis = find_axis(name);
    if (!axis) refuse_name(name, "the sweep has no such axis", axis_names());
    return *axis;
  }

  /// A column by its name, or with the family of the result in front of it.
  std::size_t observable_named(const std::string& name) const {
    std::vector<std::string> names = sweep_.observables();
    for (const std::string& wanted : {name, name.substr(name.find('.') + 1)}) {
      const auto found = std::find(names.begin(), names.end(), wanted);
      if (found == names.end()) continue;
      return sweep_.axes.size() + static_cast<std::size_t>(found - names.begin());
    }
    const std::vector<std::string> axes = axis_names();  // which --y may name as well
    names.insert(names.end(), axes.begin(), axes.end());
    refuse_name(name, "the sweep has no such observable", names);
  }

  void fix(const std::string& name, const std::string& value) {
    constexpr double kSameNumber = 5e-3;  // of a number: nobody writes all digits of a grid's
    const std::size_t a = axis_named(name);
    const SweepValues& values = sweep_.axes[a].values;
    const auto read = SweepValues::parse(value);
    const auto* wanted = std::get_if<SweepValues>(&read);
    const auto difference = [&](std::size_t k) {
      if (values.plain_text(k) == wanted->plain_text(0)) return 0.0;
      if (!values.numeric() || !wanted->numeric()) return HUGE_VAL;
      return std::abs(values.number(k) - wanted->number(0)) / std::abs(values.number(k));
    };
    std::optional<std::size_t>& nearest = fixed_[sweep_.dimension_of[a]];
    if (nearest) {
      refuse_input(FaultCode::command_conflict, sweep_.run.folder, "--at",
                   fmt::format("two values for {}", name), "one");
    }
    std::vector<std::string> known;
    double least = kSameNumber;
    for (std::size_t k = 0; k < values.size(); ++k) {
      known.push_back(shown_value(sweep_.axes[a], k));
      const double found = wanted == nullptr ? HUGE_VAL : difference(k);
      if (!(found < least)) continue;
      least = found;
      nearest = k;
    }
    if (!nearest) refuse_name(name + "=" + value, "the axis has no such value", known);
    title_ += fmt::format("{}{} = {}", title_.empty() ? "" : ", ", name, known[*nearest]);
  }

  /// An axis with numbers of each dimension that is not fixed; those with several values first.
  std::vector<std::size_t> free_axes() const {
    std::vector<std::size_t> axes;
    for (std::size_t d = 0; d < fixed_.size(); ++d) {
      const std::vector<std::size_t>& all = sweep_.dimensions[d].axes;
      const auto numeric = std::find_if(all.begin(), all.end(), [this](std::size_t axis) {
        return sweep_.axes[axis].values.numeric();
      });
      if (!fixed_[d] && numeric != all.end()) axes.push_back(*numeric);
    }
    std::stable_partition(axes.begin(), axes.end(),
                          [this](std::size_t axis) { return sweep_.axes[axis].values.size() > 1; });
    return axes;
  }

  [[noreturn]] void refuse_axes(const std::string& why) const {
    std::vector<std::string> all;
    for (const SweepAxis& axis : sweep_.axes) {
      const std::size_t count = axis.values.size();
      all.push_back(fmt::format("{} ({} value{})", axis.name, count, count == 1 ? "" : "s"));
    }
    refuse_input(FaultCode::command_missing_argument, sweep_.run.folder, "",
                 fmt::format("{}; the sweep is over {}", why, fmt::join(all, ", ")),
                 "--at NAME=VALUE for an axis that is not shown; a sweep with fewer axes");
  }

  bool is_logarithmic(std::size_t axis, char letter) const {
    if (request_.log) return request_.log->find(letter) != std::string::npos;
    return sweep_.logarithmic[axis];
  }

  /// The axis of this name, or the first that is free and not along `other`.
  Drawn drawn(const std::string& name, char letter, std::optional<std::size_t> other) const {
    Drawn result;
    if (name.empty()) {
      const std::vector<std::size_t> free = free_axes();
      const auto found = std::find_if(free.begin(), free.end(), [&](std::size_t axis) {
        return sweep_.dimension_of[axis] != other;
      });
      if (found == free.end()) refuse_axes(other ? "a map takes two axes" : "no axis is left");
      result.axis = *found;
    } else {
      result.axis = axis_named(name);
    }
    result.dimension = sweep_.dimension_of[result.axis];
    const SweepValues& values = sweep_.axes[result.axis].values;
    const auto refuse = [&](const char* why, const char* admissible) {
      refuse_input(FaultCode::command_conflict, sweep_.run.folder, name, why, admissible);
    };
    if (fixed_[result.dimension]) refuse("--at gives this axis one value", "another axis");
    if (result.dimension == other) refuse("both axes have their values together", "another axis");
    if (!values.numeric()) refuse("its values are not numbers", "an axis of numbers");
    result.logarithmic = is_logarithmic(result.axis, letter);
    std::vector<std::pair<double, std::size_t>> sorted;
    for (std::size_t k = 0; k < values.size(); ++k) sorted.emplace_back(values.number(k), k);
    std::sort(sorted.begin(), sorted.end());
    for (const auto& [number, k] : sorted) {
      result.order.push_back(k);
      result.values.push_back(number);
    }
    return result;
  }

  /// Points that are the first along these dimensions, and have the fixed values of the others.
  std::vector<std::size_t> first_points(const std::vector<std::size_t>& along,
                                        std::size_t most) const {
    std::vector<std::size_t> points;
    std::set<std::vector<std::size_t>> begun;  // of a refined sweep, lines by their other values
    for (std::size_t point = 0; point < sweep_.points && points.size() <= most; ++point) {
      bool taken = true;
      std::vector<std::size_t> line;
      for (std::size_t d = 0; d < fixed_.size(); ++d) {
        const bool shown = std::find(along.begin(), along.end(), d) != along.end();
        const bool counts = fixed_[d] || (shown && !sweep_.refined);
        if (counts) taken = taken && sweep_.index(d, point) == fixed_[d].value_or(0);
        if (!shown) line.push_back(sweep_.index(d, point));
      }
      if (sweep_.refined) taken = taken && begun.insert(std::move(line)).second;
      if (taken) points.push_back(point);
    }
    return points;
  }

  FigureText label_of_column(std::size_t column) const {
    const SampleTable::Column& found = sweep_.table.columns()[column];
    for (const std::string kind : {"error", "spread"}) {
      if (!found.name.starts_with(kind + ".")) continue;
      const FigureText of = result_label(sweep_.run, found.name.substr(kind.size() + 1));
      return {kind + " of the " + of.text, of.enhanced};
    }
    return result_label(sweep_.run, found.name);
  }

  bool is_log_y() const { return request_.log && request_.log->find('y') != std::string::npos; }

  void note(std::size_t count, const char* what) {
    if (count > 0) notes_.push_back(fmt::format("{} of {} numbers {}", count, numbers_, what));
  }

  [[noreturn]] void refuse_empty() const {
    refuse_input(FaultCode::plot_no_data, sweep_.run.folder, "", "there is no number to draw");
  }

  Figure curves();
  Panel panel_of_curves(const std::vector<std::string>& names, const Drawn& x,
                        const std::vector<std::size_t>& starts, double height);
  std::vector<Polyline> pieces_of(const std::vector<double>& numbers, const Drawn& x,
                                  std::size_t start);
  std::string label_of_curve(const Drawn& x, std::size_t start) const;
  Figure map(bool upwards);
  std::pair<std::vector<double>, FigureText> edges_of(const Drawn& along) const;
  Curve minimum(const Drawn& x, const Drawn& y, const std::vector<double>& values);

  const StoredSweep& sweep_;
  const SweepRequest& request_;
  std::vector<std::string>& notes_;
  std::vector<std::optional<std::size_t>> fixed_;  ///< [dimension]
  std::string title_;                              ///< what is fixed
  // Of the numbers that the figure is of, for notes:
  std::size_t numbers_ = 0;
  std::size_t undefined_ = 0;
  std::size_t not_positive_ = 0;
};

/// "k = 2, v = 0.1": the axes that are neither along x nor fixed.
std::string SweepDrawing::label_of_curve(const Drawn& x, std::size_t start) const {
  std::vector<std::string> parts;
  for (std::size_t a = 0; a < sweep_.axes.size(); ++a) {
    const std::size_t d = sweep_.dimension_of[a];
    if (d == x.dimension || fixed_[d] || sweep_.dimensions[d].count == 1) continue;
    parts.push_back(fmt::format("{} = {}", sweep_.axes[a].name,
                                shown_value(sweep_.axes[a], sweep_.index(d, start))));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

/// The curve that begins at a point, broken where there is no number to draw.
std::vector<Polyline> SweepDrawing::pieces_of(const std::vector<double>& numbers, const Drawn& x,
                                              std::size_t start) {
  const bool log_y = is_log_y();
  std::vector<Polyline> pieces(1);
  std::vector<std::pair<double, std::size_t>> sorted;
  for (const std::size_t point : sweep_.line(x.dimension, start)) {
    sorted.emplace_back(sweep_.axes[x.axis].values.number(sweep_.index(x.dimension, point)), point);
  }
  std::sort(sorted.begin(), sorted.end());
  for (const auto& [value, number] : sorted) {
    const Point point = {value, numbers[number]};
    const bool undefined = std::isnan(point.y);
    ++numbers_;
    const bool not_positive = (x.logarithmic && point.x <= 0.0) || (log_y && point.y <= 0.0);
    if (undefined) ++undefined_;
    if (!undefined && not_positive) ++not_positive_;
    if (undefined || not_positive) {
      if (!pieces.back().empty()) pieces.emplace_back();
    } else {
      pieces.back().push_back(point);
    }
  }
  if (pieces.back().empty()) pieces.pop_back();
  return pieces;
}

Panel SweepDrawing::panel_of_curves(const std::vector<std::string>& names, const Drawn& x,
                                    const std::vector<std::size_t>& starts, double height) {
  std::vector<std::size_t> columns;
  columns.reserve(names.size());
  for (const std::string& name : names) columns.push_back(observable_named(name));
  const auto unit = [&](std::size_t column) { return sweep_.table.columns()[column].unit; };
  for (const std::size_t column : columns) {
    if (unit(column) == unit(columns[0])) continue;
    refuse_input(FaultCode::command_invalid_value, sweep_.table.file(),
                 "--y " + sweep_.table.columns()[column].name,
                 fmt::format("[{}], on one axis with [{}]", unit(column), unit(columns[0])),
                 "one unit to an axis; another --y makes another panel");
  }
  const std::vector<std::vector<double>> numbers = sweep_.read(columns);
  Panel panel;
  panel.height = height;
  panel.y_label = columns.size() == 1 ? label_of_column(columns[0])
                                      : axis_text(dimension_words(sweep_.run, unit(columns[0])), "",
                                                  unit_name(sweep_.run, unit(columns[0])));
  NumberRange range;
  for (const std::size_t start : starts) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      Curve curve;
      curve.label = label_of_curve(x, start);
      if (columns.size() > 1) {
        const std::string& name = sweep_.table.columns()[columns[c]].name;
        curve.label = curve.label.empty() ? name : name + ", " + curve.label;
      }
      curve.colour = static_cast<int>(panel.curves.size());
      curve.mark = mark_of(x.order.size());
      curve.pieces = pieces_of(numbers[c], x, start);
      if (curve.pieces.empty()) curve.label.clear();
      for (const Polyline& piece : curve.pieces) {
        for (const Point& point : piece) range.take(point.y);
      }
      panel.curves.push_back(std::move(curve));
    }
  }
  if (range.from > range.to) refuse_empty();
  std::tie(panel.y_from, panel.y_to) = with_margin(range.from, range.to, is_log_y());
  return panel;
}

Figure SweepDrawing::curves() {
  const bool is_refined_free =
      sweep_.refined && !fixed_[sweep_.dimension_of[*sweep_.refined]] && request_.x.empty();
  const Drawn x =
      drawn(is_refined_free ? sweep_.axes[*sweep_.refined].name : request_.x, 'x', std::nullopt);
  const std::vector<std::size_t> starts = first_points({x.dimension}, kMostSweepCurves);
  if (starts.size() > kMostSweepCurves) {
    refuse_axes(fmt::format("more than {} curves", kMostSweepCurves));
  }
  std::vector<std::vector<std::string>> panels = request_.y;
  if (panels.empty()) panels = {{sweep_.observables().front()}};
  Figure figure;
  figure.x_label = parameter_label(sweep_.axes[x.axis].name);
  figure.log_x = x.logarithmic;
  figure.log_y = is_log_y();
  const double height = panels.size() == 1 ? kSweepHeight : kSweepHeightOfSeveral;
  for (const auto& panel : panels) {
    figure.panels.push_back(panel_of_curves(panel, x, starts, height));
  }
  figure.panels.front().title = title_;
  NumberRange range;
  for (const Panel& panel : figure.panels) {
    for (const Curve& curve : panel.curves) {
      for (const Polyline& piece : curve.pieces) {
        range.take(piece.front().x);
        range.take(piece.back().x);
      }
    }
  }
  std::tie(figure.x_from, figure.x_to) = with_margin(range.from, range.to, figure.log_x);
  for (Panel& panel : figure.panels) {
    const Window window = {figure.x_from,  figure.x_to,  panel.y_from, panel.y_to,
                           request_.width, panel.height, figure.log_x, figure.log_y};
    for (Curve& curve : panel.curves) curve.pieces = reduced(curve.pieces, window);
  }
  note(undefined_, "are undefined, and left out");
  note(not_positive_, "are not positive, and not on a logarithmic axis");
  return figure;
}

Figure SweepDrawing::map(bool upwards) {
  if (sweep_.refined) {
    refuse_input(FaultCode::command_conflict, sweep_.run.folder, sweep_.axes[*sweep_.refined].name,
                 "the sweep is refined along it, and its points make no grid for a map",
                 "curves, by --y with an observable");
  }
  std::optional<std::size_t> known;  // along one axis, while the other is looked for
  const std::string above = upwards ? request_.y[0][0] : "";
  if (upwards && request_.x.empty()) known = sweep_.dimension_of[*find_axis(above)];
  const Drawn x = drawn(request_.x, 'x', known);
  const Drawn y = drawn(above, 'y', x.dimension);
  const std::vector<std::size_t> starts = first_points({x.dimension, y.dimension}, 1);
  if (starts.size() > 1) refuse_axes("a map has no third axis");
  Figure figure;
  Panel panel;
  Raster raster;
  std::tie(raster.x_edges, figure.x_label) = edges_of(x);
  std::tie(raster.y_edges, panel.y_label) = edges_of(y);
  const std::size_t column =
      observable_named(request_.value.empty() ? sweep_.observables().front() : request_.value);
  const std::vector<double> numbers = sweep_.read({column})[0];
  for (const std::size_t j : y.order) {
    for (const std::size_t i : x.order) {
      raster.values.push_back(
          numbers[starts[0] + i * sweep_.stride[x.dimension] + j * sweep_.stride[y.dimension]]);
    }
  }
  numbers_ = raster.values.size();
  undefined_ = static_cast<std::size_t>(std::count_if(
      raster.values.begin(), raster.values.end(), [](double value) { return std::isnan(value); }));
  if (undefined_ == numbers_) refuse_empty();
  note(undefined_, "are undefined, and their cells stay white");
  raster.columns = x.order.size();
  raster.label = label_of_column(column);
  figure.x_from = raster.x_from = raster.x_edges.front();
  figure.x_to = raster.x_to = raster.x_edges.back();
  panel.y_from = raster.y_from = raster.y_edges.front();
  panel.y_to = raster.y_to = raster.y_edges.back();
  figure.log_x = x.logarithmic;
  figure.log_y = y.logarithmic;
  panel.height = kMapHeight;
  panel.title = title_;
  if (!request_.minimum_along.empty()) panel.curves = {minimum(x, y, raster.values)};
  panel.raster = std::move(raster);
  figure.panels.push_back(std::move(panel));
  return figure;
}

/// Limits of the cells along an axis, and its label.
std::pair<std::vector<double>, FigureText> SweepDrawing::edges_of(const Drawn& along) const {
  const std::vector<double>& values = along.values;
  const std::string& name = sweep_.axes[along.axis].name;
  const auto refuse = [&](std::string why, const char* admissible) {
    refuse_input(FaultCode::command_conflict, sweep_.run.folder, name, std::move(why), admissible);
  };
  if (std::adjacent_find(values.begin(), values.end()) != values.end()) {
    refuse("it has a value twice: a map has no place for it", "another axis; curves, by --y");
  }
  if (along.logarithmic && values[0] <= 0.0) {
    refuse(fmt::format("{:g} has no place on a logarithmic axis", values[0]), "--log none");
  }
  if (values.size() > kMostPixels) {
    refuse(fmt::format("{} values: a map has at most {} along an axis", values.size(), kMostPixels),
           "curves, by --y");
  }
  return {edges_around(values, along.logarithmic), parameter_label(name)};
}

/// The point of the least value along one axis, for each value of the other.
Curve SweepDrawing::minimum(const Drawn& x, const Drawn& y, const std::vector<double>& values) {
  const std::size_t axis = axis_named(request_.minimum_along);
  if (axis != x.axis && axis != y.axis) {
    refuse_name(request_.minimum_along, "the map has no such axis",
                {sweep_.axes[x.axis].name, sweep_.axes[y.axis].name});
  }
  const bool along_x = axis == x.axis;
  const Drawn& along = along_x ? x : y;
  const Drawn& other = along_x ? y : x;
  Curve curve;
  curve.label = "minimum along " + request_.minimum_along;
  curve.colour = kMinimumColour;
  curve.mark = mark_of(other.order.size());
  curve.pieces.emplace_back();
  std::size_t at_an_end = 0;
  for (std::size_t k = 0; k < other.order.size(); ++k) {
    std::optional<std::size_t> least;
    const auto value = [&](std::size_t i) {
      return values[along_x ? k * x.order.size() + i : i * x.order.size() + k];
    };
    for (std::size_t i = 0; i < along.order.size(); ++i) {
      if (!std::isnan(value(i)) && (!least || value(i) < value(*least))) least = i;
    }
    if (!least) {
      if (!curve.pieces.back().empty()) curve.pieces.emplace_back();
      continue;
    }
    if (*least == 0 || *least + 1 == along.order.size()) ++at_an_end;
    const double here = along.values[*least];
    const double there = other.values[k];
    curve.pieces.back().push_back(along_x ? Point{here, there} : Point{there, here});
  }
  if (at_an_end > 0) {
    notes_.push_back(fmt::format("at {} of {} values of {} the least number is at an end of {}",
                                 at_an_end, other.order.size(), sweep_.axes[other.axis].name,
                                 request_.minimum_along));
  }
  return curve;
}

}  // namespace

Figure sweep_figure(const StoredSweep& sweep, const SweepRequest& request,
                    std::vector<std::string>& notes) {
  return SweepDrawing(sweep, request, notes).figure();
}

}  // namespace tomlin
