#include "framework/core/records/parameter.hpp"

#include <cmath>

#include <fmt/format.h>

namespace tomlin {
namespace {

std::string power_of(std::string_view unit, int exponent) {
  return exponent == 1 ? std::string(unit) : fmt::format("{}^{}", unit, exponent);
}

}  // namespace

std::string product_of_powers(std::span<const std::pair<std::string_view, int>> factors) {
  std::string above;
  std::string below;
  for (const auto& [unit, exponent] : factors) {
    if (exponent > 0) above += (above.empty() ? "" : "*") + power_of(unit, exponent);
    if (exponent < 0) below += "/" + power_of(unit, -exponent);
  }
  if (above.empty()) above = "1";
  return above + below;
}

std::string to_string(const Dimension& dimension) {
  const std::pair<std::string_view, int> factors[] = {{"mass", dimension.mass},
                                                      {"length", dimension.length},
                                                      {"time", dimension.time},
                                                      {"temperature", dimension.temperature}};
  return product_of_powers(factors);
}

bool Interval::contains(double x) const {
  if (!std::isfinite(x)) return false;
  return (low_open ? x > low : x >= low) && (high_open ? x < high : x <= high);
}

std::string Interval::to_string() const {
  const bool bounded_below = std::isfinite(low);
  const bool bounded_above = std::isfinite(high);
  auto lower = fmt::format("{} {}", low_open ? ">" : ">=", low);
  auto upper = fmt::format("{} {}", high_open ? "<" : "<=", high);
  if (bounded_below && bounded_above) return lower + " and " + upper;
  if (bounded_below) return lower;
  if (bounded_above) return upper;
  return "any finite number";
}

}  // namespace tomlin
