#include "framework/bodies/whole_cells.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "framework/core/numbers/math.hpp"

namespace tomlin {
namespace {

constexpr double kMostCells = 1e15;
constexpr double kMostCounted = 1e18;
constexpr double kLengthTolerance = 1e-9;  // far more than that of a few operations

}  // namespace

std::int64_t whole_cells(double length, double cell) {
  const double cells = length / cell * (1.0 + kLengthTolerance);
  return cells >= 1.0 ? static_cast<std::int64_t>(min(cells, kMostCells)) : 0;
}

bool fills_box(double length, double box) { return abs(box - length) <= kLengthTolerance * length; }

std::int64_t particles_in(std::int64_t per_cell, std::int64_t one, std::int64_t other) {
  const double about =
      static_cast<double>(per_cell) * static_cast<double>(one) * static_cast<double>(other);
  if (about > kMostCounted) return static_cast<std::int64_t>(kMostCounted);
  return per_cell * one * other;
}

std::vector<IndexPair> each_pair_once(std::vector<IndexPair> pairs) {
  for (IndexPair& pair : pairs) std::sort(pair.begin(), pair.end());
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  const auto is_single = [](const IndexPair& pair) { return pair[0] == pair[1]; };
  pairs.erase(std::remove_if(pairs.begin(), pairs.end(), is_single), pairs.end());
  return pairs;
}

std::vector<Complaint> complaints_without_space(const char* body, const SpaceVector& centre,
                                                int dimension) {
  if (dimension == 3) return {};
  return {{.key = centre.components.empty() ? "type" : "centre",
           .why = fmt::format("{} needs three dimensions, but the scene has {}", body, dimension),
           .admissible = "a scene whose first body has three coordinates",
           .code = FaultCode::scene_wrong_count}};
}

std::vector<Complaint> complaints_unless_one(const char* one, bool has_one, const char* other,
                                             bool has_other) {
  if (has_one && has_other) {
    return {{.key = other,
             .why = fmt::format("{} are given too", one),
             .admissible = "one of the two",
             .code = FaultCode::scene_conflict}};
  }
  if (has_one || has_other) return {};
  return {{.key = one,
           .why = "missing",
           .admissible = fmt::format("{} or {}", one, other),
           .code = FaultCode::scene_missing_key}};
}

std::vector<double> centre_or_origin(const SpaceVector& centre) {
  return centre.components.empty() ? std::vector<double>(3, 0.0) : centre.components;
}

}  // namespace tomlin
