#include <atomic>
#include <cstdlib>
#include <new>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/ring_scenes.hpp"

// Between the first step and the last nothing is allocated. This binary's operator new counts.

namespace {
std::atomic<std::uint64_t> allocations{0};

void* counted(std::size_t size, std::size_t alignment) {
  allocations.fetch_add(1, std::memory_order_relaxed);
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
  RingScene rigid_implicit = rigid;
  rigid_implicit.integrator = tip_implicit.integrator;
  for (const std::string& text :
       {tip.text(), tip_adaptive.text(), flexible.text(), large.text(), rigid.text(),
        rigid_adaptive.text(), chain, tip_implicit.text(), rigid_implicit.text(),
        kept_warm(noise, "{ type = \"baoab\", dt = 0.01 }", ""),
        kept_warm(links, "{ type = \"velocity_verlet\", dt = 0.01 }", ""),
        kept_warm(noise, "{ type = \"euler_maruyama\", dt = 0.01 }",
                  "\ndynamics = \"overdamped\"")}) {
    NullSink sink;
    RunOptions options;
    options.sink = &sink;
    Engine engine(scene_of(text), options);
    engine.advance(1);
    const std::uint64_t before = allocations;
    while (!engine.done()) engine.advance(100);
    const std::uint64_t after = allocations;
    EXPECT_EQ(after - before, 0u) << text;
    EXPECT_GT(sink.samples, 100u);
    EXPECT_EQ(engine.time(), 5.0);
  }
}

}  // namespace
}  // namespace tomlin::test
