#include "tests/support/conformance.hpp"

#include <array>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "forcefields/constant_force.hpp"
#include "forcefields/driving_spring.hpp"
#include "forcefields/harmonic_bonds.hpp"
#include "forcefields/sinusoidal_substrate.hpp"
#include "forcefields/viscous_damping.hpp"
#include "framework/core/fault.hpp"
#include "framework/core/kernels.hpp"
#include "framework/core/pair_force.hpp"
#include "framework/core/site_force.hpp"
#include "tests/support/scenes.hpp"

// Every force of the registry against its claims, and the same checks against forces that are
// wrong on purpose. What depends on a single force's formula has a test of its own elsewhere.

namespace tomlin::test {
namespace {

constexpr std::uint64_t kSeeds[] = {20240611, 7, 424242};

// ---- the registry against its claims ----------------------------------------------------------

TEST(Conformance, EveryForceKeepsItsClaims) {
  for (const auto& record : standard().forces()) {
    SCOPED_TRACE(record->name);
    ClaimCheck check(*record);
    for (const std::uint64_t seed : kSeeds) check.examine_everywhere(seed);
    // Points, chains and rings in three dimensions, free and rigid: none may slip by unseen.
    EXPECT_GT(check.examined(), 100);
    EXPECT_EQ(check.broken(), std::vector<std::string>{});
  }
}

/// Every remainder of a group of eight, twice over.
TEST(Conformance, TailsOfEveryLengthHaveTheSameBits) {
  constexpr std::size_t kMost = 19;
  for (const auto& record : standard().forces()) {
    SCOPED_TRACE(record->name);
    ClaimCheck check(*record);
    check.examine_everywhere(99, kMost);
    EXPECT_EQ(check.broken(), std::vector<std::string>{});
  }
}

TEST(Conformance, ExamplesUseTheirComponentAndRun) {
  const auto runs = [](const ComponentRecord& record) {
    SCOPED_TRACE(record.name);
    const auto scene = scene_of(record.example);
    const bool used =
        std::any_of(scene->forces.begin(), scene->forces.end(),
                    [&](const auto& force) { return force.record->name == record.name; }) ||
        std::any_of(scene->bodies.begin(), scene->bodies.end(),
                    [&](const auto& body) { return body.record->name == record.name; }) ||
        scene->run.integrator.record->name == record.name;
    EXPECT_TRUE(used);
    const RunResult result = run(scene);
    EXPECT_EQ(result.status, RunStatus::finished)
        << (result.failure ? to_string(*result.failure) : "");
    EXPECT_GT(result.steps, 0u);
  };
  for (const auto& record : standard().bodies()) runs(*record);
  for (const auto& record : standard().forces()) runs(*record);
  for (const auto& record : standard().integrators()) runs(*record);
}

/// The force of this type in its example, by the name that a setting takes.
std::string refusal(const ComponentRecord& record, const std::string& path,
                    const std::string& value) {
  try {
    (void)scene_of(record.example, {{path, value}});
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Conformance, ParametersOutOfRangeAreRefused) {
  int bounded = 0;
  const auto look_at = [&](const ComponentRecord& record, const std::string& component) {
    for (const Parameter& row : record.parameters) {
      if (!std::holds_alternative<double>(row.prototype)) continue;
      const std::string path = component + "." + row.key;
      SCOPED_TRACE(path);
      for (const char* value : {"nan", "inf", "-inf"}) {
        EXPECT_NE(refusal(record, path, value).find(row.key), std::string::npos) << value;
      }
      if (row.interval.low == 0.0) {
        ++bounded;
        EXPECT_NE(refusal(record, path, "-1e-300").find(row.key), std::string::npos);
        if (row.interval.low_open) {
          EXPECT_NE(refusal(record, path, "0.0").find(row.key), std::string::npos);
        }
      }
    }
  };
  for (const auto& record : standard().forces()) look_at(*record, "force." + record->name);
  for (const auto& record : standard().integrators()) look_at(*record, "run.integrator");
  EXPECT_GT(bounded, 5);
}

TEST(Conformance, TheEdgeOfARangeIsAccepted) {
  const ForceRecord* damping = standard().force("viscous_damping");
  EXPECT_EQ(refusal(*damping, "force.viscous_damping.coefficient", "0.0"), "");
  EXPECT_EQ(refusal(*damping, "force.viscous_damping.coefficient", "1e-300"), "");
}

// ---- names

std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::string camel_case(const std::string& name) {
  std::string camel;
  bool up = true;
  for (const char c : name) {
    if (c == '_') {
      up = true;
    } else {
      camel += up ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
      up = false;
    }
  }
  return camel;
}

/// type = "..." is the file's name and, in CamelCase, the class's.
TEST(Names, TypeFileAndClassAgree) {
  const std::filesystem::path source = TOMLIN_SOURCE_DIR;
  const auto look_at = [&](const std::string& folder, const std::string& name,
                           const std::string& declared) {
    SCOPED_TRACE(folder + "/" + name);
    const std::string header = contents(source / folder / (name + ".hpp"));
    EXPECT_NE(header.find("struct " + declared + " {"), std::string::npos) << declared;
    EXPECT_NE(header.find(name + "_record()"), std::string::npos);
    EXPECT_NE(contents(source / folder / (name + ".cpp")).find("\"" + name + "\""),
              std::string::npos);
  };
  for (const auto& force : standard().forces()) {
    look_at("forcefields", force->name, camel_case(force->name));
  }
  for (const auto& scheme : standard().integrators()) {
    look_at("integrators", scheme->name, camel_case(scheme->name) + "Description");
    const std::string code = contents(source / "integrators" / (scheme->name + ".cpp"));
    EXPECT_NE(code.find("class " + camel_case(scheme->name) + " "), std::string::npos);
  }
  for (const auto& body : standard().bodies()) {
    const std::string header = contents(source / "framework/bodies" / (body->name + ".hpp"));
    EXPECT_NE(header.find("struct " + camel_case(body->name) + "Description "), std::string::npos)
        << body->name;
  }
}

/// No file of a component without its component.
TEST(Names, EveryFilePairIsRegistered) {
  const std::filesystem::path source = TOMLIN_SOURCE_DIR;
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source / "forcefields")) {
    if (entry.path().extension() != ".cpp" || entry.path().stem() == "register") continue;
    EXPECT_NE(standard().force(entry.path().stem().string()), nullptr) << entry.path();
    ++files;
  }
  EXPECT_EQ(files, static_cast<int>(standard().forces().size()));
}

// ---- registration

template <class Record, class Spoil>
bool refused(const Record& complete, Spoil&& spoil) {
  Registry registry;
  Record record = complete;
  spoil(record);
  try {
    registry.add(record);
  } catch (const std::invalid_argument& error) {
    return std::string(error.what()).size() > 10;
  }
  return false;
}

template <class Record>
void expect_completeness_is_required(const Record& record) {
  SCOPED_TRACE(record.name);
  EXPECT_FALSE(refused(record, [](Record&) {}));
  EXPECT_TRUE(refused(record, [](Record& r) { r.name.clear(); }));
  EXPECT_TRUE(refused(record, [](Record& r) { r.summary.clear(); }));
  EXPECT_TRUE(refused(record, [](Record& r) { r.equation.clear(); }));
  EXPECT_TRUE(refused(record, [](Record& r) { r.source.clear(); }));
  EXPECT_TRUE(refused(record, [](Record& r) { r.example.clear(); }));
  EXPECT_TRUE(refused(record, [](Record& r) { r.make_description = nullptr; }));
  EXPECT_TRUE(refused(record, [](Record& r) { r.complaints = nullptr; }));
  EXPECT_TRUE(refused(record, [](Record& r) { r.parameters.front().doc.clear(); }));
  EXPECT_TRUE(refused(record, [](Record& r) { r.parameters.front().key.clear(); }));
}

TEST(Registration, AnIncompleteRecordIsRejected) {
  for (const auto& force : standard().forces()) {
    expect_completeness_is_required(*force);
    EXPECT_TRUE(refused(*force, [](ForceRecord& r) { r.bind = nullptr; }));
    EXPECT_TRUE(refused(*force, [](ForceRecord& r) { r.period = nullptr; }));
  }
  for (const auto& scheme : standard().integrators()) {
    expect_completeness_is_required(*scheme);
    EXPECT_TRUE(refused(*scheme, [](IntegratorRecord& r) { r.bind = nullptr; }));
    EXPECT_TRUE(refused(*scheme, [](IntegratorRecord& r) { r.growth = nullptr; }));
  }
  for (const auto& body : standard().bodies()) {
    expect_completeness_is_required(*body);
    EXPECT_TRUE(refused(*body, [](BodyRecord& r) { r.build = nullptr; }));
  }
}

TEST(Registration, ANameIsTakenOnce) {
  Registry registry = standard_registry();
  const ForceRecord force = *registry.force("viscous_damping");
  EXPECT_THROW(registry.add(force), std::invalid_argument);
  // Nor by a component of another kind.
  BodyRecord body = *registry.body("point");
  body.name = "viscous_damping";
  EXPECT_THROW(registry.add(body), std::invalid_argument);
}

// ---- evaluators: exact derivatives

// Energy and force are rounded differently: some units in the last place of their size.
constexpr double kDualRounding = 64.0 * std::numeric_limits<double>::epsilon();

template <int D>
Site<double, D> site_at(const std::array<double, 3>& x, Random& random) {
  Site<double, D> site{};
  for (int d = 0; d < D; ++d) {
    site.position[d] = x[d];
    site.velocity[d] = uniform(random, -1.0, 1.0);
    site.start[d] = uniform(random, -1.0, 1.0);
  }
  site.elapsed = 0.25;
  return site;
}

/// The evaluator without its force: the framework differentiates the energy.
template <class E>
struct OnlyEnergyOnSites {
  using Description = typename E::Description;
  static constexpr Reads reads = E::reads;
  template <class T, int D>
  using Parameters = typename E::template Parameters<T, D>;
  template <class T, int D>
  static auto parameters(const Description& d) {
    return E::template parameters<T, D>(d);
  }
  template <class T, int D>
  static void rebase(typename E::template Parameters<T, D>& p, const Description& d,
                     const Origin& origin) requires requires {
    E::template rebase<T, D>(p, d, origin);
  }
  { E::template rebase<T, D>(p, d, origin); }
  template <class T, int D>
  static auto energy(const typename E::template Parameters<T, D>& p, const Site<T, D>& site) {
    return E::energy(p, site);
  }
};

template <class E, int D>
void expect_site_force_is_gradient(const ForceRecord& record) {
  Random random(31);
  // Random points, quarter periods of a corrugation, and far from everything.
  std::vector<std::array<double, 3>> points;
  for (int k = 0; k < 200; ++k) {
    points.push_back({uniform(random, -3, 3), uniform(random, -3, 3), uniform(random, -3, 3)});
  }
  for (const double x : {0.0, -0.0, 0.25, 0.5, 1e-300, 1e6, -1e9}) {
    for (const double y : {0.0, 1e-200, 5.0, 30.0, -1e4}) points.push_back({x, y, 0.0});
  }
  for (int draw = 0; draw < 20; ++draw) {
    const auto description = random_description(record, {D, 3, false, false}, random);
    ASSERT_NE(description, nullptr);
    const auto p = E::template parameters<double, D>(
        *static_cast<const typename E::Description*>(description.get()));
    for (const auto& point : points) {
      const Site<double, D> site = site_at<D>(point, random);
      const auto force = E::force(p, site);
      const auto exact = force_on<OnlyEnergyOnSites<E>, double, D>(p, site);
      double size = 0.0;
      for (int d = 0; d < D; ++d) size = std::max(size, std::abs(exact[d]));
      for (int d = 0; d < D; ++d) {
        EXPECT_TRUE(std::isfinite(force[d]));
        EXPECT_NEAR(force[d], exact[d], kDualRounding * (size + 1e-300))
            << record.name << " at " << point[0] << ", " << point[1];
      }
    }
  }
}

template <class E>
void expect_site_force_is_gradient() {
  std::string name;
  for (const auto& record : standard().forces()) {
    if (record->make_description == &make_description<typename E::Description>) {
      expect_site_force_is_gradient<E, 1>(*record);
      expect_site_force_is_gradient<E, 2>(*record);
      expect_site_force_is_gradient<E, 3>(*record);
      return;
    }
  }
  FAIL() << "not in the registry";
}

TEST(Evaluators, ForcesAreTheExactDerivativeOfTheEnergy) {
  expect_site_force_is_gradient<ConstantForce>();
  expect_site_force_is_gradient<DrivingSpring>();
  expect_site_force_is_gradient<SinusoidalSubstrate>();
}

template <class E>
struct OnlyEnergyOnPairs {
  using Description = typename E::Description;
  template <class T, int D>
  using Parameters = typename E::template Parameters<T, D>;
  template <class T, int D>
  static auto energy(const typename E::template Parameters<T, D>& p, const Pair<T, D>& pair) {
    return E::energy(p, pair);
  }
};

template <int D>
void expect_bond_is_gradient() {
  Random random(32);
  HarmonicBondsDescription description;
  description.stiffness = 3.7;
  const auto p = HarmonicBonds::parameters<double, D>(description);
  for (const double size : {1e-8, 1e-3, 1.0, 1e8}) {
    for (int k = 0; k < 100; ++k) {
      Pair<double, D> pair{};
      for (int d = 0; d < D; ++d) pair.separation[d] = size * uniform(random, -1.0, 1.0);
      pair.datum = k % 4 == 0 ? 0.0 : uniform(random, 0.0, 2.0);
      const auto force = HarmonicBonds::force(p, pair);
      const auto exact = force_on<OnlyEnergyOnPairs<HarmonicBonds>, double, D>(p, pair);
      const double scale = description.stiffness * (distance(pair.separation) + pair.datum);
      for (int d = 0; d < D; ++d) EXPECT_NEAR(force[d], exact[d], kDualRounding * scale);
    }
  }
}

TEST(Evaluators, BondsAreTheExactDerivativeOfTheEnergy) {
  expect_bond_is_gradient<1>();
  expect_bond_is_gradient<2>();
  expect_bond_is_gradient<3>();
}

// ---- planted faults

/// Kernels of an evaluator that lives in this file.
template <class E>
const KernelTables& tables_of() {
  static constexpr KernelTable<double> table = kernel_table<E>();
  static constexpr KernelTables tables{&table, nullptr, nullptr};
  return tables;
}

template <class E>
std::unique_ptr<BoundForce<double>> bind_on_particles(const void* description,
                                                      const Binding<double>& binding) {
  const auto& d = *static_cast<const typename E::Description*>(description);
  return for_dimension(binding.dimension, [&]<int D>() -> std::unique_ptr<BoundForce<double>> {
    return std::make_unique<ParticleForce<E, D>>(d, binding, tables_of<E>(), kRankCheap);
  });
}

template <template <class, int> class Wrapper, class E>
std::unique_ptr<BoundForce<double>> bind_wrapped(const void* description,
                                                 const Binding<double>& binding) {
  const auto& d = *static_cast<const typename E::Description*>(description);
  return for_dimension(binding.dimension, [&]<int D>() -> std::unique_ptr<BoundForce<double>> {
    return std::make_unique<Wrapper<E, D>>(d, binding, tables_of<E>(), kRankCheap);
  });
}

using Bind = std::unique_ptr<BoundForce<double>> (*)(const void*, const Binding<double>&);

/// What the checker says of the force of this name when it is bound in another way.
std::vector<std::string> broken_claims(const std::string& name, Bind bind,
                                       void (*spoil)(ForceRecord&) = nullptr) {
  ForceRecord record = *standard().force(name);
  if (bind) record.bind = bind;
  if (spoil) spoil(record);
  ClaimCheck check(record);
  check.examine_everywhere(kSeeds[0], 5);
  return check.broken();
}

bool among(const std::vector<std::string>& broken, const std::string& claim) {
  return std::find(broken.begin(), broken.end(), claim) != broken.end();
}

#define EXPECT_CAUGHT(claim, ...) \
  EXPECT_TRUE(among(broken_claims(__VA_ARGS__), claim)) << "not caught: " << (claim)

/// The evaluators themselves, bound here: the checker is silent, so what it says below is said of
/// the fault and not of the way it was planted.
TEST(PlantedFaults, SoundForcesBoundTheSameWayAreNotAccused) {
  EXPECT_EQ(broken_claims("constant_force", bind_on_particles<ConstantForce>),
            std::vector<std::string>{});
  EXPECT_EQ(broken_claims("sinusoidal_substrate", bind_on_particles<SinusoidalSubstrate>),
            std::vector<std::string>{});
  EXPECT_EQ(broken_claims("viscous_damping", bind_on_particles<ViscousDamping>),
            std::vector<std::string>{});
  EXPECT_EQ(broken_claims("sinusoidal_substrate",
                          bind_on_particles<OnlyEnergyOnSites<SinusoidalSubstrate>>),
            std::vector<std::string>{});
}

/// A substrate whose force is multiplied by `numerator`/2 on each axis.
template <int x_halves, int y_halves>
struct ScaledSubstrate : SinusoidalSubstrate {
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    Vec<T, D> force = SinusoidalSubstrate::force(p, site);
    force[0] = T(0.5 * x_halves) * force[0];
    if constexpr (D > 1) force[1] = T(0.5 * y_halves) * force[1];
    return force;
  }
};

