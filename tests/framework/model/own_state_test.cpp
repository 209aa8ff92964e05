#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/records/bound_force.hpp"
#include "framework/core/records/force.hpp"
#include "tests/support/order.hpp"
#include "tests/support/ring_scenes.hpp"

// The state contract: a force with variables of its own, which the engine lays out, integrates and
// hands on. A Maxwell element, a spring and a dashpot in series, between each particle and its
// starting point:
//
//   F = -k (x - x0 - z),  dz/dt = (x - x0 - z)/tau        (z: how far the dashpot has moved)

namespace tomlin::test {
namespace {

struct MaxwellDescription {
  double stiffness = 0.0;
  double time = 0.0;
  double start = 0.0;
};

class BoundMaxwell : public BoundForce<double>, public InternalVariables<double> {
 public:
  BoundMaxwell(const MaxwellDescription& d, const Binding<double>& binding)
      : d_(d), body_(*binding.bodies.front()) {
    arguments_ = {body_.slot, d.stiffness, 1.0 / d.time, 0, {}};
    for (const auto& start : body_.start) arguments_.start.push_back(start[0]);
  }

  std::vector<Pass<double>> passes() override {
    return {{&run<true>, &run<false>, &arguments_, {{body_.index, false}}, kRankCheap}};
  }
  std::size_t own_count() const override { return body_.slot.count; }
  void place_own(std::size_t first) override { arguments_.first = first; }
  void start_own(double* own) const override {
    for (std::size_t i = 0; i < body_.slot.count; ++i) own[arguments_.first + i] = d_.start;
  }
  double energy(const Stage<double>& stage) const override {
    double total = 0.0;
    for (std::size_t i = 0; i < body_.slot.count; ++i) {
      const double stretch = stage.position[body_.slot.offset + i] - arguments_.start[i] -
                             stage.own[arguments_.first + i];
      total += 0.5 * d_.stiffness * stretch * stretch;
    }
    return total;
  }

 private:
  struct Arguments {
    BodySlot<double> body;
    double stiffness = 0.0;
    double rate = 0.0;
    std::size_t first = 0;
    std::vector<double> start;
  };

  template <bool set>
  static void run(const void* arguments, const Stage<double>& stage) {
    const auto& a = *static_cast<const Arguments*>(arguments);
    for (std::size_t i = 0; i < a.body.count; ++i) {
      const double stretch =
          stage.position[a.body.offset + i] - a.start[i] - stage.own[a.first + i];
      double& f = stage.force[a.body.offset + i];
      f = (set ? 0.0 : f) - a.stiffness * stretch;
      stage.rates[a.first + i] = stretch * a.rate;
    }
  }

