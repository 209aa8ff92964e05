#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/text/words.hpp"
#include "framework/plot/figure.hpp"
#include "framework/plot/stored_run.hpp"

namespace tomlin {

/// What a histogram counts slips by.
enum class SlipMeasure { size, peak_force, energy };

constexpr auto word_table(SlipMeasure) {
  using enum SlipMeasure;
  return std::to_array<Word<SlipMeasure>>(
      {{size, "size"}, {peak_force, "peak_force"}, {energy, "energy"}});
}

struct SlipsRequest {
  SlipMeasure measure = SlipMeasure::size;
  std::string driver;               ///< empty: the only one
  std::optional<std::size_t> bins;  ///< by the number of slips unless given
  bool log_x = false;  ///< bins of equal ratios; slips without a positive number are left out
  bool log_y = false;
};

inline constexpr std::size_t kMostBins = 1000;

/// A histogram of the slips in events.csv, the runs in the same bins. Throws InputError where there
/// are none.
Figure slips_figure(const std::vector<StoredRun>& runs, const std::vector<std::string>& labels,
                    const SlipsRequest& request, std::vector<std::string>& notes);

}  // namespace tomlin
