#include <array>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "integrators/blanes_moan_kernels.hpp"
#include "integrators/dop853_kernels.hpp"

// Coefficients that are no fractions: their conditions of order, in quadruple numbers.

namespace tomlin::test {
namespace {

// The sources have thirty digits, and some coefficients are forty.
constexpr double kDop853Digits = 1e-27;
constexpr double kQuadRounding = 1e-32;

using Tableau = Dop853Tableau;
constexpr int kStages = Tableau::slopes;
using Stages = std::array<Quad, kStages>;

Stages nodes_to(int power) {
  Stages c;
  for (int i = 0; i < kStages; ++i) {
    c[i] = Quad(1.0);
    for (int k = 0; k < power; ++k) c[i] *= Tableau::c[i].as<Quad>();
  }
  return c;
}

Stages times(const Stages& a, const Stages& b) {
  Stages product;
  for (int i = 0; i < kStages; ++i) product[i] = a[i] * b[i];
  return product;
}

Stages through(const Stages& x) {
  Stages y;
  for (int i = 0; i < kStages; ++i) {
    y[i] = Quad(0.0);
    for (int j = 0; j < i; ++j) y[i] += Tableau::a[i][j].as<Quad>() * x[j];
  }
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
void grow(const std::vector<Tree>& all, std::size_t from, int left, const Tree& so_far,
          std::vector<Tree>& found) {
  if (left == 0) {
    found.push_back(so_far);
    return;
  }
  for (std::size_t k = from; k < all.size(); ++k) {
    if (all[k].order > left) continue;
    Tree next = so_far;
    next.weights = times(next.weights, through(all[k].weights));
    next.gamma *= all[k].gamma;
    grow(all, k, left - all[k].order, next, found);
  }
}

std::vector<Tree> trees_up_to(int order) {
  std::vector<Tree> all;
  for (int n = 1; n <= order; ++n) {
    std::vector<Tree> found;
    Tree root;
    root.weights = nodes_to(0);
    grow(all, 0, n - 1, root, found);
    for (Tree& tree : found) {
      tree.order = n;
      tree.gamma *= n;
      all.push_back(tree);
    }
  }
  return all;
}

double off(const Stages& weights, const Tree& tree) {
  Quad sum(0.0);
  for (int i = 0; i < kStages; ++i) sum += weights[i] * tree.weights[i];
  return static_cast<double>(abs(sum - Quad(1.0) / Quad(tree.gamma)));
}

/// Largest failure over the trees of an order.
double worst(const Stages& weights, const std::vector<Tree>& trees, int order) {
  double most = 0.0;
  for (const Tree& tree : trees) {
    if (tree.order == order) most = std::max(most, off(weights, tree));
  }
  return most;
}

Stages solution() {
  Stages b{};
  for (int j = 0; j < Tableau::end; ++j) b[j] = Tableau::a[Tableau::end][j].as<Quad>();
  for (int j = Tableau::end; j < kStages; ++j) b[j] = Quad(0.0);
  return b;
}

TEST(Dop853, FulfilsTheConditionsOfItsOrders) {
  const std::vector<Tree> trees = trees_up_to(8);
  EXPECT_EQ(trees.size(), 200u);  // 1 + 1 + 2 + 4 + 9 + 20 + 48 + 115
  const Stages b = solution();
  Stages fifth = b;
  Stages third = b;
  for (int j = 0; j < Tableau::end; ++j) {
    fifth[j] = b[j] - Tableau::error[j].as<Quad>();
    third[j] = Tableau::third[j].as<Quad>();
  }
  for (int order = 1; order <= 8; ++order) {
    EXPECT_LT(worst(b, trees, order), kDop853Digits) << order;
  }
  for (int order = 1; order <= 5; ++order) {
    EXPECT_LT(worst(fifth, trees, order), kDop853Digits) << order;
  }
  for (int order = 1; order <= 3; ++order) {
    EXPECT_LT(worst(third, trees, order), kDop853Digits) << order;
  }
  EXPECT_GT(worst(fifth, trees, 6), 1e-6) << "the embedded solutions would see no error";
  EXPECT_GT(worst(third, trees, 4), 1e-6);
}

TEST(Dop853, AWrongCoefficientIsSeen) {
  const std::vector<Tree> trees = trees_up_to(2);
  Stages b = solution();
  b[7] *= Quad(1.0) + Quad(1e-20);
  EXPECT_GT(worst(b, trees, 1), kDop853Digits);
}

/// All stages take the sum of their row, those of dense output too; the stages that extremes are
/// read from are within h^6 of the solution.
TEST(Dop853, StagesAreWhereTheySay) {
  const Stages c = nodes_to(1);
  const Stages sums = through(nodes_to(0));
  for (int i = 0; i < kStages; ++i) {
    EXPECT_LT(static_cast<double>(abs(sums[i] - c[i])), kDop853Digits) << i;
  }
  for (int power = 1; power <= 4; ++power) {
    const Stages integral = through(nodes_to(power));
    const Stages exact = nodes_to(power + 1);
    for (const int i : {5, 6, 9, 10, 12, 13, 14, 15}) {
      const Quad difference = integral[i] - exact[i] / Quad(power + 1.0);
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
