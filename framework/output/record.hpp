#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "framework/output/output_file.hpp"

/// Records of the binary files that a run resumes from. A record is a head (magic number, kind,
/// length of the content), the content, and the XXH3-64 checksum of both, seeded with the checksum
/// of the record before it: what was swapped, dropped or taken from another file is noticed like
/// what was changed. Numbers are in the byte order of the machine, which the magic number shows.
namespace tomlin {

/// A file that is not what a run has left; the message names the file and says what is wrong.
class DamagedFile : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One that ends too early.
class TruncatedFile : public DamagedFile {
 public:
  using DamagedFile::DamagedFile;
};

enum class RecordKind : std::uint32_t {
  journal = 1,
  rows = 2,
  events = 3,
  checkpoint = 4,
  store = 5,
  sweep = 6
};

inline constexpr std::size_t kRecordHead = 16;      ///< bytes in front of the content
inline constexpr std::size_t kRecordChecksum = 8;   ///< bytes behind it
inline constexpr std::uint64_t kFirstChecksum = 0;  ///< the seed of a file's first record

/// Puts a record together. Content within the capacity allocates nothing.
class RecordWriter {
 public:
  explicit RecordWriter(RecordKind kind, std::size_t capacity = 0);

  template <class Number>
  void number(Number x) {
    static_assert(std::is_trivially_copyable_v<Number>);
    append(&x, sizeof x);
  }
  void text(std::string_view text);
  void numbers(std::span<const double> numbers);
  void bytes(std::span<const std::byte> bytes);

  /// Bytes of content so far.
  std::size_t size() const { return content().size(); }
  /// The content alone, for what is stored within another record.
  std::span<const std::byte> content() const { return std::span(bytes_).subspan(kRecordHead); }
  /// The whole record, until anything is added. `checksum`: of the record before, then of this one.
  std::span<const std::byte> seal(std::uint64_t& checksum);
  /// An empty record of the same kind.
  void clear();

 private:
  void append(const void* data, std::size_t size);

  std::vector<std::byte> bytes_;
};

/// Takes a record's content apart. Throws DamagedFile where there is less than is asked for.
class RecordReader {
 public:
  /// `file` stands in messages.
  RecordReader(std::string file, std::span<const std::byte> content)
      : file_(std::move(file)), rest_(content) {}

  template <class Number>
  Number number() {
    static_assert(std::is_trivially_copyable_v<Number>);
    Number x;
    std::memcpy(&x, take(sizeof x).data(), sizeof x);
    return x;
  }
  std::string text();
  /// A number of things that take at least so many bytes each, and so cannot be absurd.
  std::uint64_t count(std::size_t least_bytes);
  void numbers(std::span<double> numbers);
  std::span<const std::byte> bytes();
  std::size_t left() const { return rest_.size(); }
  /// Reads the version of the file's format. Throws unless it is this one.
  void require_format(std::uint32_t format);
  /// Throws when something is left.
  void end() const;
  [[noreturn]] void refuse(const std::string& why) const;

 private:
  std::span<const std::byte> take(std::size_t size);

  std::string file_;
  std::span<const std::byte> rest_;
};

/// A record's head as it stands in a file.
struct RecordHead {
  RecordKind kind;
  std::uint64_t length;  ///< bytes of content
};

/// Takes kRecordHead bytes. Throws DamagedFile when they are no record's head.
RecordHead record_head(const std::string& file, std::span<const std::byte> bytes);

/// The content of one whole record; `checksum` as in RecordWriter::seal(). Throws DamagedFile.
std::span<const std::byte> record_content(const std::string& file, std::span<const std::byte> whole,
                                          std::uint64_t& checksum);

/// Reads the records of a file from its start, one after another: the file may be larger than
/// memory. Everything throws DamagedFile; TruncatedFile where the file ends too early and nothing
/// else is wrong.
class RecordFile {
 public:
  explicit RecordFile(const std::filesystem::path& file);
  /// `opened` is the file of this name.
  RecordFile(const std::filesystem::path& file, Descriptor opened);

  const std::string& name() const { return name_; }
  /// Bytes in the file.
  std::uint64_t size() const { return size_; }
  /// The offset of the next record.
  std::uint64_t position() const { return position_; }
  /// The checksum of the record before it.
  std::uint64_t checksum() const { return checksum_; }

  /// The head of the next record, which stays the next one.
  RecordHead next_head() const;
  /// The content of the next record, of which this is the head; valid until the next call.
  std::span<const std::byte> next(const RecordHead& head);
  /// All bytes from the next record to the end of the file.
  std::vector<std::byte> rest() const;
  [[noreturn]] void refuse(const std::string& why) const;

 private:
  void read(std::span<std::byte> bytes) const;
  [[noreturn]] void refuse_truncated() const;

  std::string name_;
  Descriptor descriptor_;
  std::uint64_t size_ = 0;
  std::uint64_t position_ = 0;
  std::uint64_t checksum_ = kFirstChecksum;
  std::vector<std::byte> record_;
};

/// All of a file that holds one record, which is not looked into; takes no more memory than the
/// file does. Throws DamagedFile.
std::vector<std::byte> read_record_file(const std::filesystem::path& file);

/// The content of `bytes`, which are one record of this kind: all of a file. `file` is for
/// messages. Throws DamagedFile.
RecordReader only_record(const std::string& file, std::span<const std::byte> bytes,
                         RecordKind kind);

/// Replaces the file of this name by one of this record alone, whole or not at all. Throws
/// OutputError.
void write_record_file(const std::filesystem::path& file, RecordWriter& record,
                       OutputFile::Lasting lasting);

}  // namespace tomlin