  MaxwellDescription d_;
  BoundBody<double> body_;
  Arguments arguments_;
};

ForceRecord maxwell_record() {
  ForceRecord record;
  record.name = "maxwell_element";
  record.summary = "a spring and a dashpot in series";
  record.equation = "F = -stiffness (x - x0 - z), dz/dt = (x - x0 - z)/time";
  record.source = "Maxwell (1867)";
  record.example = "none: it lives in a test";
  record.element = Element::site;
  record.make_description = &make_description<MaxwellDescription>;
  record.parameters = {
      parameter("stiffness", &MaxwellDescription::stiffness, dimension::stiffness, "of the spring")
          .in(positive),
      parameter("time", &MaxwellDescription::time, dimension::time, "in which the dashpot follows")
          .in(positive),
      parameter("start", &MaxwellDescription::start, dimension::length, "of the dashpot at t = 0")
          .by_default(0.0)};
  record.complaints = [](const void*, const SceneOutline&) { return std::vector<Complaint>(); };
  record.period = [](const void*, int) { return 0.0; };
  record.bind =
      +[](const void* d, const Binding<double>& binding) -> std::unique_ptr<BoundForce<double>> {
    return std::make_unique<BoundMaxwell>(*static_cast<const MaxwellDescription*>(d), binding);
  };
  return record;
}

const Registry& with_maxwell() {
  static const Registry registry = [] {
    Registry r = standard_registry();
    r.add(maxwell_record());
    return r;
  }();
  return registry;
}

constexpr double kStiffness = 3.0;
constexpr double kTime = 0.7;
constexpr double kMass = 1.2;
constexpr double kDuration = 3.2;

/// Three particles, each with two elements; a driver too weak to matter puts rates behind the own
/// variables.
std::string scene_text(const std::string& integrator, double duration = kDuration) {
  const std::string element =
      "type = \"maxwell_element\"\nstiffness = " + digits(kStiffness) + "\ntime = " + digits(kTime);
  return "[[body]]\nname = \"row\"\ntype = \"chain\"\ncount = 3\nspacing = 1.0\nparticle_mass = " +
         digits(kMass) +
         "\nvelocity = [[0.5], [-0.3], [1.1]]\n"
         "[[force]]\nname = \"one\"\n" +
         element + "\n[[force]]\nname = \"two\"\n" + element +
         "\nstart = 0.25\n[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\n"
         "stiffness = 1e-300\nvelocity = [1.0]\n"
         "[run]\nduration = " +
         digits(duration) + "\nintegrator = " + integrator + "\n";
}

/// x - x0, v, z1, z2 of one particle: y' = A y, by a Taylor series over short intervals.
std::array<double, 4> exact(double v0, double duration = kDuration) {
  using Real = long double;
  const Real a = Real(kStiffness) / kMass;
  const Real r = 1 / Real(kTime);
  std::array<Real, 4> y = {0, v0, 0, Real(0.25)};
  constexpr int kIntervals = 200;
  const Real h = Real(duration) / kIntervals;
  for (int k = 0; k < kIntervals; ++k) {
    std::array<Real, 4> term = y;
    for (int n = 1; n < 30; ++n) {
      const Real x = term[0], v = term[1], z1 = term[2], z2 = term[3];
      term = {v, -a * (2 * x - z1 - z2), (x - z1) * r, (x - z2) * r};
      for (int i = 0; i < 4; ++i) {
        term[i] *= h / n;
        y[i] += term[i];
      }
    }
  }
  return {static_cast<double>(y[0]), static_cast<double>(y[1]), static_cast<double>(y[2]),
          static_cast<double>(y[3])};
}

double error_of(Engine& engine, double duration = kDuration) {
  const double starts[3] = {0.5, -0.3, 1.1};
  const double* x = engine.state().reals("position");
  const double* v = engine.state().reals("velocity");
  const double* own = engine.state().reals("integrals");
  double error = 0.0;
  for (int i = 0; i < 3; ++i) {
    const auto y = exact(starts[i], duration);
    error = std::max({error, std::abs(x[i] - i - y[0]), std::abs(v[i] - y[1]),
                      std::abs(own[i] - y[2]), std::abs(own[3 + i] - y[3])});
  }
  return error;
}

TEST(OwnState, IsLaidOutBeforeTheRunningIntegrals) {
  Model model(parse_scene(scene_text(fixed_step(0.1)), "test.toml", with_maxwell()));
  EXPECT_EQ(model.system().view.own, kGroup);
  EXPECT_EQ(model.system().view.rates, 2 * kGroup);
  EXPECT_EQ(model.forces()[2].first_rate, static_cast<std::ptrdiff_t>(kGroup));
}

TEST(OwnState, IsIntegratedToTheOrderOfTheScheme) {
  const auto order_of = [&](auto integrator) {
    std::vector<double> steps, errors;
    for (double h = 0.16; h > 0.015; h *= 0.5) {
      Engine engine(parse_scene(scene_text(integrator(h)), "test.toml", with_maxwell()), {});
      EXPECT_EQ(engine.run().status, RunStatus::finished);
      steps.push_back(h);
      errors.push_back(error_of(engine));
    }
    return fitted_order(steps, errors, 1e-13);
  };
  const double rk4 = order_of([](double h) { return fixed_step(h); });
  EXPECT_GT(rk4, 3.8);
  EXPECT_LT(rk4, 4.25);
  const double dopri5 = order_of([](double h) { return adaptive_held_to(h); });
  EXPECT_GT(dopri5, 4.7);
  EXPECT_LT(dopri5, 5.5);
}

TEST(OwnState, IsKeptWithinTheTolerance) {
  for (const double tolerance : {1e-6, 1e-9}) {
    Engine engine(parse_scene(scene_text(adaptive(tolerance)), "test.toml", with_maxwell()), {});
    engine.run();
    EXPECT_LT(error_of(engine), 100.0 * tolerance);
    EXPECT_GT(error_of(engine), 1e-4 * tolerance) << "far more work than asked for";
  }
}

/// A particle so heavy that nothing but the own variable moves: z follows exp(-t/tau), and the step
/// is its to choose.
TEST(OwnState, HasASayInTheStep) {
  const std::string text =
      "[[body]]\ntype = \"point\"\nposition = [0.0]\nparticle_mass = 1e12\n"
      "[[force]]\ntype = \"maxwell_element\"\nstiffness = 1.0\ntime = 0.05\nstart = 1.0\n"
      "[run]\nduration = 0.5\nintegrator = { type = \"dopri5\", absolute_tolerance = 1e-8, "
      "relative_tolerance = 0.0, initial_step = 0.1 }\n";
  Engine engine(parse_scene(text, "test.toml", with_maxwell()), {});
  const RunResult result = engine.run();
  EXPECT_EQ(result.status, RunStatus::finished);
  EXPECT_NEAR(engine.state().reals("integrals")[0], std::exp(-10.0), 1e-6);
  EXPECT_GT(result.steps, 20u);
}

TEST(OwnState, IsPartOfWhatARunGoesOnFrom) {
  for (const std::string& integrator : {fixed_step(0.01), adaptive(1e-8)}) {
    const auto scene = parse_scene(scene_text(integrator), "test.toml", with_maxwell());
    Engine whole(scene, {});
    whole.run();
    Engine first(scene, {});
    first.advance(9);
    Engine second(scene, {});
    second.resume(first.state().to_bytes());
    second.run();
    EXPECT_TRUE(Motion(second) == Motion(whole));
  }
}

/// An implicit scheme would need their derivatives.
TEST(OwnState, IsRefusedByAnImplicitScheme) {
  const std::string text = scene_text(adaptive(1e-7, "radau9"));
  EXPECT_EQ(brief_refusal(text, with_maxwell()),
            "26:14 run.integrator.type = \"radau9\" [integrator.unsuitable]");
  EXPECT_NE(refusal(text, with_maxwell()).find("\"one\""), std::string::npos);
  EXPECT_EQ(refusal(scene_text(adaptive(1e-7)), with_maxwell()), "");
}

TEST(OwnState, SamplesDoNotTouchIt) {
  const auto plain = parse_scene(scene_text(fixed_step(0.01)), "test.toml", with_maxwell());
  const auto watched = parse_scene(scene_text(fixed_step(0.01)) + "[output]\nevery = 0.0137\n",
                                   "test.toml", with_maxwell());
  KeptSamples kept;
  Engine a(plain, {});
  Engine b(watched, watched_by(kept));
  a.run();
  b.run();
  EXPECT_TRUE(Motion(a) == Motion(b));
  EXPECT_GT(kept.rows.size(), 200u);
}

}  // namespace
}  // namespace tomlin::test
