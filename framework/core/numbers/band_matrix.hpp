#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

/// Square matrices with entries near the diagonal only; as wide as the matrix, they are full ones.
/// Plain loops in a fixed order: the same bits on every machine.
namespace tomlin {

class BandMatrix {
 public:
  BandMatrix() = default;
  /// Entries (i, j) with |i - j| <= band, all zero.
  BandMatrix(std::size_t size, std::size_t band);

  std::size_t size() const { return size_; }
  std::size_t band() const { return band_; }
  bool full() const { return band_ + 1 >= size_; }
  bool holds(std::size_t i, std::size_t j) const { return (i < j ? j - i : i - j) <= band_; }
  std::size_t first_of(std::size_t row) const { return row < band_ ? 0 : row - band_; }
  std::size_t end_of(std::size_t row) const { return std::min(size_, row + band_ + 1); }

  /// An entry that it holds.
  double& at(std::size_t i, std::size_t j) { return entries_[i * (2 * band_ + 1) + band_ + j - i]; }
  double at(std::size_t i, std::size_t j) const {
    return entries_[i * (2 * band_ + 1) + band_ + j - i];
  }
  void clear();
  /// y <- A x.
  void times(const double* x, double* y) const;

 private:
  std::size_t size_ = 0;
  std::size_t band_ = 0;
  std::vector<double> entries_;  ///< row by row, 2 band + 1 each
};

/// Triangular factors of a band matrix. Rows are taken in one after the other and change places
/// with an earlier one wherever that gives the larger pivot, so that each row taken in leaves the
/// next leading principal minor.
/// Source: R. S. Martin and J. H. Wilkinson, Numer. Math. 9 (1967) 279, doi:10.1007/BF02162421.
class BandFactors {
 public:
  /// False when the matrix, whose entries should be of one size, is singular to rounding.
  bool factor(const BandMatrix& matrix);
  /// x <- A^-1 x.
  void solve(double* x) const;
  /// Negative eigenvalues, of a symmetric matrix: changes of sign among leading principal minors.
  std::size_t negative() const { return negative_; }
  /// ln |det A|.
  double log_determinant() const;

 private:
  double* upper(std::size_t row) { return upper_.data() + row * (2 * band_ + 1); }
  const double* upper(std::size_t row) const { return upper_.data() + row * (2 * band_ + 1); }
  void take_in(const BandMatrix& matrix, std::size_t i, double tiny);

  std::size_t size_ = 0;
  std::size_t band_ = 0;
  std::vector<double> upper_;       ///< row k from its diagonal on, 2 band + 1 each
  std::vector<double> multiplier_;  ///< of row i with rows i - band ... i - 1
  std::vector<char> exchanged_;     ///< whether the two had changed places before
  std::vector<double> row_;         ///< the row being taken in
  bool minor_positive_ = true;      ///< the last leading principal minor
  std::size_t negative_ = 0;
};

}  // namespace tomlin