TEST(PlantedFaults, WrongSign) {
  EXPECT_CAUGHT("gradient", "sinusoidal_substrate", (bind_on_particles<ScaledSubstrate<-2, -2>>));
  EXPECT_CAUGHT("gradient", "sinusoidal_substrate", (bind_on_particles<ScaledSubstrate<2, -2>>));
}

TEST(PlantedFaults, FactorOfTwo) {
  EXPECT_CAUGHT("gradient", "sinusoidal_substrate", (bind_on_particles<ScaledSubstrate<4, 4>>));
  EXPECT_CAUGHT("gradient", "sinusoidal_substrate", (bind_on_particles<ScaledSubstrate<2, 1>>));
}

/// Eq. (18) of the paper: the y that the chain rule brings down is missing.
struct WithoutChainRule : SinusoidalSubstrate {
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    Vec<T, D> force = SinusoidalSubstrate::force(p, site);
    if constexpr (D > 1) {
      const T y = site.position[1];
      const T wave = cos_turns(fma(site.position[0], p.wave_number, p.phase));
      force[1] = exp(-(p.decay * y) * y) * (p.vertical_slope * wave);
    }
    return force;
  }
};

TEST(PlantedFaults, MissingChainRuleOfTheDecay) {
  EXPECT_CAUGHT("gradient", "sinusoidal_substrate", bind_on_particles<WithoutChainRule>);
}

