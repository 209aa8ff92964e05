#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "framework/model/force_tangent.hpp"
#include "framework/model/model.hpp"
#include "tests/support/ring_scenes.hpp"

// K and G against differences of the forces, solutions and inertia against Eigen.

namespace tomlin::test {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

// Central differences of step h leave h^2 F'''/6 and rounding eps F/h; entries of K of order 1 to
// 1e3, h = 1e-5.
constexpr double kStep = 1e-5;
constexpr double kOfDifferences = 3e-8;
// Matrices here have condition numbers up to 1e5 or so.
constexpr double kOfSolutions = 1e-9;

/// A scene's forces and their tangent, at any state.
class Linearised {
 public:
  explicit Linearised(const std::string& text)
      : model_(scene_of(text)), assembly_(model_.plan()), tangent(assembly_) {
    const SystemView<double>& view = assembly_.system().view;
    position.assign(view.dofs + 2 * kGroup, 0.0);
    velocity.assign(view.dofs + 2 * kGroup, 0.0);
    integrals_.assign(view.rates + 2 * kGroup, 0.0);
    assembly_.start(position.data(), velocity.data(), integrals_.data(), nullptr);
    assembly_.begin_step(DoubleDouble(0.0));
  }

  /// Somewhere near, and on the way.
  void disturb(double size, unsigned seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(-size, size);
    for (const std::size_t at : tangent.coordinates()) {
      position[at] += uniform(random);
      velocity[at] += uniform(random);
    }
  }

  /// Generalised forces; without inertia the drift.
  Vector forces() {
    const SystemView<double>& view = assembly_.system().view;
    const Stage<double> here =
        stage_of(view, static_cast<const double*>(position.data()),
                 static_cast<const double*>(velocity.data()),
                 static_cast<const double*>(integrals_.data()), rates_.data(), kElapsed);
    for (std::size_t k = 0; k < view.operation_count; ++k) {
      view.operations[k].run(view.operations[k].arguments, here);
    }
    Vector result(size());
    for (Eigen::Index k = 0; k < size(); ++k) {
      const std::size_t at = tangent.coordinates()[k];
      result[k] = view.force[at] * (view.inertial ? 1.0 : view.inverse_mass[at]);
    }
    return result;
  }

  void linearise() {
    tangent.linearise(position.data(), velocity.data(), integrals_.data(), kElapsed);
  }

  Matrix differences(AlignedVector<double>& of) {
    Matrix result(size(), size());
    for (Eigen::Index k = 0; k < size(); ++k) {
      double& x = of[tangent.coordinates()[k]];
      const double here = std::exchange(x, x + kStep);
      const Vector ahead = forces();
      x = here - kStep;
      const Vector behind = forces();
      x = here;
      result.col(k) = -(ahead - behind) / (2.0 * kStep);
    }
    return result;
  }

  template <class Times>
  Matrix matrix_of(Times&& times) const {
    Matrix result(size(), size());
    for (Eigen::Index k = 0; k < size(); ++k) {
      const Vector unit = Vector::Unit(size(), k);
      times(unit.data(), result.col(k).data());
    }
    return result;
  }
  Matrix stiffness() const {
    return matrix_of([&](const double* x, double* y) { tangent.times_stiffness(x, y); });
  }
  Matrix friction() const {
    return matrix_of([&](const double* x, double* y) { tangent.times_friction(x, y); });
  }
  Matrix masses() const {
    return Eigen::Map<const Vector>(tangent.masses().data(), size()).asDiagonal();
  }
  Eigen::Index size() const { return static_cast<Eigen::Index>(tangent.coordinates().size()); }

 private:
  static constexpr double kElapsed = 0.3;

  Model model_;
  Assembly<double> assembly_;

 public:
  ForceTangent tangent;
  AlignedVector<double> position;
  AlignedVector<double> velocity;

