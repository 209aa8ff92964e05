// Nanoseconds per RK4 step (four force evaluations) of the reference loops.
#include <benchmark/benchmark.h>

#include "benchmarks/plain_loops.hpp"

namespace {

using namespace tomlin::plain;

// The model outlives the call, so that repetitions go on along the trajectory rather than time its
// beginning again and again.
template <class Model>
void run(benchmark::State& state, Model& model, std::int64_t batch, double h,
         std::int64_t replicas = 1) {
  for (auto _ : state) {
    model.advance(batch, h);
    benchmark::ClobberMemory();
  }
  const double steps =
      static_cast<double>(state.iterations()) * static_cast<double>(batch * replicas);
  state.SetItemsProcessed(static_cast<std::int64_t>(steps));
  // An inverted rate is seconds per step, which is printed as such (57n: 57 nanoseconds).
  state.counters["s_per_step"] =
      benchmark::Counter(steps, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

template <class Math>
void BM_plain_pt(benchmark::State& state) {
  static PrandtlTomlinson<Math> model;
  run(state, model, 64, 1e-2);
}

void BM_plain_pt_replicas(benchmark::State& state) {
  static TipReplicas replicas(64);
  run(state, replicas, 64, 1e-2, static_cast<std::int64_t>(replicas.x.size()));
}
BENCHMARK(BM_plain_pt_replicas)->Name("pt replicas/plain");

void BM_plain_ring_replicas(benchmark::State& state) {
  static RingReplicas replicas(16);
  run(state, replicas, 64, 1e-4, static_cast<std::int64_t>(replicas.stiffness.size()));
}
BENCHMARK(BM_plain_ring_replicas)->Name("flexible_ring_8 replicas/plain");

// Time of a number.
void BM_plain_normals(benchmark::State& state) {
  static NormalReplicas normals(64);
  std::uint64_t four = 0;
  for (auto _ : state) {
    normals.draw(four++);
    benchmark::ClobberMemory();
  }
  state.counters["s_per_step"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * 4.0 * 64.0,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(BM_plain_normals)->Name("normals of replicas/plain");

template <class Math>
void BM_plain_pt_memory(benchmark::State& state) {
  static RememberingTip<Math> model;
  run(state, model, 64, 1e-2);
}

template <class Math>
void BM_plain_flexible_ring(benchmark::State& state) {
  static FlexibleRing<Math> model(8);
  run(state, model, 16, 1e-4);
}

template <class Math>
void BM_plain_rigid_ring(benchmark::State& state) {
  static RigidRing<Math> model(8);
  run(state, model, 16, 1e-2);
}

template <class Math>
void BM_plain_rigid_box(benchmark::State& state) {
  static RigidBox<Math> model;
  run(state, model, 16, 1e-2);
}

// Rest length equal to the period: the particles move nearly in phase, which flatters a library
// sine with branches. The golden chain below is the fairer case.
template <class Math>
void BM_plain_chain_1000(benchmark::State& state) {
  static Chain<Math> model(1000);
  run(state, model, 1, 1e-2);
}

// Golden mean: the phases fill the period.
template <class Math>
void BM_plain_golden_chain_1000(benchmark::State& state) {
  static Chain<Math> model(1000, std::numbers::phi);
  run(state, model, 1, 1e-2);
}

template <class Math>
void BM_plain_golden_chain_100000(benchmark::State& state) {
  static Chain<Math> model(100000, std::numbers::phi);
  run(state, model, 1, 1e-2);
}

template <class Math>
void BM_plain_flake_1000(benchmark::State& state) {
  static Flake<Math> model(40, 25, std::numbers::phi);
  run(state, model, 1, 1e-2);
}

// One evaluation of the force, nothing else.
template <class Model>
void evaluate(benchmark::State& state, Model& model) {
  for (auto _ : state) {
    model.evaluate();
    benchmark::ClobberMemory();
  }
  state.counters["s_per_step"] =
      benchmark::Counter(static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

template <class Math>
void BM_plain_chain_energy_1000(benchmark::State& state) {
  static const Chain<Math> model(1000, std::numbers::phi);
  for (auto _ : state) benchmark::DoNotOptimize(model.energy());
  state.counters["s_per_step"] =
      benchmark::Counter(static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void BM_plain_angles_1000(benchmark::State& state) {
  static Bending model(1000, 100.0);
  evaluate(state, model);
}

template <class Math>
void BM_plain_varied_1000(benchmark::State& state) {
  static VariedSubstrate<Math> model(1000, std::numbers::phi);
  evaluate(state, model);
}

void BM_plain_map_1000(benchmark::State& state) {
  static SplineSurface model(32, 40, 25, std::numbers::phi);
  evaluate(state, model);
}

void BM_plain_dry_friction_1000(benchmark::State& state) {
  static DryFriction model(1000);
  evaluate(state, model);
}

// Named MODEL/plain and MODEL/plain_own_math: main.cpp holds the engine's MODEL/tomlin against
// them.
BENCHMARK(BM_plain_chain_energy_1000<StdMath>)->Name("chain_energy_1000/plain");
BENCHMARK(BM_plain_chain_energy_1000<OwnMath>)->Name("chain_energy_1000/plain_own_math");
BENCHMARK(BM_plain_angles_1000)->Name("angles_1000/plain");
BENCHMARK(BM_plain_varied_1000<StdMath>)->Name("varied_substrate_1000/plain");
BENCHMARK(BM_plain_varied_1000<OwnMath>)->Name("varied_substrate_1000/plain_own_math");
BENCHMARK(BM_plain_map_1000)->Name("energy_map_1000/plain");
BENCHMARK(BM_plain_dry_friction_1000)->Name("dry_friction_1000/plain");
BENCHMARK(BM_plain_pt<StdMath>)->Name("pt/plain");
BENCHMARK(BM_plain_pt_memory<StdMath>)->Name("pt_memory/plain");
BENCHMARK(BM_plain_flexible_ring<StdMath>)->Name("flexible_ring_8/plain");
BENCHMARK(BM_plain_rigid_ring<StdMath>)->Name("rigid_ring_8/plain");
BENCHMARK(BM_plain_rigid_box<StdMath>)->Name("rigid_box_24/plain");
BENCHMARK(BM_plain_chain_1000<StdMath>)->Name("chain_1000/plain");
BENCHMARK(BM_plain_golden_chain_1000<StdMath>)->Name("golden_chain_1000/plain");
BENCHMARK(BM_plain_golden_chain_100000<StdMath>)->Name("golden_chain_100000/plain");
BENCHMARK(BM_plain_flake_1000<StdMath>)->Name("flake_1000/plain");
BENCHMARK(BM_plain_flake_1000<OwnMath>)->Name("flake_1000/plain_own_math");
BENCHMARK(BM_plain_pt<OwnMath>)->Name("pt/plain_own_math");
BENCHMARK(BM_plain_pt_memory<OwnMath>)->Name("pt_memory/plain_own_math");
BENCHMARK(BM_plain_flexible_ring<OwnMath>)->Name("flexible_ring_8/plain_own_math");
BENCHMARK(BM_plain_rigid_ring<OwnMath>)->Name("rigid_ring_8/plain_own_math");
BENCHMARK(BM_plain_rigid_box<OwnMath>)->Name("rigid_box_24/plain_own_math");
BENCHMARK(BM_plain_chain_1000<OwnMath>)->Name("chain_1000/plain_own_math");
BENCHMARK(BM_plain_golden_chain_1000<OwnMath>)->Name("golden_chain_1000/plain_own_math");
BENCHMARK(BM_plain_golden_chain_100000<OwnMath>)->Name("golden_chain_100000/plain_own_math");

}  // namespace
