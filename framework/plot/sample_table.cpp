#include "framework/plot/sample_table.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "framework/core/text/fault.hpp"
#include "framework/core/text/text_file.hpp"
#include "framework/scene/text.hpp"

namespace tomlin {
namespace {

[[noreturn]] void refuse(FaultCode code, Place place, const std::string& value, std::string why,
                         std::string admissible = "") {
  throw InputError({Fault(code, std::move(place), shortened(value, kLongestShownValue), "",
                          std::move(why), std::move(admissible))});
}

/// "driver.force.x [force]"
SampleTable::Column column_of(std::string_view heading) {
  const auto space = heading.rfind(" [");
  if (space == std::string_view::npos || heading.back() != ']') return {std::string(heading), ""};
  return {std::string(heading.substr(0, space)),
          std::string(heading.substr(space + 2, heading.size() - space - 3))};
}

/// Behind the words in quotes that begin here; a quote among them is two.
std::size_t behind_quotes(std::string_view text, std::size_t at) {
  while (at < text.size() && text[at] == '"') {
    at = std::min(text.find('"', at + 1), text.size() - 1) + 1;
  }
  return at;
}

std::string without_quotes(std::string_view cell) {
  if (cell.size() < 2 || cell.front() != '"') return std::string(cell);
  std::string text;
  for (std::size_t k = 1; k + 1 < cell.size(); ++k) {
    if (cell[k] == '"') ++k;  // two of them are one
    text += cell[k];
  }
  return text;
}

/// One row, cut into its fields without copying.
class Row {
 public:
  Row(const std::string& file, int line) : file_(file), line_(line) {}

  void cut(std::string_view text) {
    text_ = text;
    begins_.assign(1, 0);
    for (std::size_t at = text.find(',', behind_quotes(text, 0)); at != std::string_view::npos;
         at = text.find(',', behind_quotes(text, at + 1))) {
      begins_.push_back(at + 1);
    }
    ++line_;
  }

  std::size_t size() const { return begins_.size(); }

  std::string_view field(std::size_t k) const {
    const std::size_t end = k + 1 < begins_.size() ? begins_[k + 1] - 1 : text_.size();
    return text_.substr(begins_[k], end - begins_[k]);
  }

  /// By std::from_chars, which knows no locale.
  double number(std::size_t k) const {
    const std::string_view text = field(k);
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
      refuse(FaultCode::file_damaged, place(k), text.empty() ? "\"\"" : std::string(text),
             "not a finite number");
    }
    return value;
  }

  void must_have(std::size_t fields) const {
    if (size() == fields) return;
    refuse(FaultCode::file_damaged, place(0), "",
           fmt::format("{} fields in a table of {} columns", size(), fields));
  }

 private:
  Place place(std::size_t k) const { return {file_, line_, static_cast<int>(begins_[k]) + 1}; }

  const std::string& file_;
  int line_;
  std::string_view text_;
  std::vector<std::size_t> begins_;
};

std::ifstream opened(const std::string& file) {
  const TextFile start = read_text_file(file, 0);  // it knows what cannot be read, and why
  if (!start.why.empty()) refuse(FaultCode::file_cannot_read, {file}, "", start.why);
  return std::ifstream(file, std::ios::binary);
}

}  // namespace

SampleTable::SampleTable(std::string file, Rows rows) : file_(std::move(file)), rows_(rows) {
  std::ifstream stream = opened(file_);
  std::string header;
  std::getline(stream, header);
  Row row(file_, 0);
  row.cut(header);
  for (std::size_t k = 0; k < row.size(); ++k) columns_.push_back(column_of(row.field(k)));
  if (rows_ == Rows::points && columns_.back().name != "reason") {
    refuse(FaultCode::file_invalid, {file_, 1, 1}, header, "this is not the table of a sweep",
           "a header that ends with \"reason\"");
  }
  if (rows_ == Rows::samples && columns_.front().name != "time") {
    refuse(FaultCode::file_invalid, {file_, 1, 1}, header, "this is not a table of observables",
           "a header that begins with \"time [time]\"");
  }
}

std::vector<std::string> SampleTable::names() const {
  std::vector<std::string> result;
  for (const Column& column : columns_) result.push_back(column.name);
  return result;
}

std::optional<std::size_t> SampleTable::find(std::string_view name) const {
  const auto found = std::find_if(columns_.begin(), columns_.end(),
                                  [&](const Column& column) { return column.name == name; });
  if (found == columns_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - columns_.begin());
}

template <class Visit>
void SampleTable::for_each_row(Visit visit) const {
  std::ifstream stream = opened(file_);
  std::string line;
  std::getline(stream, line);
  Row row(file_, 1);
  bool is_empty = true;
  while (std::getline(stream, line)) {
    row.cut(line);
    row.must_have(columns_.size());
    visit(row);
    is_empty = false;
  }
  if (stream.bad()) refuse(FaultCode::file_cannot_read, {file_}, "", "the file cannot be read");
  if (is_empty) refuse(FaultCode::plot_no_data, {file_}, "", "there are no rows in it");
}

std::vector<std::vector<double>> SampleTable::read(const std::vector<std::size_t>& columns) const {
  std::vector<std::vector<double>> result(columns.size());
  for_each_row([&](const Row& row) {
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const bool undefined = rows_ == Rows::points && row.field(columns[k]).empty();
      result[k].push_back(undefined ? std::numeric_limits<double>::quiet_NaN()
                                    : row.number(columns[k]));
    }
  });
  return result;
}

std::vector<std::vector<std::string>> SampleTable::read_words(
    const std::vector<std::size_t>& columns) const {
  std::vector<std::vector<std::string>> result(columns.size());
  for_each_row([&](const Row& row) {
    for (std::size_t k = 0; k < columns.size(); ++k) {
      result[k].push_back(without_quotes(row.field(columns[k])));
    }
  });
  return result;
}

}  // namespace tomlin
