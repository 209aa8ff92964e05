#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "framework/core/numbers/constants.hpp"
#include "framework/core/numbers/normal_numbers.hpp"
#include "tests/support/scenes.hpp"

// Properties of schemes with noise, without statistics. On a free, a dragged and a harmonic
// particle a step is y' = A y + B z + c with normal numbers z. The matrices are read off by unit
// states and by the numbers z, which follow from key and step; the stationary covariance, the drift
// and the diffusion of the scheme are those of these matrices.

namespace tomlin::test {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

/// Relative. Matrices are read off to some 1e-16, and equations with them lose up to four digits at
/// h gamma = 1e-3 and near h omega = 2.
constexpr double kClosedForm = 1e-10;
/// A step agrees with its matrices to some roundings of numbers of order one to a hundred.
constexpr double kLinear = 1e-12;

constexpr double kStepLength = 0.7;
constexpr double kBathTemperature = 0.37;
constexpr double kParticleMass = 1.3;
constexpr double kSteadyForce = 0.45;
constexpr std::uint64_t kNoiseSeed = 7;
constexpr std::uint64_t kNoiseStream = 3;

const std::vector<double> kDamped = {1e-3, 1e-2, 0.1, 0.5, 1.0, 2.0, 5.0, 20.0, 100.0};
const std::vector<double> kTurned = {0.05, 0.3, 1.0, 1.5, 1.9};

RandomKey bath_key() { return {kNoiseSeed, stream_of("bath", kNoiseStream)}; }

/// Returns the normal number of the only particle, on a line.
double bath_number(std::uint64_t step, std::uint64_t part) {
  constexpr std::size_t kTogether = 2 * kGroup;  // steps that share their numbers
  alignas(64) double numbers[kTogether];
  fill_normals(bath_key(), {step / kTogether, part, 0, 0}, kTogether, kGroup, numbers);
  return numbers[step % kTogether];
}

struct ProbeScene {
  std::string scheme;
  double coefficient = 0.0;
  double spring = 0.0;
  double force = 0.0;

  bool overdamped() const { return standard().integrator(scheme)->with_inertia == false; }
  std::string text() const {
    std::string all =
        "[[body]]\ntype = \"point\"\nposition = [0.0]\nparticle_mass = " + digits(kParticleMass) +
        "\n[[force]]\nname = \"bath\"\ntype = \"langevin\"\ncoefficient = " + digits(coefficient) +
        "\ntemperature = " + digits(kBathTemperature) + "\n";
    if (spring > 0.0) {
      all += "[[force]]\ntype = \"driving_spring\"\nvelocity = [0.0]\nstart = [0.0]\nstiffness = " +
             digits(spring) + "\n";
    }
    if (force != 0.0) {
      all += "[[force]]\ntype = \"constant_force\"\nforce = [" + digits(force) + "]\n";
    }
    return all +
           "[run]\nduration = 100.0\nallow_unstable = true\nseed = " + std::to_string(kNoiseSeed) +
           "\nstream = " + std::to_string(kNoiseStream) +
           (overdamped() ? "\ndynamics = \"overdamped\"" : "") + "\nintegrator = { type = \"" +
           scheme + "\", dt = " + digits(kStepLength) + " }\n";
  }
};

/// Takes single steps of a scheme from any state: position and, with inertia, velocity.
class StepProbe {
 public:
  explicit StepProbe(const ProbeScene& scene)
      : scheme_(scene.scheme),
        inertial_(!scene.overdamped()),
        engine_(scene_of(scene.text()), {}) {}

  std::size_t size() const { return inertial_ ? 2 : 1; }

  Vector step(const Vector& from, std::uint64_t number) {
    const SystemView<double>& view = engine_.model().system().view;
    const std::size_t at = engine_.model().bodies()[0].bound.slot.offset;
    view.position[at] = from[0];
    view.velocity[at] = inertial_ ? from[1] : 0.0;
    engine_.context().integrator->forces_changed();
    engine_.state().integers(scheme_ + ".step")[0] = static_cast<std::int64_t>(number);
    const std::ptrdiff_t kinetic = engine_.model().bodies()[0].kinetic_rate;
    if (kinetic != kNoRate) view.integrals[kinetic] = 0.0;
    const StepReport report =
        engine_.context().integrator->step(DoubleDouble(0.0), kStepLength, false);
    EXPECT_EQ(report.fault, StepFault::none);
    if (kinetic != kNoRate) half_step_energy_ = view.integrals[kinetic] / kStepLength;
    Vector to(size());
    to[0] = view.position[at];
    if (inertial_) to[1] = view.velocity[at];
    return to;
  }

