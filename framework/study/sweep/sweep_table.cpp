#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "framework/output/number_text.hpp"
#include "framework/output/output_file.hpp"
#include "framework/study/sweep/files.hpp"
#include "framework/study/sweep/row_order.hpp"

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

std::string quoted_cell(std::string_view text) {
  std::string cell = "\"";
  for (const char c : text) cell += c == '"' ? "\"\"" : std::string(1, c);
  return cell + "\"";
}

}  // namespace

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
    constexpr std::size_t kBytesAtOnce = std::size_t{1} << 16;
    if (text.size() < kBytesAtOnce) return;
    output.append(text);
    text.clear();
  });
  output.append(text);
  output.publish();
}

}  // namespace tomlin
