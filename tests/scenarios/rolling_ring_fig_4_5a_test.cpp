#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/study/sweep/bisection.hpp"
#include "framework/study/sweep/runner.hpp"
#include "framework/study/sweep/sweep_journal.hpp"
#include "tests/framework/output/temporary_folder.hpp"
#include "tests/scenarios/rolling_ring_figures.hpp"

/// Figs. 4 and 5a of Sircar and Patra: the threshold of smooth sliding.
namespace tomlin::test {
namespace {

constexpr const char* kFig4 = "rolling_ring/fig_4.toml";
constexpr const char* kFig5a = "rolling_ring/fig_5a.toml";

/// Largest speed over v of the run, and how it grows as the driver slows down tenfold: 0 where
/// sliding is smooth, 2/5 at the threshold, 1 where there is a slip of given speed.
double growth(const char* scene, std::vector<Setting> settings, double stiffness) {
  settings.push_back({"k", text_of(stiffness)});
  std::vector<double> reduced;
  for (const double v : {1e-3, 1e-4}) {
    settings.push_back({"v", text_of(v)});
    reduced.push_back(max_speed(run_shipped(scene, settings)) / v);
    settings.pop_back();
  }
  return std::log10(reduced[1] / reduced[0]);
}

// The next order is a factor v^(2/5) smaller.
constexpr double kSmearing = 0.4;
constexpr double kSmearingTolerance = 0.02;

struct HeldRing {
  int count;
  double radius;
};

/// The interval of k in which a sweep that is refined finds a threshold, `tomlin sweep --refine`.
Bisection refined_in_k(SceneDocument scene, const std::vector<Setting>& settings,
                       const std::string& k, const std::string& refine, double width) {
  SweepSettings sweep;
  sweep.over.push_back({"k", std::get<SweepValues>(SweepValues::parse(k)), {"--over"}, k});
  sweep.refine.what = {refine, {"--refine"}, ""};
  sweep.refine.to = {text_of(width), {"--refine-to"}, ""};
  SweepPlan plan(std::move(scene), registry(), settings, std::move(sweep), "1.2.3");
  const TemporaryFolder folder;
  SweepJournal journal(folder.path() / "journal", plan);
  SweepBisection bisection(plan, journal);
  SweepOptions options;
  options.add_points = [&bisection] { return bisection.add_points(); };
  run_sweep(plan, journal, options);
  EXPECT_EQ(bisection.all().size(), 1) << "one threshold";
  EXPECT_EQ(bisection.all().at(0).status, BisectionStatus::found);
  return bisection.all().at(0);
}

SceneDocument shipped(const char* scene) {
  return SceneDocument(std::string(paths::source) + "/scenarios/" + scene);
}

const std::vector<Setting> kEquilibriaOfRing = {
    kHeld, {"run.dynamics", "quasistatic"}, {"run.integrator", "{ type = \"continuation\" }"}};
constexpr double kThresholdFromEquilibria = 1e-4;
constexpr double kThresholdFromDynamics = 3e-3;

/// Slips end at k_crit: the path of equilibria has no fold beyond it.
TEST(RollingRingFig4, BisectionOfSlipsFindsTheThreshold) {
  for (const HeldRing ring : {HeldRing{8, 0.1}, HeldRing{5, 0.5}}) {
    const double threshold = 4.0 * kPi * kPi * std::abs(share(ring.count, ring.radius));
    std::vector<Setting> settings = kEquilibriaOfRing;
    settings.insert(settings.end(),
                    {{"N", std::to_string(ring.count)}, {"R", text_of(ring.radius)}});
    const Bisection found = refined_in_k(shipped(kFig4), settings, "8:40:5", "events.slips=0.5",
                                         kThresholdFromEquilibria);
    const auto& [low, high] = found.ends;
    EXPECT_GT(low.number, high.number);
    EXPECT_LE(high.at - low.at, kThresholdFromEquilibria);
    EXPECT_NEAR(0.5 * (low.at + high.at), threshold, kThresholdFromEquilibria) << ring.radius;
  }
}

/// From the largest speed at three velocities: at the threshold it grows as v^(3/5), so that k
/// where it is c v^(3/5) goes to the threshold for any c, in powers of v^(2/5). The parabola
/// through three of them has its value at v = 0 there, up to v^(6/5).
TEST(RollingRingFig4, BisectionOfSpeedsFindsTheThreshold) {
  const double threshold = 4.0 * kPi * kPi * std::abs(share(kParticles, 0.1));
  constexpr double kWidth = 1e-4;
  for (const double c : {1.0, 1.5}) {
    std::vector<double> at;
    std::vector<double> powers;
    for (const double v : {3e-4, 1e-4, 3e-5}) {
      const double level = c * std::pow(v, 0.6);
      const Bisection found = refined_in_k(shipped(kFig4), {kHeld, {"v", text_of(v)}}, "33:39:4",
                                           "ring.max_speed=" + text_of(level), kWidth);
      const auto& [low, high] = found.ends;
      at.push_back(low.at + (high.at - low.at) * (low.number - level) / (low.number - high.number));
      powers.push_back(std::pow(v, 0.4));
    }
    double limit = 0.0;
    for (std::size_t i = 0; i < at.size(); ++i) {
      double weight = 1.0;
      for (std::size_t j = 0; j < at.size(); ++j) {
        if (j != i) weight *= powers[j] / (powers[j] - powers[i]);
      }
      limit += weight * at[i];
    }
    EXPECT_NEAR(limit, threshold, kThresholdFromDynamics) << "c = " << c;
    EXPECT_GT(at.front() - threshold, 100.0 * kThresholdFromDynamics) << "no single speed shows it";
  }
}

TEST(RollingRingFig4, ThresholdIsTheSumOverTheRing) {
  // (16) as printed is negative at R = 0.5 and does not hold for five particles.
  for (const HeldRing ring : {HeldRing{8, 0.1}, HeldRing{8, 0.5}, HeldRing{5, 0.5}}) {
    const double threshold = 4.0 * kPi * kPi * std::abs(share(ring.count, ring.radius));
    const std::vector<Setting> settings = {
        {"N", std::to_string(ring.count)}, {"R", text_of(ring.radius)}, kHeld};
    EXPECT_NEAR(growth(kFig4, settings, threshold), kSmearing, kSmearingTolerance) << ring.radius;
    EXPECT_GT(growth(kFig4, settings, 0.95 * threshold), 0.6) << ring.radius;
    EXPECT_LT(growth(kFig4, settings, 1.05 * threshold), 0.2) << ring.radius;
  }
  EXPECT_NEAR(4.0 * kPi * kPi * share(8, 0.1).real(), 35.677, 5e-4);  // "k about 36"
  EXPECT_LT(share(8, 0.5).real(), 0.0);
  EXPECT_GT(std::abs(share(5, 0.5)) - std::abs(share(5, 0.5).real()), 0.01);
}

/// Largest u' of u' = s - u^3: a particle that a force growing with time drives through the
/// position where its potential is flat up to the fourth power.
double fastest_through_a_cubic() {
  constexpr double kStep = 1e-3;
  const auto rate = [](double s, double u) { return s - u * u * u; };
  double u = std::cbrt(-30.0);
  double fastest = 0.0;
  for (double s = -30.0; s < 10.0; s += kStep) {
    const double a = rate(s, u);
    const double b = rate(s + 0.5 * kStep, u + 0.5 * kStep * a);
    const double c = rate(s + 0.5 * kStep, u + 0.5 * kStep * b);
    const double d = rate(s + kStep, u + kStep * c);
    u += kStep / 6.0 * (a + 2.0 * b + 2.0 * c + d);
    fastest = std::max(fastest, rate(s + kStep, u));
  }
  return fastest;
}

TEST(RollingRingFig4, LargestSpeedAtTheThresholdIsThatOfACubic) {
  // On the top xi x' = k v t - c x^3, c = k (2 pi/a)^2/6: x' = v (k tau/xi) u', s = t/tau.
  const double k = 4.0 * kPi * kPi * share(8, 0.1).real();
  const double c = k * 4.0 * kPi * kPi / 6.0;
  const double v = 1e-5;
  const double tau = std::pow(kDamping * kDamping * kDamping / (c * k * k * v * v), 0.2);
  const auto result = run_shipped(kFig4, {{"k", text_of(k)}, {"v", text_of(v)}});
  // Inertia is of relative order 1/(xi tau) = 0.02.
  EXPECT_NEAR(max_speed(result) / (v * k * tau / kDamping * fastest_through_a_cubic()), 1.0, 0.02);
}

TEST(RollingRingFig4, IsTheRingThatIsMovedByHand) {
  for (const double k : {34.0, 38.0}) {
    RigidRing ring;
    ring.radius = 0.1;
    ring.corrugation = 1.0;
    ring.stiffness = k;
    const auto trace = two_periods(kFig4, {{"k", text_of(k)}});
    EXPECT_LT(difference_to(ring, trace, 1000), kSameTrace) << "k = " << k;
  }
}

TEST(RollingRingFig4, ManyParticlesFeelABesselFunction) {
  for (const double radius : {0.1, 0.5, 1.0}) {
    EXPECT_NEAR(share(64, radius).real(), std::cyl_bessel_j(0.0, 2.0 * kPi * radius), 1e-14);
  }
}

TEST(RollingRingFig4, SmoothSlidingHasTheSpeedOfItsEquilibria) {
  // dx/dX is largest on the top, 1/(1 - k_crit/k); what is left is of order v^2.
  for (const double stiffness : {38.0, 60.0}) {
    const double s = 4.0 * kPi * kPi * std::abs(share(kParticles, 0.1)) / stiffness;
    const auto result = run_shipped(
        kFig4,
        {{"k", text_of(stiffness)}, {"v", "1e-5"}, {"run.integrator.absolute_tolerance", "1e-11"}});
    EXPECT_NEAR(max_speed(result) / 1e-5 * (1.0 - s), 1.0, 1e-4) << stiffness;
    EXPECT_NEAR(mean_force(result) / (kDamping * 1e-5 / std::sqrt(1.0 - s * s)), 1.0, 1e-4);
  }
}

/// The path of equilibria of a ring too small to have a shape, with V0 = a = 1, from a well to the
/// next top. F_y does not know the driver, so that the height gives the position: with the y_c that
/// (18) has lost, cos(2 pi x) = k (y - R) exp(b y^2)/(2 b y).
class Path {
 public:
  Path(double stiffness, double radius, double b) : k_(stiffness), r_(radius), b_(b) {
    well_ = height_where(-1.0, 1e-12, radius);
    double above = radius;
    while (cosine(above) < 1.0) above += 1e-5;
    top_ = height_where(1.0, radius, above);
  }

