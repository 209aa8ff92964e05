#include "framework/cli/output_table.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "framework/output/number_text.hpp"

namespace tomlin {
namespace {

using Cell = OutputTable::Cell;

std::string in_quotes(const std::string& words) {
  std::string text = "\"";
  for (const char c : words) text += c == '"' ? "\"\"" : std::string(1, c);
  return text + "\"";
}

std::string csv_of(const Cell& cell, const ColumnHeading& heading) {
  if (!cell || cell->is_null()) return "";
  if (cell->is_string()) {
    return heading.quoted ? in_quotes(cell->get<std::string>()) : cell->get<std::string>();
  }
  if (!cell->is_number_float()) return cell->dump();
  std::string text;
  if (std::isfinite(cell->get<double>())) append_number(text, cell->get<double>());
  return text;
}

std::string text_of(const Cell& cell, const ColumnHeading& heading) {
  if (!cell) return "";
  if (cell->is_null()) return "-";
  if (cell->is_string()) return cell->get<std::string>();
  if (!cell->is_number_float()) return cell->dump();
  return fmt::format(fmt::runtime(heading.format), cell->get<double>());
}

/// Pads to the width of the column, or of its heading and `cells` where it has none of its own.
std::string padded(const std::string& content, const ColumnHeading& heading,
                   const std::vector<Cell>& cells) {
  if (heading.width > 0) return fmt::format("  {:>{}}", content, heading.width);
  std::size_t width = std::string(heading.text).size();
  for (const Cell& cell : cells) width = std::max(width, text_of(cell, heading).size());
  return fmt::format("  {:<{}}", content, width);
}

}  // namespace

OutputTable::Json OutputTable::json(std::size_t row) const {
  Json object = Json::object();
  for (const auto& [heading, cells] : columns_) {
    if (heading.key != nullptr && cells[row]) object[heading.key] = *cells[row];
  }
  return object;
}

std::string OutputTable::csv() const {
  std::string text;
  const auto add_line = [&](const auto& content) {
    const char* comma = "";
    for (const Column& column : columns_) {
      if (column.heading.csv == nullptr) continue;
      text += comma + content(column);
      comma = ",";
    }
    text += "\n";
  };
  add_line([](const Column& column) { return std::string(column.heading.csv); });
  const std::size_t rows = columns_.empty() ? 0 : columns_.front().cells.size();
  for (std::size_t k = 0; k < rows; ++k) {
    add_line([k](const Column& column) { return csv_of(column.cells[k], column.heading); });
  }
  return text;
}

std::string OutputTable::text_names() const {
  std::string text;
  for (const auto& [heading, cells] : columns_) {
    if (heading.text != nullptr) text += padded(heading.text, heading, cells);
  }
  return text;
}

std::string OutputTable::text(std::size_t row) const {
  std::string text;
  for (const auto& [heading, cells] : columns_) {
    if (heading.text != nullptr) text += padded(text_of(cells[row], heading), heading, cells);
  }
  return text;
}

}  // namespace tomlin