/// The decay left out of the energy, which is what the ledger would add up.
struct EnergyWithoutDecay : SinusoidalSubstrate {
  template <class T, int D>
  static T energy(const Parameters<T, D>& p, const Site<T, D>& site) {
    return p.amplitude * cos_turns(fma(site.position[0], p.wave_number, p.phase));
  }
};

/// A relative error of 1e-5, far below what a plot shows.
struct SlightlyTooStrong : SinusoidalSubstrate {
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    return T(1.0 + 1e-5) * SinusoidalSubstrate::force(p, site);
  }
};

TEST(PlantedFaults, EnergyOff) {
  EXPECT_CAUGHT("gradient", "sinusoidal_substrate", bind_on_particles<EnergyWithoutDecay>);
}

TEST(PlantedFaults, ForceOffByLittle) {
  // Central differences at h = 0.0025 see 1e-3; the exact derivative sees the last digits.
  const auto p = SinusoidalSubstrate::parameters<double, 2>({1.0, 1.0, 0.5});
  Site<double, 2> site{};
  site.position = {0.3, 0.4};
  const auto right = force_on<OnlyEnergyOnSites<SinusoidalSubstrate>, double, 2>(p, site);
  EXPECT_GT(std::abs(SlightlyTooStrong::force(p, site)[0] - right[0]),
            kDualRounding * std::abs(right[0]));
}

