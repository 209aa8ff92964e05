#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "framework/output/descriptor.hpp"
#include "framework/output/output_file.hpp"
#include "framework/study/sweep/row.hpp"
#include "framework/study/sweep/sweep_plan.hpp"

namespace tomlin {

/// The rows of a sweep in a file: a header, then a record of fixed size for each number of a point
/// at its own offset, then one of the whole sweep once it is over, then the reasons of those that
/// have not finished. A record is seeded with the checksum of the header and holds the number of
/// its point: one of another sweep, of another point, or that was written in part only, is no
/// record, and its point is run again. Offsets that were never written take no room on the disk.
class SweepJournal : public SweepRows {
 public:
  enum class Found { nothing, same_sweep, other_sweep, other_version };
  enum class Use { go_on, read };

  /// Returns the records of a file, which is left as it is. Throws DamagedFile, also where it is
  /// there and cannot be read.
  static Found look(const std::filesystem::path& file, const SweepPlan& plan);

  /// Goes on with the file where it is of the same sweep, and begins one where there is nothing. A
  /// file of anything else is left as it is. To be read only, it must be of the same sweep. Throws
  /// OutputError.
  SweepJournal(std::filesystem::path file, const SweepPlan& plan, Use use = Use::go_on);

  bool has(std::size_t point) const override { return has_[point] != 0; }
  /// Records that the sweep is over: all its points have a row, and none will be added. Its status
  /// is `refused` where all of them are.
  void complete(SweepStatus status);
  /// The record of a sweep that is over; nothing: it is not.
  std::optional<SweepStatus> ended() const;
  void keep(std::size_t point, const SweepRow& row) override;

  /// The rows of these points, which are there. Throws DamagedFile.
  void read(std::size_t first, std::span<SweepRow> rows) const;

 private:
  std::size_t offset_of(std::size_t point) const { return records_at_ + point * record_size_; }
  bool decode(std::size_t point, std::span<const std::byte> record, SweepRow& row) const;
  void find_rows();
  [[noreturn]] void fail(int error) const;

  std::filesystem::path file_;
  Descriptor descriptor_;
  std::size_t columns_ = 0;
  std::uint64_t seed_ = 0;         ///< of the records: the header's checksum
  std::size_t records_at_ = 0;     ///< bytes
  std::size_t record_size_ = 0;    ///< likewise
  std::vector<std::uint8_t> has_;  ///< [point], and of the whole sweep
  std::mutex mutex_;
  std::size_t end_ = 0;  ///< of the file, where the next reason goes
};

}  // namespace tomlin
