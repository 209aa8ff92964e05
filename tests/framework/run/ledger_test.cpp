#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "forcefields/viscous_damping.hpp"
#include "framework/core/numbers/constants.hpp"
#include "framework/core/records/bound_force.hpp"
#include "framework/core/records/force.hpp"
#include "tests/support/order.hpp"
#include "tests/support/ring_scenes.hpp"

// The energy ledger: work in, heat out, energy stored; what is left over is the integrator's.

namespace tomlin::test {
namespace {

std::string keep_ledger(const std::string& dynamics = "inertial") {
  return "ledger = true\ndynamics = \"" + dynamics + "\"\n";
}

/// A tip in stick-slip; the slowest numbers to be right.
TipScene tip(const std::string& integrator, const std::string& more) {
  return {.velocity = 0.4,
          .stiffness = 1.4,
          .damping = 0.6,
          .amplitude = 0.15,
          .position = 0.15,
          .start_velocity = 0.3,
          .duration = 6.4,
          .integrator = integrator,
          .more = more};
}

/// Kinetic energy, driving spring and corrugation, by hand.
double energy_by_hand(const TipScene& tip, double t, double x, double v, bool inertial) {
  const double stretch = tip.velocity * t + tip.position - x;
  return (inertial ? 0.5 * v * v : 0.0) + 0.5 * tip.stiffness * stretch * stretch +
         tip.amplitude * std::cos(kTau * x / tip.period);
}

struct Scheme {
  std::string name;
  std::function<std::string(double)> held_to;
  std::string dynamics;
  double longest;
  Window order;  ///< of what it adds to the energy
};

// The ledger's terms are integrated by the scheme, so what does not balance falls with its order;
// schemes that hold energy better than their order may do better by one or more.
std::vector<Scheme> schemes() {
  return {{"rk4", fixed_step, "inertial", 0.05, {3.8, 5.3}},
          {"dopri5", adaptive_held_to, "inertial", 0.2, {4.7, 6.3}},
          {"velocity_verlet", verlet, "inertial", 0.1, {1.9, 2.2}},
          {"rk4", fixed_step, "overdamped", 0.1, {3.7, 5.3}},
          {"dopri5", adaptive_held_to, "overdamped", 0.1, {4.6, 6.5}}};
}

TEST(Ledger, WhatTheSchemeAddsFallsWithItsOrder) {
  for (const Scheme& scheme : schemes()) {
    std::vector<double> steps;
    std::vector<double> added;
    for (double h = scheme.longest; h > scheme.longest / 10.0; h *= 0.5) {
      // At a single end leading terms may cancel.
      double most = 0.0;
      for (const double duration : {4.8, 5.6, 6.4}) {
        TipScene scene = tip(scheme.held_to(h), keep_ledger(scheme.dynamics));
        scene.duration = duration;
        most = std::max(most, std::abs(*run_text(scene.text()).group("energy")["numerical_work"]));
      }
      steps.push_back(h);
      added.push_back(most);
    }
    const double order = fitted_order(steps, added, 1e-14);
    EXPECT_TRUE(scheme.order.holds(order))
        << scheme.name << ", " << scheme.dynamics << ": " << order;
  }
}

/// Each term against the same term of a run that is far more exact, and the balance against the
/// energies at both ends, which know nothing of integrals.
TEST(Ledger, EachTermIsRight) {
  for (const Scheme& scheme : schemes()) {
    SCOPED_TRACE(scheme.name + ", " + scheme.dynamics);
    const bool inertial = scheme.dynamics == "inertial";
    const TipScene coarse = tip(scheme.held_to(0.02), keep_ledger(scheme.dynamics));
    const TipScene fine = tip(adaptive(1e-13), keep_ledger(scheme.dynamics));
    const RunResult result = run_text(coarse.text());
    const RunResult exact = run_text(fine.text());
    const ResultGroup& e = result.group("energy");
    const ResultGroup& f = exact.group("energy");
    const double tolerance = scheme.order.high < 3.0 ? 2e-3 : 5e-6;
    EXPECT_NEAR(*e["work_in"], *f["work_in"], tolerance);
    EXPECT_NEAR(*e["heat_out"], *f["heat_out"], tolerance);
    EXPECT_NEAR(*e["stored_change"], *f["stored_change"], tolerance);
    EXPECT_LT(std::abs(*f["numerical_work"]), 1e-11);
    EXPECT_GT(*e["heat_out"], 0.05);
    EXPECT_NE(*e["numerical_work"], 0.0);

    EXPECT_EQ(*e["work_in"], *result.driver(0)["work"]);
    const double x = result.body(0)["centre_of_mass"][0];
    const double v = result.body(0)["velocity"][0];
    const double change =
        energy_by_hand(coarse, coarse.duration, x, v, inertial) -
        energy_by_hand(coarse, 0.0, coarse.position, coarse.start_velocity, inertial);
    EXPECT_NEAR(*e["stored_change"], change, 1e-14);
    EXPECT_NEAR(e["kinetic"].value(), inertial ? 0.5 * v * v : 0.0, 1e-15);
    EXPECT_NEAR(*e["numerical_work"], change + *e["heat_out"] - *e["work_in"], 1e-14);
  }
}

/// A tip that trails its driver by c V / k slides steadily: heat and work are c V^2 t, exactly.
TEST(Ledger, OfASteadySlideIsKnown) {
  const double c = 0.6, k = 1.4, v = 0.4, duration = 6.4;
  for (const Scheme& scheme : schemes()) {
    const std::string scene =
        "[[body]]\ntype = \"point\"\nposition = [0.0]\nvelocity = [" + digits(v) +
        "]\nparticle_mass = 1.0\n[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\n"
        "stiffness = " +
        digits(k) + "\nvelocity = [" + digits(v) + "]\nstart = [" + digits(c * v / k) +
        "]\n[[force]]\ntype = \"viscous_damping\"\ncoefficient = " + digits(c) +
        "\n[run]\nduration = " + digits(duration) + "\nintegrator = " + scheme.held_to(0.05) +
        "\n" + keep_ledger(scheme.dynamics);
    const ResultGroup e = run_text(scene).group("energy");
    const bool splits = scheme.name == "velocity_verlet";  // slides steadily to its order only
    EXPECT_NEAR(*e["heat_out"], c * v * v * duration, splits ? 1e-3 : 1e-13) << scheme.name;
    EXPECT_NEAR(*e["work_in"], c * v * v * duration, splits ? 1e-3 : 1e-13) << scheme.name;
  }
}

/// Without dampers and drivers the ledger is the drift of the energy.
TEST(Ledger, OfAClosedSystemIsItsDrift) {
  const std::string scene = tables(R"([[body]] | type = "chain" | count = 3 | spacing = 1.1
particle_mass = 1.0
[[force]] | type = "harmonic_bonds" | pairs = "neighbours" | stiffness = 4.0
rest_lengths = 1.0
[run] | duration = 20.0 | ledger = true | integrator = )");
  for (const std::string& integrator : {fixed_step(0.1), verlet(0.1), adaptive(1e-5)}) {
    const ResultGroup e = run_text(scene + integrator + "\n").group("energy");
    EXPECT_EQ(*e["work_in"], 0.0);
    EXPECT_EQ(*e["heat_out"], 0.0);
    EXPECT_EQ(*e["numerical_work"], *e["stored_change"]);
    // Two bonds stretched by 0.1 at the start.
    EXPECT_NEAR(e["kinetic"].value() + e["potential"].value() - *e["stored_change"],
                2.0 * 0.5 * 4.0 * 0.01, 1e-14);
    EXPECT_NE(*e["numerical_work"], 0.0);
  }
}

// ---- bodies

/// A ring, flexible or rigid, with friction centred on its mass or not.
TEST(Ledger, BalancesForRings) {
  for (const std::string coordinates : {"particles", "rigid"}) {
    for (const Scheme& scheme : schemes()) {
      if (coordinates == "particles" && scheme.dynamics == "overdamped") continue;
      SCOPED_TRACE(coordinates + ", " + scheme.name + ", " + scheme.dynamics);
      const auto numerical_work = [&](double h) {
        const RingScene ring{.coordinates = coordinates,
                             .bonds = 40.0,
                             .velocity = 0.6,
                             .duration = 4.0,
                             .integrator = scheme.held_to(h),
                             .more = keep_ledger(scheme.dynamics)};
        const ResultGroup e = run_text(ring.text()).group("energy");
        EXPECT_GT(*e["heat_out"], 0.1);
        return std::abs(*e["numerical_work"]);
      };
      const double h = 0.02;
      const double order = std::log2(numerical_work(h) / numerical_work(0.5 * h));
      EXPECT_GT(order, scheme.order.low - 0.3);
      EXPECT_LT(order, scheme.order.high + 3.0);  // a single end: leading terms may cancel
    }
  }
}

TEST(Ledger, IsThatOfTheWindow) {
  const auto work = [](double from, double to) {
    return run_text(tip(adaptive(1e-12), keep_ledger() + "[measure]\nin = \"time\"\nfrom = " +
                                             digits(from) + "\nto = " + digits(to) + "\n")
                        .text())
        .group("energy");
  };
  const ResultGroup first = work(0.0, 2.345);
  const ResultGroup second = work(2.345, 6.4);
  const ResultGroup whole = work(0.0, 6.4);
  constexpr double kDenseOutput = 1e-8;
  EXPECT_NEAR(*first["work_in"] + *second["work_in"], *whole["work_in"], kDenseOutput);
  EXPECT_NEAR(*first["heat_out"] + *second["heat_out"], *whole["heat_out"], kDenseOutput);
  EXPECT_NEAR(*first["stored_change"] + *second["stored_change"], *whole["stored_change"],
              kDenseOutput);
  EXPECT_LT(std::abs(*first["numerical_work"]), kDenseOutput);
  EXPECT_LT(std::abs(*second["numerical_work"]), kDenseOutput);
}

// ---- only what is asked for

TEST(Ledger, IsOffUnlessAskedFor) {
  const TipScene plain = tip(fixed_step(0.01), "");
  EXPECT_EQ(run_text(plain.text()).find("energy"), nullptr);
  const TipScene kept = tip(fixed_step(0.01), keep_ledger());
  Model without(scene_of(plain.text()));
  Model with(scene_of(kept.text()));
  EXPECT_EQ(without.system().view.used_rates, 2u) << "the driver's force and power";
  EXPECT_EQ(with.system().view.used_rates, 3u) << "and the damper's heat";
  EXPECT_LT(without.system().view.operation_count, with.system().view.operation_count);
}

/// Whether the books are kept or not, the motion is the same.
TEST(Ledger, DoesNotTouchTheMotion) {
  for (const Scheme& scheme : schemes()) {
    const auto end = [&](const std::string& keys) {
      const RunResult result = run_text(
          tip(scheme.held_to(0.02), keys + "dynamics = \"" + scheme.dynamics + "\"\n").text());
      return std::vector<double>{result.body(0)["centre_of_mass"][0], result.body(0)["velocity"][0],
                                 *result.driver(0)["work"]};
    };
    EXPECT_TRUE(same_bits(end("ledger = true\n"), end("ledger = false\n")))
        << scheme.name << ", " << scheme.dynamics;
  }
}

// ---- planted faults

/// A valid damper whose heat is off by a factor.
template <int percent>
class FalseHeat : public BoundForce<double>, public FrictionCoefficients {
 public:
  explicit FalseHeat(std::unique_ptr<BoundForce<double>> valid) : valid_(std::move(valid)) {}
  std::vector<Pass<double>> passes() override { return valid_->passes(); }
  bool heat(std::ptrdiff_t rate, Operation<double>& operation) override {
    rate_ = rate;
    if (!valid_->heat(rate, true_)) return false;
    operation = {&run, this};
    return true;
  }
  void friction(FrictionSink& sink) const override {
    facet_of<FrictionCoefficients>(*valid_)->friction(sink);
  }

