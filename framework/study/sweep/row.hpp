#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "framework/core/text/words.hpp"

namespace tomlin {

/// How the run of a point ended.
enum class SweepStatus : std::uint8_t {
  finished,
  failed,   ///< on the way
  refused,  ///< as input
};

constexpr auto word_table(SweepStatus) {
  using enum SweepStatus;
  return std::to_array<Word<SweepStatus>>(
      {{finished, "finished"}, {failed, "failed"}, {refused, "refused"}});
}

inline constexpr std::size_t kSweepStatuses = kWordTable<SweepStatus>.size();

/// More than there are codes of diagnostics.
inline constexpr std::size_t kMostWarningCodes = 128;

/// The results that are kept of one point.
struct SweepRow {
  SweepStatus status = SweepStatus::finished;
  std::vector<double> numbers;  ///< [column] of the plan; NaN where undefined
  std::string reason;           ///< one line, where it has not finished
  /// The warnings of the run, by FaultCode.
  std::bitset<kMostWarningCodes> warnings;
};

/// Keeps rows while a sweep goes on. Safe to call from several threads.
class SweepRows {
 public:
  virtual ~SweepRows() = default;
  /// Whether a point has a row. It is not called while this row is kept.
  virtual bool has(std::size_t point) const = 0;
  /// Throws OutputError.
  virtual void keep(std::size_t point, const SweepRow& row) = 0;

 protected:
  SweepRows() = default;
};

}  // namespace tomlin
