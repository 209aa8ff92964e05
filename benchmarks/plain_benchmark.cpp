// Nanoseconds per RK4 step (four force evaluations) of the reference loops, and per evaluation of
// one force. They are named MODEL/plain and MODEL/plain_own_math: main.cpp holds the engine's
// MODEL/tomlin against them.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numbers>
#include <string>

#include <benchmark/benchmark.h>

#include "benchmarks/counters.hpp"
#include "benchmarks/plain_loops.hpp"

namespace {

using namespace tomlin::plain;

constexpr std::size_t kTips = 64;
constexpr std::size_t kRings = 16;

// The model outlives the call, so that repetitions go on along the trajectory rather than time its
// beginning again and again.
template <class Model, class... Arguments>
void register_steps(const std::string& name, std::int64_t batch, double h, std::size_t replicas,
                    Arguments... arguments) {
  const auto model = std::make_shared<Model>(arguments...);
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
    for (auto _ : state) {
      model->advance(batch, h);
      benchmark::ClobberMemory();
    }
    const double steps = static_cast<double>(state.iterations()) * static_cast<double>(batch) *
                         static_cast<double>(replicas);
    state.SetItemsProcessed(static_cast<std::int64_t>(steps));
    tomlin::count_steps(state, steps);
  });
}

template <template <class> class Model, class... Arguments>
void register_twins(const std::string& name, std::int64_t batch, double h, Arguments... arguments) {
  register_steps<Model<StdMath>>(name + "/plain", batch, h, 1, arguments...);
  register_steps<Model<OwnMath>>(name + "/plain_own_math", batch, h, 1, arguments...);
}

// One evaluation of the force, nothing else.
template <class Model, class... Arguments>
void register_evaluation(const std::string& name, Arguments... arguments) {
  const auto model = std::make_shared<Model>(arguments...);
  benchmark::RegisterBenchmark(name.c_str(), [model](benchmark::State& state) {
    for (auto _ : state) {
      model->evaluate();
      benchmark::ClobberMemory();
    }
    tomlin::count_steps(state);
  });
}

template <class Math>
void BM_plain_chain_energy_1000(benchmark::State& state) {
  static const Chain<Math> model(1000, std::numbers::phi);
  for (auto _ : state) benchmark::DoNotOptimize(model.energy());
  tomlin::count_steps(state);
}
BENCHMARK(BM_plain_chain_energy_1000<StdMath>)->Name("chain_energy_1000/plain");
BENCHMARK(BM_plain_chain_energy_1000<OwnMath>)->Name("chain_energy_1000/plain_own_math");

// Time of a number.
void BM_plain_normals(benchmark::State& state) {
  static NormalReplicas normals(kTips);
  std::uint64_t four = 0;
  for (auto _ : state) {
    normals.draw(four++);
    benchmark::ClobberMemory();
  }
  tomlin::count_steps(state, static_cast<double>(state.iterations()) * 4.0 * kTips);
}
BENCHMARK(BM_plain_normals)->Name("normals of replicas/plain");

[[maybe_unused]] const bool registered = [] {
  register_twins<PrandtlTomlinson>("pt", 64, 1e-2);
  register_twins<RememberingTip>("pt_memory", 64, 1e-2);
  register_twins<FlexibleRing>("flexible_ring_8", 16, 1e-4);
  register_twins<RigidRing>("rigid_ring_8", 16, 1e-2);
  register_twins<RigidBox>("rigid_box_24", 16, 1e-2);
  // Rest length equal to the period: the particles move nearly in phase, which flatters a library
  // sine with branches. The phases of the golden chains fill the period, which is the fairer case.
  register_twins<Chain>("chain_1000", 1, 1e-2, 1000, 1.0);
  register_twins<Chain>("golden_chain_1000", 1, 1e-2, 1000, std::numbers::phi);
  register_twins<Chain>("golden_chain_100000", 1, 1e-2, 100000, std::numbers::phi);
  register_twins<Flake>("flake_1000", 1, 1e-2, 40, 25, std::numbers::phi);
  register_steps<TipReplicas>("pt replicas/plain", 64, 1e-2, kTips, kTips);
  register_steps<RingReplicas>("flexible_ring_8 replicas/plain", 64, 1e-4, kRings, kRings);
  register_evaluation<Bending>("angles_1000/plain", 1000, 100.0);
  register_evaluation<VariedSubstrate<StdMath>>("varied_substrate_1000/plain", 1000,
                                                std::numbers::phi);
  register_evaluation<VariedSubstrate<OwnMath>>("varied_substrate_1000/plain_own_math", 1000,
                                                std::numbers::phi);
  register_evaluation<SplineSurface>("energy_map_1000/plain", 32, 40, 25, std::numbers::phi);
  register_evaluation<DryFriction>("dry_friction_1000/plain", 1000);
  return true;
}();

}  // namespace
