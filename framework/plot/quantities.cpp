#include "framework/plot/quantities.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "framework/core/text/fault.hpp"
#include "framework/core/text/nearest_name.hpp"
#include "framework/plot/axis_text.hpp"
#include "framework/scene/text.hpp"

namespace tomlin {
namespace {

constexpr std::array kQuantities = {
    Quantity{"time", "time", "{/:Italic t}", Owner::nobody, "time", Measure::component, "time"},
    Quantity{"driver_position", "driver position", "{/:Italic vt}", Owner::driver, "position.x",
             Measure::component, "where the driver's support is along x: v t"},
    Quantity{"force", "lateral force", "{/:Italic F_x}", Owner::driver, "force.x",
             Measure::component, "x component of the driver's force"},
    Quantity{"force_size", "friction force", "{/:Italic F_f}", Owner::driver, "force",
             Measure::signed_size, "size of the driver's force, with the sign of its x component"},
    Quantity{"position", "centre of mass", "{/:Italic x_c}", Owner::body, "centre_of_mass.x",
             Measure::component, "the centre of mass along x"},
    Quantity{"height", "centre of mass", "{/:Italic y_c}", Owner::body, "centre_of_mass.y",
             Measure::component, "the centre of mass along y"},
    Quantity{"rotation", "rotation", "{/:Italic φ}", Owner::body, "rotation", Measure::component,
             "rotation, unwrapped, counter-clockwise positive"},
    Quantity{"speed", "speed", "{/:Italic v_c}", Owner::body, "velocity", Measure::size,
             "speed of the centre of mass"},
};

constexpr std::array kFigureKinds = {
    FigureKind{"force", "force", "driver_position", "the friction trace: F_x versus v t"},
    FigureKind{"force_size", "force_size", "driver_position",
               "F_f versus v t: the force's size with the sign of F_x"},
    FigureKind{"position", "position", "driver_position",
               "x_c versus v t, beside a spring that is not stretched"},
    FigureKind{"height", "height", "driver_position", "y_c versus v t"},
    FigureKind{"rotation", "rotation", "driver_position", "the angle versus v t"},
    FigureKind{"speed", "speed", "driver_position", "the speed versus v t"},
    FigureKind{"hysteresis", "force", "position",
               "F_x over x_c, a loop when the driver turns back"},
    FigureKind{"path", "height", "position", "y_c over x_c"},
};

constexpr std::array kAxes = {".x", ".y", ".z"};

/// Components of vectors in words; the axis stands behind the symbol.
struct WordedColumn {
  std::string_view ending;  ///< of a column's name without its axis
  const char* words;
  const char* symbol;
};

constexpr std::array kWordedColumns = {WordedColumn{".position", "support position", ""},
                                       WordedColumn{".force", "force", "F_"},
                                       WordedColumn{".centre_of_mass", "centre of mass", ""},
                                       WordedColumn{".velocity", "velocity", "v_"}};

template <class Named>
const Named* find_named(std::span<const Named> all, std::string_view name) {
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Named& one) { return one.name == name; });
  return found == all.end() ? nullptr : &*found;
}

/// A vector by its first component.
std::string first_column(const Quantity& quantity) {
  return std::string(quantity.column) + (quantity.measure == Measure::component ? "" : kAxes[0]);
}

Series series_of(const SampleTable& table, const Quantity& quantity, const Owners& owners) {
  std::string prefix;
  if (quantity.owner != Owner::nobody) {
    prefix = chosen_owner(table, quantity.owner, first_column(quantity), owners) + ".";
  }
  prefix += quantity.column;
  Series series;
  series.name = quantity.name;
  series.words = quantity.words;
  series.symbol = quantity.symbol;
  series.enhanced = true;
  series.measure = quantity.measure;
  if (quantity.measure == Measure::component) {
    series.columns = {*table.find(prefix)};
  } else {
    for (const char* axis : kAxes) {
      if (const auto column = table.find(prefix + axis)) series.columns.push_back(*column);
    }
  }
  series.unit = table.columns()[series.columns.front()].unit;
  return series;
}

}  // namespace

std::span<const Quantity> quantities() { return kQuantities; }

std::span<const FigureKind> figure_kinds() { return kFigureKinds; }