/// Bonds whose reaction is lost, or acts on the next particle.
template <int reaction_shift>
class LopsidedBonds : public BoundForce<double> {
 public:
  LopsidedBonds(double stiffness, const Binding<double>& binding) : body_(*binding.bodies.front()) {
    arguments_.body = body_.slot;
    arguments_.axes = binding.dimension;
    arguments_.stiffness = stiffness;
  }
  std::vector<Pass<double>> passes() override {
    return {{nullptr, &add, &arguments_, {{body_.index, false}}, kRankPairs}};
  }

 private:
  struct Arguments {
    BodySlot<double> body;
    int axes = 0;
    double stiffness = 0.0;
  };

  static void add(const void* arguments, const Stage<double>& stage) {
    const auto& a = *static_cast<const Arguments*>(arguments);
    const double* x = (a.body.mapped ? stage.mapped_position : stage.position) + a.body.offset;
    double* f = (a.body.mapped ? stage.mapped_force : stage.force) + a.body.offset;
    for (std::size_t i = 0; i + 1 < a.body.count; ++i) {
      for (int d = 0; d < a.axes; ++d) {
        const std::size_t at = d * a.body.stride;
        const double pull = a.stiffness * (x[at + i + 1] - x[at + i]);
        f[at + i] += pull;
        if (reaction_shift >= 0) f[at + (i + 1 + reaction_shift) % a.body.count] -= pull;
      }
    }
  }

