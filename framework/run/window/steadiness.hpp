#pragma once

#include <cstddef>
#include <optional>

/// Whether a number that comes once a period has become steady.
///
/// Its values are kept as blocks of equal length, which doubles when there are too many. The last
/// half of all periods is looked at in four windows, so that what is known grows with the time that
/// was watched:
///   range  of the values in the last two windows (what alternates or swings does not become steady
///          by chance)
///   drift  of the windows' means. Changes that shrink from window to window add up to a geometric
///          series; those that do not, to as much as they come to by the end of the run, as far as
///          a hundred windows ahead
/// The slowest time that the scene is known to have, of a memory or of soft springs under friction,
/// has to have passed twice, and what it still lets come is part of the drift.
namespace tomlin {

class Steadiness {
 public:
  static constexpr std::size_t kBlocks = 64;
  static constexpr std::size_t kWindows = 4;
  static constexpr double kTimesSlowest = 2.0;
  static constexpr std::size_t kNumbers = 6 + 3 * kBlocks;  ///< in the run state, zero at the start

  void attach(double* numbers) { numbers_ = numbers; }

  void add(double value);

  double periods() const { return numbers_[kPeriods]; }
  bool reached() const { return numbers_[kReached] != 0.0; }
  void reach() { numbers_[kReached] = 1.0; }

  /// Periods that have to have passed before anything is known, `slowest` being the scene's slowest
  /// time in periods.
  static double least_periods(double slowest);

  /// Estimated distance of the last value from the steady one, with so many periods to come;
  /// nothing as long as it can not be known.
  std::optional<double> distance(double slowest, double ahead) const;

  /// The last one that distance() was asked for at the end of a period, kept by the caller.
  double& kept_distance() { return numbers_[kDistance]; }
  double kept_distance() const { return numbers_[kDistance]; }

 private:
  enum { kPeriods, kReached, kDistance, kBlocksFilled, kBlockLength, kInBlock, kFirst };
  double* mean(std::size_t block) const { return numbers_ + kFirst + 3 * block; }
  double* low(std::size_t block) const { return mean(block) + 1; }
  double* high(std::size_t block) const { return mean(block) + 2; }
  std::size_t filled() const { return static_cast<std::size_t>(numbers_[kBlocksFilled]); }
  double window_mean(std::size_t window, std::size_t width) const;
  void halve();

  double* numbers_ = nullptr;
};

}  // namespace tomlin
