#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "framework/output/descriptor.hpp"
#include "framework/output/lock_file.hpp"
#include "framework/output/output_file.hpp"
#include "framework/output/record.hpp"
#include "framework/run/run.hpp"

/// The journal: every sample and event of a run in a file that is only ever appended to, in checked
/// records. Tables are made from it when the run ends; a run that was stopped resumes from a
/// checkpoint, which knows how far the journal had come.
namespace tomlin {

/// The journal's data on its run.
struct JournalHeader {
  std::string program_version;
  std::string scene;  ///< the effective scene
  RunLayout layout;
};

/// A position between two records. Two journals with the same mark agree in every byte before it.
struct JournalMark {
  std::uint64_t bytes = 0;
  std::uint64_t checksum = kFirstChecksum;  ///< of the record before, and through it of all
  std::uint64_t rows = 0;
  std::uint64_t events = 0;

  friend bool operator==(const JournalMark&, const JournalMark&) = default;
};

/// Bytes that a row takes in a journal, with its part of the record that it stands in.
double journal_bytes_per_row(const RunLayout& layout);

/// Another program writes this journal.
class JournalInUse : public OutputError {
 public:
  using OutputError::OutputError;
};

/// The file beside a journal that stands for its lock where the file system has none.
inline constexpr const char* kLockFile = "run.lock";

enum class Absent { make_it, leave_it };

/// The journal of this name, opened for writing; whoever has it has the folder. Where there is none
/// it is made, empty, or what comes back is not open. Throws JournalInUse or OutputError.
/// `instead` is the guard where the file system has no locks; null: there is none.
Descriptor own_journal(const std::filesystem::path& file, Absent absent,
                       LockFile* instead = nullptr);

/// Appends to a journal, which no other program may write to meanwhile. Everything throws
/// OutputError; after that nothing more can be written.
class JournalWriter {
 public:
  /// A new journal in an owned file; what stands there is dropped.
  JournalWriter(std::filesystem::path file, Descriptor owned, const JournalHeader& header);
  /// Goes on behind `mark`; what comes after it is dropped.
  JournalWriter(std::filesystem::path file, Descriptor owned, const RunLayout& layout,
                const JournalMark& mark);

  /// RunLayout::row() numbers. Costs a copy; a block of rows is written when it is full.
  void row(std::span<const double> row);
  void event(const Event& event);
  /// All that have come so far.
  std::uint64_t events() const { return events_; }
  /// Writes out what has come so far and says how far that is.
  JournalMark flush();
  /// Makes flushed rows outlive a power cut.
  void synchronise();

 private:
  void write(RecordWriter& record);
  void write_rows();
  void write_events();
  [[noreturn]] void fail(int error) const;

  std::filesystem::path file_;
  Descriptor descriptor_;
  JournalMark mark_;            ///< of what is in the file
  std::size_t row_length_ = 0;  ///< numbers
  std::uint64_t rows_ = 0;      ///< with those that are not written yet
  std::uint64_t events_ = 0;
  RecordWriter row_block_;
  RecordWriter event_block_;
  bool broken_ = false;
};

/// Reads a journal (see RecordFile). Whatever the file holds, it is read to the first fault and no
/// further. Everything throws DamagedFile, or TruncatedFile.
class JournalReader {
 public:
  /// Reads the header.
  explicit JournalReader(const std::filesystem::path& file);

  const JournalHeader& header() const { return header_; }
  /// The position up to which everything was read and found right; at first, behind the header.
  JournalMark mark() const { return {records_.position(), records_.checksum(), rows_, events_}; }
  /// Bytes in the file.
  std::uint64_t size() const { return records_.size(); }

  /// Sends everything up to `end` bytes to the sink as the run did: begin(), samples and events
  /// each in their order, though not always in the same order between each other. Names of events
  /// live as long as this reader. Once only.
  void play(RunSink& sink, std::uint64_t end = std::numeric_limits<std::uint64_t>::max());

 private:
  void play_rows(std::span<const std::byte> content, RunSink& sink);
  void play_events(std::span<const std::byte> content, RunSink& sink);

  RecordFile records_;
  JournalHeader header_;
  std::uint64_t rows_ = 0;
  std::uint64_t events_ = 0;
  std::vector<double> row_;
  std::set<std::string, std::less<>> names_;
};

}  // namespace tomlin