  /// Largest speed of the ring over that of the driver; infinite beyond a fold.
  double fastest() const {
    constexpr int kPoints = 5000;
    double fastest = 0.0;
    Point last = at(0.0);
    for (int n = 1; n <= kPoints; ++n) {
      const Point point = at(0.5 - 0.5 * std::cos(kPi * n / kPoints));
      const double driven = last.driver - point.driver;
      if (driven < -1e-14) return HUGE_VAL;
      if (driven > 0.0) {
        fastest = std::max(fastest, std::hypot(point.x - last.x, point.y - last.y) / driven);
      }
      last = point;
    }
    return fastest;
  }

 private:
  struct Point {
    double x, y, driver;
  };

  double cosine(double y) const { return k_ * (y - r_) * std::exp(b_ * y * y) / (2.0 * b_ * y); }

  double height_where(double value, double low, double high) const {
    for (int n = 0; n < 200; ++n) {
      const double middle = 0.5 * (low + high);
      (cosine(middle) < value ? low : high) = middle;
    }
    return low;
  }

  Point at(double share) const {
    const double y = well_ + (top_ - well_) * share;
    const double x = std::acos(std::clamp(cosine(y), -1.0, 1.0)) / (2.0 * kPi);
    const double pull = 2.0 * kPi * std::exp(-b_ * y * y) * std::sin(2.0 * kPi * x);
    return {x, y, x - pull / k_};
  }

