#pragma once

#include <cstddef>
#include <vector>

#include "framework/core/numbers/band_matrix.hpp"

namespace tomlin {

/// weight * direction direction^T, beside a band.
struct RankOne {
  std::vector<double> direction;
  double weight = 0.0;
};

/// Factors of A, a band plus terms that would fill it: Woodbury's identity, on entries scaled to
/// one size. With D the scales, D A D = B + U S U^T, S the terms' signs.
class BorderedFactors {
 public:
  /// Solves with `matrix` plus `terms`. `sizes`: of what the diagonal entries of the matrix were
  /// summed from, so that rounding is known from what matters. False when singular to rounding.
  bool factor(const BandMatrix& matrix, const std::vector<RankOne>& terms,
              const std::vector<double>& sizes);
  /// x <- A^-1 x.
  void solve(double* x) const;
  /// Negative eigenvalues, of a symmetric matrix.
  std::size_t negative() const { return negative_; }
  /// ln |det A|.
  double log_determinant() const { return log_determinant_; }

 private:
  void scale(const std::vector<double>& sizes);
  void fill();
  void pin();
  bool factor_terms();
  void count();

  std::vector<double> scale_;                  ///< D
  BandMatrix matrix_;                          ///< B
  BandFactors band_;                           ///< of B
  std::vector<RankOne> terms_;                 ///< U and S
  std::vector<std::vector<double>> response_;  ///< B^-1 U
  BandFactors capacitance_;                    ///< of S + U^T B^-1 U
  std::size_t negative_ = 0;
  double log_determinant_ = 0.0;
  mutable std::vector<double> shares_;
};

}  // namespace tomlin