 private:
  AlignedVector<double> integrals_;
  AlignedVector<double> rates_ = AlignedVector<double>(200, 0.0);
};

double largest(const Matrix& matrix) { return matrix.cwiseAbs().maxCoeff(); }

std::string run_of(const std::string& dynamics = "inertial") {
  return "[run]\nduration = 1.0\ndynamics = \"" + dynamics +
         "\"\nintegrator = { type = \"dopri5\" }\n";
}

const std::string kSubstrate =
    "[[force]]\nname = \"substrate\"\ntype = \"sinusoidal_substrate\"\namplitude = 0.3\n"
    "period = 1.0\n";
const std::string kSubstrateWithDecay = kSubstrate + "decay = 0.4\n";
const std::string kDrag =
    "[[force]]\nname = \"drag\"\ntype = \"viscous_damping\"\ncoefficient = 0.7\n";

std::string spring(const std::string& velocity, const std::string& attach) {
  return "[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\nstiffness = 1.7\nvelocity = " +
         velocity + "\nattach = " + attach + "\n";
}

std::string chain(int count, const std::string& more) {
  return "[[body]]\nname = \"chain\"\ntype = \"chain\"\nspacing = 1.0\nparticle_mass = 0.5\ncount "
         "= " +
         std::to_string(count) + "\n" + more +
         "[[force]]\nname = \"bonds\"\ntype = \"harmonic_bonds\"\npairs = \"neighbours\"\n"
         "stiffness = 3.0\nrest_lengths = 0.8\n";
}

std::string closed_chain(int count, const std::string& more = "") {
  return "[box]\nlengths = [" + digits(count) + "]\nperiodic = [true]\n" + chain(count, more);
}

std::string ring(const std::string& coordinates, const std::string& more = "",
                 const std::string& mass = "0.25") {
  return "[[body]]\nname = \"ring\"\ntype = \"ring\"\nradius = 0.8\ncount = 5\ncentre = [0.1, "
         "0.2]\n"
         "coordinates = \"" +
         coordinates + "\"\nparticle_mass = " + mass + "\n" + more;
}

const std::string kBonds =
    "[[force]]\nname = \"bonds\"\ntype = \"harmonic_bonds\"\npairs = \"all\"\nstiffness = 5.0\n"
    "rest_lengths = 0.9\n";
const std::string kUneven = "[0.1, 0.4, 0.2, 0.7, 0.3]";

struct Case {
  const char* name;
  std::string scene;
};

std::vector<Case> inertial_cases() {
  const std::string tip =
      "[[body]]\nname = \"tip\"\ntype = \"point\"\nposition = [0.2]\nparticle_mass = 1.5\n";
  return {
      {"a tip", tip + spring("[0.3]", "\"centre_of_mass\"") + kDrag + kSubstrate},
      {"an open chain", chain(7, kSubstrate + kDrag)},
      {"a long open chain with a driver on its centre",
       chain(45, kSubstrate + kDrag) + spring("[0.3]", "\"centre_of_mass\"")},
      {"a long chain with a driver on one particle",
       chain(45, kSubstrate + kDrag) + spring("[0.3]", "{ particle = 11 }")},
      {"a long chain with a driver on each particle",
       chain(45, kSubstrate + kDrag) + spring("[0.3]", "\"each_particle\"")},
      {"a long chain closed by its box", closed_chain(47, kSubstrate + kDrag)},
      {"the same with a driver on its centre",
       closed_chain(47, kSubstrate + kDrag) + spring("[0.3]", "\"centre_of_mass\"")},
      {"a flexible ring", ring("particles", kSubstrateWithDecay + kDrag + kBonds) +
                              spring("[0.3, 0.1]", "\"centre_of_mass\"")},
      {"a flexible ring, y held",
       ring("particles", "hold = [\"y\"]\n" + kSubstrateWithDecay + kDrag + kBonds)},
      {"a rigid ring",
       ring("rigid", kSubstrateWithDecay + kDrag) + spring("[0.3, 0.1]", "\"centre_of_mass\"")},
      {"a rigid ring of unequal masses, pulled at a particle",
       ring("rigid", kSubstrateWithDecay + kDrag, kUneven) +
           spring("[0.3, 0.1]", "{ particle = 2 }")},
      {"a rigid ring that does not turn",
       ring("rigid", "hold = [\"rotation\"]\n" + kSubstrateWithDecay + kDrag, kUneven)},
  };
}

TEST(Tangent, IsTheDerivativeOfTheForces) {
  for (const Case& c : inertial_cases()) {
    Linearised scene(c.scene + run_of());
    ASSERT_EQ(scene.tangent.unknown(), "") << c.name;
    for (unsigned seed = 1; seed <= 5; ++seed) {
      scene.disturb(0.15, seed);
      scene.linearise();
      const Matrix k = scene.stiffness();
      const Matrix g = scene.friction();
      EXPECT_LE(largest(k - scene.differences(scene.position)), kOfDifferences * largest(k))
          << c.name;
      EXPECT_LE(largest(g - scene.differences(scene.velocity)), kOfDifferences * largest(k))
          << c.name;
      EXPECT_GT(largest(k), 0.1) << c.name;
    }
  }
}

/// Without inertia G u follows the forces: the drift changes by -G^-1 K.
TEST(Tangent, IsTheDerivativeOfTheDrift) {
  for (const Case& c : inertial_cases()) {
    if (c.scene.find("viscous_damping") == std::string::npos) continue;
    Linearised scene(c.scene + run_of("overdamped"));
    for (unsigned seed = 1; seed <= 5; ++seed) {
      scene.disturb(0.15, seed);
      scene.linearise();
      const Matrix relaxation = scene.friction().lu().solve(scene.stiffness());
      EXPECT_LE(largest(relaxation - scene.differences(scene.position)),
                kOfDifferences * largest(relaxation))
          << c.name;
    }
  }
}

TEST(Tangent, SolvesAsEigenDoes) {
  for (const Case& c : inertial_cases()) {
    Linearised scene(c.scene + run_of());
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (unsigned seed = 1; seed <= 5; ++seed) {
      scene.disturb(0.15, seed);
      scene.linearise();
      for (const auto& [mass, friction, stiffness] :
           {std::array{1.0, 0.0, 0.0}, std::array{1e4, 1e2, 1.0}, std::array{0.5, 0.3, 1.0},
            std::array{0.0, 1.0, 0.5}, std::array{0.2, 0.0, 1.0}}) {
        const Matrix a =
            mass * scene.masses() + friction * scene.friction() + stiffness * scene.stiffness();
        Vector b(scene.size());
        for (double& x : b) x = uniform(random);
        Vector x = b;
        ASSERT_TRUE(scene.tangent.factor(mass, friction, stiffness)) << c.name;
        scene.tangent.solve(x.data());
        const Vector expected = a.fullPivLu().solve(b);
        EXPECT_LE((x - expected).norm(), kOfSolutions * expected.norm())
            << c.name << mass << ' ' << friction << ' ' << stiffness;
        const double log_determinant =
            a.fullPivLu().matrixLU().diagonal().cwiseAbs().array().log().sum();
        EXPECT_NEAR(scene.tangent.log_determinant(), log_determinant,
                    kOfSolutions * (1.0 + std::abs(log_determinant)))
            << c.name;
      }
    }
  }
}

/// At rest K is symmetric, and Sylvester's law counts its negative eigenvalues.
TEST(Tangent, CountsNegativeEigenvaluesAsEigenDoes) {
  std::size_t most = 0;
  for (const Case& c : inertial_cases()) {
    Linearised scene(c.scene + run_of());
    for (unsigned seed = 1; seed <= 8; ++seed) {
      scene.disturb(0.3, seed);
      std::fill(scene.velocity.begin(), scene.velocity.end(), 0.0);
      scene.linearise();
      const Matrix k = scene.stiffness();
      EXPECT_LE(largest(k - k.transpose()), 1e-13 * largest(k)) << c.name;
      for (const double shift : {0.0, -1.0, -7.0, 2.0}) {
        const Matrix a = k + shift * scene.masses();
        const Vector values = Eigen::SelfAdjointEigenSolver<Matrix>(a).eigenvalues();
        ASSERT_TRUE(scene.tangent.factor(shift, 0.0, 1.0)) << c.name;
        const auto expected = static_cast<std::size_t>((values.array() < 0.0).count());
        EXPECT_EQ(scene.tangent.negative(), expected) << c.name << shift;
        most = std::max(most, expected);
      }
    }
  }
  EXPECT_GE(most, 20U);
}

/// A chain that only its driver holds: the band alone is singular, the whole is not.
TEST(Tangent, SolvesWhatOnlyASpreadForceHolds) {
  const std::string driver = spring("[0.3]", "\"centre_of_mass\"");
  Linearised scene(chain(50, "") + driver + run_of());
  scene.linearise();
  ASSERT_TRUE(scene.tangent.factor(0.0, 0.0, 1.0));
  EXPECT_EQ(scene.tangent.negative(), 0U);
  const Vector uniform = Vector::Ones(scene.size());
  Vector x = uniform;
  scene.tangent.solve(x.data());
  // K 1 = (k/N) 1 for the driver's k, shared by N.
  EXPECT_LE((x - uniform * 50.0 / 1.7).norm(), 1e-10 * x.norm());
}

TEST(Tangent, NoticesWhatNothingHoldsAndTakesBorders) {
  for (const int count : {5, 50}) {
    Linearised scene(chain(count, "") + run_of());
    scene.disturb(0.1, 3);
    scene.linearise();
    EXPECT_FALSE(scene.tangent.factor(0.0, 0.0, 1.0));
    const Vector along = Vector::Ones(scene.size()) / std::sqrt(count);
    ASSERT_TRUE(scene.tangent.factor(0.0, 0.0, 1.0, along.data(), 1, 2.0));
    const Matrix a = scene.stiffness() + 2.0 * along * along.transpose();
    const Vector b = Vector::LinSpaced(scene.size(), -1.0, 2.0);
    Vector x = b;
    scene.tangent.solve(x.data());
    EXPECT_LE((a * x - b).norm(), kOfSolutions * b.norm());
    const Vector values = Eigen::SelfAdjointEigenSolver<Matrix>(a).eigenvalues();
    EXPECT_EQ(scene.tangent.negative(), static_cast<std::size_t>((values.array() < 0.0).count()));
    EXPECT_NEAR(scene.tangent.log_determinant(), values.cwiseAbs().array().log().sum(), 1e-9);
  }
}

/// The rotation of a small ring is a numerical zero, and seen as one, whatever its units.
TEST(Tangent, TheRotationOfASmallRingIsSingular) {
  const auto of_radius = [](double radius) {
    return "[[body]]\nname = \"ring\"\ntype = \"ring\"\nradius = " + digits(radius) +
           "\ncount = 8\ncentre = [0.4, 0.1]\ncoordinates = \"rigid\"\nparticle_mass = 0.125\n" +
           kSubstrate + spring("[0.0, 0.0]", "\"centre_of_mass\"") + run_of();
  };
  Linearised small(of_radius(1e-3));
  small.linearise();
  EXPECT_FALSE(small.tangent.factor(0.0, 0.0, 1.0));
  Linearised large(of_radius(0.7));
  large.linearise();
  EXPECT_TRUE(large.tangent.factor(0.0, 0.0, 1.0));
}

/// Differences would take so many evaluations.
TEST(Tangent, CountsItsColumns) {
  const std::string tip =
      "[[body]]\nname = \"tip\"\ntype = \"point\"\nposition = [0.2]\nparticle_mass = 1.5\n";
  const auto columns = [](const std::string& scene) {
    return Linearised(scene + run_of()).tangent.columns();
  };
  const std::string driver = spring("[0.3]", "\"centre_of_mass\"");
  EXPECT_EQ(columns(tip + kSubstrate), 1U);
  EXPECT_EQ(columns(chain(60, kSubstrate)), 3U);
  EXPECT_EQ(columns(chain(60, kSubstrate) + driver), 4U);
  EXPECT_EQ(columns(closed_chain(60, kSubstrate)), 3U);
  EXPECT_EQ(columns(ring("rigid", kSubstrate)), 3U);
  EXPECT_EQ(columns(ring("particles", kSubstrate + kBonds)), 10U);
}

}  // namespace
}  // namespace tomlin::test
