#include "framework/study/sweep/sweep_journal.hpp"

#include <algorithm>
#include <cerrno>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include "framework/output/checksum.hpp"
#include "framework/output/record.hpp"

namespace tomlin {
namespace {

constexpr std::uint32_t kSweepFormat = 2;
constexpr std::size_t kRecordsReadAtOnce = 4096;
constexpr std::size_t kLongestReason = 2000;  // bytes
constexpr std::size_t kWordBits = 64;

struct SweepHeader {
  std::string version;
  std::uint64_t identity = 0;
  std::uint64_t points = 0;
  std::uint64_t columns = 0;
};

/// The start of a record, in front of its numbers.
struct SweepRecordStart {
  std::uint64_t point = 0;
  std::uint64_t status = 0;
  std::uint64_t warnings[kMostWarningCodes / kWordBits] = {};
  std::uint64_t reason_at = 0;
  std::uint64_t reason_size = 0;
  std::uint64_t reason_checksum = 0;
};

SweepHeader header_of(const SweepPlan& plan) {
  return {plan.program_version(), plan.identity(), plan.point_numbers(), plan.columns().size()};
}

RecordWriter record_of(const SweepHeader& header) {
  RecordWriter record(RecordKind::sweep);
  record.number(kSweepFormat);
  record.text(header.version);
  record.number(header.identity);
  record.number(header.points);
  record.number(header.columns);
  return record;
}

std::size_t size_of(const Descriptor& file) {
  struct stat status = {};
  return ::fstat(file.number(), &status) == 0 ? static_cast<std::size_t>(status.st_size) : 0;
}

/// More than any header has.
constexpr std::size_t kLongestHeader = 4096;  // bytes

/// Returns nothing where the file ends before its header does: then there is no record either.
std::optional<SweepHeader> header_in(RecordFile file) try {
  const RecordHead head = file.next_head();
  if (head.kind != RecordKind::sweep) file.refuse("not a journal of a sweep");
  RecordReader record(file.name(), file.next(head));
  record.require_format(kSweepFormat);
  SweepHeader header;
  header.version = record.text();
  header.identity = record.number<std::uint64_t>();
  header.points = record.number<std::uint64_t>();
  header.columns = record.number<std::uint64_t>();
  record.end();
  return header;
} catch (const TruncatedFile&) {
  if (file.size() > kLongestHeader) file.refuse("its header is damaged");
  return std::nullopt;
}

}  // namespace

SweepJournal::Found SweepJournal::look(const std::filesystem::path& file, const SweepPlan& plan) {
  Descriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW));
  if (!descriptor.open() && errno == ENOENT) return Found::nothing;
  if (!descriptor.open()) {
    throw DamagedFile(fmt::format("{}: cannot be read: {}", file.string(),
                                  std::generic_category().message(errno)));
  }
  const auto header = header_in(RecordFile(file, std::move(descriptor)));
  if (!header) return Found::nothing;
  const SweepHeader expected = header_of(plan);
  if (header->version != expected.version) return Found::other_version;
  const bool same = header->identity == expected.identity && header->points == expected.points &&
                    header->columns == expected.columns;
  return same ? Found::same_sweep : Found::other_sweep;
}

SweepJournal::SweepJournal(std::filesystem::path file, const SweepPlan& plan, Use use)
    : file_(std::move(file)), columns_(plan.columns().size()), has_(plan.point_numbers() + 1, 0) {
  RecordWriter header = record_of(header_of(plan));
  seed_ = kFirstChecksum;
  const auto bytes = header.seal(seed_);
  records_at_ = bytes.size();
  record_size_ =
      kRecordHead + sizeof(SweepRecordStart) + columns_ * sizeof(double) + kRecordChecksum;

  Found found = Found::nothing;
  try {
    found = look(file_, plan);
  } catch (const DamagedFile& error) {
    throw OutputError(error.what());
  }
  const bool same = found == Found::same_sweep;
  if (!same && (use == Use::read || found != Found::nothing)) fail(EINVAL);
  const int how = use == Use::read ? O_RDONLY : O_RDWR | O_CREAT;
  descriptor_ = Descriptor(::open(file_.c_str(), how | O_CLOEXEC | O_NOFOLLOW, 0666));
  if (!descriptor_.open()) fail(errno);
  if (!same) {
    if (const int error = write_at(descriptor_, bytes, 0)) fail(error);
  }
  end_ = std::max(offset_of(has_.size()), size_of(descriptor_));
  if (same) find_rows();
}

