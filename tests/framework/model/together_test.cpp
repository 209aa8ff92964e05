#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/system/state_layout.hpp"
#include "framework/model/model.hpp"
#include "framework/model/properties.hpp"
#include "framework/model/stability.hpp"
#include "tests/support/ring_scenes.hpp"

// Pairs whose particles coincide: where their energy is level there they are as regular as
// anywhere, and else there is an error that says so.

namespace tomlin::test {
namespace {

constexpr double kStiffness = 3.0;
constexpr double kMass = 0.7;
constexpr double kLoad = 0.2;
constexpr double kDuration = 2.0;

std::string point_of(int dimension, double x) {
  std::string list = "[" + digits(x);
  for (int d = 1; d < dimension; ++d) list += ", 0.5";
  return list + "]";
}

std::string along_x(int dimension, double x) {
  std::string list = "[" + digits(x);
  for (int d = 1; d < dimension; ++d) list += ", 0.0";
  return list + "]";
}

/// A tip tied to the position of a support, and loaded along x: x - x0 = F/k (1 - cos(w t)).
std::string tied(int dimension, const std::string& tie, const std::string& run) {
  std::string all;
  for (const char* name : {"tip", "support"}) {
    all += std::string("[[body]]\nname = \"") + name +
           "\"\ntype = \"point\"\nposition = " + point_of(dimension, 0.25) +
           "\nparticle_mass = " + digits(kMass) + "\n";
    if (name == std::string("support")) all += "coordinates = \"fixed\"\n";
  }
  return all + "[[force]]\nname = \"tie\"\nbodies = [\"tip\", \"support\"]\n" + tie +
         "[[force]]\ntype = \"constant_force\"\nbody = \"tip\"\nforce = " +
         along_x(dimension, kLoad) + "\n[run]\nduration = " + digits(kDuration) + "\n" + run;
}

std::string harmonic(double rest) {
  return "type = \"harmonic_bonds\"\npairs = \"all\"\nstiffness = " + digits(kStiffness) +
         "\nrest_lengths = " + digits(rest) + "\n";
}

/// Morse bonds of the same stiffness at rest: 2 D a^2.
std::string morse(double rest) {
  return "type = \"morse_bonds\"\npairs = \"all\"\ndepth = " + digits(kStiffness / 2.0) +
         "\ninverse_width = 1.0\nrest_lengths = " + digits(rest) + "\n";
}

const std::string kFormula =
    "type = \"expression\"\nenergy = \"" + digits(0.5 * kStiffness) + " * r^2\"\n";

double swing() {
  return kLoad / kStiffness * (1.0 - std::cos(std::sqrt(kStiffness / kMass) * kDuration));
}

TEST(PairsInOnePlace, TieATipToItsSupportInEveryNumberType) {
  constexpr double kRight = 1e-9;  // the scheme's error
  for (const std::string type : {"double", "quadruple"}) {
    for (int dimension = 1; dimension <= 3; ++dimension) {
      for (const std::string& tie : {harmonic(0.0), kFormula}) {
        const RunResult result = run_text(
            tied(dimension, tie,
                 "number_type = \"" + type + "\"\nintegrator = " + fixed_step(1e-2) + "\n"));
        ASSERT_EQ(result.status, RunStatus::finished) << type << dimension << tie;
        EXPECT_NEAR(body_of(result, "tip")["centre_of_mass"][0] - 0.25, swing(), kRight)
            << type << dimension << tie;
        for (int d = 1; d < dimension; ++d) {
          EXPECT_EQ(body_of(result, "tip")["centre_of_mass"][static_cast<std::size_t>(d)], 0.5);
        }
      }
    }
  }
}

/// Schemes that use second derivatives.
TEST(PairsInOnePlace, HaveACurvatureThere) {
  constexpr double kRight = 1e-7;
  for (int dimension = 1; dimension <= 3; ++dimension) {
    for (const std::string& tie : {harmonic(0.0), kFormula}) {
      for (const std::string& scheme :
           {adaptive(1e-9, "radau9"),
            std::string("{ type = \"exponential_verlet\", dt = 1e-4 }")}) {
        const RunResult result = run_text(tied(dimension, tie, "integrator = " + scheme + "\n"));
        ASSERT_EQ(result.status, RunStatus::finished) << dimension << tie << scheme;
        EXPECT_NEAR(body_of(result, "tip")["centre_of_mass"][0] - 0.25, swing(), kRight)
            << dimension << tie << scheme;
      }
    }
    for (const std::string& tie : {harmonic(0.0), morse(0.0), kFormula}) {
      Model model(scene_of(tied(dimension, tie, "integrator = " + fixed_step(1e-2) + "\n")));
      StateLayout layout;
      model.declare(layout);
      RunState state(layout);
      model.attach(state);
      model.start();
      EXPECT_NEAR(stiffness_of(model).spring_frequency, std::sqrt(kStiffness / kMass), 1e-12)
          << dimension << tie;
    }
  }
}

TEST(PairsInOnePlace, KeepTheirProperties) {
  for (int dimension = 1; dimension <= 3; ++dimension) {
    for (const std::string& tie : {harmonic(0.0), kFormula}) {
      const auto results = check_properties(
          *scene_of(tied(dimension, tie, "integrator = " + fixed_step(1e-2) + "\n")));
      EXPECT_GT(results.size(), 10u);
      for (const PropertyResult& result : results) {
        EXPECT_TRUE(result.holds) << dimension << tie << result.force << " " << result.property
                                  << " " << result.worst.text();
      }
    }
  }
}

/// A bond with a length has no direction there.
TEST(PairsInOnePlace, WithALengthAreAnError) {
  for (int dimension = 2; dimension <= 3; ++dimension) {
    for (const std::string& tie : {harmonic(0.5), morse(0.5)}) {
      const RunResult result =
          run_text(tied(dimension, tie, "integrator = " + fixed_step(1e-2) + "\n"));
      ASSERT_EQ(result.status, RunStatus::failed) << dimension << tie;
      EXPECT_NE(result.failure->cause.find(
                    "particle 0 of \"tip\" and particle 0 of \"support\" coincide"),
                std::string::npos)
          << result.failure->cause;
    }
    EXPECT_THROW(run_text(tied(dimension, "type = \"expression\"\nenergy = \"(r - 0.5)^2\"\n",
                               "integrator = " + fixed_step(1e-2) + "\n")),
                 InputError);
  }
}

}  // namespace
}  // namespace tomlin::test
