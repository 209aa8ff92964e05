#include "framework/cli/result_text.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "framework/output/references.hpp"
#include "framework/scene/title.hpp"

namespace tomlin {
namespace {

constexpr std::size_t kMostShown = 6;  // drivers, bodies, warnings: the summary has all of them

std::string text_of(double x) { return fmt::format("{:.9g}", x); }

std::string text_of(const ResultValue& value) {
  if (value.size() == 1) return text_of(value[0]);
  std::string text;
  for (const double x : value) text += (text.empty() ? "" : ", ") + text_of(x);
  return "(" + text + ")";
}

/// The quantities of each family that are printed, and what they are called.
struct Printed {
  std::string_view family;
  std::vector<std::pair<std::string_view, std::string_view>> names;
};

const Printed& printed_of(std::string_view family) {
  static const Printed all[] = {
      {"drivers",
       {{"mean_force", "mean force"},
        {"work_per_distance", "work/distance"},
        {"static_force", "static force"}}},
      {"bodies", {{"mean_velocity", "mean velocity"}, {"turns", "turns"}, {"rolling", "rolling"}}},
      {"energy",
       {{"work_in", "work in"},
        {"heat_out", "heat out"},
        {"stored_change", "stored"},
        {"numerical_work", "numerical work"}}}};
  return *std::find_if(std::begin(all), std::end(all),
                       [family](const Printed& one) { return one.family == family; });
}

/// "mean force 0.1, static force 0.2": what is defined, by name.
std::string about(const ResultGroup& group) {
  std::string text;
  for (const auto& [key, name] : printed_of(group.family).names) {
    const ResultValue* value = group.find(key);
    if (value == nullptr || !value->has_value()) continue;
    if (!text.empty()) text += ", ";
    text += std::string(name) + " " + text_of(*value);
  }
  return text;
}

std::string about(const AccuracyResult& accuracy) {
  const std::string by = accuracy.companion.empty() ? "" : "; errors by " + accuracy.companion;
  return fmt::format("{:g} asked: {}{}", accuracy.asked, accuracy.integrator, by);
}

/// "driver.mean_force.x +/- 3e-7", of the mean forces.
std::vector<std::string> shown_errors(const RunResult& result) {
  std::vector<std::string> shown;
  for (const ErrorEstimate& estimate : result.errors) {
    if (!estimate.error || estimate.path.find(".mean_force.") == std::string::npos) continue;
    shown.push_back(fmt::format("{} within {:.1e}", estimate.path, *estimate.error));
  }
  return shown;
}

struct Line {
  std::string label;
  std::string content;
};

void row(std::vector<Line>& lines, std::string label, std::string content) {
  lines.push_back({std::move(label), std::move(content)});
}

void add_lines(std::vector<Line>& lines, std::span<const ResultGroup> results) {
  const std::size_t shown = std::min(results.size(), kMostShown);
  for (std::size_t k = 0; k < shown; ++k) {
    std::string text = about(results[k]);
    row(lines, results[k].name, text.empty() ? "the run ended before the window" : text);
  }
  if (results.size() > shown) {
    row(lines, "...", fmt::format("and {} more", results.size() - shown));
  }
}

}  // namespace

std::string result_text(const Scene& scene, const RunResult& result, const std::string& where) {
  std::vector<Line> lines;
  const std::string refused =
      result.refused_steps > 0 ? fmt::format(" ({} refused)", result.refused_steps) : "";
  row(lines, to_string(result.status),
      fmt::format("at time {:.9g} after {} steps{}, {} force evaluations", result.end_time,
                  result.steps, refused, result.force_evaluations));
  row(lines, "speed",
      fmt::format("{:.3g} s, {:.3g} steps/s, {}", result.wall_seconds, result.steps_per_second,
                  to_string(result.instruction_set)));
  row(lines, "window", fmt::format("time {:.9g} to {:.9g}", result.window_from, result.window_to));
  add_lines(lines, result.family("drivers"));
  add_lines(lines, result.family("bodies"));
  const ResultGroup* energy = result.find("energy");
  if (energy != nullptr && (*energy)["work_in"]) row(lines, "energy", about(*energy));
  if (result.accuracy) row(lines, "accuracy", about(*result.accuracy));
  for (std::size_t k = 0; k < std::min(shown_errors(result).size(), kMostShown); ++k) {
    row(lines, "error", shown_errors(result)[k]);
  }
  for (std::size_t k = 0; k < std::min(result.determined.size(), kMostShown); ++k) {
    const DeterminedResult& found = result.determined[k];
    row(lines, "determined",
        fmt::format("{} to {:.1f} digits ({} to {})", found.path, found.digits, text_of(found.min),
                    text_of(found.max)));
  }
  for (const auto& [force, why] : result.left_out)
    row(lines, "left out", fmt::format("{}: {}", force, why));
  for (std::size_t k = 0; k < std::min(result.warnings.size(), kMostShown); ++k) {
    row(lines, "warning", to_string(result.warnings[k]));
  }
  const std::size_t cited = references(scene, result.accuracy ? &*result.accuracy : nullptr).size();
  row(lines, "cite", fmt::format("{} works, under references in summary.json", cited));
  row(lines, "results", where);

  std::size_t width = 0;
  for (const Line& line : lines) width = std::max(width, line.label.size());
  std::string text = title_of(scene) + "\n";
  for (const auto& [label, content] : lines) {
    fmt::format_to(std::back_inserter(text), "  {:<{}}  {}\n", label, width, content);
  }
  return text;
}

}  // namespace tomlin
