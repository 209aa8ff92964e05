#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "framework/output/number_text.hpp"
#include "framework/output/output_file.hpp"
#include "framework/study/sweep/files.hpp"

namespace tomlin {
namespace {

constexpr std::size_t kRowsAtOnce = 4096;

template <class Visit>
void for_each_row(const SweepPlan& plan, const SweepJournal& journal, Visit visit,
                  SweepPart part = {}) {
  const RowOrder order(plan);
  // Rows of other parts may be missing: then one at a time.
  std::vector<SweepRow> rows(part.of == 1 ? std::min(kRowsAtOnce, order.size()) : 1);
  for (std::size_t first = 0; first < order.size(); first += rows.size()) {
    if (!part.has(first)) continue;
    const auto block = std::span(rows).first(std::min(rows.size(), order.size() - first));
    order.read(journal, first, block);
    for (std::size_t k = 0; k < block.size(); ++k)
      visit(first + k, order.point(first + k), block[k]);
  }
}

}  // namespace

RowOrder::RowOrder(const SweepPlan& plan) : plan_(plan) {
  if (!plan.refinement()) return;
  for (std::size_t point = 0; point < plan.point_numbers(); ++point) {
    if (plan.exists(point)) points_.push_back(point);
  }
  const std::size_t refined = plan.refinement()->axis;
  const SweepValues& values = plan.axes()[refined].values;
  const bool rises = values.number(values.size() - 1) > values.number(0);
  const auto comes_before = [&](std::size_t one, std::size_t other) {
    for (const SweepDimension& dimension : plan.dimensions()) {
      const std::size_t axis = dimension.axes.front();
      const std::size_t a = plan.index(axis, one);
      const std::size_t b = plan.index(axis, other);
      if (a != b) return a < b;
      if (axis != refined || (one < plan.points() && other < plan.points())) continue;
      const double x = plan.number(axis, one);
      const double y = plan.number(axis, other);
      if (x != y) return (x < y) == rises;
    }
    return false;
  };
  std::sort(points_.begin(), points_.end(), comes_before);
}

void RowOrder::read(const SweepJournal& journal, std::size_t first,
                    std::span<SweepRow> rows) const {
  if (!plan_.refinement()) return journal.read(first, rows);
  for (std::size_t k = 0; k < rows.size(); ++k)
    journal.read(points_[first + k], rows.subspan(k, 1));
}

SweepCounts count_rows(const SweepPlan& plan, const SweepJournal& journal, SweepPart part) {
  SweepCounts counts;
  const auto count = [&](std::size_t number, std::size_t point, const SweepRow& row) {
    if (row.status != SweepStatus::finished && counts.reason.empty()) {
      counts.first_without_numbers = number;
      counts.point_without_numbers = point;
      counts.reason = row.reason;
    }
    ++counts.by_status[static_cast<std::size_t>(row.status)];
    if (row.warnings.none()) return;
    for (std::size_t code = 0; code < kMostWarningCodes; ++code) {
      if (!row.warnings[code]) continue;
      ++counts.warnings.try_emplace(static_cast<FaultCode>(code), SweepCounts::Warned{0, number})
            .first->second.points;
    }
  };
  for_each_row(plan, journal, count, part);
  return counts;
}

void write_sweep_table(const std::filesystem::path& file, const SweepPlan& plan,
                       const SweepJournal& journal) {
  OutputFile output(file);
  std::string text;
  for (std::size_t axis = 0; axis < plan.axes().size(); ++axis) text += plan.axis_title(axis) + ",";
  for (const SweepColumn& column : plan.columns()) {
    text += fmt::format("{} [{}],", column.name, plan.observables()[column.observable].unit);
  }
  text += "status,reason\n";
  for_each_row(plan, journal, [&](std::size_t, std::size_t point, const SweepRow& row) {
    for (std::size_t k = 0; k < plan.axes().size(); ++k) {
      const SweepValues& values = plan.axes()[k].values;
      if (values.numeric()) {
        append_number(text, plan.number(k, point));
      } else {
        text += quoted_cell(values.plain_text(plan.index(k, point)));
      }
      text += ',';
    }
    for (const double number : row.numbers) {
      if (std::isfinite(number)) append_number(text, number);
      text += ',';
    }
    text += to_string(row.status);
    text += ',';
    if (!row.reason.empty()) text += quoted_cell(row.reason);
    text += '\n';
    output.append_if_long(text);
  });
  output.append(text);
  output.publish();
}

}  // namespace tomlin
