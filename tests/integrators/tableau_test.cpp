#include <algorithm>
#include <array>
#include <complex>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "integrators/blanes_moan_kernels.hpp"
#include "integrators/dop853_kernels.hpp"
#include "integrators/dopri5_kernels.hpp"
#include "integrators/midpoint_kernels.hpp"
#include "integrators/rk4_kernels.hpp"
#include "tests/support/tableaus.hpp"

// Conditions of order, in quadruple precision.

namespace tomlin::test {
namespace {

// The sources have thirty digits, and some coefficients are forty.
constexpr double kDop853Digits = 1e-27;
constexpr double kQuadRounding = 1e-32;
constexpr double kDopri5Rounding = 1e-30;  // coefficients up to 30

using Stages = std::vector<Quad>;
using Matrix = std::vector<Stages>;

/// The first `known` coefficients of a row of n.
template <class Row>
Stages numbers(const Row& row, std::size_t n, std::size_t known) {
  Stages x(n, Quad(0.0));
  for (std::size_t j = 0; j < known; ++j) x[j] = row[j].template as<Quad>();
  return x;
}

template <class Tableau>
Matrix matrix(std::size_t n) {
  Matrix a;
  for (std::size_t i = 0; i < n; ++i) a.push_back(numbers(Tableau::a[i], n, i));
  return a;
}

Quad product(const Stages& a, const Stages& b) {
  Quad sum(0.0);
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

Stages times(const Stages& a, const Stages& b) {
  Stages result(a);
  for (std::size_t i = 0; i < a.size(); ++i) result[i] *= b[i];
  return result;
}

Stages through(const Matrix& a, const Stages& x) {
  Stages y;
  for (const Stages& row : a) y.push_back(product(row, x));
  return y;
}

/// Elementary weights of the trees of up to `order` vertices, each with its 1/gamma, all 200 of
/// them up to order 8: a tree is a root with a multiset of trees on it.
struct Tree {
  Stages weights;    ///< product over the root's branches
  double gamma = 1;  ///< product of the sizes of all subtrees
  int order = 1;
};

/// Trees of exactly `order` vertices, with branches taken in the order of `all`, none before
/// `from`.
void grow(const Matrix& a, const std::vector<Tree>& all, std::size_t from, int left,
          const Tree& so_far, std::vector<Tree>& found) {
  if (left == 0) {
    found.push_back(so_far);
    return;
  }
  for (std::size_t k = from; k < all.size(); ++k) {
    if (all[k].order > left) continue;
    Tree next = so_far;
    next.weights = times(next.weights, through(a, all[k].weights));
    next.gamma *= all[k].gamma;
    grow(a, all, k, left - all[k].order, next, found);
  }
}

std::vector<Tree> trees_up_to(int order, const Matrix& a) {
  std::vector<Tree> all;
  for (int n = 1; n <= order; ++n) {
    std::vector<Tree> found;
    Tree root;
    root.weights = Stages(a.size(), Quad(1.0));
    grow(a, all, 0, n - 1, root, found);
    for (Tree& tree : found) {
      tree.order = n;
      tree.gamma *= n;
      all.push_back(tree);
    }
  }
  return all;
}

/// Largest failure over the trees of the orders from `least` to `most`.
double worst(const Stages& weights, const std::vector<Tree>& trees, int least, int most) {
  double failure = 0.0;
  for (const Tree& tree : trees) {
    if (tree.order < least || tree.order > most) continue;
    const Quad off = product(weights, tree.weights) - Quad(1.0) / Quad(tree.gamma);
    failure = std::max(failure, static_cast<double>(abs(off)));
  }
  return failure;
}

// ---- fixed steps

/// Largest failure up to an order. The times of the stages are sums of rows by definition.
double worst(const Matrix& a, const Stages& b, int order) {
  return worst(b, trees_up_to(order, a), 1, order);
}

template <class Tableau>
void check_fixed() {
  SCOPED_TRACE(Tableau::name);
  constexpr std::size_t n = Tableau::stages;
  const Matrix a = matrix<Tableau>(n);
  const Stages b = numbers(Tableau::b, n, n);
  EXPECT_LT(worst(a, b, Tableau::order), kQuadRounding);
  EXPECT_GT(worst(a, b, Tableau::order + 1), 1e-3) << "of higher order than stated";

  // Each wrong coefficient is seen.
  const Quad wrong(1.0 + 1e-9);
  for (std::size_t i = 0; i < n; ++i) {
    Stages spoilt_b = b;
    spoilt_b[i] *= wrong;
    if (b[i] != Quad(0.0)) {
      EXPECT_GT(worst(a, spoilt_b, Tableau::order), 1e-11) << i;
    }
    for (std::size_t j = 0; j < i; ++j) {
      Matrix spoilt_a = a;
      spoilt_a[i][j] *= wrong;
      if (a[i][j] != Quad(0.0)) {
        EXPECT_GT(worst(spoilt_a, b, Tableau::order), 1e-11) << i << ", " << j;
      }
    }
  }
}

TEST(FixedStepTableau, FulfilsTheConditionsOfItsOrder) {
  check_fixed<Rk4Tableau>();
  check_fixed<MidpointTableau>();
  check_fixed<HeunTableau>();
  check_fixed<RalstonTableau>();
  check_fixed<ThreeEighthsTableau>();
}

/// R(z) = 1 + z + ... + z^s / s! where order and number of stages s are equal.
TEST(FixedStepTableau, HasTheStabilityFunctionOfItsOrder) {
  const std::complex<double> z(-0.7, 1.9);
  const std::complex<double> second = 1.0 + z + z * z / 2.0;
  const std::complex<double> third = second + z * z * z / 6.0;
  const std::complex<double> fourth = third + z * z * z * z / 24.0;
  constexpr double kRounded = 1e-14;
  EXPECT_LT(std::abs(stability_function<MidpointTableau>(z) - second), kRounded);
  EXPECT_LT(std::abs(stability_function<HeunTableau>(z) - second), kRounded);
  EXPECT_LT(std::abs(stability_function<RalstonTableau>(z) - third), kRounded);
  EXPECT_LT(std::abs(stability_function<Rk4Tableau>(z) - fourth), kRounded);
  EXPECT_LT(std::abs(stability_function<ThreeEighthsTableau>(z) - fourth), kRounded);
}

// ---- embedded pairs

/// Weights of the solution, of n slopes.
template <class Tableau>
Stages solution(std::size_t n) {
  return numbers(Tableau::a[Tableau::end], n, Tableau::end);
}

Stages less(const Stages& a, const Stages& b) {
  Stages difference(a);
  for (std::size_t i = 0; i < b.size(); ++i) difference[i] -= b[i];
  return difference;
}

template <class Tableau>
void check_times(const Matrix& a, double rounding) {
  const Stages sums = through(a, Stages(a.size(), Quad(1.0)));
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Quad off = sums[i] - Tableau::c[i].template as<Quad>();
    EXPECT_LT(static_cast<double>(abs(off)), rounding) << i;
  }
}

TEST(Dopri5, FulfilsTheConditionsOfItsOrders) {
  constexpr std::size_t n = Dopri5Tableau::end + 1;
  const Matrix a = matrix<Dopri5Tableau>(n);
  const std::vector<Tree> trees = trees_up_to(5, a);
  EXPECT_EQ(trees.size(), 17u);
  Stages b = solution<Dopri5Tableau>(n);
  const Stages embedded = less(b, numbers(Dopri5Tableau::error, n, n));
  EXPECT_LT(worst(b, trees, 1, 5), kDopri5Rounding);
  EXPECT_LT(worst(embedded, trees, 1, 4), kDopri5Rounding);
  EXPECT_GT(worst(embedded, trees, 5, 5), 1e-5) << "the embedded solution would see no error";
  check_times<Dopri5Tableau>(a, kDopri5Rounding);
  b[3] *= Quad(1.0) + Quad(1e-25);
  EXPECT_GT(worst(b, trees, 1, 5), kDopri5Rounding);
}

constexpr std::size_t kDop853Slopes = Dop853Tableau::slopes;

TEST(Dop853, FulfilsTheConditionsOfItsOrders) {
  const std::vector<Tree> trees = trees_up_to(8, matrix<Dop853Tableau>(kDop853Slopes));
  EXPECT_EQ(trees.size(), 200u);  // 1 + 1 + 2 + 4 + 9 + 20 + 48 + 115
  constexpr std::size_t end = Dop853Tableau::end;
  Stages b = solution<Dop853Tableau>(kDop853Slopes);
  const Stages fifth = less(b, numbers(Dop853Tableau::error, end, end));
  const Stages third = numbers(Dop853Tableau::third, kDop853Slopes, end);
  EXPECT_LT(worst(b, trees, 1, 8), kDop853Digits);
  EXPECT_LT(worst(fifth, trees, 1, 5), kDop853Digits);
  EXPECT_LT(worst(third, trees, 1, 3), kDop853Digits);
  EXPECT_GT(worst(fifth, trees, 6, 6), 1e-6) << "the embedded solutions would see no error";
  EXPECT_GT(worst(third, trees, 4, 4), 1e-6);
  b[7] *= Quad(1.0) + Quad(1e-20);
  EXPECT_GT(worst(b, trees, 1, 1), kDop853Digits) << "a wrong coefficient is not seen";
}

/// All stages take the sum of their row, those of dense output too; the stages that extremes are
/// read from are within h^6 of the solution.
TEST(Dop853, StagesAreWhereTheySay) {
  const Matrix a = matrix<Dop853Tableau>(kDop853Slopes);
  check_times<Dop853Tableau>(a, kDop853Digits);
  const Stages c = through(a, Stages(kDop853Slopes, Quad(1.0)));
  Stages nodes = c;
  for (int power = 1; power <= 4; ++power) {
    const Stages integral = through(a, nodes);
    nodes = times(nodes, c);
    for (const int i : {5, 6, 9, 10, 12, 13, 14, 15}) {
      const Quad difference = integral[i] - nodes[i] / Quad(power + 1.0);
      EXPECT_LT(static_cast<double>(abs(difference)), kDop853Digits) << i << ", " << power;
    }
  }
}

// ---- Blanes and Moan

struct Kicks {
  std::vector<Quad> b, c;
};

Kicks kicks() {
  Kicks all;
  Quad c(0.0);
  for (int i = 0; i < 7; ++i) {
    all.b.push_back(BlanesMoanScheme::kick<Quad>[i]);
    all.c.push_back(c);
    if (i < 6) {
      c += BlanesMoanScheme::drift<Quad>[i];
      EXPECT_LT(static_cast<double>(abs(c - BlanesMoanScheme::time<Quad>[i])), kQuadRounding);
    }
  }
  return all;
}

/// How far the two conditions are off that a symmetric composition needs for fourth order.
std::array<double, 2> off(const Kicks& k) {
  Quad squares(0.0);
  Quad pairs(0.0);
  for (int i = 0; i < 7; ++i) {
    squares += k.b[i] * k.c[i] * k.c[i];
    for (int j = 0; j < i; ++j) pairs += k.b[i] * k.b[j] * (k.c[i] - k.c[j]);
  }
  return {static_cast<double>(abs(squares - Quad(1.0) / Quad(3.0))),
          static_cast<double>(abs(pairs - Quad(1.0) / Quad(6.0)))};
}

TEST(BlanesMoan, FulfilsTheConditionsOfFourthOrder) {
  Kicks k = kicks();
  Quad sum(0.0);
  for (const Quad& b : k.b) sum += b;
  EXPECT_LT(static_cast<double>(abs(sum - Quad(1.0))), kQuadRounding);
  EXPECT_LT(static_cast<double>(abs(k.c.back() - Quad(1.0))), kQuadRounding);
  for (const double failure : off(k)) EXPECT_LT(failure, kQuadRounding);
  // With the fifteen digits of the table they would hold to double's rounding only.
  k.b[2] = k.b[4] = Quad(-0.0390563049223486);
  EXPECT_GT(off(k)[0] + off(k)[1], 1e-17);
}

}  // namespace
}  // namespace tomlin::test
