#include "tests/support/many_forces.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/numbers/constants.hpp"
#include "framework/core/system/state_layout.hpp"
#include "framework/model/model.hpp"
#include "framework/model/properties.hpp"
#include "tests/support/ring_scenes.hpp"
#include "tests/support/spoilt_registry.hpp"

// All forces of a scene at once, on every kind of body: against an evaluation written down a second
// time, and against the sum of each alone.

namespace tomlin::test {
namespace {

/// Sums of some hundred terms, each with some roundings, over the size of these terms.
constexpr double kRounding = 1e-12;
constexpr std::uint64_t kFirstSeeds[] = {1, 20000, 424242};
constexpr std::uint64_t kScenes = 40;  // after each of these; some ms each

/// A model at a state of its own, beside the same bodies of ManyForces.
class Beside {
 public:
  Beside(const std::shared_ptr<const Scene>& scene, ManyForces& many) : model_(scene), many_(many) {
    StateLayout layout;
    model_.declare(layout);
    state_ = RunState(layout);
    model_.attach(state_);
    model_.start();
    const SystemView<double>& view = model_.system().view;
    x_.assign(view.dofs + 2 * kGroup, 0.0);
    v_.assign(view.dofs + 2 * kGroup, 0.0);
    std::copy(view.position, view.position + view.dofs, x_.begin());
    rates_.assign(view.rates + 2 * kGroup, 0.0);
  }

  /// Coordinates somewhere near the start, and the particles where these put them.
  void move(double time) {
    time_ = time;
    const auto axes = static_cast<std::size_t>(many_.dimension);
    const double* inverse_mass = model_.system().view.inverse_mass;
    for (std::size_t b = 0; b < many_.bodies.size(); ++b) {
      ManyForces::Body& body = many_.bodies[b];
      const BodySlot<double>& slot = model_.bodies()[b].bound.slot;
      const auto displace = [&](std::size_t at, double by) {
        if (!(inverse_mass[at] > 0.0)) return;
        x_[at] += by * many_.uniform(-1.0, 1.0);
        v_[at] = by * many_.uniform(-1.0, 1.0);
      };
      body.x = body.start;
      body.v.assign(body.start.size(), ManyForces::Point{});
      if (slot.rigid || body.coordinates == "prescribed") {
        const ManyForces::Point from = body.mean(body.start);
        ManyForces::Point centre = from;
        ManyForces::Point velocity{};
        double turn = 0.0;
        double omega = 0.0;
        for (std::size_t d = 0; d < axes; ++d) {
          if (slot.rigid) {
            displace(slot.centre + d, 0.3);
            centre[d] = position(d, x_[slot.centre + d]);
            velocity[d] = v_[slot.centre + d];
          } else {
            centre[d] = from[d] + body.velocity[d] * time;
            velocity[d] = body.velocity[d];
          }
        }
        if (axes == 2 && slot.rigid) {
          displace(slot.centre + kRotation, 0.2);
          turn = kTau * x_[slot.centre + kRotation];
          omega = kTau * v_[slot.centre + kRotation];
        } else if (axes == 2) {
          turn = body.angular_velocity * time;
          omega = body.angular_velocity;
        }
        for (std::size_t i = 0; i < body.x.size(); ++i) {
          ManyForces::Point arm{};
          for (std::size_t d = 0; d < axes; ++d) arm[d] = body.start[i][d] - from[d];
          if (axes == 2) {
            const double x = arm[0];
            arm[0] = std::cos(turn) * x - std::sin(turn) * arm[1];
            arm[1] = std::sin(turn) * x + std::cos(turn) * arm[1];
          }
          for (std::size_t d = 0; d < axes; ++d) {
            body.x[i][d] = centre[d] + arm[d];
            body.v[i][d] = velocity[d];
          }
          if (axes == 2) {
            body.v[i][0] -= omega * arm[1];
            body.v[i][1] += omega * arm[0];
          }
        }
      } else if (!slot.mapped) {
        for (std::size_t i = 0; i < body.x.size(); ++i) {
          for (std::size_t d = 0; d < axes; ++d) {
            const std::size_t at = slot.offset + d * slot.stride + i;
            displace(at, 0.3);
            body.x[i][d] = position(d, x_[at]);
            body.v[i][d] = v_[at];
          }
        }
      }
    }
  }

