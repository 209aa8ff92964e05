#include <atomic>
#include <cstdlib>
#include <memory>
#include <new>
#include <string>

#include <gtest/gtest.h>

#include "framework/core/system/thread_team.hpp"
#include "tests/support/ring_scenes.hpp"

// Between the first step and the last nothing is allocated. This binary's operator new counts.

namespace {
std::atomic<std::uint64_t> allocations{0};
std::atomic<std::uint64_t> allocated{0};  // bytes

void* counted(std::size_t size, std::size_t alignment) {
  allocations.fetch_add(1, std::memory_order_relaxed);
  allocated.fetch_add(size, std::memory_order_relaxed);
  const std::size_t whole = (size + alignment - 1) / alignment * alignment;
  void* memory = std::aligned_alloc(alignment, whole > 0 ? whole : alignment);
  if (!memory) throw std::bad_alloc();
  return memory;
}

void* counted_or_null(std::size_t size) noexcept {
  allocations.fetch_add(1, std::memory_order_relaxed);
  return std::malloc(size > 0 ? size : 1);
}
}  // namespace

void* operator new(std::size_t size) { return counted(size, alignof(std::max_align_t)); }
void* operator new[](std::size_t size) { return counted(size, alignof(std::max_align_t)); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return counted(size, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return counted(size, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return counted_or_null(size);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  return counted_or_null(size);
}
void operator delete(void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete[](void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace tomlin::test {
namespace {

class NullSink : public RunSink {
 public:
  void begin(const RunLayout&) override {}
  void sample(const std::vector<double>&) override { ++samples; }
  std::uint64_t samples = 0;
};

TEST(Allocations, AreCounted) {
  const std::uint64_t before = allocations;
  const auto* numbers = new std::vector<double>(100);
  EXPECT_GE(allocations - before, 2u);
  delete numbers;
}

TEST(Allocations, ThereAreNoneBetweenTheFirstStepAndTheLast) {
  const std::string look =
      "[output]\nevery = 0.0377\n[measure]\nin = \"time\"\nfrom = 1.0\nto = 3.0\n";
  TipScene tip{.velocity = 2.0, .duration = 5.0, .more = look};
  TipScene tip_adaptive = tip;
  tip_adaptive.integrator = adaptive(1e-7);
  TipScene tip_implicit = tip;
  tip_implicit.integrator = "{ type = \"radau9\" }";
  RingScene flexible{.velocity = 2.0, .duration = 5.0, .more = look};
  RingScene large = flexible;
  large.count = 21;
  RingScene rigid = flexible;
  rigid.coordinates = "rigid";
  RingScene rigid_adaptive = rigid;
  rigid_adaptive.integrator = adaptive(1e-7);
  const std::string chain =
      "[[body]]\ntype = \"chain\"\ncount = 50\nspacing = 1.0\nparticle_mass = 1.0\n"
      "[[force]]\ntype = \"harmonic_bonds\"\npairs = \"neighbours\"\nstiffness = 1.0\n"
      "[[force]]\ntype = \"driving_spring\"\nstiffness = 0.1\nvelocity = [0.5]\n"
      "attach = \"each_particle\"\n"
      "[[force]]\ntype = \"sinusoidal_substrate\"\namplitude = 0.1\nperiod = 1.0\n"
      "[run]\nduration = 5.0\nintegrator = { type = \"rk4\", dt = 0.01 }\n" +
      look;
  const std::string noise =
      "[[force]]\ntype = \"langevin\"\ncoefficient = 0.5\ntemperature = 1e-3\n";
  const std::string links =
      "[[force]]\ntype = \"nose_hoover_chain\"\nperiod = 5.0\ntemperature = 1e-3\n";
  const auto kept_warm = [&](const std::string& bath, const std::string& integrator,
                             const std::string& more) {
    return chain.substr(0, chain.find("[run]")) + bath +
           "[run]\nduration = 5.0\nintegrator = " + integrator + more +
           "\n[output]\nevery = 0.03\n" + look.substr(look.find("[measure]"));
  };
  // Looks at the error from step 1300 on, and does not reach it.
  std::string until_error =
      kept_warm(noise, "{ type = \"baoab\", dt = 0.002 }",
                "\nuntil = { error = 1e-9, of = \"driving_spring.mean_force.x\" }");
  until_error.erase(until_error.find("to = 3.0"));
  RingScene rigid_implicit = rigid;
  rigid_implicit.integrator = tip_implicit.integrator;
  for (const std::string& text :
       {tip.text(), tip_adaptive.text(), flexible.text(), large.text(), rigid.text(),
        rigid_adaptive.text(), chain, tip_implicit.text(), rigid_implicit.text(), until_error,
        kept_warm(noise, "{ type = \"baoab\", dt = 0.01 }", ""),
        kept_warm(links, "{ type = \"velocity_verlet\", dt = 0.01 }", ""),
        kept_warm(noise, "{ type = \"euler_maruyama\", dt = 0.01 }",
                  "\ndynamics = \"overdamped\"")}) {
    NullSink sink;
    Engine engine(scene_of(text), watched_by(sink));
    engine.advance(1);
    const std::uint64_t before = allocations;
    while (!engine.done()) engine.advance(100);
    const std::uint64_t after = allocations;
    EXPECT_EQ(after - before, 0u) << text;
    EXPECT_GT(sink.samples, 100u);
    EXPECT_EQ(engine.time(), 5.0);
  }
}

/// A free layer of graphene over a fixed one, as two threads share it: 256 atoms, of which each
/// takes some groups. It slides by 4 Angstrom in 200 steps, so that lists are made again.
std::string layers(double temperature) {
  const std::string cells =
      "type = \"graphene\"\nbond_length = \"b\"\ncells = [8, 8]\nparticle_mass = 12.011\n";
  return "[scene]\nunits = \"metal\"\n[parameters]\nb = 1.4388\n[box]\nlengths = [\"8 * 3 * b\", "
         "\"8 * sqrt(3) * b\", 60.0]\nperiodic = [true, true, false]\n[[body]]\nname = "
         "\"layer\"\n" +
         cells + "centre = [0.4, 0.3, 3.4]\nvelocity = [20.0, 0.0, 0.0]\nstart_temperature = " +
         std::to_string(temperature) + "\n[[body]]\nname = \"sheet\"\n" + cells +
         "coordinates = \"fixed\"\n[[force]]\ntype = \"tersoff\"\nbody = \"layer\"\nparameters = "
         "\"lindsay_broido_2010\"\n[[force]]\ntype = \"lennard_jones\"\nbodies = [\"layer\", "
         "\"sheet\"]\nepsilon = 0.002411\nsigma = 3.4\ncutoff = 7.0\n[run]\nseed = 1\nduration = "
         "0.6\nintegrator = { type = \"velocity_verlet\", dt = 1e-3 }\n";
}

/// Neither by sharing work between threads nor by making neighbour lists again: they stay in the
/// memory of those that were before.
TEST(Allocations, ThereAreNoneWithThreadsAndNeighbourLists) {
  for (const double temperature : {10.0, 300.0}) {
    for (const std::size_t members : {1, 2}) {
      SCOPED_TRACE(std::to_string(temperature) + " K, threads: " + std::to_string(members));
      const std::unique_ptr<ThreadTeam> team = team_of(members);
      RunOptions options;
      if (team) options.team = &team->team();
      Engine engine(scene_of(layers(temperature)), options);
      engine.advance(200);
      const std::uint64_t before = allocations;
      engine.advance(300);
      EXPECT_EQ(allocations - before, 0u);
      EXPECT_FALSE(engine.done());
    }
  }
}

/// The cost of binding and running a scene.
struct Cost {
  std::uint64_t allocations = 0;
  std::uint64_t bytes = 0;
  std::string state;  ///< names and sizes of the numbers of the run
  std::uint64_t noises = 0;
};

Cost cost_of(const std::string& text) {
  const auto scene = scene_of(text);
  const std::uint64_t before = allocations;
  const std::uint64_t bytes_before = allocated;
  Engine engine(scene, options_to_bind());
  engine.advance(20);
  Cost cost{allocations - before, allocated - bytes_before, "", 0};
  for (const auto& field : engine.state().layout().reals()) {
    cost.state += field.name + " " + std::to_string(field.count) + ", ";
  }
  const SystemView<double>& view = engine.model().system().view;
  cost.noises = view.noise_count + view.kinetic_count;
  return cost;
}

/// A thermostat of temperature 0 takes what friction takes: nothing is allocated, kept or called
/// for random numbers. The control: with a temperature there is more of all three.
TEST(Allocations, WithoutNoiseNoGeneratorIsBuilt) {
  const auto text = [](const std::string& force, const std::string& scheme) {
    const bool inertial = standard().integrator(scheme)->with_inertia;
    return "[[body]]\nname = \"chain\"\ntype = \"chain\"\ncount = 5\nspacing = 1.0\n"
           "particle_mass = 1.0\n[[force]]\nname = \"driver\"\ntype = \"driving_spring\"\n"
           "stiffness = 1.0\nvelocity = [0.1]\n[[force]]\nname = \"bath\"\ncoefficient = 1.0\n" +
           force + "[run]\nduration = 1.0\n" + (inertial ? "" : "dynamics = \"overdamped\"\n") +
           "integrator = { type = \"" + scheme + "\", dt = 0.01 }\n";
  };
  constexpr std::uint64_t kOfAParameter = 3;
  for (const std::string scheme :
       {"baoab", "gjf", "velocity_verlet", "leimkuhler_matthews", "euler_maruyama"}) {
    SCOPED_TRACE(scheme);
    const Cost friction = cost_of(text("type = \"viscous_damping\"\n", scheme));
    const Cost cold = cost_of(text("type = \"langevin\"\ntemperature = 0.0\n", scheme));
    // The temperature is one more number that the scene may vary from particle to particle.
    EXPECT_LE(cold.allocations, friction.allocations + kOfAParameter);
    EXPECT_LE(cold.bytes, friction.bytes + kOfAParameter * sizeof(double));
    EXPECT_EQ(cold.state, friction.state);
    EXPECT_EQ(cold.noises, 0U);
    const Cost warm = cost_of(text("type = \"langevin\"\ntemperature = 0.1\n", scheme));
    EXPECT_GT(warm.allocations, cold.allocations + kOfAParameter);
    EXPECT_GT(warm.bytes, cold.bytes + 1000);
    EXPECT_GT(warm.state.size(), cold.state.size());
  }
  for (const std::string scheme : {"baoab", "gjf", "velocity_verlet", "rk4"}) {
    SCOPED_TRACE(scheme);
    const std::string memory = "type = \"memory_damping\"\nmemory_time = 1.0\n";
    const Cost without = cost_of(text(memory, scheme));
    const Cost cold = cost_of(text(memory + "temperature = 0.0\n", scheme));
    EXPECT_EQ(cold.allocations, without.allocations);
    EXPECT_EQ(cold.bytes, without.bytes);
    EXPECT_EQ(cold.state, without.state);
    if (scheme == "rk4") continue;
    EXPECT_GT(cost_of(text(memory + "temperature = 0.1\n", scheme)).bytes, cold.bytes);
  }
}

}  // namespace
}  // namespace tomlin::test
