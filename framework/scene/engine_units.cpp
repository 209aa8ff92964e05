#include "framework/scene/engine_units.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

namespace tomlin {
namespace {

/// Changes numbers that have the row's dimension.
template <class Change>
class NumbersOf {
 public:
  explicit NumbersOf(Change change) : change_(std::move(change)) {}

  void operator()(double& number) const { number = change_(number); }
  void operator()(SpaceVector& vector) const { each(vector.components); }
  void operator()(PerParticle& numbers) const { each(numbers.values); }
  void operator()(PerParticleVector& vectors) const {
    for (SpaceVector& vector : vectors.values) each(vector.components);
  }
  void operator()(WordOrNumbers& numbers) const { each(numbers.numbers); }
  void operator()(PointList& points) const { each(points.coordinates); }
  void operator()(NumberTable& table) const { each(table.numbers); }
  template <class Other>
  void operator()(Other& other) const {
    (void)other;
  }

 private:
  void each(std::vector<double>& numbers) const {
    for (double& number : numbers) number = change_(number);
  }
  Change change_;
};

template <class Change>
ParameterValue changed(ParameterValue value, Change change) {
  std::visit(NumbersOf(std::move(change)), value);
  return value;
}

}  // namespace

// Products are rounded, so that neighbours of a number may come to the same.
double scene_number(double number, double unit) {
  if (unit == 1.0) return number;
  constexpr int kNeighbours = 8;
  double candidate = number / unit;
  if (!std::isfinite(candidate)) return candidate;
  for (int k = 0; k < kNeighbours / 2; ++k) {
    candidate = std::nextafter(candidate, -std::numeric_limits<double>::infinity());
  }
  double best = number / unit;
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  for (int k = 0; k <= kNeighbours; ++k) {
    const std::size_t digits = fmt::format("{}", candidate).size();
    if (candidate * unit == number && digits < fewest) {
      best = candidate;
      fewest = digits;
    }
    candidate = std::nextafter(candidate, std::numeric_limits<double>::infinity());
  }
  return best;
}

ParameterValue in_engine_units(ParameterValue value, double unit) {
  if (unit == 1.0) return value;
  return changed(std::move(value), [unit](double x) { return x * unit; });
}

bool contains_all(const Interval& interval, const ParameterValue& value) {
  bool all = true;
  changed(value, [&](double x) {
    all = all && (std::isnan(x) || interval.contains(x));  // NaN: absent
    return x;
  });
  return all;
}

ParameterValue in_scene_units(ParameterValue value, double unit) {
  if (unit == 1.0) return value;
  return changed(std::move(value), [unit](double x) { return scene_number(x, unit); });
}

}  // namespace tomlin
