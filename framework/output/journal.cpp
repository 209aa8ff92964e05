#include "framework/output/journal.hpp"

#include <algorithm>
#include <cerrno>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

namespace tomlin {
namespace fs = std::filesystem;
namespace {

constexpr std::uint32_t kJournalFormat = 1;
constexpr std::size_t kRecordBytes = std::size_t{1} << 16;  // of samples or events
/// An event without its name.
constexpr std::size_t kEventBytes =
    sizeof(std::uint32_t) + sizeof(std::uint64_t) + 5 * sizeof(double);

std::size_t row_bytes(const RunLayout& layout) { return layout.row() * sizeof(double); }

/// A block holds a row at least.
std::size_t row_block(const RunLayout& layout) {
  return std::max(kRecordBytes, sizeof(std::uint64_t) + row_bytes(layout));
}

void append_species(const RunLayout& layout, RecordWriter& record) {
  record.number(static_cast<std::uint64_t>(layout.species.size()));
  for (const std::string& name : layout.species) record.text(name);
  for (const TrajectoryBody& body : layout.bodies) {
    record.number(static_cast<std::uint64_t>(body.species.size()));
    for (const std::int32_t species : body.species) record.number(species);
  }
}

RecordWriter header_record(const JournalHeader& header) {
  RecordWriter record(RecordKind::journal);
  record.number(kJournalFormat);
  record.text(header.program_version);
  record.text(header.scene);
  const RunLayout& layout = header.layout;
  record.number(static_cast<std::uint64_t>(layout.columns.size()));
  for (const SampleColumn& column : layout.columns) {
    record.text(column.name);
    record.text(column.unit);
  }
  record.number(static_cast<std::uint64_t>(layout.bodies.size()));
  for (const TrajectoryBody& body : layout.bodies) {
    record.text(body.name);
    record.number(static_cast<std::uint64_t>(body.mass.size()));
    record.numbers(body.mass);
  }
  record.number(static_cast<std::int32_t>(layout.dimension));
  record.number(static_cast<std::uint64_t>(layout.box.size()));
  record.numbers(layout.box);
  record.number(static_cast<std::uint64_t>(layout.periodic.size()));
  for (const bool periodic : layout.periodic) record.number(static_cast<std::uint8_t>(periodic));
  record.number(static_cast<std::uint8_t>(layout.events));
  record.text(layout.state);
  if (!layout.species.empty()) append_species(layout, record);
  return record;
}

/// One for each particle of a body that has species, and each with a name.
bool has_valid_species(const RunLayout& layout) {
  return std::all_of(layout.bodies.begin(), layout.bodies.end(), [&](const TrajectoryBody& body) {
    const auto is_named = [&](std::int32_t species) {
      return species >= 0 && static_cast<std::size_t>(species) < layout.species.size();
    };
    return (body.species.empty() || body.species.size() == body.mass.size()) &&
           std::all_of(body.species.begin(), body.species.end(), is_named);
  });
}

void read_species(RecordReader& record, RunLayout& layout) {
  layout.species.resize(record.count(sizeof(std::uint64_t)));
  for (std::string& name : layout.species) name = record.text();
  for (TrajectoryBody& body : layout.bodies) {
    body.species.resize(record.count(sizeof(std::int32_t)));
    for (std::int32_t& species : body.species) species = record.number<std::int32_t>();
  }
  if (!has_valid_species(layout)) record.refuse("no such species");
}

JournalHeader header_in(RecordReader record) {
  JournalHeader header;
  record.require_format(kJournalFormat);
  header.program_version = record.text();
  header.scene = record.text();
  RunLayout& layout = header.layout;
  constexpr std::size_t kText = sizeof(std::uint64_t);  // an empty one
  layout.columns.resize(record.count(2 * kText));
  for (SampleColumn& column : layout.columns) {
    column.name = record.text();
    column.unit = record.text();
  }
  layout.bodies.resize(record.count(2 * kText));
  for (TrajectoryBody& body : layout.bodies) {
    body.name = record.text();
    body.mass.resize(record.count(sizeof(double)));
    record.numbers(body.mass);
  }
  layout.dimension = record.number<std::int32_t>();
  if (layout.dimension < 0 || layout.dimension > 3) record.refuse("no such dimension");
  layout.box.resize(record.count(sizeof(double)));
  record.numbers(layout.box);
  layout.periodic.resize(record.count(sizeof(std::uint8_t)));
  for (std::size_t k = 0; k < layout.periodic.size(); ++k) {
    layout.periodic[k] = record.number<std::uint8_t>() != 0;
  }
  layout.events = record.number<std::uint8_t>() != 0;
  layout.state = record.text();
  if (record.left() > 0) read_species(record, layout);
  record.end();
  return header;
}

}  // namespace

double journal_bytes_per_row(const RunLayout& layout) {
  constexpr std::size_t kAround = kRecordHead + kRecordChecksum + sizeof(std::uint64_t);
  const std::size_t row = std::max<std::size_t>(1, row_bytes(layout));
  const std::size_t rows = std::max<std::size_t>(1, (kRecordBytes - sizeof(std::uint64_t)) / row);
  return static_cast<double>(row) + static_cast<double>(kAround) / static_cast<double>(rows);
}

Descriptor own_journal(const fs::path& file, Absent absent, LockFile* instead) {
  const int flags = O_RDWR | O_NOFOLLOW | O_CLOEXEC | (absent == Absent::make_it ? O_CREAT : 0);
  Descriptor journal(::open(file.c_str(), flags, 0666));
  if (!journal.open()) {
    if (errno == ENOENT && absent == Absent::leave_it) return journal;
    throw OutputError(file, errno);
  }
  const LockOutcome outcome = lock(journal);
  if (outcome == LockOutcome::held || !is_at(journal, file)) {
    throw JournalInUse(fmt::format("{}: another run is writing here", file.string()));
  }
  if (outcome == LockOutcome::taken || instead == nullptr || instead->taken()) return journal;
  const fs::path lock_file = file.parent_path() / kLockFile;
  const std::string holder = instead->take(lock_file);
  if (holder.empty()) return journal;
  throw JournalInUse(
      fmt::format("{} is writing here, as {} says; if it has ended, remove that file", holder,
                  lock_file.string()));
}

JournalWriter::JournalWriter(fs::path file, Descriptor owned, const JournalHeader& header)
    : JournalWriter(std::move(file), std::move(owned), header.layout, JournalMark()) {
  RecordWriter record = header_record(header);
  write(record);
}

JournalWriter::JournalWriter(fs::path file, Descriptor owned, const RunLayout& layout,
                             const JournalMark& mark)
    : file_(std::move(file)),
      descriptor_(std::move(owned)),
      mark_(mark),
      row_length_(layout.row()),
      rows_(mark.rows),
      events_(mark.events),
      row_block_(RecordKind::rows, row_block(layout)),
      event_block_(RecordKind::events, kRecordBytes) {
  const auto end = static_cast<off_t>(mark.bytes);
  if (::ftruncate(descriptor_.number(), end) != 0) fail(errno);
  if (::lseek(descriptor_.number(), end, SEEK_SET) != end) fail(errno);
}

void JournalWriter::row(std::span<const double> row) {
  if (row.size() != row_length_) {
    throw OutputError(fmt::format("{}: a sample of {} numbers where {} are expected",
                                  file_.string(), row.size(), row_length_));
  }
  if (row_block_.size() > 0 && row_block_.size() + row.size_bytes() > kRecordBytes) write_rows();
  if (row_block_.size() == 0) row_block_.number(rows_);
  row_block_.numbers(row);
  ++rows_;
}

void JournalWriter::event(const Event& event) {
  if (event_block_.size() > 0 &&
      event_block_.size() + kEventBytes + event.name.size() + event.label.size() > kRecordBytes) {
    write_events();
  }
  if (event_block_.size() == 0) event_block_.number(events_);
  event_block_.number(static_cast<std::uint32_t>(event.kind));
  event_block_.text(event.name);
  if (event.kind == EventKind::observed) event_block_.text(event.label);
  for (const double x :
       {event.time, event.duration, event.size, event.energy_lost, event.peak_force}) {
    event_block_.number(x);
  }
  ++events_;
}

JournalMark JournalWriter::flush() {
  write_rows();
  write_events();
  return mark_;
}

void JournalWriter::synchronise() {
  if (const int error = tomlin::synchronise(descriptor_)) fail(error);
}

void JournalWriter::write_rows() {
  if (row_block_.size() == 0) return;
  write(row_block_);
  mark_.rows = rows_;
}

void JournalWriter::write_events() {
  if (event_block_.size() == 0) return;
  write(event_block_);
  mark_.events = events_;
}

void JournalWriter::write(RecordWriter& record) {
  // Part of a record may be in the file: whatever came behind it would never be read.
  if (broken_) throw OutputError(fmt::format("cannot write {}: an earlier error", file_.string()));
  const auto whole = record.seal(mark_.checksum);
  broken_ = true;
  if (const int error = write_all(descriptor_, whole)) fail(error);
  broken_ = false;
  mark_.bytes += whole.size();
  record.clear();
}

void JournalWriter::fail(int error) const { throw OutputError(file_, error); }

JournalReader::JournalReader(const fs::path& file) : records_(file) {
  const RecordHead head = records_.next_head();
  if (head.kind != RecordKind::journal) records_.refuse("not a journal");
  header_ = header_in(RecordReader(records_.name(), records_.next(head)));
  row_.resize(header_.layout.row());
}

void JournalReader::play(RunSink& sink, std::uint64_t end) {
  sink.begin(header_.layout);
  // Names of components stand in the scene, which bounds what a block of events can hold.
  const std::uint64_t most_of_rows = row_block(header_.layout);
  const std::uint64_t most_of_events = kRecordBytes + kEventBytes + header_.scene.size();
  while (records_.position() < std::min(size(), end)) {
    const RecordHead head = records_.next_head();
    if (head.kind == RecordKind::rows && head.length <= most_of_rows) {
      play_rows(records_.next(head), sink);
    } else if (head.kind == RecordKind::events && head.length <= most_of_events) {
      play_events(records_.next(head), sink);
    } else {
      records_.refuse(fmt::format("corrupted: the record at byte {} is not one of a journal",
                                  records_.position()));
    }
  }
}

void JournalReader::play_rows(std::span<const std::byte> content, RunSink& sink) {
  RecordReader record(records_.name(), content);
  if (record.number<std::uint64_t>() != rows_ || row_.empty()) {
    records_.refuse("corrupted: samples are missing");
  }
  while (record.left() > 0) {
    record.numbers(row_);
    sink.sample(row_);
    ++rows_;
  }
}

void JournalReader::play_events(std::span<const std::byte> content, RunSink& sink) {
  RecordReader record(records_.name(), content);
  if (record.number<std::uint64_t>() != events_) records_.refuse("corrupted: events are missing");
  while (record.left() > 0) {
    Event event;
    const auto kind = record.number<std::uint32_t>();
    if (kind >= kEventKinds) records_.refuse("an event of a kind that this program does not know");
    event.kind = static_cast<EventKind>(kind);
    event.name = *names_.insert(record.text()).first;
    if (event.kind == EventKind::observed) event.label = *names_.insert(record.text()).first;
    for (double* x :
         {&event.time, &event.duration, &event.size, &event.energy_lost, &event.peak_force}) {
      *x = record.number<double>();
    }
    sink.event(event);
    ++events_;
  }
}

}  // namespace tomlin
