#pragma once

#include <benchmark/benchmark.h>

namespace tomlin {

/// Reports seconds per step, as an inverted rate, which is printed as such (57n: 57 nanoseconds).
inline void count_steps(benchmark::State& state, double steps) {
  state.counters["s_per_step"] =
      benchmark::Counter(steps, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

/// With a step per iteration.
inline void count_steps(benchmark::State& state) {
  count_steps(state, static_cast<double>(state.iterations()));
}

}  // namespace tomlin