  const double* evaluate() {
    model_.anchor(DoubleDouble(time_));
    model_.evaluate_at(DoubleDouble(time_), x_.data(), v_.data(), state_.reals("integrals"),
                       rates_.data());
    return model_.system().view.force;
  }

  /// How many numbers are not those of the other evaluation, and how many were looked at.
  std::size_t wrong(std::size_t& looked, std::string& first) {
    many_.evaluate(time_);
    const double* force = evaluate();
    std::size_t wrong = 0;
    const auto compare = [&](double found, double expected, double size, const std::string& what) {
      ++looked;
      if (std::abs(found - expected) <= kRounding * size) return;
      if (wrong++ == 0) first = what + ": " + digits(found) + " for " + digits(expected);
    };
    const auto axes = static_cast<std::size_t>(many_.dimension);
    for (std::size_t b = 0; b < many_.bodies.size(); ++b) {
      const ManyForces::Body& body = many_.bodies[b];
      const BodySlot<double>& slot = model_.bodies()[b].bound.slot;
      ManyForces::Point total{};
      ManyForces::Point size{};
      double torque = 0.0;
      double lever = 0.0;
      const ManyForces::Point centre = body.mean(body.x);
      for (std::size_t i = 0; i < body.x.size(); ++i) {
        for (std::size_t d = 0; d < axes; ++d) {
          total[d] += body.force[i][d];
          size[d] += body.size[i][d];
          if (slot.mapped) continue;
          compare(force[slot.offset + d * slot.stride + i], body.force[i][d], body.size[i][d],
                  body.name + ", particle " + std::to_string(i));
        }
        if (axes != 2) continue;
        for (std::size_t d = 0; d < 2; ++d) {
          const double arm = body.x[i][d] - centre[d];
          torque += (d == 0 ? 1.0 : -1.0) * arm * body.force[i][1 - d];
          lever += std::abs(arm) * body.size[i][1 - d];
        }
      }
      if (slot.rigid) {
        for (std::size_t d = 0; d < axes; ++d) {
          compare(force[slot.centre + d], total[d], size[d], body.name + ", the centre");
        }
        if (axes == 2) {
          compare(force[slot.centre + kRotation], kTau * torque, kTau * lever,
                  body.name + ", the rotation");
        }
      }
      for (const Model::Driver& driver : model_.drivers()) {
        if (driver.name != body.name) continue;
        for (std::size_t d = 0; d < axes; ++d) {
          compare(rates_[static_cast<std::size_t>(driver.first_rate) + d], -total[d], size[d],
                  body.name + ", what keeps it moving");
        }
      }
    }
    return wrong;
  }

  /// The bits of the last evaluation again.
  bool repeats() {
    const SystemView<double>& view = model_.system().view;
    const std::vector<double> before(view.force, view.force + view.dofs);
    evaluate();
    return std::equal(before.begin(), before.end(), view.force, [](double a, double b) {
      return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
    });
  }

 private:
  double position(std::size_t axis, double offset) const {
    return static_cast<double>(model_.placed(static_cast<int>(axis), offset));
  }