  /// Kinetic energy of the last step, in its middle.
  double half_step_energy() const { return half_step_energy_; }

  /// The normal numbers that a step draws.
  Vector numbers(std::uint64_t step) const {
    if (scheme_ == "velocity_verlet") return pair_of(bath_number(step, 0), bath_number(step, 1));
    if (scheme_ == "leimkuhler_matthews") {
      return pair_of(bath_number(step, 0), bath_number(step + 1, 0));
    }
    return Vector::Constant(1, bath_number(step, 0));
  }

 private:
  static Vector pair_of(double first, double second) {
    Vector both(2);
    both << first, second;
    return both;
  }

  std::string scheme_;
  bool inertial_;
  Engine engine_;
  double half_step_energy_ = 0.0;
};

/// y' = A y + B z + c. The first component is the position.
struct LinearStep {
  Matrix a;
  Matrix b;
  Vector c;

  /// In the long run, of a step that contracts: S = A S A^T + B B^T.
  Matrix covariance() const {
    const auto n = a.rows();
    Matrix system = Matrix::Identity(n * n, n * n);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < n; ++j) {
        for (Eigen::Index k = 0; k < n; ++k) {
          for (Eigen::Index l = 0; l < n; ++l) system(i * n + j, k * n + l) -= a(i, k) * a(j, l);
        }
      }
    }
    const Matrix noise = b * b.transpose();
    Vector right(n * n);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < n; ++j) right[i * n + j] = noise(i, j);
    }
    const Vector solved = system.fullPivLu().solve(right);
    Matrix s(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < n; ++j) s(i, j) = solved[i * n + j];
    }
    return s;
  }

  /// Displacement, in all steps to come, per unit of each number of the rest of the state.
  Eigen::RowVectorXd moves() const {
    const auto rest = a.rows() - 1;
    const Matrix left = Matrix::Identity(rest, rest) - a.bottomRightCorner(rest, rest);
    return left.transpose().fullPivLu().solve(a.topRightCorner(1, rest).transpose()).transpose();
  }

  /// Diffusion coefficient D of a free particle: its mean square displacement grows by 2 D h a
  /// step.
  double diffusion() const {
    Eigen::RowVectorXd weight = b.row(0);
    if (a.rows() > 1) weight += moves() * b.bottomRows(a.rows() - 1);
    return weight.squaredNorm() / (2.0 * kStepLength);
  }

  double drift() const {
    double way = c[0];
    if (a.rows() > 1) way += moves().dot(c.tail(a.rows() - 1));
    return way / kStepLength;
  }
};

/// Read off by unit states and known numbers, and compared with steps from other states.
LinearStep linear_step(const ProbeScene& scene) {
  StepProbe probe(scene);
  const auto n = static_cast<Eigen::Index>(probe.size());
  const auto q = probe.numbers(0).size();
  const Vector none = Vector::Zero(n);
  LinearStep step;
  step.a = Matrix(n, n);
  const Vector origin = probe.step(none, 0);
  for (Eigen::Index k = 0; k < n; ++k) {
    step.a.col(k) = probe.step(Vector::Unit(n, k), 0) - origin;
  }
  Matrix known(q + 1, q + 1);
  Matrix reached(q + 1, n);
  for (Eigen::Index s = 0; s <= q; ++s) {
    const auto number = static_cast<std::uint64_t>(3 + 5 * s);
    known.row(s) << probe.numbers(number).transpose(), 1.0;
    reached.row(s) = probe.step(none, number).transpose();
  }
  const Matrix solved = known.fullPivLu().solve(reached);
  step.b = solved.topRows(q).transpose();
  step.c = solved.row(q).transpose();
  for (const std::uint64_t number : {1U, 17U, 1000000U}) {
    const Vector from = Vector::LinSpaced(n, -0.8, 0.6);
    const Vector expected = step.a * from + step.b * probe.numbers(number) + step.c;
    const Vector to = probe.step(from, number);
    EXPECT_LT((to - expected).norm(), kLinear * (1.0 + to.norm())) << scene.scheme << number;
  }
  if (scene.scheme != "leimkuhler_matthews") return step;
  // The second number is the next step's first: part of the state.
  LinearStep longer{Matrix::Zero(2, 2), Matrix(2, 1), Vector::Zero(2)};
  longer.a(0, 0) = step.a(0, 0);
  longer.a(0, 1) = step.b(0, 0);
  longer.b << step.b(0, 1), 1.0;
  longer.c[0] = step.c[0];
  return longer;
}

