#include "framework/run/results/results.hpp"

#include <algorithm>
#include <utility>

#include "framework/core/text/axis_names.hpp"
#include "framework/run/observers/run_observer.hpp"

/// Results of a run: rows of observers, and those of the run itself.
namespace tomlin {
namespace {

using enum Scope;
using enum Shape;

enum TimeRow { kEnd, kSteps, kForceEvaluations, kJacobianColumns, kRefusedSteps };
const ResultQuantity kTimeRows[] = {
    {"end", dimension::time, number, end, "time that the run has reached"},
    {"steps", dimension::none, count, run, "steps"},
    {"force_evaluations", dimension::none, count, run, "evaluations of all forces"},
    {"jacobian_columns", dimension::none, count, run,
     "columns of derivatives, each worth an evaluation"},
    {"rejected_steps", dimension::none, count, run,
     "attempted steps that the error control rejected"},
};

const ResultQuantity kWindowRows[] = {
    {"from", dimension::time, number, window, "beginning of the window"},
    {"to", dimension::time, number, window, "end of the window"},
};

const ResultQuantity kPerformanceRows[] = {
    {"wall_seconds", dimension::none, number, run, "duration of the run on this machine", "s"},
    {"steps_per_second", dimension::none, number, run, "steps by wall_seconds", "1/s"},
    {"threads", dimension::none, count, run, "threads that shared the evaluations of forces"},
};

/// Rows of observers' kinds, by family.
ResultFamily family_of_observers(std::string_view name, std::string_view of,
                                 std::string_view when) {
  ResultFamily family{name, of, when, {}};
  for (const ObserverKind& kind : observer_kinds()) {
    for (const ObserverRows& rows : kind.rows) {
      if (rows.family != name) continue;
      for (const ResultQuantity* row : rows.quantities) family.quantities.push_back(*row);
    }
  }
  return family;
}

std::vector<ResultFamily> list_families() {
  const auto of_run = [](std::string_view name, std::span<const ResultQuantity> rows) {
    return ResultFamily{name, "", "", {rows.begin(), rows.end()}};
  };
  return {
      of_run("time", kTimeRows),
      of_run("window", kWindowRows),
      family_of_observers("drivers", "each driver", ""),
      family_of_observers("bodies", "each body", ""),
      family_of_observers("forces", "each force on each body",
                          "where [measure] observables asks for it"),
      family_of_observers("events", "", ""),
      family_of_observers("equilibrium", "", "with dynamics = \"quasistatic\""),
      family_of_observers("energy", "", "with ledger = true"),
      of_run("performance", kPerformanceRows),
  };
}

std::optional<double> number_of(std::optional<std::uint64_t> count) {
  if (!count) return {};
  return static_cast<double>(*count);
}

}  // namespace

std::span<const ResultFamily> result_families() {
  static const std::vector<ResultFamily> families = list_families();
  return families;
}

const ResultQuantity* quantity_at(std::string_view path) {
  const auto last = [](std::string_view text) { return text.substr(text.rfind('.') + 1); };
  std::string_view key = last(path);
  if (value_named<Axis>(key)) key = last(path.substr(0, path.size() - 2));
  for (const bool named : {true, false}) {
    for (const ResultFamily& family : result_families()) {
      if (named && !path.starts_with(family.family)) continue;
      for (const ResultQuantity& quantity : family.quantities) {
        if (quantity.key == key) return &quantity;
      }
    }
  }
  return nullptr;
}

std::vector<ResultGroup> groups_of_run(const RunResult& result) {
  ResultGroup time = {"time", "", {}};
  time.add(kTimeRows[kEnd], result.end_time);
  time.add(kTimeRows[kSteps], number_of(result.steps));
  time.add(kTimeRows[kForceEvaluations], number_of(result.force_evaluations));
  time.add(kTimeRows[kJacobianColumns], number_of(result.jacobian_columns));
  time.add(kTimeRows[kRefusedSteps], number_of(result.refused_steps));
  ResultGroup window = {"window", "", {}};
  window.add(kWindowRows[0], result.window_from);
  window.add(kWindowRows[1], result.window_to);
  ResultGroup performance = {"performance", "", {}};
  performance.add(kPerformanceRows[0], result.wall_seconds);
  performance.add(kPerformanceRows[1], result.steps_per_second);
  performance.add(kPerformanceRows[2], number_of(result.threads));
  return {std::move(time), std::move(window), std::move(performance)};
}

}  // namespace tomlin