  BoundBody<double> body_;
  Arguments arguments_;
};

template <int reaction_shift>
std::unique_ptr<BoundForce<double>> bind_lopsided(const void* description,
                                                  const Binding<double>& binding) {
  return std::make_unique<LopsidedBonds<reaction_shift>>(
      static_cast<const HarmonicBondsDescription*>(description)->stiffness, binding);
}

TEST(PlantedFaults, PairsThatAreNotReciprocal) {
  EXPECT_CAUGHT("internal", "harmonic_bonds", bind_lopsided<-1>);
  EXPECT_CAUGHT("gradient", "harmonic_bonds", bind_lopsided<-1>);
  EXPECT_CAUGHT("hessian", "harmonic_bonds", bind_lopsided<-1>);
}

/// Forces sum to zero, so only the torque tells.
TEST(PlantedFaults, ReactionOnTheWrongParticle) {
  EXPECT_CAUGHT("internal", "harmonic_bonds", bind_lopsided<1>);
}

struct AntiDissipative : ViscousDamping {
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    return p.coefficient * site.velocity;
  }
};

TEST(PlantedFaults, DampingThatDrives) {
  EXPECT_CAUGHT("dissipative", "viscous_damping", bind_on_particles<AntiDissipative>);
  EXPECT_CAUGHT("friction", "viscous_damping", bind_on_particles<AntiDissipative>);
  EXPECT_CAUGHT("flow", "viscous_damping", bind_on_particles<AntiDissipative>);
}

