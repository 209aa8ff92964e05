#include "framework/study/sweep/point_run.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "framework/core/text/fault.hpp"
#include "framework/output/sweep_files.hpp"
#include "framework/run/results/observables.hpp"
#include "framework/study/accuracy/accuracy.hpp"
#include "framework/study/tradeoff/methods.hpp"

namespace tomlin {
namespace {

/// The name of the run itself in its store; runs beside it have other names.
constexpr const char* kRunOfPoint = "run";

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

SweepRow row_without_numbers(const SweepPlan& plan, SweepStatus status, std::string reason) {
  SweepRow row;
  row.status = status;
  row.numbers.assign(plan.columns().size(), kNoNumber);
  row.reason = std::move(reason);
  return row;
}

std::optional<double> number_of(const RunResult& result, SweepColumn::Kind kind,
                                const std::string& path) {
  switch (kind) {
    case SweepColumn::Kind::value:
      return observable(result, path);
    case SweepColumn::Kind::error:
      for (const ErrorEstimate& estimate : result.errors) {
        if (estimate.path == path) return estimate.error;
      }
      return std::nullopt;
    case SweepColumn::Kind::spread:
      for (const DeterminedResult& one : result.determined) {
        if (full_path(result, one.path) == path) return one.spread;
      }
      return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace

SweepRow row_of_refused(const SweepPlan& plan, const InputError& error) {
  return row_without_numbers(plan, SweepStatus::refused, condensed(error));
}

PointRun::PointRun(const SweepPlan& plan, std::size_t point, const std::atomic<bool>* stop,
                   const std::filesystem::path& checkpoints)
    : plan_(plan), point_(point), scene_(plan.scene_at(point, EffectiveText::left_out)) {
  options_.stop = stop;
  options_.observables = plan.paths();
  if (checkpoints.empty()) return;
  store_.emplace(checkpoints / fmt::format("{}{}", point, kPointSuffix),
                 fmt::format("sweep {:x}, point {}", plan.identity(), point),
                 scene_->run.checkpoint_every);
  state_ = store_->kept(kRunOfPoint);
  options_.sink = this;
  options_.store = &*store_;
}

void PointRun::checkpoint(const RunState& state) { store_->keep(kRunOfPoint, state.to_bytes()); }

/// Resumes from its checkpoint, unless that is of a program with other numbers in its state.
template <class Act>
auto PointRun::resumed(Act act) {
  RunOptions options = options_;
  if (!state_.empty()) {
    options.resume_from = &state_;
    try {
      return act(options);
    } catch (const std::invalid_argument&) {
      options.resume_from = nullptr;
    }
  }
  return act(options);
}

/// Faults that are found on the way, such as a missing observable, make a row of a refused point.
template <class Act>
std::optional<SweepRow> PointRun::row_unless_refused(Act act) {
  try {
    return row_of(act());
  } catch (const InputError& error) {
    return row_of_refused(plan_, error);
  }
}

std::optional<SweepRow> PointRun::run() {
  return row_unless_refused([this] {
    if (engine_) return engine_->run();
    return resumed([this](const RunOptions& options) { return tomlin::run(scene_, options); });
  });
}

Engine* PointRun::engine() {
  if (scene_->run.accuracy || scene_->run.perturb || scene_->run.repeats > 1) return nullptr;
  if (!engine_) {
    engine_ = resumed(
        [this](const RunOptions& options) { return std::make_unique<Engine>(scene_, options); });
  }
  return engine_.get();
}

std::optional<SweepRow> PointRun::end() {
  return row_unless_refused([this] { return engine_->end(); });
}

void PointRun::remove_checkpoint() const {
  if (store_) store_->remove();
}

std::optional<SweepRow> PointRun::row_of(const RunResult& result) {
  if (result.status == RunStatus::interrupted) {
    if (store_) store_->write();
    return std::nullopt;
  }
  SweepRow row = row_without_numbers(plan_, SweepStatus::finished, "");
  for (const Warning& warning : result.warnings) {
    row.warnings.set(static_cast<std::size_t>(warning.code));
  }
  if (result.failure) {
    row.status = SweepStatus::failed;
    row.reason = to_string(*result.failure);
    return row;
  }
  for (std::size_t k = 0; k < plan_.columns().size(); ++k) {
    const SweepColumn& column = plan_.columns()[k];
    const auto number = number_of(result, column.kind, plan_.paths()[column.observable]);
    if (number && std::isfinite(*number)) row.numbers[k] = *number;
  }
  return row;
}

}  // namespace tomlin
