#include "framework/study/sweep/merge.hpp"

#include <bit>
#include <cstdint>

#include <fmt/format.h>

#include "framework/core/text/words.hpp"

namespace tomlin {
namespace {

SweepRow row_in(const SweepJournal& journal, std::size_t point) {
  SweepRow row;
  journal.read(point, {&row, 1});
  return row;
}

/// How two rows of a point differ; empty where they are the same to the last bit.
std::string difference(const SweepPlan& plan, const SweepRow& one, const SweepRow& other) {
  if (one.status != other.status) {
    return fmt::format("status = {} and {}", to_string(one.status), to_string(other.status));
  }
  for (std::size_t k = 0; k < plan.columns().size(); ++k) {
    const auto bits = [k](const SweepRow& row) {
      return std::bit_cast<std::uint64_t>(row.numbers[k]);
    };
    if (bits(one) == bits(other)) continue;
    return fmt::format("{} = {:.17g} and {:.17g}", plan.columns()[k].name, one.numbers[k],
                       other.numbers[k]);
  }
  if (one.reason != other.reason) {
    return fmt::format("reason = \"{}\" and \"{}\"", one.reason, other.reason);
  }
  return one.warnings == other.warnings ? "" : "their warnings";
}

}  // namespace

std::optional<RowConflict> find_conflict(const SweepPlan& plan,
                                         const std::deque<SweepJournal>& journals) {
  for (std::size_t point = 0; point < plan.points(); ++point) {
    std::size_t first = 0;
    while (first < journals.size() && !journals[first].has(point)) ++first;
    std::optional<SweepRow> row;
    for (std::size_t k = first + 1; k < journals.size(); ++k) {
      if (!journals[k].has(point)) continue;
      if (!row) row = row_in(journals[first], point);
      std::string what = difference(plan, *row, row_in(journals[k], point));
      if (!what.empty()) return RowConflict{point, first, k, std::move(what)};
    }
  }
  return std::nullopt;
}

std::size_t merge_rows(const SweepPlan& plan, const std::deque<SweepJournal>& journals,
                       SweepJournal& into, const std::atomic<bool>& stop) {
  std::size_t kept = 0;
  for (std::size_t point = 0; point < plan.points() && !stop; ++point) {
    if (into.has(point)) continue;
    for (const SweepJournal& journal : journals) {
      if (!journal.has(point)) continue;
      into.keep(point, row_in(journal, point));
      ++kept;
      break;
    }
  }
  return kept;
}

}  // namespace tomlin
