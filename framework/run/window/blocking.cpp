#include "framework/run/window/blocking.hpp"

#include <cmath>
#include <cstddef>
#include <vector>

namespace tomlin {
namespace {

/// Fewer blocks do not show how much they scatter.
constexpr std::size_t kFewestBlocks = 8;

/// A series that swings back is averaged over no fewer blocks than this; a variance below this part
/// of that of shorter blocks is no chance.
constexpr std::size_t kFewestSwings = 16;
constexpr double kVariancePartOfSwing = 0.25;

/// Means of neighbours.
std::span<double> halved(std::span<double> blocks) {
  for (std::size_t k = 0; k < blocks.size() / 2; ++k) {
    blocks[k] = 0.5 * (blocks[2 * k] + blocks[2 * k + 1]);
  }
  return blocks.first(blocks.size() / 2);
}

}  // namespace

double variance_of_mean(std::span<const double> numbers) {
  double mean = 0.0;
  for (const double x : numbers) mean += x;
  const auto n = static_cast<double>(numbers.size());
  mean /= n;
  double squares = 0.0;
  for (const double x : numbers) squares += (x - mean) * (x - mean);
  return squares / (n * (n - 1.0));
}

BlockedMean blocked_mean(std::span<const double> series) {
  std::vector<double> copy(series.begin(), series.end());
  return blocked_mean_in_place(copy);
}

std::optional<double> error_of_independent(std::span<const double> numbers) {
  if (numbers.size() < kFewestBlocks) return std::nullopt;
  return std::sqrt(variance_of_mean(numbers));
}

BlockedMean blocked_mean_in_place(std::span<double> blocks) {
  BlockedMean result;
  const auto n = static_cast<double>(blocks.size());
  if (n < kFewestCorrelationTimes) return result;
  // From the first on: equal numbers have no variance, whatever rounding makes of their mean.
  const double start = blocks.front();
  for (double& x : blocks) x -= start;
  const double first = variance_of_mean(blocks);
  if (!(first > 0.0)) return {.error = 0.0, .correlation_times = n};
  double variance = first;
  double growth = 1.0;
  for (double size = 1.0; blocks.size() >= kFewestBlocks; size *= 2.0) {
    variance = variance_of_mean(blocks);
    growth = variance / first;
    if (size * size * size > 2.0 * n * growth * growth) break;
    blocks = halved(blocks);
  }
  // A series that swings back has a smaller error than independent numbers.
  for (; growth <= 1.0 && blocks.size() >= 2 * kFewestSwings;) {
    blocks = halved(blocks);
    const double longer = variance_of_mean(blocks);
    if (longer < kVariancePartOfSwing * variance) variance = longer;
  }
  result.correlation_times = growth > 1.0 ? n / growth : n;
  if (result.correlation_times >= kFewestCorrelationTimes) result.error = std::sqrt(variance);
  return result;
}

}  // namespace tomlin
