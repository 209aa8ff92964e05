#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace tomlin {

/// How the forms of a table show a column; a form whose name is null does not have it.
struct ColumnHeading {
  const char* key = nullptr;  ///< JSON
  const char* csv = nullptr;  ///< with the unit
  bool quoted = false;        ///< in CSV: words that may hold commas
  const char* text = nullptr;
  std::size_t width = 0;      ///< of the text, which stands to the right; 0: as needed, to the left
  const char* format = "{}";  ///< of floating-point numbers in the text
};

/// A table that is written as JSON, CSV and text. A column is added once, with a value for each
/// row.
class OutputTable {
 public:
  using Json = nlohmann::ordered_json;
  /// Null is "-" in text; null and numbers that are not finite are null in JSON and empty in CSV.
  /// Without a value JSON has no key, and CSV and text are empty.
  using Cell = std::optional<Json>;

  /// `value(row)` converts to a Cell.
  template <class Rows, class Value>
  void add(const ColumnHeading& heading, const Rows& rows, Value value) {
    Column& column = columns_.emplace_back(Column{heading, {}});
    for (const auto& row : rows) column.cells.emplace_back(value(row));
  }

  /// An object.
  Json json(std::size_t row) const;
  /// A line of names, then the rows.
  std::string csv() const;
  /// The line of names, without its end.
  std::string text_names() const;
  std::string text(std::size_t row) const;

 private:
  struct Column {
    ColumnHeading heading;
    std::vector<Cell> cells;
  };
  std::vector<Column> columns_;
};

/// Null where there is no number.
inline OutputTable::Json number(const std::optional<double>& x) {
  return x ? OutputTable::Json(*x) : OutputTable::Json();
}

}  // namespace tomlin
