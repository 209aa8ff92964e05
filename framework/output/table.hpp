#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "framework/output/output_file.hpp"
#include "framework/run/run.hpp"

namespace tomlin {

/// Writes samples as comma-separated values: a header `time [time],driver.force.x [force],...`,
/// then one row per sample with 17 significant digits, which read back as the same bits. A number
/// that is not finite is never written. Throws OutputError.
class TableWriter : public RunSink {
 public:
  /// Nothing is opened before the first sample is due.
  explicit TableWriter(std::filesystem::path file);

  void begin(const RunLayout& layout) override;
  void sample(const std::vector<double>& values) override;

  /// True from begin() on.
  bool begun() const { return output_.has_value(); }
  /// The table is complete: it gets its name.
  void finish();
  /// Brings what has come so far to the file, which keeps its unfinished name.
  void flush();

 private:
  std::filesystem::path file_;
  std::optional<OutputFile> output_;
  std::vector<std::string> names_;
  std::string buffer_;
  std::size_t rows_ = 0;
};

}  // namespace tomlin
