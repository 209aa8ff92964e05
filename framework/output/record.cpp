#include "framework/output/record.hpp"

#include <cerrno>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include "framework/output/checksum.hpp"
#include "framework/output/descriptor.hpp"

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

std::vector<std::byte> read_record_file(const std::filesystem::path& file) {
  const auto refuse = [&file](const std::string& why) {
    throw DamagedFile(fmt::format("{}: {}", file.string(), why));
  };
  const Descriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat status = {};
  if (!descriptor.open() || ::fstat(descriptor.number(), &status) != 0) {
    refuse("cannot be read: " + std::generic_category().message(errno));
  }
  if (!S_ISREG(status.st_mode)) refuse("not a file");
  // A file of another length than its head says is not read at all.
  std::byte head[kRecordHead];
  const auto size = static_cast<std::uint64_t>(status.st_size);
  if (read_at(descriptor, head, 0) < static_cast<std::ptrdiff_t>(sizeof head) ||
      record_head(file.string(), head).length + kRecordHead + kRecordChecksum > size) {
    refuse("truncated");
  }
  std::vector<std::byte> bytes(static_cast<std::size_t>(status.st_size));
  const std::ptrdiff_t got = read_at(descriptor, bytes, 0);
  if (got < 0) {
    refuse("cannot be read: " + std::generic_category().message(static_cast<int>(-got)));
  }
  bytes.resize(static_cast<std::size_t>(got));
  return bytes;
}

}  // namespace tomlin
