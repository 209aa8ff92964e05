#include "framework/cli/sweep_text.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/cli/diagnostics.hpp"
#include "framework/cli/explanation.hpp"
#include "framework/cli/progress.hpp"
#include "framework/core/system/instruction_set.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/core/text/words.hpp"
#include "framework/output/checksum.hpp"
#include "framework/output/this_machine.hpp"
#include "framework/run/steps/lane_batch.hpp"
#include "framework/scene/text.hpp"
#include "framework/study/sweep/point_run.hpp"
#include "framework/study/tradeoff/methods.hpp"

namespace tomlin {
namespace {

using Json = nlohmann::ordered_json;

/// Version of the layout of sweep.json, which changes when a key goes or means something else.
constexpr int kSweepJsonFormat = 1;
constexpr std::size_t kMostNamesOnALine = 4;
constexpr std::size_t kMostIntervalsShown = 4;

double rate_of(const SweepProgress& progress) {
  const auto done = static_cast<double>(progress.with_row() - progress.before);
  return progress.seconds > 0.0 ? done / progress.seconds : 0.0;
}

/// "a, b and 3 more"
template <class All, class Name>
std::string some_of(const All& all, Name name) {
  std::vector<std::string> shown;
  for (const auto& one : all) {
    if (shown.size() < kMostNamesOnALine) shown.push_back(name(one));
  }
  std::string text = fmt::format("{}", fmt::join(shown, ", "));
  if (all.size() > shown.size()) text += fmt::format(" and {} more", all.size() - shown.size());
  return text;
}

/// "31 x 4 = 124"
std::string shape_text(const SweepPlan& plan) {
  std::vector<std::size_t> counts;
  for (const SweepDimension& dimension : plan.dimensions()) counts.push_back(dimension.count);
  if (counts.size() == 1) return fmt::format("{}", plan.points());
  return fmt::format("{} = {}", fmt::join(counts, " x "), plan.points());
}

std::string settings_text(const SweepPlan& plan, std::size_t point) {
  std::vector<std::string> texts;
  for (const Setting& setting : plan.settings_at(point)) {
    texts.push_back(setting.path + " = " + shortened(setting.value, kLongestShownValue));
  }
  return fmt::format("{}", fmt::join(texts, ", "));
}

std::string result_row(const char* name, const std::string& text) {
  return fmt::format("  {:<12} {}\n", name, text);
}

/// Along which axis, where points continue.
std::string continued_text(const SweepPlan& plan) {
  if (plan.line() == 1) return "";
  return fmt::format("; each point from the end of the one before along {}",
                     plan.axes()[plan.dimensions().back().axes.front()].name);
}

std::string refined_text(const SweepPlan& plan) {
  const SweepRefinement& refinement = *plan.refinement();
  return fmt::format("{} where {} {}", plan.axes()[refinement.axis].name,
                     plan.columns()[plan.refined_column()].name,
                     refinement.level ? fmt::format("crosses {}", *refinement.level) : "jumps");
}

/// "k from 35.6765 (1) to 35.6768 (0), v = 0.001"
std::string interval_text(const SweepPlan& plan, const Bisection& one) {
  const std::size_t refined = plan.refinement()->axis;
  const auto& [low, high] = one.ends;
  std::string text = fmt::format("{} from {} ({:.6g}) to {} ({:.6g})", plan.axes()[refined].name,
                                 low.at, low.number, high.at, high.number);
  for (std::size_t axis = 0; axis < plan.axes().size(); ++axis) {
    if (axis == refined) continue;
    text += fmt::format(", {} = {}", plan.axes()[axis].name, plan.text(axis, one.first));
  }
  return text;
}

/// Rows on what is refined, the number of points added, and the first intervals with a result.
std::string refined_rows(const SweepPlan& plan, std::size_t added,
                         const std::vector<Bisection>& bisections) {
  if (!plan.refinement()) return "";
  std::vector<std::size_t> counts(kWordTable<BisectionStatus>.size());
  std::string intervals;
  std::size_t shown = 0;
  for (const Bisection& one : bisections) {
    if (!one.status) continue;
    ++counts[static_cast<std::size_t>(*one.status)];
    if (*one.status == BisectionStatus::none || shown == kMostIntervalsShown) continue;
    ++shown;
    intervals += result_row(to_string(*one.status), interval_text(plan, one));
  }
  std::string text = fmt::format("{}: {} points more", refined_text(plan), added);
  for (std::size_t k = 0; k < counts.size(); ++k) {
    if (counts[k] == 0) continue;
    text += fmt::format(", {} {}", counts[k], to_string(static_cast<BisectionStatus>(k)));
  }
  return result_row("refined", text) + intervals;
}

std::string shard_row(const SweepPlan& plan, const std::optional<SweepPart>& shard) {
  if (!shard) return "";
  return result_row("shard", fmt::format("{} of {}: {} of these points", shard->index + 1,
                                         shard->of, shard->size(plan.points())));
}

std::string axes_and_observables(const SweepPlan& plan, const std::optional<SweepPart>& shard) {
  return result_row("points", shape_text(plan)) + shard_row(plan, shard) +
         result_row("over", some_of(plan.axes(), [](const SweepAxis& axis) { return axis.name; }) +
                                continued_text(plan)) +
         result_row("observables", some_of(plan.observables(),
                                           [](const SweepObservable& one) { return one.name; }));
}

/// "4 points finished, 1 failed"
std::string counts_text(const SweepCounts& counts) {
  std::string text = fmt::format("{} points finished", counts.of(SweepStatus::finished));
  for (const SweepStatus status : {SweepStatus::failed, SweepStatus::refused}) {
    if (counts.of(status) > 0) {
      text += fmt::format(", {} {}", counts.of(status), to_string(status));
    }
  }
  return text + "\n";
}

/// The first point without numbers, and the warnings.
std::string remarks(const SweepPlan& plan, const SweepCounts& counts) {
  std::string text;
  if (!counts.reason.empty()) {
    text += result_row(
        "first", fmt::format("point {}, {}: {}", counts.first_without_numbers,
                             settings_text(plan, counts.point_without_numbers), counts.reason));
  }
  for (const auto& [code, warned] : counts.warnings) {
    text += result_row("warning", fmt::format("{} at {} points, first: point {}", id_of(code),
                                              warned.points, warned.first));
  }
  return text;
}

Json axis_entry(const SweepPlan& plan, std::size_t axis) {
  const SweepAxis& from = plan.axes()[axis];
  const SweepValues& values = from.values;
  Json entry = {{"name", from.name}, {"count", values.size()}};
  for (std::size_t d = 0; d < plan.dimensions().size(); ++d) {
    const auto& axes = plan.dimensions()[d].axes;
    if (std::find(axes.begin(), axes.end(), axis) != axes.end()) entry["dimension"] = d;
  }
  switch (values.spacing()) {
    case SweepValues::Spacing::list:
      entry["spacing"] = "list";
      for (std::size_t k = 0; k < values.size(); ++k) {
        entry["values"].push_back(values.numeric() ? Json(values.number(k))
                                                   : Json(values.plain_text(k)));
      }
      return entry;
    case SweepValues::Spacing::linear:
      entry["spacing"] = "linear";
      break;
    case SweepValues::Spacing::logarithmic:
      entry["spacing"] = "logarithmic";
      break;
  }
  entry["from"] = values.number(0);
  entry["to"] = values.number(values.size() - 1);
  return entry;
}

/// The other axes' values, the interval and the observable at its ends.
Json interval_entry(const SweepPlan& plan, const Bisection& one) {
  Json entry = {{"status", to_string(*one.status)}, {"axes", Json::object()}};
  const std::size_t refined = plan.refinement()->axis;
  for (std::size_t axis = 0; axis < plan.axes().size(); ++axis) {
    if (axis == refined) continue;
    const SweepValues& values = plan.axes()[axis].values;
    entry["axes"][plan.axes()[axis].name] =
        values.numeric() ? Json(plan.number(axis, one.first))
                         : Json(values.plain_text(plan.index(axis, one.first)));
  }
  if (*one.status == BisectionStatus::none) return entry;
  entry["interval"] = {one.ends[0].at, one.ends[1].at};
  entry["values"] = {one.ends[0].number, one.ends[1].number};
  return entry;
}

Json refine_entry(const SweepPlan& plan, const std::vector<Bisection>& bisections) {
  const SweepRefinement& refinement = *plan.refinement();
  Json entry = {{"observable", plan.paths()[plan.refined_column()]},
                {"level", refinement.level ? Json(*refinement.level) : Json()},
                {"along", plan.axes()[refinement.axis].name},
                {"to", refinement.width},
                {"intervals", Json::array()}};
  for (const Bisection& one : bisections) {
    if (one.status) entry["intervals"].push_back(interval_entry(plan, one));
  }
  return entry;
}

/// If a level lies between all neighbours.
std::size_t most_added(const SweepPlan& plan) {
  const SweepRefinement& refinement = *plan.refinement();
  const SweepValues& values = plan.axes()[refinement.axis].values;
  std::size_t most = 0;
  for (std::size_t k = 1; refinement.level && k < values.size(); ++k) {
    most += refinement.rounds_between(values.number(k - 1), values.number(k));
  }
  return (refinement.level ? most : refinement.rounds) * (plan.points() / values.size());
}

}  // namespace

std::string sweep_progress_text(const SweepProgress& progress) {
  const std::size_t done = progress.with_row();
  const auto left = static_cast<double>(progress.points - done);
  const double rate = rate_of(progress);
  std::string text =
      fmt::format("{} %, {} of {} points", done * 100 / std::max<std::size_t>(1, progress.points),
                  done, progress.points);
  for (const SweepStatus status : {SweepStatus::failed, SweepStatus::refused}) {
    const std::size_t count = progress.done[static_cast<std::size_t>(status)];
    if (count > 0) text += fmt::format(", {} {}", count, to_string(status));
  }
  return text + fmt::format(", {} elapsed, {} remaining, {:.2g} points/s",
                            duration_text(progress.seconds),
                            rate > 0.0 ? duration_text(left / rate) : "?", rate);
}

std::string sweep_text(const SweepPlan& plan, const RecordedSweep& sweep,
                       const std::string& where) {
  const SweepProgress& progress = sweep.progress;
  std::string text;
  if (!sweep.counts) {
    text = fmt::format("interrupted with {} of {} points; the same command goes on\n",
                       progress.with_row(), progress.points);
  } else {
    text = counts_text(*sweep.counts);
    if (progress.traces_left > 0) {
      text += fmt::format("interrupted with {} traces left; the same command goes on\n",
                          progress.traces_left);
    }
  }
  text += axes_and_observables(plan, sweep.shard);
  text += refined_rows(plan, progress.points - std::min(progress.points, plan.points()),
                       sweep.bisections);
  if (sweep.counts) text += remarks(plan, *sweep.counts);
  text += result_row(
      "time", fmt::format("{} for {} points, {:.3g} points/s", duration_text(progress.seconds),
                          progress.with_row() - progress.before, rate_of(progress)));
  return text + result_row("results", where);
}

std::string merge_text(const SweepPlan& plan, const RecordedSweep& merged,
                       std::size_t first_missing, const std::string& where) {
  const std::string axes = axes_and_observables(plan, std::nullopt);
  const std::string results = result_row("results", where);
  if (merged.counts) {
    return counts_text(*merged.counts) + axes + remarks(plan, *merged.counts) + results;
  }
  const SweepProgress& progress = merged.progress;
  return fmt::format("{} of {} points are missing\n", progress.points - progress.with_row(),
                     progress.points) +
         axes +
         result_row("missing", fmt::format("first point {}, {}", first_missing,
                                           settings_text(plan, first_missing))) +
         results;
}

std::string sweep_json(const SweepPlan& plan, const RecordedSweep& sweep, std::size_t threads) {
  const SweepProgress& progress = sweep.progress;
  const std::optional<SweepCounts>& counts = sweep.counts;
  const std::optional<SweepPart>& shard = sweep.shard;
  const std::string& scene = plan.scene_text();
  Json json;
  json["status"] = to_string(counts ? RunStatus::finished : RunStatus::interrupted);
  json["program"] = {
      {"name", "tomlin"}, {"version", plan.program_version()}, {"format", kSweepJsonFormat}};
  json["scene"] = {
      {"name", plan.scene().name.empty() ? Json() : Json(plan.scene().name)},
      {"xxh3_64", fmt::format("{:016x}", checksum_of(std::as_bytes(std::span(scene)), 0))}};
  json["sweep"] = fmt::format("{:016x}", plan.identity());
  json["axes"] = Json::array();
  for (std::size_t axis = 0; axis < plan.axes().size(); ++axis) {
    json["axes"].push_back(axis_entry(plan, axis));
  }
  json["observables"] = Json::array();
  for (const SweepObservable& one : plan.observables()) {
    json["observables"].push_back(
        {{"path", one.path}, {"column", one.name}, {"unit", one.unit}, {"meaning", one.meaning}});
  }
  json["continue_from_neighbour"] = plan.line() > 1;
  if (plan.refinement()) json["refine"] = refine_entry(plan, sweep.bisections);
  json["points"] = plan.refinement() ? progress.points : plan.points();
  if (shard) {
    json["shard"] = {
        {"number", shard->index + 1}, {"of", shard->of}, {"points", shard->size(plan.points())}};
  }
  json["counts"] = Json::object();
  json["warnings"] = Json::array();
  if (counts) {
    for (std::size_t k = 0; k < kSweepStatuses; ++k) {
      json["counts"][to_string(static_cast<SweepStatus>(k))] = counts->by_status[k];
    }
    for (const auto& [code, warned] : counts->warnings) {
      json["warnings"].push_back({{"code", id_of(code)},
                                  {"meaning", kind_of(code).meaning},
                                  {"points", warned.points},
                                  {"first", warned.first}});
    }
  }
  const Machine machine = this_machine();
  json["performance"] = {{"rows", progress.with_row()},
                         {"rows_of_this_process", progress.with_row() - progress.before},
                         {"wall_seconds", progress.seconds},
                         {"points_per_second", rate_of(progress)},
                         {"threads", threads},
                         {"instruction_set", to_string(chosen_instruction_set())},
                         {"processor", machine.processor},
                         {"system", machine.system},
                         {"scene_file", plan.scene().file}};
  return json_text(json);
}

namespace {

/// Whether points are taken in lanes, by one of them.
std::string lanes_text(const SweepPlan& plan, std::size_t point) {
  PointRun run(plan, point);
  Engine* const engine = run.engine();
  const std::string alone = engine == nullptr
                                ? "accuracy, perturb or repeats make several runs of each"
                                : engine->in_lanes().why_not();
  if (!alone.empty()) return "none, points are run one by one: " + alone;
  return fmt::format("points of one structure together, {} in a thread",
                     LaneBatch::good_width(*engine));
}

}  // namespace

std::string sweep_plan_text(const SweepPlan& plan, std::size_t threads,
                            const std::optional<SweepPart>& shard) {
  std::string text = "nothing is run or written\n" + axes_and_observables(plan, shard);
  const SweepPart part = shard.value_or(SweepPart{});
  const std::size_t points = part.size(plan.points());
  if (points == 0) return text;
  if (plan.refinement()) {
    text += result_row("refined", fmt::format("{}, which adds up to {} points", refined_text(plan),
                                              most_added(plan)));
  }
  std::size_t first = 0;
  while (!part.has(first)) ++first;
  std::size_t last = plan.points() - 1;
  while (!part.has(last)) --last;
  text += result_row("first", settings_text(plan, first));
  text += result_row("last", settings_text(plan, last));
  std::optional<std::string> refused;
  for (const std::size_t point : {first, last}) {
    try {
      const Explanation explanation = explain(plan.scene_at(point));
      const std::string lanes = lanes_text(plan, point);
      if (!explanation.cost) {
        refused = "a step of the trial failed or is too long";
        continue;
      }
      // One point takes as long as it does, however many threads there are.
      const std::size_t lines = points / plan.line();
      const std::size_t at_once = std::min(threads, lines);
      const std::size_t rounds = (lines + at_once - 1) / at_once;
      const double all = explanation.cost->seconds * static_cast<double>(rounds * plan.line());
      text += result_row(
          "cost", fmt::format("about {:.3g} s for {} point, {} for all one by one in {} threads",
                              explanation.cost->seconds, point == first ? "the first" : "the last",
                              duration_text(all), at_once));
      text += result_row("lanes", lanes);
      return text;
    } catch (const InputError& error) {
      refused = condensed(error);
    }
  }
  return text +
         result_row("cost", "not known: the first and the last point cannot be tried: " + *refused);
}

}  // namespace tomlin
