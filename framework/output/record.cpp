#include "framework/output/record.hpp"

#include <cerrno>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include "framework/output/checksum.hpp"

namespace tomlin {
namespace {

constexpr std::uint32_t kMagic = 0x52'4d'4f'54;  // "TOMR" in a file of a little-endian machine
constexpr std::uint32_t kMagicSwapped = 0x54'4f'4d'52;  // as seen by the other kind

struct Head {
  std::uint32_t magic;
  RecordKind kind;
  std::uint64_t length;
};
static_assert(sizeof(Head) == kRecordHead && sizeof(std::uint64_t) == kRecordChecksum);

}  // namespace

RecordWriter::RecordWriter(RecordKind kind, std::size_t capacity) {
  bytes_.reserve(kRecordHead + capacity + kRecordChecksum);
  number(Head{kMagic, kind, 0});
}

void RecordWriter::append(const void* data, std::size_t size) {
  if (size == 0) return;
  const std::size_t before = bytes_.size();
  bytes_.resize(before + size);
  std::memcpy(bytes_.data() + before, data, size);
}

void RecordWriter::text(std::string_view text) { bytes(std::as_bytes(std::span(text))); }

void RecordWriter::numbers(std::span<const double> numbers) {
  append(numbers.data(), numbers.size_bytes());
}

void RecordWriter::bytes(std::span<const std::byte> bytes) {
  number(static_cast<std::uint64_t>(bytes.size()));
  append(bytes.data(), bytes.size());
}

std::span<const std::byte> RecordWriter::seal(std::uint64_t& checksum) {
  const std::uint64_t length = size();
  std::memcpy(bytes_.data() + offsetof(Head, length), &length, sizeof length);
  checksum = checksum_of(bytes_, checksum);
  number(checksum);
  return bytes_;
}

void RecordWriter::clear() { bytes_.resize(kRecordHead); }

std::string RecordReader::text() {
  const auto content = bytes();
  return {reinterpret_cast<const char*>(content.data()), content.size()};
}

std::uint64_t RecordReader::count(std::size_t least_bytes) {
  const auto count = number<std::uint64_t>();
  if (count > left() / least_bytes) refuse("a list is longer than its record");
  return count;
}

void RecordReader::numbers(std::span<double> numbers) {
  const auto content = take(numbers.size_bytes());
  if (!content.empty()) std::memcpy(numbers.data(), content.data(), content.size());
}

std::span<const std::byte> RecordReader::bytes() { return take(count(1)); }

std::span<const std::byte> RecordReader::take(std::size_t size) {
  if (size > left()) refuse("a record ends too early");
  const auto taken = rest_.first(size);
  rest_ = rest_.subspan(size);
  return taken;
}

void RecordReader::require_format(std::uint32_t format) {
  const auto found = number<std::uint32_t>();
  if (found != format) {
    refuse(fmt::format("its format is {}, this program's is {}", found, format));
  }
}

void RecordReader::end() const {
  if (left() > 0) refuse("a record continues past its end");
}

void RecordReader::refuse(const std::string& why) const {
  throw DamagedFile(fmt::format("{}: {}", file_, why));
}

RecordHead record_head(const std::string& file, std::span<const std::byte> bytes) {
  RecordReader reader(file, bytes);
  const auto head = reader.number<Head>();
  if (head.magic == kMagicSwapped) reader.refuse("written on a machine of the other byte order");
  if (head.magic != kMagic) reader.refuse("corrupted: a record is missing");
  return {head.kind, head.length};
}

std::span<const std::byte> record_content(const std::string& file, std::span<const std::byte> whole,
                                          std::uint64_t& checksum) {
  RecordReader reader(file, whole);
  if (whole.size() < kRecordHead + kRecordChecksum) reader.refuse("truncated");
  const RecordHead head = record_head(file, whole.first(kRecordHead));
  const std::uint64_t length = whole.size() - kRecordHead - kRecordChecksum;
  if (head.length > length) reader.refuse("truncated");
  if (head.length < length) reader.refuse("corrupted: there is more in it than there should be");
  std::uint64_t stored = 0;
  std::memcpy(&stored, whole.last(kRecordChecksum).data(), sizeof stored);
  const std::uint64_t found = checksum_of(whole.first(kRecordHead + length), checksum);
  if (found != stored) reader.refuse("corrupted: a checksum is wrong");
  checksum = found;
  return whole.subspan(kRecordHead, length);
}

RecordFile::RecordFile(const std::filesystem::path& file)
    : RecordFile(file, Descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK))) {}

RecordFile::RecordFile(const std::filesystem::path& file, Descriptor opened)
    : name_(file.string()), descriptor_(std::move(opened)) {
  struct stat status = {};
  if (!descriptor_.open() || ::fstat(descriptor_.number(), &status) != 0) {
    refuse("cannot be read: " + std::generic_category().message(errno));
  }
  if (!S_ISREG(status.st_mode)) refuse("not a file");
  size_ = static_cast<std::uint64_t>(status.st_size);
}

RecordHead RecordFile::next_head() const {
  std::byte bytes[kRecordHead];
  read(bytes);
  return record_head(name_, bytes);
}

std::span<const std::byte> RecordFile::next(const RecordHead& head) {
  constexpr std::size_t kAround = kRecordHead + kRecordChecksum;
  const std::uint64_t left = size_ - position_;
  if (left < kAround || head.length > left - kAround) refuse_truncated();
  record_.resize(kAround + head.length);
  read(record_);
  const auto content = record_content(name_, record_, checksum_);
  position_ += record_.size();
  return content;
}

std::vector<std::byte> RecordFile::rest() const {
  std::vector<std::byte> bytes(size_ - position_);
  read(bytes);
  return bytes;
}

void RecordFile::read(std::span<std::byte> bytes) const {
  const std::ptrdiff_t got = read_at(descriptor_, bytes, position_);
  if (got < 0) refuse("cannot be read: " + std::generic_category().message(static_cast<int>(-got)));
  if (static_cast<std::size_t>(got) < bytes.size()) refuse_truncated();
}

void RecordFile::refuse_truncated() const {
  throw TruncatedFile(
      fmt::format("{}: truncated: it ends in the record at byte {}", name_, position_));
}

void RecordFile::refuse(const std::string& why) const {
  throw DamagedFile(fmt::format("{}: {}", name_, why));
}

std::vector<std::byte> read_record_file(const std::filesystem::path& file) {
  const RecordFile record(file);
  // A file of another length than its head says is not read at all.
  if (record.next_head().length > record.size()) record.refuse("truncated");
  return record.rest();
}

RecordReader only_record(const std::string& file, std::span<const std::byte> bytes,
                         RecordKind kind) {
  std::uint64_t checksum = kFirstChecksum;
  RecordReader record(file, record_content(file, bytes, checksum));
  if (record_head(file, bytes.first(kRecordHead)).kind != kind) {
    record.refuse("a file of another kind");
  }
  return record;
}

void write_record_file(const std::filesystem::path& file, RecordWriter& record,
                       OutputFile::Lasting lasting) {
  std::uint64_t checksum = kFirstChecksum;
  OutputFile output(file);
  output.append(record.seal(checksum));
  output.publish(lasting);
}

}  // namespace tomlin