  double k_, r_, b_, well_, top_;
};

double fold_threshold(double radius, double b) {
  double folds = 1.0;
  double slides = 1000.0;
  for (int n = 0; n < 40; ++n) {
    const double middle = 0.5 * (folds + slides);
    (std::isinf(Path(middle, radius, b).fastest()) ? folds : slides) = middle;
  }
  return slides;
}

double papers_threshold(double b) { return std::pow(2.0 * b, 1.5) / std::sqrt(std::exp(1.0)); }

TEST(RollingRingFig5a, ThresholdIsTheFoldOfThePathInBothDirections) {
  const double threshold = fold_threshold(0.001, 50.0);
  EXPECT_NEAR(threshold, 56.096, 1e-3);  // found elsewhere, five digits
  EXPECT_NEAR(papers_threshold(50.0), 606.5, 0.1);
  const std::vector<Setting> settings = {{"lambda", "0.05"}};
  // The path bends, which the powers of v beyond the first know.
  EXPECT_NEAR(growth(kFig5a, settings, threshold), kSmearing, 3.0 * kSmearingTolerance);
  EXPECT_GT(growth(kFig5a, settings, 0.9 * threshold), 0.6);
  EXPECT_LT(growth(kFig5a, settings, 1.1 * threshold), 0.1);
  // Half the paper's threshold: it should stick and slip, and slides along its path.
  const auto result = run_shipped(kFig5a, {{"lambda", "0.05"}, {"k", "300"}, {"v", "1e-4"}});
  EXPECT_NEAR(max_speed(result) / 1e-4 / Path(300.0, 0.001, 50.0).fastest(), 1.0, 1e-4);
}

/// A particle at the height of the ring's centre, as the path of equilibria has it.
const std::string kParticleOfFig5a = tables(R"(
[parameters] | k = 56.0
[[body]] | type = "point" | position = [0.0, 0.001] | particle_mass = 1.0
[[force]] | type = "driving_spring" | stiffness = "k" | velocity = [1.0, 0.0]
[[force]] | type = "sinusoidal_substrate" | amplitude = 1.0 | period = 1.0 | decay = 50.0
[run] | dynamics = "quasistatic" | duration = 2.5
)");

TEST(RollingRingFig5a, BisectionOfSlipsFindsTheThreshold) {
  const auto threshold_of = [](SceneDocument scene, const std::vector<Setting>& settings) {
    const auto [low, high] = refined_in_k(std::move(scene), settings, "50:60:3", "events.slips=0.5",
                                          kThresholdFromEquilibria)
                                 .ends;
    return 0.5 * (low.at + high.at);
  };
  const double threshold = fold_threshold(0.001, 50.0);
  EXPECT_NEAR(threshold_of(SceneDocument(kParticleOfFig5a, "tip.toml"), {}), threshold,
              kThresholdFromEquilibria);
  // The ring has a shape: particles are R above and below the centre, b R^2 = 5e-5 of what they
  // feel.
  std::vector<Setting> of_ring = kEquilibriaOfRing;
  of_ring.push_back({"lambda", "0.05"});
  EXPECT_NEAR(threshold_of(shipped(kFig5a), of_ring) / threshold, 1.0, 1e-4);
}

TEST(RollingRingFig5a, IsTheRingThatIsMovedByHand) {
  for (const double k : {38.0, 40.0}) {
    RigidRing ring;
    ring.radius = 0.001;
    ring.lambda = 0.001;
    ring.corrugation = 1.0;
    ring.stiffness = k;
    const auto trace = two_periods(kFig5a, {{"k", text_of(k)}});
    EXPECT_LT(difference_to(ring, trace, 1000), kSameTrace) << "k = " << k;
  }
}

TEST(RollingRingFig5a, HasTheThresholdOfX) {
  const double threshold = fold_threshold(0.001, 1.0);  // lambda = 0.001
  EXPECT_NEAR(threshold, 4.0 * kPi * kPi, 1e-3);        // "about 40"
  EXPECT_NEAR(growth(kFig5a, {}, threshold), kSmearing, kSmearingTolerance);
}

}  // namespace
}  // namespace tomlin::test