/// exp(-c h) instead of exp(-c h/m).
template <class E, int D>
class FlowWithoutMass : public ParticleForce<E, D> {
 public:
  using ParticleForce<E, D>::ParticleForce;
  void flow(const Stage<double>&, const double*, double* velocity, double h) const override {
    const BodySlot<double>& slot = this->body_.slot;
    for (int d = 0; d < D; ++d) {
      for (std::size_t i = 0; i < slot.count; ++i) {
        velocity[slot.offset + d * slot.stride + i] *= E::decay_factor(this->parameters_, h);
      }
    }
  }
};

/// First-order in h: 1 - c h/m.
struct FlowToFirstOrder : ViscousDamping {
  template <class T, int D>
  static T decay_factor(const Parameters<T, D>& p, const T& h_over_mass) {
    return T(1.0) - p.coefficient * h_over_mass;
  }
};

struct TwiceTheFriction : ViscousDamping {
  template <class T, int D>
  static T friction(const Parameters<T, D>& p) {
    return T(2.0) * p.coefficient;
  }
};

TEST(PlantedFaults, WrongFlowOrFriction) {
  EXPECT_CAUGHT("flow", "viscous_damping", (bind_wrapped<FlowWithoutMass, ViscousDamping>));
  EXPECT_CAUGHT("flow", "viscous_damping", bind_on_particles<FlowToFirstOrder>);
  EXPECT_CAUGHT("friction", "viscous_damping", bind_on_particles<TwiceTheFriction>);
}

