#include "framework/plot/result_figure.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "framework/core/text/axis_names.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/core/text/nearest_name.hpp"
#include "framework/output/run_folder.hpp"
#include "framework/plot/axis_text.hpp"
#include "framework/plot/curve_labels.hpp"
#include "framework/run/results.hpp"
#include "framework/scene/text.hpp"

namespace tomlin {
namespace {

constexpr double kResultHeight = 360.0;  // of the panel, in points of the screen

/// Names as short as result_name() takes them.
std::vector<std::string> short_names(const StoredRun& run) {
  std::vector<std::string> names;
  for (const auto& [path, value] : run.results) {
    const std::string name = path.substr(path.find('.') + 1);
    names.push_back(result_name(run, name) == path ? name : path);
  }
  return names;
}

[[noreturn]] void refuse_path(const StoredRun& run, const char* option, const std::string& path,
                              const std::vector<std::string>& parameters) {
  std::vector<std::string> known = parameters;
  const std::vector<std::string> results = short_names(run);
  known.insert(known.end(), results.begin(), results.end());
  refuse_input(FaultCode::plot_no_data, file_of(run, kSummaryFile),
               shortened(std::string(option) + " " + path, kLongestShownValue),
               "there is no such number in the summary", listed(known),
               nearest_name(path, known).value_or(""));
}

double result_of(const StoredRun& run, const std::string& path) {
  const std::string name = result_name(run, path);
  if (name.empty()) refuse_path(run, "--result", path, {});
  return run.results.at(name);
}

double abscissa_of(const StoredRun& run, const std::string& path) {
  if (const double* value = parameter_of(run, path)) return *value;
  const std::string name = result_name(run, path);
  if (!name.empty()) return run.results.at(name);
  std::vector<std::string> parameters;
  for (const auto& [parameter, value] : run.parameters) parameters.push_back(parameter);
  refuse_path(run, "--against", path, parameters);
}

/// "mean force along x", or the parameter's name.
FigureText label_of_number(const StoredRun& run, const std::string& path, bool may_be_parameter) {
  if (may_be_parameter && parameter_of(run, path) != nullptr) return parameter_label(path);
  const std::string name = result_name(run, path);
  return result_label(run, name.empty() ? path : name);
}

std::size_t values_of(const std::vector<StoredRun>& runs, const std::string& parameter) {
  std::set<double> values;
  for (const StoredRun& run : runs) {
    if (const double* value = parameter_of(run, parameter)) values.insert(*value);
  }
  return values.size();
}

/// The parameters that tell curves apart.
std::vector<std::string> parameters_of_curves(const std::vector<StoredRun>& runs,
                                              const std::string& against) {
  std::vector<std::string> names = differing_parameters(runs);
  auto along = std::find(names.begin(), names.end(), against);
  // A parameter that all runs have alike varies along no curve; along a result some parameter does.
  if (along == names.end() && parameter_of(runs.front(), against) == nullptr) {
    along = std::max_element(names.begin(), names.end(),
                             [&](const std::string& a, const std::string& b) {
                               return values_of(runs, a) < values_of(runs, b);
                             });
  }
  if (along != names.end()) names.erase(along);
  return names;
}

struct ResultExtent {
  double from = HUGE_VAL;
  double to = -HUGE_VAL;
  void take(double value) {
    from = std::min(from, value);
    to = std::max(to, value);
  }
};

}  // namespace

FigureText parameter_label(const std::string& name) {
  return axis_text("", "{/:Italic " + literal_text(name) + "}", "");
}

FigureText result_label(const StoredRun& run, const std::string& name) {
  const ResultQuantity* quantity = quantity_at(name);
  if (quantity == nullptr) return axis_text(literal_text(name), "", "");
  std::string words = quantity->key;
  std::replace(words.begin(), words.end(), '_', ' ');
  const bool has_axis = name.size() > 2 && value_named<Axis>(name.substr(name.size() - 1)) &&
                        name[name.size() - 2] == '.';
  if (has_axis) words += " along {/:Italic " + name.substr(name.size() - 1) + "}";
  return axis_text(words, "", unit_name(run, unit_of(*quantity)));
}

Figure result_figure(const std::vector<StoredRun>& runs, const ResultRequest& request,
                     std::vector<std::string>& notes) {
  const std::vector<std::string> names = parameters_of_curves(runs, request.against);
  std::vector<std::string> labels;
  Panel panel;
  ResultExtent x;
  ResultExtent y;
  for (const StoredRun& run : in_order_of_parameters(runs)) {
    const Point point = {abscissa_of(run, request.against), result_of(run, request.result)};
    const bool defined = std::isfinite(point.x) && std::isfinite(point.y);
    if (!defined) notes.push_back(run.folder + ": undefined, and left out");
    if (!defined) continue;
    if ((request.log_x && !(point.x > 0.0)) || (request.log_y && !(point.y > 0.0))) {
      notes.push_back(run.folder + ": not positive, and not on a logarithmic axis");
      continue;
    }
    x.take(point.x);
    y.take(point.y);
    const std::string label = label_of(run, names);
    const auto known = std::find(labels.begin(), labels.end(), label);
    const auto which = static_cast<std::size_t>(known - labels.begin());
    if (known == labels.end()) {
      labels.push_back(label);
      Curve curve;
      curve.label = label;
      curve.colour = static_cast<int>(which);
      curve.mark = Mark::large_disc;
      curve.pieces.emplace_back();
      panel.curves.push_back(std::move(curve));
    }
    panel.curves[which].pieces.front().push_back(point);
  }
  if (panel.curves.empty()) {
    refuse_input(FaultCode::plot_no_data, "--result", request.result,
                 "there is no number to draw in any of the folders");
  }
  for (Curve& curve : panel.curves) {
    std::stable_sort(curve.pieces.front().begin(), curve.pieces.front().end(),
                     [](const Point& a, const Point& b) { return a.x < b.x; });
  }
  if (panel.curves.size() == 1) panel.curves.front().label.clear();
  panel.height = kResultHeight;
  panel.y_label = label_of_number(runs.front(), request.result, false);
  std::tie(panel.y_from, panel.y_to) = with_margin(y.from, y.to, request.log_y);
  Figure figure;
  figure.x_label = label_of_number(runs.front(), request.against, true);
  figure.log_x = request.log_x;
  figure.log_y = request.log_y;
  std::tie(figure.x_from, figure.x_to) = with_margin(x.from, x.to, request.log_x);
  figure.panels.push_back(std::move(panel));
  return figure;
}

}  // namespace tomlin
