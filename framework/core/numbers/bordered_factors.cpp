#include "framework/core/numbers/bordered_factors.hpp"

#include <cmath>
#include <utility>

#include "framework/core/numbers/math.hpp"
#include "framework/core/numbers/power_of_two.hpp"

namespace tomlin {
namespace {

double dot(const std::vector<double>& a, const double* b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// One by the power of two of the first size that is one: a unit that is taken out before roots
/// are, so that a matrix in other units has the same bits.
double unit_of(const std::vector<double>& sizes) {
  for (const double size : sizes) {
    if (std::isnormal(size)) return 1.0 / power_of_two_above(size);
  }
  return 1.0;
}

}  // namespace

bool BorderedFactors::factor(const BandMatrix& matrix, const std::vector<RankOne>& terms,
                             const std::vector<double>& sizes) {
  matrix_ = matrix;
  terms_.clear();
  for (const RankOne& term : terms) {
    if (term.weight != 0.0) terms_.push_back(term);
  }
  scale(sizes);
  if (matrix_.full()) {
    fill();
  } else {
    pin();
  }
  if (!band_.factor(matrix_) || !factor_terms()) return false;
  count();
  return true;
}

/// Entries of one size, whatever the units of a coordinate: rounding then is, too.
void BorderedFactors::scale(const std::vector<double>& sizes) {
  const std::size_t n = matrix_.size();
  scale_ = sizes;
  for (const RankOne& term : terms_) {
    for (std::size_t i = 0; i < n; ++i) {
      scale_[i] += std::abs(term.weight) * term.direction[i] * term.direction[i];
    }
  }
  const double unit = unit_of(scale_);
  for (double& scale : scale_) {
    scale = scale > 0.0 && std::isfinite(scale) ? 1.0 / std::sqrt(scale * unit) : 1.0;
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = matrix_.first_of(i); j < matrix_.end_of(i); ++j) {
      matrix_.at(i, j) = matrix_.at(i, j) * unit * (scale_[i] * scale_[j]);
    }
  }
  scale_.push_back(unit);  // behind the scales
  for (RankOne& term : terms_) {
    const double root = std::sqrt(std::abs(term.weight * unit));
    for (std::size_t i = 0; i < n; ++i) term.direction[i] *= root * scale_[i];
    term.weight = term.weight < 0.0 ? -1.0 : 1.0;
  }
}

void BorderedFactors::fill() {
  for (const RankOne& term : terms_) {
    for (std::size_t i = 0; i < matrix_.size(); ++i) {
      const double part = term.weight * term.direction[i];
      for (std::size_t j = 0; j < matrix_.size(); ++j) matrix_.at(i, j) += part * term.direction[j];
    }
  }
  terms_.clear();
}

/// A direction that only such a term holds would leave the band singular: the band gets the term at
/// one coordinate, and another term takes that back.
void BorderedFactors::pin() {
  const std::size_t count = terms_.size();
  for (std::size_t k = 0; k < count; ++k) {
    const std::vector<double>& d = terms_[k].direction;
    std::size_t at = 0;
    double total = 0.0;
    for (std::size_t i = 0; i < d.size(); ++i) {
      total += std::abs(d[i]);
      if (std::abs(d[i]) > std::abs(d[at])) at = i;
    }
    RankOne pin{std::vector<double>(d.size(), 0.0), -terms_[k].weight};
    pin.direction[at] = std::sqrt(std::abs(d[at]) * total);
    matrix_.at(at, at) -= pin.weight * pin.direction[at] * pin.direction[at];
    terms_.push_back(std::move(pin));
  }
}

bool BorderedFactors::factor_terms() {
  const std::size_t count = terms_.size();
  response_.clear();
  shares_.assign(count, 0.0);
  if (count == 0) return true;
  BandMatrix capacitance(count, count - 1);
  for (std::size_t k = 0; k < count; ++k) {
    response_.push_back(terms_[k].direction);
    band_.solve(response_[k].data());
    for (std::size_t l = 0; l < count; ++l) {
      capacitance.at(l, k) = dot(terms_[l].direction, response_[k].data());
    }
    capacitance.at(k, k) += terms_[k].weight;
  }
  return capacitance_.factor(capacitance);
}

/// Haynsworth's inertia of the block matrix with B and -S on its diagonal and U beside it.
void BorderedFactors::count() {
  const std::size_t n = matrix_.size();
  log_determinant_ = band_.log_determinant() - static_cast<double>(n) * log(scale_[n]);
  for (std::size_t i = 0; i < n; ++i) log_determinant_ -= 2.0 * log(scale_[i]);
  negative_ = band_.negative();
  if (terms_.empty()) return;
  log_determinant_ += capacitance_.log_determinant();
  negative_ += terms_.size() - capacitance_.negative();
  for (const RankOne& term : terms_) negative_ -= term.weight > 0.0 ? 1 : 0;
}

/// A^-1 b = D (y - B^-1 U (S + U^T B^-1 U)^-1 U^T y), y = B^-1 D b.
void BorderedFactors::solve(double* x) const {
  if (scale_.empty()) return;
  const std::size_t n = scale_.size() - 1;
  for (std::size_t i = 0; i < n; ++i) x[i] *= scale_[n] * scale_[i];
  band_.solve(x);
  if (!terms_.empty()) {
    for (std::size_t k = 0; k < terms_.size(); ++k) shares_[k] = dot(terms_[k].direction, x);
    capacitance_.solve(shares_.data());
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      for (std::size_t i = 0; i < n; ++i) x[i] -= shares_[k] * response_[k][i];
    }
  }
  for (std::size_t i = 0; i < n; ++i) x[i] *= scale_[i];
}

}  // namespace tomlin