  Model model_;
  ManyForces& many_;
  RunState state_;
  AlignedVector<double> x_, v_, rates_;
  double time_ = 0.0;
};

TEST(ManyForces, AreWhatTheirEquationsSay) {
  std::size_t looked = 0;
  for (const std::uint64_t first : kFirstSeeds) {
    for (std::uint64_t seed = first; seed < first + kScenes; ++seed) {
      ManyForces many(seed);
      const std::string text = many.text();
      Beside beside(scene_of(text), many);
      for (const double time : {0.0, 0.37}) {
        beside.move(time);
        std::string which;
        ASSERT_EQ(beside.wrong(looked, which), 0u) << "seed " << seed << ", " << which << "\n"
                                                   << text;
        EXPECT_TRUE(beside.repeats()) << "seed " << seed << "\n" << text;
      }
    }
  }
  EXPECT_GT(looked, 2000u);
}

/// The suite itself, over the same scenes.
TEST(ManyForces, AreTheSumOfEachAlone) {
  int sums = 0;
  for (const std::uint64_t first : kFirstSeeds) {
    for (std::uint64_t seed = first; seed < first + kScenes / 8; ++seed) {
      const std::string text = ManyForces(seed).text();
      for (const PropertyResult& result :
           check_properties(*scene_of(text), {.displaced_states = 2})) {
        if (result.property != "sum") continue;
        EXPECT_TRUE(result.holds) << "seed " << seed << ", " << result.worst.text() << "\n" << text;
        sums += result.states;
      }
    }
  }
  EXPECT_GT(sums, 20);
}

// ---- planted faults

/// A right force but for the kernel that sets: it leaves a number of its region as it was.
class LeavesANumber : public BoundForce<double>, public Driving {
 public:
  LeavesANumber(std::unique_ptr<BoundForce<double>> valid, const BoundBody<double>& body)
      : valid_(std::move(valid)), body_(body) {
    pass_ = valid_->passes().front();
    driving_ = facet_of<Driving>(*valid_);
  }

  std::vector<Pass<double>> passes() override {
    return {{&set, &add, this, pass_.writes, pass_.rank}};
  }
  std::size_t rate_count() const override { return driving_->rate_count(); }
  void place_rates(std::ptrdiff_t first) override { driving_->place_rates(first); }
  bool depends_on_time() const override { return valid_->depends_on_time(); }
  void begin_step(const DoubleDouble& time) override { valid_->begin_step(time); }
  void rebase(const Origin& origin) override { valid_->rebase(origin); }
  double energy(const Stage<double>& stage) const override { return valid_->energy(stage); }
  const Drive* drive() const override { return driving_->drive(); }

 private:
  static void set(const void* arguments, const Stage<double>& stage) {
    const auto& self = *static_cast<const LeavesANumber*>(arguments);
    const BodySlot<double>& slot = self.body_.slot;
    const bool centre = self.pass_.writes.front().centre;
    double& left = centre        ? stage.force[slot.centre + kRotation]
                   : slot.mapped ? stage.mapped_force[slot.offset + slot.count - 1]
                                 : stage.force[slot.offset + slot.count - 1];
    const double before = left;
    self.pass_.set(self.pass_.arguments, stage);
    left = before;
  }
  static void add(const void* arguments, const Stage<double>& stage) {
    const auto& self = *static_cast<const LeavesANumber*>(arguments);
    self.pass_.add(self.pass_.arguments, stage);
  }

