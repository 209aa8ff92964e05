#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "framework/run/window/blocking.hpp"

namespace tomlin {

/// Numbers that come one after another, such as those of slips, kept as means over blocks of equal
/// count for the standard error of their mean (blocking.hpp). Blocks double in length when there
/// are too many; what stands in a block that is not full yet does not count.
class BlockedSeries {
 public:
  static constexpr std::size_t kBlocks = 512;
  static constexpr std::size_t kReals = kBlocks + 1;  ///< in the run's state
  static constexpr std::size_t kIntegers = 3;

  void attach(double* reals, std::int64_t* integers) {
    sums_ = reals;
    open_ = reals + kBlocks;
    counts_ = integers;
  }
  /// Begins a series: all numbers are zero.
  void start() {
    *open_ = 0.0;
    counts_[kFilled] = counts_[kDoublings] = counts_[kInOpen] = 0;
  }

  void add(double x) {
    *open_ += x;
    if (++counts_[kInOpen] < length()) return;
    if (counts_[kFilled] == static_cast<std::int64_t>(kBlocks)) {
      for (std::size_t k = 0; k < kBlocks / 2; ++k) sums_[k] = sums_[2 * k] + sums_[2 * k + 1];
      counts_[kFilled] /= 2;
      ++counts_[kDoublings];  // the open block is half full now
      return;
    }
    sums_[counts_[kFilled]++] = *open_;
    *open_ = 0.0;
    counts_[kInOpen] = 0;
  }

  std::int64_t count() const { return counts_[kFilled] * length() + counts_[kInOpen]; }

  /// The standard error of the mean of numbers that are nearly independent: that of mean(), and of
  /// the scatter alone where they are too few to show a correlation. `scratch` has room for kBlocks
  /// numbers.
  std::optional<double> error(std::vector<double>& scratch) const {
    const auto filled = static_cast<std::size_t>(counts_[kFilled]);
    if (static_cast<double>(filled) >= kFewestCorrelationTimes) return mean(scratch).error;
    std::copy_n(sums_, filled, scratch.begin());
    return error_of_independent({scratch.data(), filled});
  }

  /// `scratch` has room for kBlocks numbers.
  BlockedMean mean(std::vector<double>& scratch) const {
    const auto filled = static_cast<std::size_t>(counts_[kFilled]);
    const auto numbers = static_cast<double>(length());
    std::transform(sums_, sums_ + filled, scratch.begin(),
                   [numbers](double sum) { return sum / numbers; });
    return blocked_mean_in_place({scratch.data(), filled});
  }

 private:
  enum { kFilled, kDoublings, kInOpen };
  std::int64_t length() const { return std::int64_t{1} << counts_[kDoublings]; }

  double* sums_ = nullptr;  ///< of full blocks
  double* open_ = nullptr;  ///< of the last one
  std::int64_t* counts_ = nullptr;
};

}  // namespace tomlin