const Quantity* find_quantity(std::string_view name) { return find_named(quantities(), name); }

const FigureKind* find_figure_kind(std::string_view name) {
  return find_named(figure_kinds(), name);
}

std::vector<std::string> owners_of(const SampleTable& table, std::string_view column) {
  const std::string ending = "." + std::string(column);
  std::vector<std::string> result;
  for (const SampleTable::Column& one : table.columns()) {
    if (one.name.ends_with(ending)) {
      result.push_back(one.name.substr(0, one.name.size() - ending.size()));
    }
  }
  return result;
}

std::string chosen_owner(const SampleTable& table, Owner owner, std::string_view column,
                         const Owners& owners) {
  const bool driver = owner == Owner::driver;
  const std::string& wanted = driver ? owners.driver : owners.body;
  const char* kind = driver ? "driver" : "body";
  const std::vector<std::string> candidates = owners_of(table, column);
  if (candidates.empty()) {
    refuse_input(FaultCode::plot_no_data, table.file(), "",
                 fmt::format("no {} has a column {}", kind, column),
                 listed(table.names()) + "; --x and --y take any of them");
  }
  const char* option = driver ? "--driver" : "--body";
  if (wanted.empty() && candidates.size() == 1) return candidates.front();
  if (wanted.empty()) {
    refuse_input(FaultCode::command_missing_argument, table.file(), "",
                 fmt::format("several {} have a column {}", driver ? "drivers" : "bodies", column),
                 fmt::format("{} {}", option, fmt::join(candidates, fmt::format(", {} ", option))));
  }
  if (std::find(candidates.begin(), candidates.end(), wanted) != candidates.end()) return wanted;
  refuse_input(FaultCode::plot_no_data, table.file(),
               shortened(std::string(option) + " " + wanted, kLongestShownValue),
               fmt::format("there is no column {}.{}", wanted, column), listed(candidates),
               nearest_name(wanted, candidates).value_or(""));
}

Series find_series(const SampleTable& table, const std::string& name, const Owners& owners,
                   const std::string& option) {
  if (const Quantity* quantity = find_quantity(name)) return series_of(table, *quantity, owners);
  if (const auto column = table.find(name)) {
    const SampleTable::Column& found = table.columns()[*column];
    return {found.name, "", found.name, false, found.unit, Measure::component, {*column}};
  }
  std::vector<std::string> known = table.names();
  for (const Quantity& quantity : quantities()) {
    if (!table.find(quantity.name)) known.emplace_back(quantity.name);
  }
  refuse_input(
      FaultCode::plot_no_data, table.file(), shortened(option + " " + name, kLongestShownValue),
      "there is no such column or quantity", listed(known), nearest_name(name, known).value_or(""));
}

FigureText axis_label(const StoredRun& run, const Series& series) {
  const std::string unit = unit_name(run, series.unit);
  if (!series.enhanced && unit.empty()) return {series.symbol};
  return axis_text(series.words, series.enhanced ? series.symbol : literal_text(series.symbol),
                   unit);
}

FigureText axis_label_in_words(const StoredRun& run, const Series& series) {
  const std::size_t length = series.name.size();
  const bool has_axis = length > 2 && std::find(kAxes.begin(), kAxes.end(),
                                                series.name.substr(length - 2)) != kAxes.end();
  if (series.enhanced || !has_axis) return axis_label(run, series);
  const char axis = series.name.back();
  const std::string_view vector = std::string_view(series.name).substr(0, length - 2);
  for (const WordedColumn& column : kWordedColumns) {
    if (!vector.ends_with(column.ending)) continue;
    return axis_text(column.words, fmt::format("{{/:Italic {}{}}}", column.symbol, axis),
                     unit_name(run, series.unit));
  }
  return axis_label(run, series);
}

std::string key_text_of(const Series& series) {
  return series.words.empty() ? series.symbol : series.words;
}

double value_of(Measure measure, std::span<const double> components) {
  if (measure == Measure::component) return components.front();
  double square = 0.0;
  for (const double component : components) square += component * component;
  const double size = std::sqrt(square);
  return measure == Measure::signed_size ? std::copysign(size, components.front()) : size;
}

}  // namespace tomlin
