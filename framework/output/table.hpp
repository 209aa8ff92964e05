#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "framework/output/output_file.hpp"
#include "framework/output/result_file.hpp"

namespace tomlin {

/// Bytes of the longest row, a comma or the end of the line behind each number.
std::size_t table_bytes_per_row(const RunLayout& layout);

/// Writes samples as comma-separated values: a header `time [time],driver.force.x [force],...`,
/// then one row per sample with 17 significant digits, which read back as the same bits. A number
/// that is not finite is never written. Throws OutputError.
class TableWriter : public ResultFile {
 public:
  /// Nothing is opened before the run begins, and nothing ever where no samples are to come.
  explicit TableWriter(std::filesystem::path file);

  void begin(const RunLayout& layout) override;
  /// Positions of particles, behind the columns, are left out.
  void sample(const std::vector<double>& row) override;
  void finish() override;

 private:
  std::filesystem::path file_;
  std::optional<OutputFile> output_;
  std::vector<std::string> names_;
  std::size_t row_ = 0;  ///< numbers of a sample
  std::string buffer_;
  std::size_t rows_ = 0;
};

}  // namespace tomlin