 private:
  static void run(const void* self, const Stage<double>& stage) {
    const auto& a = *static_cast<const FalseHeat*>(self);
    a.true_.run(a.true_.arguments, stage);
    stage.rates[a.rate_] *= 0.01 * percent;
  }

  std::unique_ptr<BoundForce<double>> valid_;
  Operation<double> true_;
  std::ptrdiff_t rate_ = kNoRate;
};

template <int percent>
Registry with_false_heat() {
  Registry registry;
  for (const auto& body : standard().bodies()) registry.add(*body);
  for (const auto& scheme : standard().integrators()) registry.add(*scheme);
  for (const auto& valid : standard().forces()) {
    ForceRecord record = *valid;
    if (record.name == "viscous_damping") {
      record.bind = +[](const void* description, const Binding<double>& binding) {
        static const ForceRecord damping = viscous_damping_record();
        std::unique_ptr<BoundForce<double>> bound =
            std::make_unique<FalseHeat<percent>>(damping.bind.in_double(description, binding));
        return bound;
      };
    }
    registry.add(std::move(record));
  }
  return registry;
}

template <int percent>
double balance_with_false_heat() {
  const Registry registry = with_false_heat<percent>();
  const auto scene =
      parse_scene(tip(fixed_step(0.01), keep_ledger()).text(), "test.toml", registry);
  return std::abs(*run(scene).group("energy")["numerical_work"]);
}

TEST(PlantedFaults, AWrongHeatIsSeen) {
  const double valid = balance_with_false_heat<100>();
  EXPECT_LT(valid, 1e-8);
  EXPECT_GT(balance_with_false_heat<-100>(), 1e6 * valid) << "wrong sign";
  EXPECT_GT(balance_with_false_heat<50>(), 1e6 * valid) << "half";
  EXPECT_GT(balance_with_false_heat<101>(), 1e4 * valid) << "a percent";
}

}  // namespace
}  // namespace tomlin::test
