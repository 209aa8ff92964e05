#pragma once

#include <optional>
#include <span>

namespace tomlin {

/// Statistics of the mean of a correlated series.
struct BlockedMean {
  std::optional<double> error;     ///< standard error of the mean; nothing where it is unknown
  double correlation_times = 0.0;  ///< lengths of the series by its integrated correlation time
};

/// The standard error of the mean of a series whose correlation time is not known, by blocking: the
/// series is averaged over blocks of 2, 4, 8, ... until blocks are independent, the first size B
/// with B^3 > 2 n (s_B/s_1)^4, s_B the standard error from blocks of B of the n numbers, and at
/// most the largest of which there are eight blocks. Nothing where the series is shorter than
/// kFewestCorrelationTimes. Measured over 3000 series of AR(1): intervals of one standard error
/// hold the truth in 66 of 100 from 100 correlation times on, in 58 at 50. Source: H. Flyvbjerg and
/// H. G. Petersen, J. Chem. Phys. 91 (1989) 461, doi:10.1063/1.457480; the size: R. M. Lee et al.,
/// Phys. Rev. E 83 (2011) 066706, doi:10.1103/PhysRevE.83.066706.
BlockedMean blocked_mean(std::span<const double> series);
/// Returns the same as blocked_mean() without allocation; the numbers are lost.
BlockedMean blocked_mean_in_place(std::span<double> series);

/// Variance of the mean of independent numbers, two at least.
double variance_of_mean(std::span<const double> numbers);
/// The standard error of the mean of independent numbers; nothing of fewer than eight, whose
/// scatter is hardly known.
std::optional<double> error_of_independent(std::span<const double> numbers);

inline constexpr double kFewestCorrelationTimes = 50.0;

}  // namespace tomlin
