#include "framework/plot/series_reader.hpp"

#include <algorithm>

#include "framework/core/text/fault.hpp"

namespace tomlin {

void SeriesReader::add(const Series& series) {
  for (const std::size_t column : series.columns) {
    if (std::find(columns_.begin(), columns_.end(), column) == columns_.end()) {
      columns_.push_back(column);
    }
  }
}

void SeriesReader::read(const SampleTable& table) { numbers_ = table.read(columns_); }

std::vector<double> SeriesReader::values(const Series& series) const {
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

Series column_series(const SampleTable& table, const std::string& name) {
  const auto column = table.find(name);
  if (!column) {
    refuse_input(FaultCode::plot_no_data, table.file(), "", "there is no column " + name);
  }
  const SampleTable::Column& found = table.columns()[*column];
  return {found.name, "", found.name, false, found.unit, Measure::component, {*column}};
}

}  // namespace tomlin
