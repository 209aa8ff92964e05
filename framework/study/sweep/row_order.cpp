#include "framework/study/sweep/row_order.hpp"

#include <algorithm>

namespace tomlin {

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

}  // namespace tomlin
