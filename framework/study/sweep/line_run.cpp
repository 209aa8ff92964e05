#include "framework/study/sweep/line_run.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "framework/core/text/fault.hpp"
#include "framework/output/record.hpp"
#include "framework/output/sweep_files.hpp"
#include "framework/study/sweep/point_run.hpp"

namespace tomlin {
namespace {

/// The name in the store.
constexpr const char* kEndOfLine = "line";

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
  return {record.content().begin(), record.content().end()};
}

FinalState from_bytes(std::span<const std::byte> bytes, std::size_t& next) {
  RecordReader record("the end of a line", bytes);
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

std::filesystem::path line_file(const std::filesystem::path& folder, std::size_t first) {
  return folder.empty() ? folder : folder / fmt::format("{}{}", first, kLineSuffix);
}

void require_end(const FinalState* before, std::size_t point) {
  if (before == nullptr || before->known()) return;
  throw InputError(
      {Fault(FaultCode::resume_impossible, {}, "", "",
             fmt::format("point {}, which it continues from, has not finished", point - 1))});
}

}  // namespace

LineEnd::LineEnd(const SweepPlan& plan, std::size_t first, std::size_t most,
                 const std::filesystem::path& folder)
    : first_(first),
      next_(first),
      store_(line_file(folder, first), fmt::format("sweep {:x}, line {}", plan.identity(), first),
             plan.scene().run.checkpoint_every) {
  const std::vector<std::byte> kept = store_.kept(kEndOfLine);
  if (kept.empty()) return;
  try {
    std::size_t next = 0;
    FinalState state = from_bytes(kept, next);
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
  store_.keep(kEndOfLine, to_bytes(next_, state_));
}

bool run_line(const SweepPlan& plan, const std::vector<std::size_t>& points, PointSource& source,
              const WorkerOptions& options) {
  const std::size_t first = points.front() / plan.line() * plan.line();
  LineEnd end(plan, first, points.front(), options.checkpoints);
  for (;;) {
    const std::size_t point = end.next();
    std::unique_ptr<PointRun> run;
    std::optional<SweepRow> row;
    FinalState state;
    try {
      require_end(end.before(), point);
      run = std::make_unique<PointRun>(plan, point, options.stop, options.checkpoints);
      run->connect(end.before(), &state);
      row = run->run();
    } catch (const InputError& error) {
      row = row_of_refused(plan, error);
    }
    if (!row) {
      end.write();
      return false;
    }
    const bool is_last = point == points.back();
    if (is_last) end.remove();  // nothing that a kill would leave after the last row
    if (std::binary_search(points.begin(), points.end(), point)) source.keep(point, *row);
    if (run) run->remove_checkpoint();
    if (is_last) return true;
    end.pass(std::move(state));
  }
}

}  // namespace tomlin
