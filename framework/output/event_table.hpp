#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/records/unit_system.hpp"
#include "framework/output/output_file.hpp"
#include "framework/output/result_file.hpp"

namespace tomlin {

/// Writes events as comma-separated values, one row each, with 17 significant digits; what a kind
/// of event has no number for is left empty. The size of a turn is in turns, of the rest a length.
class EventTable : public ResultFile {
 public:
  /// Nothing is opened before the run begins, and nothing ever where no events can happen.
  explicit EventTable(std::filesystem::path file, UnitSystem units = UnitSystem::reduced);

  void begin(const RunLayout& layout) override;
  void sample(const std::vector<double>& row) override { (void)row; }
  void event(const Event& event) override;
  void finish() override;

 private:
  std::filesystem::path file_;
  UnitSystem units_;
  std::optional<OutputFile> output_;
  std::string buffer_;
};

}  // namespace tomlin
