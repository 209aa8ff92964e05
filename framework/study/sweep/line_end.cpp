#include "framework/study/sweep/line_end.hpp"

#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "framework/output/record.hpp"
#include "framework/study/sweep/point_checkpoint.hpp"

namespace tomlin {
namespace {

constexpr const char* kEnd = "end";

void write_quads(RecordWriter& record, const std::vector<Quad>& numbers) {
  record.bytes(std::as_bytes(std::span(numbers)));
}

std::vector<Quad> read_quads(RecordReader& record) {
  const auto bytes = record.bytes();
  std::vector<Quad> numbers(bytes.size() / sizeof(Quad));
  if (!numbers.empty()) std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(Quad));
  return numbers;
}

std::vector<std::byte> to_bytes(std::size_t next, const FinalState& state) {
  RecordWriter record(RecordKind::store);
  record.number(static_cast<std::uint64_t>(next));
  record.number(static_cast<std::uint64_t>(state.structure.size()));
  for (const std::string& part : state.structure) record.text(part);
  record.number(state.origin);
  write_quads(record, state.position);
  write_quads(record, state.velocity);
  write_quads(record, state.own);
  for (const FinalState::Support& support : state.supports) {
    record.text(support.name);
    write_quads(record, support.position);
  }
  std::uint64_t checksum = kFirstChecksum;
  const auto whole = record.seal(checksum);
  return {whole.begin(), whole.end()};
}

FinalState from_bytes(const std::string& file, std::span<const std::byte> bytes,
                      std::size_t& next) {
  std::uint64_t checksum = kFirstChecksum;
  RecordReader record(file, record_content(file, bytes, checksum));
  FinalState state;
  next = record.number<std::uint64_t>();
  state.structure.resize(record.count(sizeof(std::uint64_t)));
  for (std::string& part : state.structure) part = record.text();
  state.origin = record.number<Origin>();
  state.position = read_quads(record);
  state.velocity = read_quads(record);
  state.own = read_quads(record);
  while (record.left() > 0) {
    FinalState::Support& support = state.supports.emplace_back();
    support.name = record.text();
    support.position = read_quads(record);
  }
  return state;
}

}  // namespace

LineEnd::LineEnd(const SweepPlan& plan, std::size_t first, std::size_t most,
                 const std::filesystem::path& folder)
    : first_(first),
      next_(first),
      file_(folder.empty() ? folder : folder / fmt::format("{}{}", first, kLineEndSuffix)),
      every_(plan.scene().run.checkpoint_every),
      store_(file_, fmt::format("sweep {:x}, line {}", plan.identity(), first),
             folder.empty() ? StoreFile::Before::ignore : StoreFile::Before::read) {
  const std::vector<std::byte> kept = store_.kept(kEnd);
  if (kept.empty()) return;
  try {
    std::size_t next = 0;
    FinalState state = from_bytes(file_.string(), kept, next);
    if (next <= first || next > most) return;
    next_ = next;
    state_ = std::move(state);
  } catch (const DamagedFile&) {
    // A damaged state is treated like a missing one.
  }
}

void LineEnd::pass(FinalState state) {
  ++next_;
  state_ = std::move(state);
  const std::chrono::duration<double> since = std::chrono::steady_clock::now() - last_written_;
  if (since.count() >= every_) write();
}

void LineEnd::write() {
  if (file_.empty() || next_ == first_) return;
  std::error_code error;
  std::filesystem::create_directories(file_.parent_path(), error);
  store_.keep(kEnd, to_bytes(next_, state_));
  last_written_ = std::chrono::steady_clock::now();
}

void LineEnd::remove() {
  if (!file_.empty()) PointCheckpoint::remove(file_);
}

}  // namespace tomlin
