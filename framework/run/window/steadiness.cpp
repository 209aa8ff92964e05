#include "framework/run/window/steadiness.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace tomlin {
namespace {

/// Windows ahead that changes which do not shrink are taken to go on for.
constexpr double kMostWindowsAhead = 100.0;
/// Changes shrink by the same factor as before: exponentials do, but for what is under them.
constexpr double kGrowthOfFactor = 1.05;
/// The windows looked at are the last half of all.
constexpr std::size_t kWindowsInAll = 2 * Steadiness::kWindows;

}  // namespace

void Steadiness::add(double value) {
  numbers_[kPeriods] += 1.0;
  if (numbers_[kBlockLength] == 0.0) numbers_[kBlockLength] = 1.0;
  if (numbers_[kInBlock] == 0.0 && filled() == kBlocks) halve();
  const std::size_t block = filled();
  if (numbers_[kInBlock] == 0.0) {
    *mean(block) = 0.0;
    *low(block) = *high(block) = value;
  }
  numbers_[kInBlock] += 1.0;
  *mean(block) += (value - *mean(block)) / numbers_[kInBlock];
  *low(block) = std::min(*low(block), value);
  *high(block) = std::max(*high(block), value);
  if (numbers_[kInBlock] < numbers_[kBlockLength]) return;
  numbers_[kInBlock] = 0.0;
  numbers_[kBlocksFilled] += 1.0;
}

void Steadiness::halve() {
  for (std::size_t k = 0; k < kBlocks / 2; ++k) {
    *mean(k) = 0.5 * (*mean(2 * k) + *mean(2 * k + 1));
    *low(k) = std::min(*low(2 * k), *low(2 * k + 1));
    *high(k) = std::max(*high(2 * k), *high(2 * k + 1));
  }
  numbers_[kBlocksFilled] = 0.5 * static_cast<double>(kBlocks);
  numbers_[kBlockLength] *= 2.0;
}

double Steadiness::least_periods(double slowest) {
  return std::max(static_cast<double>(kWindows), std::ceil(kTimesSlowest * slowest));
}

double Steadiness::window_mean(std::size_t window, std::size_t width) const {
  double sum = 0.0;
  for (std::size_t k = 1; k <= width; ++k) sum += *mean(filled() - window * width - k);
  return sum / static_cast<double>(width);
}

std::optional<double> Steadiness::distance(double slowest, double ahead) const {
  // Between the ends of blocks nothing new is known.
  if (numbers_[kInBlock] != 0.0 || periods() < least_periods(slowest)) return std::nullopt;
  const std::size_t width = std::max<std::size_t>(1, filled() / kWindowsInAll);
  const double window = static_cast<double>(width) * numbers_[kBlockLength];
  double lowest = *low(filled() - 1);
  double highest = *high(filled() - 1);
  for (std::size_t k = 1; k <= 2 * width; ++k) {
    lowest = std::min(lowest, *low(filled() - k));
    highest = std::max(highest, *high(filled() - k));
  }
  std::array<double, kWindows - 1> moved{};  // from the last one back
  std::array<double, kWindows - 1> change{};
  for (std::size_t k = 0; k + 1 < kWindows; ++k) {
    moved[k] = window_mean(k, width) - window_mean(k + 1, width);
    change[k] = std::abs(moved[k]);
  }
  const auto ratio = [](double now, double before) { return now == 0.0 ? 0.0 : now / before; };
  // A change is small by chance where the means reverse: it is held to what the ones before
  // foretell. Something slower has come to the fore where changes shrink less than before; to and
  // fro is no drift, as rounding leaves it.
  const double before = ratio(change[1], change[2]);
  const double last = std::max(change[0], change[1] * std::min(1.0, before));
  const double factor = ratio(last, change[1]);
  double outlook = std::min(kMostWindowsAhead, ahead / window);
  if (moved[0] * moved[1] < 0.0) {
    outlook = std::min(outlook, std::max(1.0, slowest / window));
  } else if (factor < 1.0 && factor <= kGrowthOfFactor * before) {
    outlook = std::min(outlook, std::max(factor / (1.0 - factor), slowest / window));
  }
  return std::max(highest - lowest, last * outlook);
}

}  // namespace tomlin
