#include "framework/cli/result_text.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "framework/cli/sections.hpp"
#include "framework/output/references.hpp"
#include "framework/run/results/observables.hpp"
#include "framework/run/results/results.hpp"
#include "framework/scene/title.hpp"

namespace tomlin {
namespace {

constexpr std::size_t kMostShown = 6;  // drivers, bodies, warnings: the summary has all of them

std::string text_of(double x) { return fmt::format("{:.9g}", x); }

/// " eV/A"; empty in reduced units, which have no symbols.
std::string unit_behind(UnitSystem units, const Dimension& dimension) {
  const bool none = units == UnitSystem::reduced || dimension == dimension::none;
  return none ? "" : " " + unit_symbol(units, dimension);
}

std::string text_of(const ResultValue& value, UnitSystem units) {
  const std::string unit = unit_behind(units, value.quantity().dimension);
  if (value.size() == 1) return text_of(value[0]) + unit;
  std::string text;
  for (const double x : value) text += (text.empty() ? "" : ", ") + text_of(x);
  return "(" + text + ")" + unit;
}

/// The quantities of each family that are printed, and what they are called.
struct Printed {
  std::string_view family;
  std::vector<std::pair<std::string_view, std::string_view>> names;
};

const Printed& printed_of(std::string_view family) {
  static const Printed all[] = {{"drivers",
                                 {{"half_difference", "friction (half difference)"},
                                  {"trace", "trace"},
                                  {"retrace", "retrace"},
                                  {"loop_area", "loop area"},
                                  {"mean_force", "mean force"},
                                  {"work_per_distance", "work/distance"},
                                  {"static_force", "static force"}}},
                                {"bodies",
                                 {{"mean_velocity", "mean velocity"},
                                  {"turns", "turns"},
                                  {"rolling", "rolling"},
                                  {"temperature", "temperature"}}},
                                {"energy",
                                 {{"work_in", "work in"},
                                  {"heat_out", "heat out"},
                                  {"stored_change", "stored"},
                                  {"numerical_work", "numerical work"}}}};
  return *std::find_if(std::begin(all), std::end(all),
                       [family](const Printed& one) { return one.family == family; });
}

/// Whether a driver reverses: the friction is then that of its loops, and means over the window
/// are of both directions.
bool has_loops(const ResultGroup& group) { return group.find("loops") != nullptr; }
bool is_of_both_directions(std::string_view key) {
  return key == "mean_force" || key == "work_per_distance";
}

/// "mean force 0.1, static force 0.2": what is defined, by name.
std::string about(const ResultGroup& group, UnitSystem units) {
  std::string text;
  if (has_loops(group) && group["loops"] == 0.0) text = "no complete loop within the window";
  for (const auto& [key, name] : printed_of(group.family).names) {
    const ResultValue* value = group.find(key);
    if (value == nullptr || !value->has_value()) continue;
    if (has_loops(group) && is_of_both_directions(key)) continue;
    if (!text.empty()) text += ", ";
    text += std::string(name) + " " + text_of(*value, units);
  }
  return text;
}

/// Describes a group that has only the quantities which the scene asks for: all of them, and those
/// that have no value.
std::string about_asked(const ResultGroup& group, UnitSystem units) {
  const auto& names = printed_of(group.family).names;
  std::string text = about(group, units);
  std::string undefined;
  for (const ResultValue& value : group.values) {
    const ResultQuantity& quantity = value.quantity();
    const bool printed = !(has_loops(group) && is_of_both_directions(quantity.key)) &&
                         std::any_of(names.begin(), names.end(),
                                     [&](const auto& name) { return name.first == quantity.key; });
    if (!value.has_value()) {
      undefined += fmt::format("{}no {} ({})", undefined.empty() ? "" : ", ", quantity.key,
                               quantity.meaning);
    } else if (!printed) {
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", quantity.key, text_of(value, units));
    }
  }
  return text + (text.empty() || undefined.empty() ? "" : "; ") + undefined;
}

std::string about(const AccuracyResult& accuracy) {
  std::string by;
  if (!accuracy.companion.empty()) {
    by = "; errors by " + accuracy.companion;
    by += accuracy.companion_scheme != accuracy.scheme
              ? " and, of another family, " + accuracy.second_companion
              : ", of the same integrator alone";
  }
  return fmt::format("{:g} asked: {}{}", accuracy.asked, accuracy.integrator, by);
}

/// "drivers.driver.mean_force.x = 0.316 +- 0.011 (standard error)", of the mean forces; of a driver
/// that reverses, of its loops.
std::vector<std::string> shown_errors(const RunResult& result, UnitSystem units) {
  std::vector<std::string> shown;
  const std::vector<Observable> all = observables(result);
  const char* kind = result.accuracy ? "estimated error" : "standard error";
  for (const ErrorEstimate& estimate : result.errors) {
    const auto is_mean_of_loops = [&](const ResultGroup& driver) {
      return has_loops(driver) &&
             estimate.path.starts_with("drivers." + driver.name + ".mean_force.");
    };
    const auto drivers = result.family("drivers");
    const bool mean_force = estimate.path.find(".mean_force.") != std::string::npos &&
                            std::none_of(drivers.begin(), drivers.end(), is_mean_of_loops);
    const bool shows = mean_force || estimate.path.ends_with(".half_difference") ||
                       estimate.path.ends_with("trace") ||
                       estimate.path.find(".mean_velocity.") != std::string::npos ||
                       estimate.path.ends_with(".temperature");
    if (!estimate.error || !shows) continue;
    const auto of = std::find_if(all.begin(), all.end(), [&](const Observable& one) {
      return one.path == estimate.path && one.value;
    });
    if (of == all.end()) continue;
    shown.push_back(fmt::format("{} = {} +- {:.2g}{} ({})", estimate.path, text_of(*of->value),
                                *estimate.error, unit_behind(units, of->quantity->dimension),
                                kind));
  }
  return shown;
}

void add_groups(Sections& sections, const Scene& scene, const RunResult& result,
                std::string_view family) {
  const auto results = result.family(family);
  const bool ended_before = result.end_time < result.window_to;
  const bool asked = !scene.measure.observables.empty() && !ended_before;
  const std::size_t shown = std::min(results.size(), kMostShown);
  for (std::size_t k = 0; k < shown; ++k) {
    std::string text =
        asked ? about_asked(results[k], scene.units) : about(results[k], scene.units);
    if (text.empty()) text = ended_before ? "the run ended before the window" : "no value";
    sections.row(results[k].name, text);
  }
  if (results.size() > shown) {
    sections.row("...", fmt::format("and {} more", results.size() - shown));
  }
}

}  // namespace

std::string result_text(const Scene& scene, const RunResult& result, const std::string& where) {
  Sections sections;
  sections.section(title_of(scene));
  const std::string rejected =
      result.refused_steps > 0 ? fmt::format(" ({} rejected)", result.refused_steps) : "";
  const std::string time = unit_behind(scene.units, dimension::time);
  sections.row(
      to_string(result.status),
      fmt::format("at time {:.9g}{} after {} steps{}, {} force evaluations", result.end_time, time,
                  result.steps, rejected, result.force_evaluations));
  const std::string threads = result.threads > 1 ? fmt::format(", {} threads", result.threads) : "";
  sections.row("speed",
               fmt::format("{:.3g} s, {:.3g} steps/s, {}{}", result.wall_seconds,
                           result.steps_per_second, to_string(result.instruction_set), threads));
  sections.row("window",
               fmt::format("time {:.9g} to {:.9g}{}", result.window_from, result.window_to, time));
  add_groups(sections, scene, result, "drivers");
  add_groups(sections, scene, result, "bodies");
  const ResultGroup* energy = result.find("energy");
  const bool any = energy != nullptr && !about(*energy, scene.units).empty();
  if (any) sections.row("energy", about(*energy, scene.units));
  if (result.accuracy) sections.row("accuracy", about(*result.accuracy));
  const std::vector<std::string> errors = shown_errors(result, scene.units);
  for (std::size_t k = 0; k < std::min(errors.size(), kMostShown); ++k) {
    sections.row("error", errors[k]);
  }
  for (std::size_t k = 0; k < std::min(result.determined.size(), kMostShown); ++k) {
    const DeterminedResult& found = result.determined[k];
    sections.row("determined", fmt::format("{} to {:.1f} digits ({} to {})", found.path,
                                           found.digits, text_of(found.min), text_of(found.max)));
  }
  for (const auto& [force, why] : result.left_out)
    sections.row("left out", fmt::format("{}: {}", force, why));
  for (std::size_t k = 0; k < std::min(result.warnings.size(), kMostShown); ++k) {
    sections.row("warning", to_string(result.warnings[k]));
  }
  const std::size_t cited = references(scene, result.accuracy ? &*result.accuracy : nullptr).size();
  sections.row("cite", fmt::format("{} works, under references in summary.json", cited));
  sections.row("results", where);
  return sections.text();
}

}  // namespace tomlin