  std::unique_ptr<BoundForce<double>> valid_;
  Driving* driving_ = nullptr;
  BoundBody<double> body_;
  Pass<double> pass_;
};

template <const char* const& name>
std::unique_ptr<BoundForce<double>> leaves_a_number(const void* description,
                                                    const Binding<double>& binding) {
  return std::make_unique<LeavesANumber>(
      standard().force(name)->bind.in_double(description, binding), *binding.bodies.front());
}

const char* const kFormula = "expression";
const char* const kConstant = "constant_force";

/// A formula of the centre beside forces on the particles of a rigid body in the plane.
const std::string kCentreOfRigid = tables(R"([[body]] | type = "particles"
positions = [[0.1, 0.2], [1.3, 0.1], [0.9, 1.2], [0.3, 0.8]] | particle_mass = 1.0
coordinates = "rigid"
[[force]] | type = "sinusoidal_substrate" | amplitude = 0.2 | period = 1.0 | decay = 0.5
[[force]] | type = "expression" | energy = "1.0*xc^2"
[run] | duration = 1.0 | integrator = { type = "rk4", dt = 1e-3 }
)");

/// Two forces on each particle; the first sets.
const std::string kFree = tables(R"([[body]] | type = "chain" | count = 3 | spacing = 0.8
particle_mass = 0.7
[[force]] | type = "constant_force" | force = [0.5]
[[force]] | type = "sinusoidal_substrate" | amplitude = 0.2 | period = 1.0
[run] | duration = 1.0 | integrator = { type = "rk4", dt = 1e-3 }
)");

TEST(PlantedFaults, AKernelThatLeavesANumberIsFoundBySums) {
  const std::string expected = std::string(kAllForces) + ": sum";
  EXPECT_EQ(SpoiltRegistry(kFormula, nullptr).broken_in(kCentreOfRigid).count(expected), 0u);
  EXPECT_EQ(SpoiltRegistry(kConstant, nullptr).broken_in(kFree).count(expected), 0u);
  for (const std::uint64_t seed : {1, 2, 3}) {
    EXPECT_EQ(SpoiltRegistry(kFormula, &leaves_a_number<kFormula>)
                  .broken_in(kCentreOfRigid, seed)
                  .count(expected),
              1u);
    EXPECT_EQ(SpoiltRegistry(kConstant, &leaves_a_number<kConstant>)
                  .broken_in(kFree, seed)
                  .count(expected),
              1u);
  }
}

/// The other evaluation finds it as well: the kernels are evaluated twice in a row.
TEST(PlantedFaults, AKernelThatLeavesANumberIsFoundByTheEquations) {
  const SpoiltRegistry spoilt(kConstant, &leaves_a_number<kConstant>);
  int found = 0;
  for (std::uint64_t seed = 1; seed <= kScenes; ++seed) {
    ManyForces many(seed);
    const std::string text = many.text();
    if (text.find("constant_force") == std::string::npos) continue;
    Beside beside(parse_scene(text, "test.toml", spoilt.registry()), many);
    beside.move(0.37);
    std::size_t looked = 0;
    std::string which;
    beside.evaluate();
    found += beside.wrong(looked, which) > 0 ? 1 : 0;
  }
  EXPECT_GT(found, 3);
}

/// With assertions on no number stands where a kernel should set: what it leaves is none.
TEST(PlantedFaults, AKernelThatLeavesANumberLeavesNoneWithAssertions) {
#ifdef NDEBUG
  GTEST_SKIP() << "arrays of forces are filled in builds with assertions only";
#else
  const SpoiltRegistry spoilt(kFormula, &leaves_a_number<kFormula>);
  const auto run_with = [](const Registry& registry) {
    return run(parse_scene(kCentreOfRigid, "test.toml", registry), {});
  };
  EXPECT_FALSE(run_with(standard()).failure.has_value());
  EXPECT_TRUE(run_with(spoilt.registry()).failure.has_value());
#endif
}

// ---- the scenes in which it was found

/// A load through the centre is a constant force on each particle.
TEST(CentreFormula, LoadsARigidRingAsAConstantForceDoes) {
  const auto scene = [](const std::string& load) {
    return "[[body]]\nname = \"ring\"\ntype = \"ring\"\ncount = 5\nradius = 1.0\n"
           "centre = [0.0, 1.0]\nparticle_mass = 0.2\ncoordinates = \"rigid\"\n" +
           load +
           "[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = 0.02\nperiod = 1.0\n"
           "decay = 1.0\n[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\n"
           "stiffness = 2.0\nvelocity = [0.1, 0.0]\nattach = \"each_particle\"\n"
           "[[force]]\ntype = \"viscous_damping\"\ncoefficient = 0.5\n"
           "[run]\nduration = 3.0\nledger = true\n"
           "integrator = { type = \"rk4\", dt = 1e-2 }\n";
  };
  const RunResult formula =
      run_text(scene("[[force]]\ntype = \"expression\"\nenergy = \"0.1 * yc\"\n"));
  const RunResult plain =
      run_text(scene("[[force]]\ntype = \"constant_force\"\nforce = [0.0, -0.02]\n"));
  constexpr double kSame = 1e-12;  // rounding over 300 steps
  EXPECT_NEAR(*body_of(formula, "ring")["rotation"], *body_of(plain, "ring")["rotation"], kSame);
  EXPECT_NEAR(*driver_of(formula, "driver")["work"], *driver_of(plain, "driver")["work"], kSame);
}

}  // namespace
}  // namespace tomlin::test