TEST(PlantedFaults, ClaimsThatAreNotTrue) {
  EXPECT_CAUGHT("gradient", "viscous_damping", nullptr,
                [](ForceRecord& r) { r.traits.conservative = true; });
  EXPECT_CAUGHT("velocity", "viscous_damping", nullptr,
                [](ForceRecord& r) { r.traits.depends_on_velocity = false; });
  EXPECT_CAUGHT("velocity", "sinusoidal_substrate", nullptr,
                [](ForceRecord& r) { r.traits.depends_on_velocity = true; });
  EXPECT_CAUGHT("time", "driving_spring", nullptr,
                [](ForceRecord& r) { r.traits.depends_on_time = false; });
  EXPECT_CAUGHT("time", "sinusoidal_substrate", nullptr,
                [](ForceRecord& r) { r.traits.depends_on_time = true; });
  EXPECT_CAUGHT("internal", "sinusoidal_substrate", nullptr,
                [](ForceRecord& r) { r.traits.internal = true; });
  EXPECT_CAUGHT("internal is not claimed", "harmonic_bonds", nullptr,
                [](ForceRecord& r) { r.traits.internal = false; });
  EXPECT_CAUGHT("conservative is not claimed", "sinusoidal_substrate", nullptr,
                [](ForceRecord& r) { r.traits.conservative = false; });
  EXPECT_CAUGHT("dissipative", "constant_force", nullptr,
                [](ForceRecord& r) { r.traits.dissipative = true; });
  EXPECT_CAUGHT("driver", "driving_spring", nullptr,
                [](ForceRecord& r) { r.traits.does_work = false; });
  EXPECT_CAUGHT("periodic", "harmonic_bonds", nullptr,
                [](ForceRecord& r) { r.traits.periodic = true; });
  EXPECT_CAUGHT("periodic", "sinusoidal_substrate", nullptr, [](ForceRecord& r) {
    r.period = [](const void* d, int axis) {
      return axis == 0 ? 1.5 * static_cast<const SinusoidalSubstrateDescription*>(d)->period : 0.0;
    };
  });
}

/// A substrate that does not hear of a new origin.
struct WithoutRebase : SinusoidalSubstrate {
  template <class T, int D>
  static void rebase(Parameters<T, D>&, const Description&, const Origin&) {}
};

TEST(PlantedFaults, OriginForgotten) {
  EXPECT_CAUGHT("origin", "sinusoidal_substrate", bind_on_particles<WithoutRebase>);
}

struct BoundTooSmall : SinusoidalSubstrate {
  template <int D>
  static double curvature_bound(const Description& d) {
    return 0.9 * SinusoidalSubstrate::curvature_bound<1>(d);
  }
};

struct BoundTooLarge : SinusoidalSubstrate {
  template <int D>
  static double curvature_bound(const Description& d) {
    return 4.0 * SinusoidalSubstrate::curvature_bound<D>(d);
  }
};

struct BoundAlongTooSmall : SinusoidalSubstrate {
  template <int D>
  static double curvature_bound_along(const Description& d, int axis) {
    return 0.9 * SinusoidalSubstrate::curvature_bound_along<D>(d, axis);
  }
};

TEST(PlantedFaults, CurvatureBoundThatIsNone) {
  EXPECT_CAUGHT("curvature bound", "sinusoidal_substrate", bind_on_particles<BoundAlongTooSmall>);
  EXPECT_CAUGHT("curvature bound", "sinusoidal_substrate", bind_on_particles<BoundTooSmall>);
  EXPECT_CAUGHT("curvature bound is far too large", "sinusoidal_substrate",
                bind_on_particles<BoundTooLarge>);
}

/// `set` that adds to what is there, and `add` that overwrites.
template <class E, int D>
class SwappedPasses : public ParticleForce<E, D> {
 public:
  using ParticleForce<E, D>::ParticleForce;
  std::vector<Pass<double>> passes() override {
    auto passes = ParticleForce<E, D>::passes();
    for (Pass<double>& pass : passes) std::swap(pass.set, pass.add);
    return passes;
  }
};

TEST(PlantedFaults, SetAndAddSwapped) {
  EXPECT_CAUGHT("set and add", "sinusoidal_substrate",
                (bind_wrapped<SwappedPasses, SinusoidalSubstrate>));
}

/// The last bit differs on the wider sets.
struct OneBitOff : SinusoidalSubstrate {
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    return T(1.0 + std::numeric_limits<double>::epsilon()) * SinusoidalSubstrate::force(p, site);
  }
};

