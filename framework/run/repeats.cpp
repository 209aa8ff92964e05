#include "framework/run/repeats.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "framework/core/text/axis_names.hpp"
#include "framework/run/guard/side_run.hpp"
#include "framework/run/steps/lane_batch.hpp"
#include "framework/run/window/blocking.hpp"

namespace tomlin {
namespace {

constexpr const char* kRepeatsKey = "run.repeats";  // of warnings

/// A number over the window, in all repeats.
struct Repeated {
  std::size_t group;
  std::size_t value;
  std::size_t component;
  std::string path;
  std::vector<double> numbers;

  double mean() const {
    double sum = 0.0;
    for (const double x : numbers) sum += x;
    return sum / static_cast<double>(numbers.size());
  }
  /// Standard error of the mean; nothing for a single number.
  std::optional<double> error() const {
    if (numbers.size() < 2) return std::nullopt;
    return std::sqrt(variance_of_mean(numbers));
  }
};

std::vector<Repeated> repeated_numbers(const RunResult& result) {
  std::vector<Repeated> all;
  for (std::size_t g = 0; g < result.groups.size(); ++g) {
    const ResultGroup& group = result.groups[g];
    const std::string name = group.name.empty() ? "" : "." + group.name;
    for (std::size_t v = 0; v < group.values.size(); ++v) {
      const ResultQuantity& quantity = group.values[v].quantity();
      if (quantity.scope != Scope::window || quantity.shape == Shape::count) continue;
      for (std::size_t d = 0; d < group.values[v].count(); ++d) {
        const std::string axis =
            quantity.shape == Shape::vector ? fmt::format(".{}", kAxisNames[d]) : "";
        all.push_back(
            {g, v, d, fmt::format("{}{}.{}{}", group.family, name, quantity.key, axis), {}});
      }
    }
  }
  return all;
}

void add_numbers(const RunResult& result, std::vector<Repeated>& all) {
  for (Repeated& one : all) {
    const auto number = result.groups[one.group].values[one.value].finite(one.component);
    if (number) one.numbers.push_back(*number);
  }
}

using Repeats = std::vector<std::unique_ptr<SideRun>>;

/// A stream for each pair of a stream, which is at most 1e12 in a scene, and a repeat from 1 on. It
/// is negative, which no stream of a scene is.
std::int64_t stream_of_repeat(std::int64_t stream, std::int64_t repeat) {
  constexpr std::int64_t kMostRepeats = 1'000'000;  // of a scene
  return -(stream * kMostRepeats + repeat);
}

/// Returns the repeats from `first` on that run together.
Repeats next_repeats(const std::shared_ptr<const Scene>& scene, const RunOptions& options,
                     std::int64_t first) {
  Repeats runs;
  std::size_t most = 1;
  RunOptions own = options;
  for (std::int64_t repeat = first; repeat < scene->run.repeats && runs.size() < most; ++repeat) {
    const auto other = std::make_shared<Scene>(*scene);
    other->run.stream = stream_of_repeat(scene->run.stream, repeat);
    runs.push_back(std::make_unique<SideRun>(other, own, fmt::format("repeat {}", repeat)));
    own.on_progress = nullptr;  // that of the first is that of all
    Engine& engine = runs.front()->engine();
    if (runs.size() == 1 && engine.in_lanes().why_not().empty())
      most = LaneBatch::good_width(engine);
  }
  return runs;
}

std::vector<RunResult> results_of(const Repeats& runs) {
  std::vector<RunResult> results(runs.size());
  if (runs.size() < LaneBatch::kFewestRuns) {
    std::transform(runs.begin(), runs.end(), results.begin(),
                   [](const auto& run) { return run->engine().run(); });
    return results;
  }
  LaneBatch batch(runs.front()->engine(), runs.size());
  for (const auto& run : runs) batch.add(run->engine());
  while (!batch.is_empty()) {
    for (Engine* const ended : batch.advance()) {
      const auto run = std::find_if(runs.begin(), runs.end(),
                                    [&](const auto& one) { return &one->engine() == ended; });
      results[static_cast<std::size_t>(run - runs.begin())] = ended->end();
    }
  }
  return results;
}

}  // namespace

void average_over_repeats(const std::shared_ptr<const Scene>& scene, const RunOptions& options,
                          RunResult& result) {
  if (result.status != RunStatus::finished) return;
  std::vector<Repeated> all = repeated_numbers(result);
  add_numbers(result, all);
  const auto warn = [&result](FaultCode code, std::string text) {
    result.warnings.push_back({code, std::move(text), kRepeatsKey});
  };
  for (std::int64_t repeat = 1; repeat < scene->run.repeats;) {
    for (const RunResult& found : results_of(next_repeats(scene, options, repeat))) {
      if (found.status == RunStatus::interrupted) {
        result.status = RunStatus::interrupted;
        warn(FaultCode::run_comparison_stopped,
             fmt::format("stopped after {} of {} repeats", repeat, scene->run.repeats));
        return;
      }
      if (found.failure) {
        warn(FaultCode::run_perturb_failed,
             fmt::format("repeat {} failed: {}", repeat, to_string(*found.failure)));
      } else {
        add_numbers(found, all);
      }
      ++repeat;
    }
  }
  result.errors.clear();
  for (const Repeated& one : all) {
    if (one.numbers.empty()) continue;
    ResultValue& value = result.groups[one.group].values[one.value];
    std::vector<double> numbers(value.count(), std::nan(""));
    for (std::size_t d = 0; d < value.count(); ++d) {
      if (const auto known = value.finite(d)) numbers[d] = *known;
    }
    numbers[one.component] = one.mean();
    value.set(numbers);
    result.errors.push_back({one.path, one.error()});
  }
  std::erase_if(result.warnings, [](const Warning& warning) {
    return warning.code == FaultCode::run_error_not_estimated;
  });
}

}  // namespace tomlin
