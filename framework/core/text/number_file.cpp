#include "framework/core/text/number_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "framework/core/text/ascii.hpp"
#include "framework/core/text/utf8.hpp"

namespace tomlin {
namespace {

constexpr std::size_t kMostFaults = 10;  // of a file; nobody reads more

/// The columns of one line.
struct Row {
  std::vector<double> numbers;
  std::string why;  ///< what is wrong; empty when valid
};

/// Never repeats what stands in the file: a scene of somebody else's may name any.
class RowReader {
 public:
  explicit RowReader(std::string_view line) : rest_(line.substr(0, line.find('#'))) {}

  Row read() {
    Row row;
    skip_spaces();
    bool after_comma = false;
    while (!rest_.empty() || after_comma) {
      const std::string_view word = take_word();
      if (word.empty()) return refused("is empty");
      std::string why;
      row.numbers.push_back(parse_number(word, why));
      if (!why.empty()) return refused(why);
      ++column_;
      after_comma = take_comma();
    }
    return row;
  }

 private:
  Row refused(const std::string& why) const {
    return {{}, fmt::format("column {} {}", column_, why)};
  }

  void skip_spaces() {
    while (!rest_.empty() && is_space(rest_.front())) rest_.remove_prefix(1);
  }

  std::string_view take_word() {
    std::size_t length = 0;
    while (length < rest_.size() && !is_space(rest_[length]) && rest_[length] != ',') ++length;
    const std::string_view word = rest_.substr(0, length);
    rest_.remove_prefix(length);
    skip_spaces();
    return word;
  }

  bool take_comma() {
    if (rest_.empty() || rest_.front() != ',') return false;
    rest_.remove_prefix(1);
    skip_spaces();
    return true;
  }

  std::string_view rest_;
  std::size_t column_ = 1;
};

std::string columns(std::size_t count) {
  return fmt::format("{} column{}", count, count == 1 ? "" : "s");
}

}  // namespace

double parse_number(std::string_view word, std::string& why) {
  const auto end = word.data() + word.size();
  // A sign that from_chars does not know.
  const char* begin = word.data() + (word.size() > 1 && word[0] == '+' && word[1] != '-');
  double number = 0.0;
  const auto [stop, error] = std::from_chars(begin, end, number);
  if (error == std::errc::result_out_of_range) {
    why = "is too large or too small for a double";
  } else if (error != std::errc() || stop != end) {
    why = "is not a number";
  } else if (!std::isfinite(number)) {
    why = "is not a finite number";
  }
  return number;
}

NumberFile parse_numbers(std::string_view text, const std::string& name, std::size_t most_columns,
                         const std::string& why_most) {
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  NumberFile file;
  std::size_t first_line = 0;
  for (std::size_t line = 1; !text.empty() && file.faults.size() < kMostFaults; ++line) {
    const std::size_t length = std::min(text.find('\n'), text.size());
    Row row = RowReader(text.substr(0, length)).read();
    text.remove_prefix(std::min(length + 1, text.size()));
    const std::size_t count = row.numbers.size();
    if (row.why.empty() && count == 0) continue;
    if (row.why.empty() && count > most_columns) {
      row.why = columns(count) + why_most;
    } else if (row.why.empty() && first_line > 0 && count != file.columns) {
      row.why = fmt::format("{}, but line {} has {}", columns(count), first_line, file.columns);
    }
    if (!row.why.empty()) {
      file.faults.push_back(fmt::format("{}:{}: {}", name, line, row.why));
      continue;
    }
    if (first_line == 0) first_line = line;
    file.columns = count;
    file.numbers.insert(file.numbers.end(), row.numbers.begin(), row.numbers.end());
  }
  if (file.faults.empty() && file.numbers.empty()) {
    file.faults.push_back(name + ":1: the file has no numbers");
  }
  return file;
}

}  // namespace tomlin
