#include "framework/plot/equal_scale.hpp"

#include <algorithm>
#include <cmath>

namespace tomlin {
namespace {

// Of a panel, in points of the screen; beyond them an axis is made longer.
constexpr double kLeastHeight = 110.0;
constexpr double kMostHeight = 480.0;

struct Box {
  double left = HUGE_VAL, right = -HUGE_VAL, low = HUGE_VAL, high = -HUGE_VAL;

  void take(const Point& point) {
    left = std::min(left, point.x);
    right = std::max(right, point.x);
    low = std::min(low, point.y);
    high = std::max(high, point.y);
  }
  void take(const Panel& panel) {
    if (panel.raster) {
      take({panel.raster->x_from, panel.raster->y_from});
      take({panel.raster->x_to, panel.raster->y_to});
    }
    for (const Curve& curve : panel.curves) {
      for (const Polyline& piece : curve.pieces) {
        for (const Point& point : piece) take(point);
      }
    }
  }
};

}  // namespace

void scale_equally(Figure& figure, double margin_share) {
  Box all;
  double tallest = 0.0;
  for (const Panel& panel : figure.panels) {
    Box box;
    box.take(panel);
    all.take(panel);
    tallest = std::max(tallest, box.high - box.low);
  }
  const double margin = margin_share * std::max(all.right - all.left, tallest);
  const double least_width = (tallest + 2.0 * margin) * kPanelWidth / kMostHeight;
  double width = std::max(all.right - all.left + 2.0 * margin, least_width);
  if (!(width > 0.0)) width = 1.0;  // a single point
  const double middle = 0.5 * (all.left + all.right);
  figure.x_from = middle - 0.5 * width;
  figure.x_to = middle + 0.5 * width;
  const double points_per_length = kPanelWidth / width;
  for (Panel& panel : figure.panels) {
    Box box;
    box.take(panel);
    const double height =
        std::max(box.high - box.low + 2.0 * margin, kLeastHeight / points_per_length);
    const double centre = 0.5 * (box.low + box.high);
    panel.y_from = centre - 0.5 * height;
    panel.y_to = centre + 0.5 * height;
    panel.height = height * points_per_length;
  }
  figure.to_scale = true;
}

}  // namespace tomlin