void expect_closed(double value, double exact, const std::string& what, double damped,
                   double turned = 0.0) {
  EXPECT_NEAR(value / exact, 1.0, kClosedForm)
      << what << ", h gamma = " << damped << ", h omega = " << turned;
}

/// By which drift and diffusion of the splittings with an exact flow of friction exceed the right
/// ones.
double too_fast(double damped) { return 0.5 * damped / std::tanh(0.5 * damped); }

struct InertialScheme {
  std::string name;
  std::function<double(double damped)> drift;     ///< and diffusion, by the exact ones
  std::function<double(double turned)> position;  ///< variance, by T/(m omega^2)
  std::function<double(double turned)> velocity;  ///< variance at the ends of steps, by T/m
};

const std::vector<InertialScheme>& inertial_schemes() {
  const auto exact = [](double) { return 1.0; };
  const auto reduced = [](double turned) { return 1.0 - 0.25 * turned * turned; };
  // Kicks and drifts keep the energy m v^2/2 + m omega^2 (1 - (h omega)^2/4) x^2/2, whose Maxwell
  // distribution friction and noise at the ends of steps keep as well.
  const auto widened = [](double turned) { return 1.0 / (1.0 - 0.25 * turned * turned); };
  static const std::vector<InertialScheme> schemes = {
      {"baoab", too_fast, exact, reduced},
      {"gjf", exact, exact, reduced},
      {"velocity_verlet", too_fast, widened, exact},
  };
  return schemes;
}

TEST(LangevinScheme, DriftAndDiffusionOfAFreeParticle) {
  for (const InertialScheme& scheme : inertial_schemes()) {
    for (const double damped : kDamped) {
      const double coefficient = damped * kParticleMass / kStepLength;
      const LinearStep step =
          linear_step({.scheme = scheme.name, .coefficient = coefficient, .force = kSteadyForce});
      EXPECT_NEAR(step.a(0, 0), 1.0, kLinear);
      EXPECT_NEAR(step.a(1, 0), 0.0, kLinear);
      expect_closed(step.diffusion(), kBathTemperature / coefficient * scheme.drift(damped),
                    scheme.name + ": diffusion", damped);
      expect_closed(step.drift(), kSteadyForce / coefficient * scheme.drift(damped),
                    scheme.name + ": drift", damped);
    }
  }
}

TEST(LangevinScheme, FreeVelocitiesHaveTheTemperature) {
  for (const InertialScheme& scheme : inertial_schemes()) {
    for (const double damped : kDamped) {
      LinearStep step =
          linear_step({.scheme = scheme.name, .coefficient = damped * kParticleMass / kStepLength});
      step.a = Matrix(step.a.bottomRightCorner(1, 1));
      step.b = Matrix(step.b.bottomRows(1));
      expect_closed(step.covariance()(0, 0), kBathTemperature / kParticleMass,
                    scheme.name + ": velocity", damped);
    }
  }
}

TEST(LangevinScheme, VariancesOfAHarmonicParticle) {
  for (const InertialScheme& scheme : inertial_schemes()) {
    for (const double damped : kDamped) {
      for (const double turned : kTurned) {
        const double omega = turned / kStepLength;
        const double spring = kParticleMass * omega * omega;
        const Matrix s = linear_step({.scheme = scheme.name,
                                      .coefficient = damped * kParticleMass / kStepLength,
                                      .spring = spring})
                             .covariance();
        expect_closed(s(0, 0), kBathTemperature / spring * scheme.position(turned),
                      scheme.name + ": position", damped, turned);
        expect_closed(s(1, 1), kBathTemperature / kParticleMass * scheme.velocity(turned),
                      scheme.name + ": velocity", damped, turned);
        EXPECT_NEAR(s(0, 1), 0.0, kClosedForm * std::sqrt(s(0, 0) * s(1, 1))) << scheme.name;
      }
    }
  }
}

