// Time per row to make a run's files from its rows when it ends, to be compared with that of the
// steps that made them.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <unistd.h>

#include "framework/output/table.hpp"
#include "framework/output/trajectory.hpp"

namespace {

using namespace tomlin;

/// A table of seven columns and the positions of a ring of so many.
RunLayout layout_of(std::size_t particles) {
  RunLayout layout;
  for (const char* name : {"time", "fx", "fy", "x", "y", "vx", "vy"}) {
    layout.columns.push_back({name, "1"});
  }
  layout.bodies = {{"ring", std::vector<double>(particles, 1.0)}};
  layout.dimension = 2;
  return layout;
}

void write(benchmark::State& state, ResultFile& file, const std::filesystem::path& path) {
  const RunLayout layout = layout_of(static_cast<std::size_t>(state.range(0)));
  std::vector<double> row(layout.row());
  for (std::size_t k = 0; k < row.size(); ++k) row[k] = 1.0 / (3.0 + static_cast<double>(k));
  file.begin(layout);
  for (auto _ : state) {
    for (double& number : row) number += 0.01;
    file.sample(row);
  }
  state.SetItemsProcessed(state.iterations());
  state.counters["s_per_row"] =
      benchmark::Counter(static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  std::filesystem::remove(path.string() + std::string(kUnfinished));
}

std::filesystem::path scratch() {
  return std::filesystem::temp_directory_path() /
         ("tomlin-benchmark-" + std::to_string(::getpid()));
}

void BM_table(benchmark::State& state) {
  TableWriter table(scratch());
  write(state, table, scratch());
}
BENCHMARK(BM_table)->Name("conversion/csv")->Arg(1);

void BM_h5md(benchmark::State& state) {
  TrajectoryFile trajectory(scratch(), TrajectoryFormat::h5md, {});
  write(state, trajectory, scratch());
}
BENCHMARK(BM_h5md)->Name("conversion/h5md")->Arg(1)->Arg(8)->Arg(1000);

void BM_xyz(benchmark::State& state) {
  TrajectoryFile trajectory(scratch(), TrajectoryFormat::xyz, {});
  write(state, trajectory, scratch());
}
BENCHMARK(BM_xyz)->Name("conversion/xyz")->Arg(1)->Arg(8)->Arg(1000);

}  // namespace
