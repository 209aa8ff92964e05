#pragma once

#include <complex>
#include <cstdint>
#include <numeric>

#include "integrators/coefficient.hpp"

/// Tableaus of explicit Runge-Kutta schemes in integers, and what follows from them at compile
/// time. A tableau is a type with
///   name, order
///   stages   number of evaluations
///   a[]      rows of the stages; the first is empty
///   b        weights of the solution
/// The times c of the stages are the sums of their rows.
namespace tomlin {

/// numerator[j] / denominator.
template <int n>
struct TableauRow {
  std::int64_t numerator[n] = {};
  std::int64_t denominator = 1;

  constexpr Coefficient operator[](int j) const {
    return {static_cast<double>(numerator[j]), static_cast<double>(denominator)};
  }
  constexpr TableauRow reduced() const {
    TableauRow row = *this;
    std::int64_t common = denominator;
    for (const std::int64_t x : numerator) common = std::gcd(common, x);
    for (std::int64_t& x : row.numerator) x /= common;
    row.denominator /= common;
    return row;
  }
  constexpr TableauRow<1> sum() const {
    TableauRow<1> total = {{0}, denominator};
    for (const std::int64_t x : numerator) total.numerator[0] += x;
    return total.reduced();
  }
};

/// Row of a stage; after the last stage, the weights.
template <class Tableau>
consteval TableauRow<Tableau::stages> tableau_row(int stage) {
  return stage == Tableau::stages ? Tableau::b : Tableau::a[stage];
}

/// The row times the matrix a.
template <class Tableau>
consteval TableauRow<Tableau::stages> times_matrix(const TableauRow<Tableau::stages>& row) {
  std::int64_t common = 1;
  for (const auto& stage : Tableau::a) common = std::lcm(common, stage.denominator);
  TableauRow<Tableau::stages> product;
  product.denominator = row.denominator * common;
  for (int k = 0; k < Tableau::stages; ++k) {
    for (int j = 0; j < k; ++j) {
      product.numerator[j] +=
          row.numerator[k] * Tableau::a[k].numerator[j] * (common / Tableau::a[k].denominator);
    }
  }
  return product.reduced();
}

/// A row of a tableau as numerator / denominator times whole numbers without a common factor.
template <class Tableau>
struct WholeRow {
  static constexpr int n = Tableau::stages;
  std::int64_t count[n] = {};
  std::int64_t numerator = 0;
  std::int64_t denominator = 1;

  consteval explicit WholeRow(const TableauRow<n>& row) : denominator(row.denominator) {
    for (const std::int64_t x : row.numerator) numerator = std::gcd(numerator, x);
    for (int j = 0; j < n; ++j) count[j] = row.numerator[j] / numerator;
    const std::int64_t common = std::gcd(numerator, denominator);
    numerator /= common;
    denominator /= common;
  }
  /// The next index after j of the same number; n if there is none.
  consteval int equal_after(int j) const {
    for (int k = j + 1; k < n; ++k) {
      if (count[k] == count[j]) return k;
    }
    return n;
  }
  /// Whether j has a number that is not zero and that no index before it has.
  consteval bool new_at(int j) const {
    for (int k = 0; k < j; ++k) {
      if (count[k] == count[j]) return false;
    }
    return count[j] != 0;
  }
  consteval int first() const {
    int j = 0;
    while (count[j] == 0) ++j;
    return j;
  }
  /// A single one, at j.
  consteval bool is_unit(int j) const { return first() == j && new_at(j) && equal_after(j) == n; }
};

/// R(z), where a step on y' = lambda y multiplies y by R(h lambda): the polynomial
/// 1 + z s_0 + z^2 s_1 + ... of the sums s_k of the weights times a^k, by Horner's rule on
/// quotients of successive sums. `last` and `row` are s_(k-1) and the weights times a^k.
template <class Tableau, TableauRow<1> last = TableauRow<1>{{1}},
          TableauRow<Tableau::stages> row = Tableau::b>
std::complex<double> stability_function(std::complex<double> z) {
  constexpr TableauRow<1> sum = row.sum();
  if constexpr (sum.numerator[0] == 0) {
    return 1.0;
  } else {
    constexpr Coefficient quotient =
        TableauRow<1>{{sum.numerator[0] * last.denominator}, sum.denominator * last.numerator[0]}
            .reduced()[0];
    return 1.0 + z * quotient.numerator / quotient.denominator *
                     stability_function<Tableau, sum, times_matrix<Tableau>(row)>(z);
  }
}

}  // namespace tomlin
