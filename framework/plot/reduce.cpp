#include "framework/plot/reduce.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_set>
#include <utility>

namespace tomlin {
namespace {

/// Points of the screen in the width of a cell in which neither end of a line is told from the
/// other: half of one, as lines are drawn smoothed.
constexpr double kFinestCell = 0.5;

bool further_left(const Point& a, const Point& b) { return a.x < b.x; }
bool lower(const Point& a, const Point& b) { return a.y < b.y; }

/// Which of `cells` parts of [from, to] holds this number; the outer ones hold what is beyond.
std::uint32_t cell_of(double value, double from, double to, bool logarithmic, double cells) {
  if (logarithmic) {
    value = std::log(value);
    from = std::log(from);
    to = std::log(to);
  }
  const double share = to > from ? (value - from) / (to - from) : 0.0;
  return static_cast<std::uint32_t>(std::clamp(std::floor(share * cells), 0.0, cells - 1.0));
}

/// Of every stretch of the curve that stays in one column of the screen the first point, the last
/// and the outermost ones: what is drawn is the same.
Polyline by_columns(const Polyline& curve, const Window& window) {
  Polyline result;
  const auto column = [&](const Point& point) {
    return cell_of(point.x, window.x_from, window.x_to, window.log_x, window.width);
  };
  for (std::size_t begin = 0; begin < curve.size();) {
    std::size_t end = begin + 1;
    while (end < curve.size() && column(curve[end]) == column(curve[begin])) ++end;
    const Point* const first = &curve[begin];
    const Point* const behind = first + (end - begin);
    const auto [left, right] = std::minmax_element(first, behind, further_left);
    const auto [low, high] = std::minmax_element(first, behind, lower);
    std::array<const Point*, 6> kept = {first, left, right, low, high, behind - 1};
    std::sort(kept.begin(), kept.end());
    const auto last = std::unique(kept.begin(), kept.end());
    for (auto point = kept.begin(); point != last; ++point) result.push_back(**point);
    begin = end;
  }
  return result;
}

/// Drops what would be drawn over a line that is there already, as in the second and all later
/// rounds of a loop, by the cells in which lines begin and end.
class Overdrawn {
 public:
  /// The curve has at least one point. It and the window must outlive this.
  Overdrawn(const std::vector<Polyline>& curve, const Window& window, double cell)
      : curve_(curve),
        window_(window),
        columns_(std::max(1.0, std::ceil(window.width / cell))),
        rows_(std::max(1.0, std::ceil(window.height / cell))) {
    for (const Polyline& piece : curve) {
      for (const Point& point : piece) keep_extremes(point);
    }
  }

  /// What is left of the curve.
  std::vector<Polyline> dropped() {
    for (const Polyline& piece : curve_) {
      end_piece();
      const Point* last = nullptr;
      for (const Point& point : piece) {
        const bool extreme = is_extreme(point);
        if (last != nullptr && !extreme && cell(point) == cell(*last)) continue;
        const bool drawn = last != nullptr && !is_new(*last, point);
        if (drawn && !extreme && !is_extreme(*last)) end_piece();
        now_.push_back(point);
        last = &point;
      }
    }
    end_piece();
    return std::move(result_);
  }

 private:
  void keep_extremes(const Point& point) {
    const auto keep = [&](std::size_t which, bool further) {
      if (extremes_[which] == nullptr || further) extremes_[which] = &point;
    };
    keep(0, extremes_[0] != nullptr && further_left(point, *extremes_[0]));
    keep(1, extremes_[1] != nullptr && further_left(*extremes_[1], point));
    keep(2, extremes_[2] != nullptr && lower(point, *extremes_[2]));
    keep(3, extremes_[3] != nullptr && lower(*extremes_[3], point));
  }

  bool is_extreme(const Point& point) const {
    return std::find(extremes_.begin(), extremes_.end(), &point) != extremes_.end();
  }

  std::uint64_t cell(const Point& point) const {
    return cell_of(point.y, window_.y_from, window_.y_to, window_.log_y, rows_) *
               static_cast<std::uint64_t>(columns_) +
           cell_of(point.x, window_.x_from, window_.x_to, window_.log_x, columns_);
  }

  /// Is there no line between these two cells yet, either way? From now on there is.
  bool is_new(const Point& from, const Point& to) {
    const auto [low, high] = std::minmax({cell(from), cell(to)});
    return drawn_.insert((low << 32U) | high).second;
  }

  /// A piece of one point draws nothing.
  void end_piece() {
    if (now_.size() > 1) result_.push_back(std::move(now_));
    now_.clear();
  }

  const std::vector<Polyline>& curve_;
  const Window& window_;
  double columns_;
  double rows_;
  std::array<const Point*, 4> extremes_{};
  std::unordered_set<std::uint64_t> drawn_;
  Polyline now_;
  std::vector<Polyline> result_;
};

std::size_t points_in(const std::vector<Polyline>& pieces) {
  std::size_t count = 0;
  for (const Polyline& piece : pieces) count += piece.size();
  return count;
}

}  // namespace

std::vector<Polyline> reduced(const std::vector<Polyline>& curve, const Window& window) {
  if (points_in(curve) <= kFewPoints) return curve;
  std::vector<Polyline> pieces;
  pieces.reserve(curve.size());
  for (const Polyline& piece : curve) pieces.push_back(by_columns(piece, window));
  // Coarser cells until it fits: a curve that fills the panel is a surface whatever is left out.
  for (double cell = kFinestCell; points_in(pieces) > kMostPoints; cell *= 2.0) {
    pieces = Overdrawn(pieces, window, cell).dropped();
  }
  return pieces;
}

}  // namespace tomlin
