// Runs the benchmarks and prints, for each model, the engine's time per step over that of its
// hand-written twins in this same process. The ratio is the figure; absolute times drift.
#include <algorithm>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "framework/core/system/instruction_set.hpp"

namespace {

/// Whether a benchmark was skipped with an error: the library has two names for it.
template <class Run>
bool failed(const Run& run) {
  if constexpr (requires { run.error_occurred; }) {
    return run.error_occurred;
  } else {
    return run.skipped != decltype(run.skipped){};
  }
}

class RatioReporter : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      const bool median = run.run_type == Run::RT_Aggregate && run.aggregate_name == "median";
      if ((run.run_type == Run::RT_Iteration || median) && !failed(run)) {
        const auto counter = run.counters.find("s_per_step");
        if (counter != run.counters.end()) {
          times_[run.run_name.function_name].push_back(1e9 * counter->second.value);
        }
      }
    }
    ConsoleReporter::ReportRuns(runs);
  }

  void Finalize() override {
    std::printf("\nMedian ns per step; kernels: %s; plain loops: -O3 -march=x86-64-v3\n",
                std::string(tomlin::to_string(tomlin::chosen_instruction_set())).c_str());
    std::printf("%-22s %12s %12s %12s %10s %10s\n", "model", "plain", "own sine", "tomlin",
                "/ plain", "/ own");
    for (const auto& [name, values] : times_) {
      const std::size_t at = name.find("/tomlin");
      if (at == std::string::npos) continue;
      const std::string model = name.substr(0, at);
      const double plain = median(model + "/plain");
      const double own = median(model + "/plain_own_math");
      const double ours = median(name);
      if (plain > 0.0) {
        std::printf("%-22s %12.1f %12.1f %12.1f %10.3f %10.3f\n", model.c_str(), plain, own, ours,
                    ours / plain, ours / own);
      } else {  // its twin was not asked for, or there is none
        std::printf("%-22s %12s %12s %12.1f\n", model.c_str(), "", "", ours);
      }
    }
    print_costs();
    ConsoleReporter::Finalize();
  }

 private:
  /// Variants of a model, over the model as it is.
  void print_costs() {
    std::printf("\n%-22s %-26s %12s %12s\n", "model", "with", "ns per step", "/ without");
    for (const auto& [name, values] : times_) {
      const std::size_t at = name.find('/');
      const std::string variant = name.substr(at + 1);
      if (variant == "tomlin" || variant.rfind("plain", 0) == 0) continue;
      const std::string model = name.substr(0, at);
      // A model that is not built in is compared with its hand-written twin.
      const bool built_in = times_.count(model + "/tomlin") > 0;
      const double plain = median(model + (built_in ? "/tomlin" : "/plain"));
      const double ours = median(name);
      std::printf("%-22s %-26s %12.1f", model.c_str(), variant.c_str(), ours);
      if (plain > 0.0) std::printf(" %12.3f", ours / plain);
      std::printf("\n");
    }
  }

  double median(const std::string& name) {
    std::vector<double>& values = times_[name];
    if (values.empty()) return 0.0;
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
  }

  std::map<std::string, std::vector<double>> times_;
};

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  RatioReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  benchmark::Shutdown();
  return 0;
}