/// The energy in the middle of a step is a quadratic form of position, velocity and noise.
double mean_half_step_energy(const ProbeScene& scene) {
  StepProbe probe(scene);
  constexpr Eigen::Index kArguments = 3;
  constexpr Eigen::Index kTerms = kArguments * (kArguments + 1) / 2;
  constexpr Eigen::Index kSamples = 3 * kTerms;
  Matrix terms(kSamples, kTerms);
  Vector energies(kSamples);
  for (Eigen::Index s = 0; s < kSamples; ++s) {
    const auto number = static_cast<std::uint64_t>(s);
    Vector y(kArguments);
    y << std::cos(1.0 + 2.0 * static_cast<double>(s)), std::sin(3.0 * static_cast<double>(s)),
        probe.numbers(number)[0];
    probe.step(y.head(2), number);
    energies[s] = probe.half_step_energy();
    Eigen::Index term = 0;
    for (Eigen::Index i = 0; i < kArguments; ++i) {
      for (Eigen::Index j = i; j < kArguments; ++j) terms(s, term++) = y[i] * y[j];
    }
  }
  const Vector form = terms.colPivHouseholderQr().solve(energies);
  EXPECT_LT((terms * form - energies).norm(), kLinear * (1.0 + energies.norm()));
  Matrix second = Matrix::Identity(kArguments, kArguments);
  second.topLeftCorner(2, 2) = linear_step(scene).covariance();
  double mean = 0.0;
  Eigen::Index term = 0;
  for (Eigen::Index i = 0; i < kArguments; ++i) {
    for (Eigen::Index j = i; j < kArguments; ++j) mean += form[term++] * second(i, j);
  }
  return mean;
}

TEST(LangevinScheme, VelocitiesWithinStepsHaveTheTemperature) {
  for (const std::string scheme : {"baoab", "gjf"}) {
    for (const double damped : kDamped) {
      for (const double turned : kTurned) {
        const double omega = turned / kStepLength;
        const double mean =
            mean_half_step_energy({.scheme = scheme,
                                   .coefficient = damped * kParticleMass / kStepLength,
                                   .spring = kParticleMass * omega * omega});
        expect_closed(2.0 * mean, kBathTemperature, scheme + ": in the middle", damped, turned);
      }
    }
  }
}

TEST(LangevinScheme, WithoutInertiaDriftAndDiffusionAreExact) {
  constexpr double kCoefficient = 2.3;
  for (const std::string scheme : {"leimkuhler_matthews", "euler_maruyama"}) {
    const LinearStep step =
        linear_step({.scheme = scheme, .coefficient = kCoefficient, .force = kSteadyForce});
    expect_closed(step.diffusion(), kBathTemperature / kCoefficient, scheme + ": diffusion", 0.0);
    expect_closed(step.drift(), kSteadyForce / kCoefficient, scheme + ": drift", 0.0);
  }
}

TEST(LangevinScheme, WithoutInertiaVarianceOfAHarmonicParticle) {
  constexpr double kCoefficient = 2.3;
  for (const double relaxed : {1e-3, 0.1, 0.5, 1.0, 1.5, 1.9}) {
    const double spring = relaxed * kCoefficient / kStepLength;
    const auto variance = [&](const std::string& scheme) {
      return linear_step({.scheme = scheme, .coefficient = kCoefficient, .spring = spring})
          .covariance()(0, 0);
    };
    const double exact = kBathTemperature / spring;
    expect_closed(variance("leimkuhler_matthews"), exact, "leimkuhler_matthews", relaxed);
    expect_closed(variance("euler_maruyama"), exact / (1.0 - 0.5 * relaxed), "euler_maruyama",
                  relaxed);
  }
}

// ---- bodies

/// Applies the only flow of a scene to velocities of the test's own.
class FlowProbe {
 public:
  explicit FlowProbe(const std::string& text) : engine_(scene_of(text), {}) {}

  const SystemView<double>& view() { return engine_.model().system().view; }
  const Model::Body& body(std::size_t k) { return engine_.model().bodies()[k]; }

  /// On the coordinates first, ..., as many as `from`. Returns them afterwards.
  Vector flow(std::size_t which, std::size_t first, const Vector& from, double h, bool midpoint,
              std::uint64_t step) {
    for (Eigen::Index k = 0; k < from.size(); ++k) {
      view().velocity[first + static_cast<std::size_t>(k)] = from[k];
    }
    const Flow<double>& flow = view().flows[which];
    FlowStage<double> stage;
    stage.position = view().position;
    stage.inverse_mass = view().inverse_mass;
    stage.velocity = view().velocity;
    stage.key = flow.key;
    stage.step = step;
    stage.heat = true;
    stage.midpoint = midpoint;
    heat_ = flow.run(flow.arguments, stage, h);
    return Eigen::Map<const Vector>(view().velocity + first, from.size());
  }
  double heat() const { return heat_; }

