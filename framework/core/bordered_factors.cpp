#include "framework/core/bordered_factors.hpp"

#include <cmath>
#include <utility>

#include "framework/core/math.hpp"

namespace tomlin {
namespace {

double dot(const std::vector<double>& a, const double* b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

bool BorderedFactors::factor(BandMatrix matrix, std::vector<RankOne> terms,
                             std::vector<double> sizes) {
  terms_.clear();
  for (RankOne& term : terms) {
    if (term.weight != 0.0) terms_.push_back(std::move(term));
  }
  scale(matrix, std::move(sizes));
  if (matrix.full()) {
    fill(matrix);
  } else {
    pin(matrix);
  }
  if (!band_.factor(matrix) || !factor_terms()) return false;
  count();
  return true;
}

/// Entries of one size, whatever the units of a coordinate: rounding then is, too.
void BorderedFactors::scale(BandMatrix& matrix, std::vector<double> sizes) {
  const std::size_t n = matrix.size();
  for (const RankOne& term : terms_) {
    for (std::size_t i = 0; i < n; ++i) {
      sizes[i] += std::abs(term.weight) * term.direction[i] * term.direction[i];
    }
  }
  scale_.assign(n, 1.0);
  for (std::size_t i = 0; i < n; ++i) {
    if (sizes[i] > 0.0 && std::isfinite(sizes[i])) scale_[i] = 1.0 / std::sqrt(sizes[i]);
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = matrix.first_of(i); j < matrix.end_of(i); ++j) {
      matrix.at(i, j) *= scale_[i] * scale_[j];
    }
  }
  for (RankOne& term : terms_) {
    const double root = std::sqrt(std::abs(term.weight));
    for (std::size_t i = 0; i < n; ++i) term.direction[i] *= root * scale_[i];
    term.weight = term.weight < 0.0 ? -1.0 : 1.0;
  }
}

void BorderedFactors::fill(BandMatrix& matrix) {
  for (const RankOne& term : terms_) {
    for (std::size_t i = 0; i < matrix.size(); ++i) {
      const double part = term.weight * term.direction[i];
      for (std::size_t j = 0; j < matrix.size(); ++j) matrix.at(i, j) += part * term.direction[j];
    }
  }
  terms_.clear();
}

/// What only such a term holds would leave the band singular: the band gets it at one coordinate,
/// and another term takes that back.
void BorderedFactors::pin(BandMatrix& matrix) {
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
    matrix.at(at, at) -= pin.weight * pin.direction[at] * pin.direction[at];
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
  log_determinant_ = band_.log_determinant();
  for (const double scale : scale_) log_determinant_ -= 2.0 * log(scale);
  negative_ = band_.negative();
  if (terms_.empty()) return;
  log_determinant_ += capacitance_.log_determinant();
  negative_ += terms_.size() - capacitance_.negative();
  for (const RankOne& term : terms_) negative_ -= term.weight > 0.0 ? 1 : 0;
}

/// A^-1 b = D (y - B^-1 U (S + U^T B^-1 U)^-1 U^T y), y = B^-1 D b.
void BorderedFactors::solve(double* x) const {
  const std::size_t n = scale_.size();
  for (std::size_t i = 0; i < n; ++i) x[i] *= scale_[i];
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
