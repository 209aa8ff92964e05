#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tomlin {

/// The number that a word is; `why` says what is wrong with it, empty where it is a finite number.
double parse_number(std::string_view word, std::string& why);

/// A file of rows of numbers, or the faults that keep it from being read.
struct NumberFile {
  std::size_t columns = 0;
  std::vector<double> numbers;      ///< row after row
  std::vector<std::string> faults;  ///< "NAME:LINE: why", by line; of many the first ones

  std::size_t rows() const { return columns == 0 ? 0 : numbers.size() / columns; }
};

/// One row per line, as many columns in each, apart by spaces, tabs or one comma; `#` begins a
/// comment, blank lines do not count. `name` stands in messages, and `why_most` follows the count
/// of columns that are too many.
NumberFile parse_numbers(std::string_view text, const std::string& name, std::size_t most_columns,
                         const std::string& why_most);

}  // namespace tomlin
