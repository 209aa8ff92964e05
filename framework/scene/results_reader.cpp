// Readers of the requested results: `[measure]`, the window for means, and `[output]`.

#include <algorithm>

#include <fmt/format.h>

#include "framework/core/text/nearest_name.hpp"
#include "framework/scene/scene_draft.hpp"
#include "framework/scene/text.hpp"

namespace tomlin {
namespace {

// How far a driver gets is known to the model only; see there for windows in its periods.
void check_window(SceneDraft& draft, const TableReading& reading) {
  const MeasureSettings& measure = draft.scene->measure;
  const double duration = draft.scene->run.duration;
  if (!reading.has("from") || (reading.given->find("to") && !reading.has("to"))) return;
  if (measure.to && *measure.to <= measure.from) {
    reading.complain(draft.faults, "to",
                     {FaultCode::run_invalid_window, "", "the window ends before it begins",
                      fmt::format("> {}, the value of from", measure.from)});
    return;
  }
  const bool in_time = reading.has("in") && measure.unit == MeasureSettings::Unit::time;
  if (!in_time || !draft.duration_is_known) return;
  if (measure.to && *measure.to > duration) {
    reading.complain(draft.faults, "to",
                     {FaultCode::run_invalid_window, "", "past the end of the run",
                      fmt::format("<= {}, the run's duration", duration)});
  } else if (!measure.to && measure.from >= duration) {
    reading.complain(draft.faults, "from",
                     {FaultCode::run_invalid_window, "", "past the end of the run",
                      fmt::format("< {}, the run's duration", duration)});
  }
}

void check_periods(SceneDraft& draft, const TableReading& reading) {
  const MeasureSettings& measure = draft.scene->measure;
  for (const char* key : {"driver", "period"}) {
    if (measure.unit == MeasureSettings::Unit::time && reading.has(key)) {
      reading.complain(
          draft.faults, key,
          {FaultCode::scene_conflict, "", "has a meaning only with in = \"driver_periods\""});
      return;
    }
  }
  if (!reading.has("driver")) return;
  const auto names = names_of(draft.forces);
  if (std::find(names.begin(), names.end(), measure.driver) == names.end()) {
    reading.complain(draft.faults, "driver",
                     {FaultCode::scene_unknown_name, "", "there is no such force", listed(names),
                      nearest_name(measure.driver, names).value_or("")});
  }
}

}  // namespace

void read_measure(SceneDraft& draft) {
  const auto given = draft.section("measure");
  if (!given) return;
  MeasureSettings& measure = draft.scene->measure;
  static const TableLayout layout = measure_layout();
  const TableReading reading = draft.read(*given, layout, "measure", &measure);
  measure.location = draft.source.location(given->where);
  measure.locations = reading.locations;
  const std::optional<UntilSettings>& until = draft.scene->run.until;
  if (until && !until->is_steady() && given->table->find("to") != nullptr) {
    reading.complain(draft.faults, "to",
                     {FaultCode::scene_conflict, "",
                      "run.until ends the window where the error of a mean is small enough",
                      "no to; max in run.until is the latest time"});
  } else if (!until || !until->is_steady()) {
    check_window(draft, reading);
  }
  if (reading.valid) check_periods(draft, reading);
  draft.effective.set("measure", {reading.effective, {}});
}

void read_output(SceneDraft& draft) {
  const Table nothing;
  const auto given = draft.section("output").value_or(SceneSection{&nothing, kTopOfFile});
  OutputSettings& output = draft.scene->output;
  static const TableLayout layout = output_layout();
  const TableReading reading = draft.read(given, layout, "output", &output);
  output.location = draft.source.location(given.where);
  output.locations = reading.locations;
  if (output.trajectory && given.table->find("every") == nullptr) {
    reading.complain(draft.faults, "trajectory",
                     {FaultCode::scene_conflict, "",
                      "positions are written with samples, but none are requested",
                      "set every, the sampling interval"});
  }
  draft.effective.set("output", {reading.effective, {}});
}

}  // namespace tomlin
