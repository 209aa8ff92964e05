#include "framework/core/numbers/band_matrix.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "framework/core/numbers/math.hpp"

namespace tomlin {

BandMatrix::BandMatrix(std::size_t size, std::size_t band)
    : size_(size), band_(size == 0 ? 0 : std::min(band, size - 1)) {
  entries_.assign(size_ * (2 * band_ + 1), 0.0);
}

void BandMatrix::clear() { std::fill(entries_.begin(), entries_.end(), 0.0); }

void BandMatrix::times(const double* x, double* y) const {
  for (std::size_t i = 0; i < size_; ++i) {
    double sum = 0.0;
    for (std::size_t j = first_of(i); j < end_of(i); ++j) sum += at(i, j) * x[j];
    y[i] = sum;
  }
}

bool BandFactors::factor(const BandMatrix& matrix) {
  size_ = matrix.size();
  band_ = matrix.band();
  upper_.assign(size_ * (2 * band_ + 1), 0.0);
  multiplier_.assign(size_ * band_, 0.0);
  exchanged_.assign(size_ * band_, 0);
  row_.assign(size_, 0.0);
  minor_positive_ = true;
  negative_ = 0;
  double largest = 0.0;
  for (std::size_t i = 0; i < size_; ++i) {
    for (std::size_t j = matrix.first_of(i); j < matrix.end_of(i); ++j) {
      largest = std::max(largest, std::abs(matrix.at(i, j)));
    }
  }
  if (size_ == 0) return true;
  if (!(largest > 0.0 && largest < std::numeric_limits<double>::infinity())) return false;
  // A pivot that is nothing but rounding: each has gone through about `band` subtractions.
  constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
  const double rounding = 8.0 * static_cast<double>(band_ + 1) * kEpsilon * largest;
  for (std::size_t i = 0; i < size_; ++i) take_in(matrix, i, kEpsilon * kEpsilon * largest);
  for (std::size_t k = 0; k < size_; ++k) {
    if (!(std::abs(upper(k)[0]) > rounding)) return false;
  }
  return true;
}

void BandFactors::take_in(const BandMatrix& matrix, std::size_t i, double tiny) {
  const std::size_t first = matrix.first_of(i);
  const std::size_t end = matrix.end_of(i);
  for (std::size_t j = first; j < end; ++j) row_[j] = matrix.at(i, j);
  bool positive = minor_positive_;
  for (std::size_t k = first; k < i; ++k) {
    double* pivot_row = upper(k);
    const std::size_t at = i * band_ + (k + band_ - i);
    if (std::abs(row_[k]) > std::abs(pivot_row[0])) {
      // The sign of the product of pivots, and that of the exchange.
      if ((row_[k] < 0.0) == (pivot_row[0] < 0.0)) positive = !positive;
      for (std::size_t j = k; j < end; ++j) std::swap(row_[j], pivot_row[j - k]);
      exchanged_[at] = 1;
    }
    const double share = row_[k] / pivot_row[0];
    multiplier_[at] = share;
    if (share == 0.0) continue;
    for (std::size_t j = k + 1; j < end; ++j) row_[j] -= share * pivot_row[j - k];
  }
  // In place of a minor that is exactly zero one that is nearly: it may be followed by others.
  if (row_[i] == 0.0) row_[i] = tiny > 0.0 ? tiny : std::numeric_limits<double>::min();
  if (row_[i] < 0.0) positive = !positive;
  if (positive != minor_positive_) ++negative_;
  minor_positive_ = positive;
  for (std::size_t j = i; j < end; ++j) upper(i)[j - i] = row_[j];
}

void BandFactors::solve(double* x) const {
  for (std::size_t i = 0; i < size_; ++i) {
    for (std::size_t k = i < band_ ? 0 : i - band_; k < i; ++k) {
      const std::size_t at = i * band_ + (k + band_ - i);
      if (exchanged_[at] != 0) std::swap(x[i], x[k]);
      x[i] -= multiplier_[at] * x[k];
    }
  }
  for (std::size_t k = size_; k-- > 0;) {
    const double* row = upper(k);
    const std::size_t end = std::min(size_, k + 2 * band_ + 1);
    double rest = x[k];
    for (std::size_t j = k + 1; j < end; ++j) rest -= row[j - k] * x[j];
    x[k] = rest / row[0];
  }
}

double BandFactors::log_determinant() const {
  double sum = 0.0;
  for (std::size_t k = 0; k < size_; ++k) sum += log(std::abs(upper(k)[0]));
  return sum;
}

}  // namespace tomlin