std::unique_ptr<BoundForce<double>> bind_one_bit_off(const void* description,
                                                     const Binding<double>& binding) {
  static constexpr KernelTable<double> right = kernel_table<SinusoidalSubstrate>();
  static constexpr KernelTable<double> wrong = kernel_table<OneBitOff>();
  [[maybe_unused]] static constexpr KernelTables one_bit_off{&right, &wrong, &wrong};
  const auto& d = *static_cast<const SinusoidalSubstrateDescription*>(description);
  return for_dimension(binding.dimension, [&]<int D>() -> std::unique_ptr<BoundForce<double>> {
    return std::make_unique<ParticleForce<SinusoidalSubstrate, D>>(d, binding, one_bit_off,
                                                                   kRankCheap);
  });
}

TEST(PlantedFaults, LastBitOfAnInstructionSet) {
  if (!is_supported(InstructionSet::avx2)) GTEST_SKIP() << "only one instruction set here";
  EXPECT_CAUGHT("instruction sets", "sinusoidal_substrate", bind_one_bit_off);
}

template <class E, int D>
class TwiceTheHessian : public ParticleForce<E, D> {
 public:
  using ParticleForce<E, D>::ParticleForce;
  void hessian(const Stage<double>& stage, HessianSink& sink) const override {
    ParticleForce<E, D>::hessian(stage, sink);
    ParticleForce<E, D>::hessian(stage, sink);
  }
};

TEST(PlantedFaults, HessianOff) {
  EXPECT_CAUGHT("hessian", "sinusoidal_substrate",
                (bind_wrapped<TwiceTheHessian, SinusoidalSubstrate>));
}

/// A driver whose power has the sign of what the body receives; the checker only needs the rates.
struct PowerOfTheWrongSign : DrivingSpring {
  template <class T, int D>
  static T power(const Parameters<T, D>& p, const Site<T, D>&, const Vec<T, D>& force) {
    return -dot(force, p.velocity);
  }
};

template <class E, int D>
class PlainDriver : public ParticleForce<E, D> {
 public:
  PlainDriver(const DrivingSpringDescription& description, const Binding<double>& binding,
              const KernelTables& tables, int rank)
      : ParticleForce<E, D>(description, binding, tables, rank) {
    drive_.velocity = description.velocity.components;
  }
  bool depends_on_time() const override { return true; }
  void begin_step(const DoubleDouble& time) override {
    for (int d = 0; d < D; ++d) {
      this->parameters_.travel[d] =
          static_cast<double>(time * this->parameters_.velocity[d]) - shift_[d];
    }
  }
  void rebase(const Origin& origin) override {
    for (int d = 0; d < D; ++d) {
      shift_[d] = static_cast<double>(origin.cells[d]) * origin.unit[d];
    }
  }
  const Drive* drive() const override { return &drive_; }

 private:
  double shift_[D] = {};
  Drive drive_;
};

TEST(PlantedFaults, DriversPower) {
  EXPECT_EQ(broken_claims("driving_spring", (bind_wrapped<PlainDriver, DrivingSpring>)),
            std::vector<std::string>{});
  EXPECT_CAUGHT("driver", "driving_spring", (bind_wrapped<PlainDriver, PowerOfTheWrongSign>));
}

/// The factor 1/2 left out of a spring's energy.
struct WithoutOneHalf : DrivingSpring {
  template <class T, int D>
  static T energy(const Parameters<T, D>& p, const Site<T, D>& site) {
    return p.stiffness * norm_squared(extension(p, site));
  }
};

/// The pulled end stands still within a step.
struct ElapsedForgotten : DrivingSpring {
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, Site<T, D> site) {
    site.elapsed = T(0.0);
    return DrivingSpring::force(p, site);
  }
};

TEST(PlantedFaults, DriversEnergyAndTime) {
  EXPECT_CAUGHT("gradient", "driving_spring", (bind_wrapped<PlainDriver, WithoutOneHalf>));
  EXPECT_CAUGHT("elapsed", "driving_spring", (bind_wrapped<PlainDriver, ElapsedForgotten>));
}

}  // namespace
}  // namespace tomlin::test
