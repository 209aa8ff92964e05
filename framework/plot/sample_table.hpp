#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tomlin {

/// observables.csv, read back: a header `time [time],driver.force.x [force],...`, then a row per
/// sample. Or sweep.csv, with a row per point. Everything throws InputError, with line and column
/// where there is one.
class SampleTable {
 public:
  struct Column {
    std::string name;  ///< "driver.force.x"
    std::string unit;  ///< "force"; empty when the header has none
  };

  enum class Rows {
    samples,
    points,  ///< of a sweep: undefined numbers are empty, and read as NaN; words are in quotes
  };

  /// Reads the header.
  explicit SampleTable(std::string file, Rows rows = Rows::samples);

  const std::string& file() const { return file_; }
  const std::vector<Column>& columns() const { return columns_; }
  std::vector<std::string> names() const;
  std::optional<std::size_t> find(std::string_view name) const;

  /// These columns, whole, in this order. Reads the file row by row and keeps nothing else of it;
  /// every row must have as many fields as the header.
  std::vector<std::vector<double>> read(const std::vector<std::size_t>& columns) const;
  /// The same as they are written, words without their quotes.
  std::vector<std::vector<std::string>> read_words(const std::vector<std::size_t>& columns) const;

 private:
  template <class Visit>
  void for_each_row(Visit visit) const;

  std::string file_;
  Rows rows_;
  std::vector<Column> columns_;
};

}  // namespace tomlin
