#include "framework/model/properties.hpp"

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "forcefields/harmonic_bonds.hpp"
#include "forcefields/sinusoidal_substrate.hpp"
#include "forcefields/viscous_damping.hpp"
#include "framework/core/records/bound_force.hpp"
#include "tests/support/ring_scenes.hpp"
#include "tests/support/spoilt_registry.hpp"

// The forces of a scene against their properties on its own bodies, and forces that are wrong on
// purpose: each must be caught.

namespace tomlin::test {
namespace {

// Finite differences of a right force are off by this: rounding, and an error of order h^8.
constexpr double kRight = 1e-8;
// A driver alone declares no period that positions could be counted in: 1e5 away they lose 5
// digits.
constexpr double kRightFarAway = 1e-6;

using Properties = std::vector<std::pair<std::string, std::string>>;

Properties properties_of(const std::vector<PropertyResult>& results) {
  Properties properties;
  for (const PropertyResult& result : results)
    properties.emplace_back(result.force, result.property);
  return properties;
}

/// Properties that are looked at near the start only, where errors have a size.
bool is_near(const std::string& property) {
  return property == "conservative" || property == "periodic" || property == "friction";
}

void expect_valid(const std::string& text, double right = kRight) {
  const auto results = check_properties(*scene_of(text));
  EXPECT_GT(results.size(), 10u);
  for (const PropertyResult& result : results) {
    EXPECT_TRUE(result.holds) << result.force << " " << result.property << " " << result.error
                              << " > " << result.allowed << " at " << result.worst.text() << "\n"
                              << text;
    if (!is_near(result.property)) continue;
    EXPECT_LT(result.error, right) << result.force << " " << result.property;
    EXPECT_LT(result.allowed, 1e-4)
        << "a check that allows all checks nothing: " << result.force << " " << result.property;
    EXPECT_EQ(result.states, 9);
  }
}

std::string chain(int count, double spacing, const std::string& axis, int dimension) {
  std::string origin = "0.3";
  for (int d = 1; d < dimension; ++d) origin += ", 0.2";
  return "[[body]]\ntype = \"chain\"\nparticle_mass = 0.7\ncount = " + std::to_string(count) +
         "\nspacing = " + digits(spacing) + "\naxis = \"" + axis + "\"\norigin = [" + origin +
         "]\n[[force]]\ntype = \"harmonic_bonds\"\npairs = \"neighbours\"\nstiffness = 3.0\n"
         "rest_lengths = " +
         digits(0.9 * spacing) +
         "\n[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = 0.2\nperiod = 1.0\n"
         "[run]\nduration = 1.0\nintegrator = { type = \"rk4\", dt = 1e-3 }\n";
}

TEST(Properties, AreThoseOfTheForcesThatAreBuilt) {
  const Properties all = properties_of(check_properties(*scene_of(TipScene{}.text())));
  const auto has = [&](const char* force, const char* property) {
    return std::count(all.begin(), all.end(), std::pair<std::string, std::string>(force, property));
  };
  for (const char* force : {"driver", "viscous_damping", "sinusoidal_substrate"}) {
    for (const char* property :
         {"finite", "balance", "origin", "time", "repeatable", "its own", "set and add", "padding",
          "point", "same bits", "number types", "digits", "quadruple", "not internal"}) {
      EXPECT_EQ(has(force, property), 1) << force << " " << property;
    }
    const bool is_drag = std::string(force) == "viscous_damping";
    for (const char* property : {"conservative", "exact", "path", "hessian", "velocity"}) {
      EXPECT_EQ(has(force, property), is_drag ? 0 : 1) << force << " " << property;
    }
    for (const char* property : {"dissipative", "friction", "not conservative", "uses velocity"}) {
      EXPECT_EQ(has(force, property), is_drag ? 1 : 0) << force << " " << property;
    }
    EXPECT_EQ(has(force, "internal"), 0) << force;
  }
  EXPECT_EQ(has("driver", "driver"), 1);
  EXPECT_EQ(has("sinusoidal_substrate", "periodic"), 1);
  EXPECT_EQ(has("driver", "periodic"), 0);
  EXPECT_EQ(has("driver", "uses time"), 1);
  for (const char* property : {"rebase", "tight"}) {
    EXPECT_EQ(has("sinusoidal_substrate", property), 1) << property;
    EXPECT_EQ(has("driver", property), 0) << property;
  }
  const auto rigid =
      properties_of(check_properties(*scene_of(RingScene{.coordinates = "rigid"}.text())));
  EXPECT_EQ(std::count(rigid.begin(), rigid.end(),
                       std::pair<std::string, std::string>("harmonic_bonds", "internal")),
            0);
  const auto flexible = properties_of(check_properties(*scene_of(RingScene{}.text())));
  EXPECT_EQ(std::count(flexible.begin(), flexible.end(),
                       std::pair<std::string, std::string>("harmonic_bonds", "internal")),
            1);
  EXPECT_TRUE(check_properties(*scene_of(RingScene{.coordinates = "fixed"}.text())).empty())
      << "nothing moves";
}

TEST(Properties, HoldOnTipsChainsAndRings) {
  expect_valid(TipScene{}.text());
  for (const char* coordinates : {"particles", "rigid"}) {
    for (const int count : {2, 8, 11}) {
      expect_valid(RingScene{.coordinates = coordinates, .count = count}.text());
    }
  }
  for (const int count : {2, 9, 60}) {
    for (int dimension = 1; dimension <= 3; ++dimension) {
      expect_valid(chain(count, 0.618, "x", dimension));
    }
    expect_valid(chain(count, 1.0, "y", 2));
  }
}

/// Sums over thousands of particles are rounded by more than those over some.
TEST(Properties, HoldForADriverOfManyParticles) {
  const std::string text =
      "[[body]]\ntype = \"chain\"\ncount = 4000\nspacing = 1.0\nparticle_mass = 1.0\n"
      "[[force]]\ntype = \"driving_spring\"\nstiffness = 1.0\nvelocity = [0.01]\n"
      "[run]\nduration = 1.0\nintegrator = { type = \"rk4\", dt = 0.01 }\n";
  for (const PropertyResult& result : check_properties(*scene_of(text))) {
    EXPECT_TRUE(result.holds) << result.property << " " << result.error << " > " << result.allowed;
  }
}

/// If the origin moved along an axis, coordinates held along it would stay behind.
TEST(Properties, HoldBesideABodyThatIsHeld) {
  for (const char* held : {"x", "y"}) {
    expect_valid(std::string(tables(R"(
[[body]] | name = "free" | type = "point" | position = [0.3, 0.2] | particle_mass = 1.0
[[body]] | name = "guided" | type = "chain" | count = 3 | spacing = 1.0 | axis = "x"
origin = [1.0, 0.4] | particle_mass = 0.5 | hold = [")")) +
                 held + tables(R"("]
[[force]] | name = "to_free" | type = "harmonic_bonds" | bodies = ["free", "guided"]
pairs = [[0, 0], [0, 2]] | stiffness = 3.0 | rest_lengths = 0.8
[[force]] | name = "within" | type = "harmonic_bonds" | body = "guided" | pairs = "neighbours"
stiffness = 3.0 | rest_lengths = 0.9
[run] | duration = 1.0 | integrator = { type = "rk4", dt = 1e-3 }
)"));
  }
}

TEST(Properties, HoldOnTheSecondOfTwoTips) {
  expect_valid(tables(R"(
[[body]] | name = "first" | type = "point" | position = [0.4] | particle_mass = 10.0
[[body]] | name = "second" | type = "point" | position = [0.5] | particle_mass = 0.1
[[force]] | type = "viscous_damping" | body = "second" | coefficient = 0.5
[[force]] | type = "sinusoidal_substrate" | body = "second" | amplitude = 0.1 | period = 1.0
[run] | duration = 10.0 | integrator = { type = "rk4", dt = 0.01 }
)"));
}

TEST(Properties, HoldFarFromTheOriginAndForStiffBonds) {
  expect_valid(TipScene{.position = 1e5 + 0.1}.text(), kRightFarAway);
  expect_valid(RingScene{.bonds = 1e6, .centre = 1e4}.text(), kRightFarAway);
}

/// An atomic force microscope in kg, m and s: nothing is near one.
const TipScene kInSIUnits{.velocity = 1e-6,
                          .stiffness = 1.0,
                          .damping = 1e-6,
                          .amplitude = 1e-19,
                          .period = 2.5e-10,
                          .position = 1e-10,
                          .duration = 1e-4,
                          .integrator = adaptive(1e-9)};

TEST(Properties, HoldInSIUnits) { expect_valid(kInSIUnits.text()); }

// ---- planted faults

/// The forces of one description and the energy of another.
class TwoFaced : public BoundForce<double>, public Diagnosis<double> {
 public:
  TwoFaced(std::unique_ptr<BoundForce<double>> pulls, std::unique_ptr<BoundForce<double>> stores)
      : pulls_(std::move(pulls)), stores_(std::move(stores)) {}

  std::vector<Pass<double>> passes() override { return pulls_->passes(); }
  double energy(const Stage<double>& stage) const override { return stores_->energy(stage); }
  void rebase(const Origin& origin) override {
    pulls_->rebase(origin);
    stores_->rebase(origin);
  }
  double shortest_bond() const override {
    return facet_of<Diagnosis<double>>(*stores_)->shortest_bond();
  }

 private:
  std::unique_ptr<BoundForce<double>> pulls_;
  std::unique_ptr<BoundForce<double>> stores_;
};

/// Binds a force whose forces, but not whose energy, have a spoilt description.
template <class Description, auto record, auto spoil>
std::unique_ptr<BoundForce<double>> bind_spoilt(const void* description,
                                                const Binding<double>& binding) {
  static const ForceRecord valid = record();
  Description wrong = *static_cast<const Description*>(description);
  spoil(wrong);
  return std::make_unique<TwoFaced>(valid.bind.in_double(&wrong, binding),
                                    valid.bind.in_double(description, binding));
}

template <auto spoil>
constexpr auto kSpoiltSubstrate =
    &bind_spoilt<SinusoidalSubstrateDescription, &sinusoidal_substrate_record, spoil>;
template <auto spoil>
constexpr auto kSpoiltBonds = &bind_spoilt<HarmonicBondsDescription, &harmonic_bonds_record, spoil>;

constexpr auto kUnspoilt = [](SinusoidalSubstrateDescription&) {};
constexpr auto kWrongSign = [](SinusoidalSubstrateDescription& d) { d.amplitude = -d.amplitude; };
constexpr auto kTwice = [](SinusoidalSubstrateDescription& d) { d.amplitude *= 2.0; };
constexpr auto kSlightly = [](SinusoidalSubstrateDescription& d) { d.amplitude *= 1.0 + 1e-5; };
constexpr auto kOtherDecay = [](SinusoidalSubstrateDescription& d) { d.decay *= 1.001; };
constexpr auto kSofterBonds = [](HarmonicBondsDescription& d) { d.stiffness *= 0.5; };

using Bind = ForceFactory<double>;
using Broken = std::set<std::string>;

const std::string kGradient = "sinusoidal_substrate: conservative";

TEST(PlantedFaults, ASoundForceBoundTheSameWayIsNotAccused) {
  const SpoiltRegistry valid("sinusoidal_substrate", kSpoiltSubstrate<kUnspoilt>);
  EXPECT_EQ(valid.broken_in(TipScene{}.text()), Broken{});
  EXPECT_EQ(valid.broken_in(RingScene{.coordinates = "rigid"}.text()), Broken{});
}

TEST(PlantedFaults, WrongSignFactorTwoAndLess) {
  const std::string scenes[] = {TipScene{}.text(), RingScene{}.text(),
                                RingScene{.coordinates = "rigid"}.text(),
                                TipScene{.position = 1e5 + 0.1}.text(), kInSIUnits.text()};
  for (const std::string& text : scenes) {
    for (const std::uint64_t seed : {1, 2, 3}) {
      for (const Bind bind :
           {kSpoiltSubstrate<kWrongSign>, kSpoiltSubstrate<kTwice>, kSpoiltSubstrate<kSlightly>}) {
        EXPECT_EQ(
            SpoiltRegistry("sinusoidal_substrate", bind).broken_in(text, seed).count(kGradient), 1u)
            << text;
      }
    }
  }
}

TEST(PlantedFaults, ADecayThatIsNotTheEnergys) {
  const SpoiltRegistry spoilt("sinusoidal_substrate", kSpoiltSubstrate<kOtherDecay>);
  EXPECT_GE(spoilt.broken_in(RingScene{}.text()).count(kGradient), 1u);
  EXPECT_GE(spoilt.broken_in(RingScene{.coordinates = "rigid"}.text()).count(kGradient), 1u);
  EXPECT_EQ(spoilt.broken_in(TipScene{}.text()), Broken{}) << "there is no decay in it";
}

TEST(PlantedFaults, BondsOfHalfTheStiffness) {
  const SpoiltRegistry spoilt("harmonic_bonds", kSpoiltBonds<kSofterBonds>);
  EXPECT_GE(spoilt.broken_in(RingScene{}.text()).count("harmonic_bonds: conservative"), 1u);
  EXPECT_GE(spoilt.broken_in(chain(60, 1.0, "x", 1)).count("harmonic_bonds: conservative"), 1u);
}

TEST(PlantedFaults, DampingThatDrives) {
  constexpr auto kDrives = [](ViscousDampingDescription& d) { d.coefficient = -d.coefficient; };
  const SpoiltRegistry spoilt(
      "viscous_damping", &bind_spoilt<ViscousDampingDescription, &viscous_damping_record, kDrives>);
  EXPECT_GE(spoilt.broken_in(TipScene{}.text()).count("viscous_damping: dissipative"), 1u);
  EXPECT_GE(spoilt.broken_in(RingScene{.coordinates = "rigid"}.text())
                .count("viscous_damping: dissipative"),
            1u);
}

TEST(PlantedFaults, PropertiesThatAreNotTrue) {
  const SpoiltRegistry internal("sinusoidal_substrate", nullptr,
                                [](ForceRecord& r) { r.traits.internal = true; });
  EXPECT_EQ(internal.broken_in(RingScene{}.text()), Broken{"sinusoidal_substrate: internal"});
  const SpoiltRegistry conservative("viscous_damping", nullptr,
                                    [](ForceRecord& r) { r.traits.conservative = true; });
  EXPECT_EQ(conservative.broken_in(TipScene{.start_velocity = 0.3}.text())
                .count("viscous_damping: conservative"),
            1u);
  const SpoiltRegistry periodic("sinusoidal_substrate", nullptr, [](ForceRecord& r) {
    r.period = [](const void* d, int axis) {
      return axis == 0 ? 1.5 * static_cast<const SinusoidalSubstrateDescription*>(d)->period : 0.0;
    };
  });
  EXPECT_EQ(periodic.broken_in(TipScene{}.text()).count("sinusoidal_substrate: periodic"), 1u);
}

/// Bonds that pull on one of the two only.
class OneSided : public BoundForce<double> {
 public:
  OneSided(std::unique_ptr<BoundForce<double>> pulls, const BoundBody<double>& body)
      : pulls_(std::move(pulls)), body_(body) {}

  std::vector<Pass<double>> passes() override {
    std::vector<Pass<double>> passes = pulls_->passes();
    passes.push_back({nullptr, &push, this, {{body_.index, false}}, kRankPairs});
    return passes;
  }
  double energy(const Stage<double>& stage) const override { return pulls_->energy(stage); }

 private:
  static void push(const void* self, const Stage<double>& stage) {
    stage.force[static_cast<const OneSided*>(self)->body_.slot.offset] += 1e-3;
  }

  std::unique_ptr<BoundForce<double>> pulls_;
  BoundBody<double> body_;
};

TEST(PlantedFaults, ForcesThatDoNotSumToZero) {
  const Bind bind = [](const void* description,
                       const Binding<double>& binding) -> std::unique_ptr<BoundForce<double>> {
    static const ForceRecord valid = harmonic_bonds_record();
    return std::make_unique<OneSided>(valid.bind.in_double(description, binding),
                                      *binding.bodies.front());
  };
  EXPECT_GE(SpoiltRegistry("harmonic_bonds", bind)
                .broken_in(chain(5, 1.0, "x", 2))
                .count("harmonic_bonds: conservative"),
            1u);
}

}  // namespace
}  // namespace tomlin::test