 private:
  Engine engine_;
  double heat_ = 0.0;
};

/// Friction that is not centred on the centre of mass: the centre drifts when the body turns.
std::string friction_off_centre(const std::string& hold) {
  return tables(R"([[body]] | name = "cluster" | type = "ring" | count = 5 | radius = 0.8
particle_mass = [0.1, 0.7, 0.3, 0.2, 0.4] | centre = [0.1, 0.8] | coordinates = "rigid"
)") + hold +
         tables(R"(
[[force]] | name = "bath" | type = "langevin" | coefficient = [0.9, 0.2, 0.05, 0.4, 0.6]
temperature = 0.37

[run] | duration = 1.0 | seed = 7 | stream = 3 | integrator = { type = "baoab", dt = 0.1 }
)");
}

/// Velocities of the centre and of the rotation, at rest otherwise: their covariance in the long
/// run is T M^-1, centre and rotation independent of each other however friction couples them.
TEST(LangevinScheme, RigidBodyWithFrictionOffItsCentre) {
  for (const std::string hold : {"", "hold = [\"y\"]", "hold = [\"rotation\"]"}) {
    FlowProbe probe(friction_off_centre(hold));
    const std::size_t centre = probe.body(0).bound.slot.centre;
    ASSERT_EQ(probe.view().flow_count, 1U);
    for (const bool midpoint : {false, true}) {
      for (const double turns : {0.0, 0.13, -0.4}) {
        for (const double h : {1e-3, 0.1, 3.0, 50.0}) {
          SCOPED_TRACE(hold + " " + digits(turns) + " " + digits(h));
          probe.view().position[centre + 2] = turns;
          std::vector<Eigen::Index> moving;
          for (std::size_t k = 0; k < 3; ++k) {
            if (probe.view().inverse_mass[centre + k] > 0.0) {
              moving.push_back(static_cast<Eigen::Index>(k));
            }
          }
          ASSERT_EQ(moving.size(), hold.empty() ? 3U : 2U);
          const auto step_from = [&](const Vector& from, std::uint64_t step) {
            return probe.flow(0, centre, from, h, midpoint, step);
          };
          const auto numbers_of = [](std::uint64_t step) {
            alignas(64) double numbers[kGroup];
            fill_normals(bath_key(), {step, 0, 0, 0}, kGroup, 3, numbers);
            return Vector(Eigen::Map<const Vector>(numbers, 3));
          };
          const Vector none = Vector::Zero(3);
          const Vector origin = step_from(none, 0);
          Matrix a = Matrix::Zero(3, 3);
          for (const Eigen::Index k : moving) a.col(k) = step_from(Vector::Unit(3, k), 0) - origin;
          Matrix known(3, 3);
          Matrix reached(3, 3);
          for (Eigen::Index s = 0; s < 3; ++s) {
            known.row(s) = numbers_of(static_cast<std::uint64_t>(s)).transpose();
            reached.row(s) = step_from(none, static_cast<std::uint64_t>(s)).transpose();
          }
          const Matrix b = known.fullPivLu().solve(reached).transpose();
          const Vector other = step_from(none, 29);
          EXPECT_LT((other - b * numbers_of(29)).norm(), kLinear);
          const auto n = static_cast<Eigen::Index>(moving.size());
          LinearStep step{Matrix(n, n), Matrix(n, 3), Vector::Zero(n)};
          for (Eigen::Index i = 0; i < n; ++i) {
            for (Eigen::Index j = 0; j < n; ++j) {
              step.a(i, j) =
                  a(moving[static_cast<std::size_t>(i)], moving[static_cast<std::size_t>(j)]);
            }
            step.b.row(i) = b.row(moving[static_cast<std::size_t>(i)]);
          }
          const Matrix s = step.covariance();
          for (Eigen::Index i = 0; i < n; ++i) {
            const auto at = [&](Eigen::Index k) {
              return probe.view().inverse_mass[centre + static_cast<std::size_t>(
                                                            moving[static_cast<std::size_t>(k)])];
            };
            for (Eigen::Index j = 0; j < n; ++j) {
              const double scale = kBathTemperature * std::sqrt(at(i) * at(j));
              EXPECT_NEAR(s(i, j) / scale, i == j ? 1.0 : 0.0, kClosedForm) << i << ", " << j;
            }
          }
          // Held coordinates stay.
          for (Eigen::Index k = 0; k < 3; ++k) {
            if (std::find(moving.begin(), moving.end(), k) == moving.end()) {
              EXPECT_EQ(other[k], 0.0);
            }
          }
        }
      }
    }
  }
}