void SweepJournal::keep(std::size_t point, const SweepRow& row) {
  SweepRecordStart start;
  start.point = point;
  start.status = static_cast<std::uint64_t>(row.status);
  for (std::size_t k = 0; k < kMostWarningCodes; ++k) {
    if (row.warnings[k]) start.warnings[k / kWordBits] |= std::uint64_t{1} << (k % kWordBits);
  }
  std::string_view reason = row.reason;
  if (reason.size() > kLongestReason) {
    // The cut is not within a character of UTF-8.
    std::size_t end = kLongestReason;
    while (end > 0 && (static_cast<unsigned char>(reason[end]) & 0xC0U) == 0x80U) --end;
    reason = reason.substr(0, end);
  }
  const std::lock_guard lock(mutex_);
  if (!reason.empty()) {
    const auto bytes = std::as_bytes(std::span(reason));
    start.reason_at = end_;
    start.reason_size = bytes.size();
    start.reason_checksum = checksum_of(bytes, seed_);
    if (const int error = write_at(descriptor_, bytes, end_)) fail(error);
    end_ += bytes.size();
  }
  RecordWriter record(RecordKind::sweep, record_size_);
  record.number(start);
  record.numbers(row.numbers);
  std::uint64_t checksum = seed_;
  if (const int error = write_at(descriptor_, record.seal(checksum), offset_of(point))) fail(error);
  has_[point] = 1;
}

std::optional<SweepStatus> SweepJournal::ended() const {
  if (has_.back() == 0) return std::nullopt;
  SweepRow of_all;
  read(has_.size() - 1, {&of_all, 1});
  return of_all.status;
}

void SweepJournal::complete(SweepStatus status) {
  SweepRow of_all;
  of_all.status = status;
  of_all.numbers.assign(columns_, 0.0);
  keep(has_.size() - 1, of_all);
}

bool SweepJournal::decode(std::size_t point, std::span<const std::byte> record,
                          SweepRow& row) const {
  // A record that was never written is read as zeros.
  const auto head = record.first(kRecordHead);
  if (std::all_of(head.begin(), head.end(), [](std::byte b) { return b == std::byte{0}; })) {
    return false;
  }
  try {
    std::uint64_t checksum = seed_;
    RecordReader reader(file_.string(), record_content(file_.string(), record, checksum));
    const auto start = reader.number<SweepRecordStart>();
    if (start.point != point || start.status >= kSweepStatuses) return false;
    row.status = static_cast<SweepStatus>(start.status);
    row.numbers.resize(columns_);
    reader.numbers(row.numbers);
    for (std::size_t k = 0; k < kMostWarningCodes; ++k) {
      row.warnings[k] = (start.warnings[k / kWordBits] >> (k % kWordBits) & 1U) != 0;
    }
    if (start.reason_size > kLongestReason) return false;
    row.reason.resize(start.reason_size);
    if (row.reason.empty()) return true;
    const auto bytes = std::as_writable_bytes(std::span(row.reason));
    return read_at(descriptor_, bytes, start.reason_at) ==
               static_cast<std::ptrdiff_t>(bytes.size()) &&
           checksum_of(bytes, seed_) == start.reason_checksum;
  } catch (const DamagedFile&) {
    return false;
  }
}

void SweepJournal::find_rows() {
  std::vector<std::byte> block(std::min(kRecordsReadAtOnce, has_.size()) * record_size_);
  SweepRow row;
  for (std::size_t first = 0; first < has_.size(); first += kRecordsReadAtOnce) {
    const std::ptrdiff_t got = read_at(descriptor_, block, offset_of(first));
    if (got < 0) fail(static_cast<int>(-got));
    if (got == 0) return;
    const std::size_t whole = static_cast<std::size_t>(got) / record_size_;
    const std::size_t count = std::min(whole, has_.size() - first);
    for (std::size_t k = 0; k < count; ++k) {
      const auto record = std::span(block).subspan(k * record_size_, record_size_);
      has_[first + k] = decode(first + k, record, row) ? 1 : 0;
    }
  }
}

void SweepJournal::read(std::size_t first, std::span<SweepRow> rows) const {
  std::vector<std::byte> block(rows.size() * record_size_);
  const std::ptrdiff_t got = read_at(descriptor_, block, offset_of(first));
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto record = std::span(block).subspan(k * record_size_, record_size_);
    if (got < static_cast<std::ptrdiff_t>((k + 1) * record_size_) ||
        !decode(first + k, record, rows[k])) {
      throw DamagedFile(
          fmt::format("{}: the row of point {} is missing", file_.string(), first + k));
    }
  }
}

void SweepJournal::fail(int error) const { throw OutputError(file_, error); }

}  // namespace tomlin
