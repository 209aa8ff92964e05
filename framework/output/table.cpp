#include "framework/output/table.hpp"

#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "framework/output/number_text.hpp"

namespace tomlin {
std::size_t table_bytes_per_row(const RunLayout& layout) {
  return (kLongestNumber + 1) * layout.columns.size();
}

TableWriter::TableWriter(std::filesystem::path file) : file_(std::move(file)) {}

void TableWriter::begin(const RunLayout& layout) {
  if (layout.columns.empty()) return;
  output_.emplace(file_);
  row_ = layout.row();
  // Room for the longest row behind a buffer that is just not full: no sample allocates.
  buffer_.reserve(kTextAtOnce + table_bytes_per_row(layout));
  for (const SampleColumn& column : layout.columns) {
    if (!names_.empty()) buffer_ += ',';
    fmt::format_to(std::back_inserter(buffer_), "{} [{}]", column.name, column.unit);
    names_.push_back(column.name);
  }
  buffer_ += '\n';
}

void TableWriter::sample(const std::vector<double>& row) {
  if (row.size() != row_) {
    throw OutputError(fmt::format("{}: a sample of {} numbers where {} are expected",
                                  file_.string(), row.size(), row_));
  }
  for (std::size_t k = 0; k < names_.size(); ++k) {
    if (!std::isfinite(row[k])) {
      throw OutputError(fmt::format("{}: sample {}: {} is not a finite number", file_.string(),
                                    rows_, names_[k]));
    }
  }
  for (std::size_t k = 0; k < names_.size(); ++k) {
    if (k > 0) buffer_ += ',';
    append_number(buffer_, row[k]);
  }
  buffer_ += '\n';
  ++rows_;
  output_->append_if_long(buffer_);
}

void TableWriter::finish() {
  if (!output_) return;
  output_->append(buffer_);
  output_->publish();
}

}  // namespace tomlin