/// The heat of a flow is the kinetic energy that it took.
TEST(LangevinScheme, HeatIsTheEnergyTaken) {
  FlowProbe probe(friction_off_centre(""));
  const std::size_t centre = probe.body(0).bound.slot.centre;
  Vector from(3);
  from << 0.4, -0.9, 0.2;
  for (std::uint64_t step = 0; step < 20; ++step) {
    const Vector to = probe.flow(0, centre, from, 0.3, false, step);
    double lost = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      lost += 0.5 * (from[i] * from[i] - to[i] * to[i]) / probe.view().inverse_mass[centre + k];
    }
    EXPECT_NEAR(probe.heat(), lost, kLinear) << step;
  }
}

/// Every coordinate of every body has numbers of its own.
TEST(LangevinScheme, EveryCoordinateHasNumbersOfItsOwn) {
  const std::string ring =
      "type = \"ring\"\nradius = 1.0\ncount = 20\nparticle_mass = 1.0\ncentre = [0.0, 2.0]\n";
  const auto bath = [](const std::string& body) {
    return "[[force]]\nname = \"bath_of_" + body + "\"\ntype = \"langevin\"\nbody = \"" + body +
           "\"\ncoefficient = 1.0\ntemperature = 1.0\n";
  };
  FlowProbe probe("[[body]]\nname = \"a\"\n" + ring + "[[body]]\nname = \"b\"\n" + ring +
                  "[[body]]\nname = \"c\"\ncoordinates = \"rigid\"\n" + ring + bath("a") +
                  bath("b") + bath("c") +
                  "[run]\nduration = 1.0\nintegrator = { type = \"baoab\", dt = 0.1 }\n");
  ASSERT_EQ(probe.view().flow_count, 3U);
  std::vector<double> all;
  for (std::size_t k = 0; k < 3; ++k) {
    const BodySlot<double>& slot = probe.body(k).bound.slot;
    const std::size_t first = slot.rigid ? slot.centre : slot.offset;
    const std::size_t length = slot.rigid ? 3 : 2 * slot.stride;
    // A flow of infinite length leaves nothing but the random numbers.
    const Vector to =
        probe.flow(k, first, Vector::Zero(static_cast<Eigen::Index>(length)), 1e3, false, 5);
    for (std::size_t i = 0; i < length; ++i) {
      const double inverse = probe.view().inverse_mass[first + i];
      if (inverse > 0.0) all.push_back(to[static_cast<Eigen::Index>(i)] / std::sqrt(inverse));
    }
  }
  ASSERT_EQ(all.size(), 83U);
  std::sort(all.begin(), all.end());
  for (std::size_t k = 1; k < all.size(); ++k) {
    EXPECT_GT(all[k] - all[k - 1], 1e-9) << "two coordinates share a number";
  }
}

/// Each particle has the temperature of its own bath; one of 0 only loses.
TEST(LangevinScheme, TemperaturesOfParticles) {
  FlowProbe probe(
      "[[body]]\ntype = \"chain\"\ncount = 3\nspacing = 1.0\nparticle_mass = [1.0, 2.0, 0.5]\n"
      "[[force]]\nname = \"bath\"\ntype = \"langevin\"\ntemperature = [0.0, 0.1, 0.4]\n"
      "coefficient = [1.0, 0.3, 2.0]\n"
      "[run]\nseed = 7\nstream = 3\nduration = 1.0\nintegrator = { type = \"baoab\", dt = 0.1 }\n");
  alignas(64) double numbers[kGroup];
  fill_normals(bath_key(), {5, 0, 0, 0}, kGroup, 3, numbers);
  const Vector to = probe.flow(0, probe.body(0).bound.slot.offset, Vector::Zero(3), 1e3, false, 5);
  const double temperature[] = {0.0, 0.1, 0.4};
  const double mass[] = {1.0, 2.0, 0.5};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(to[static_cast<Eigen::Index>(k)], std::sqrt(temperature[k] / mass[k]) * numbers[k],
                kLinear);
  }
}

}  // namespace
}  // namespace tomlin::test
