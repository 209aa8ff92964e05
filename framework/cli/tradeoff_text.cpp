#include "framework/cli/tradeoff_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/cli/diagnostics.hpp"
#include "framework/cli/output_table.hpp"
#include "framework/cli/sections.hpp"
#include "framework/scene/title.hpp"

namespace tomlin {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMostDecades = 16;

/// The points, but for what the text says in words.
OutputTable table_of(const Tradeoff& tradeoff) {
  OutputTable table;
  using Point = const TradeoffPoint&;
  const auto add = [&](const ColumnHeading& heading, auto value) {
    table.add(heading, tradeoff.points, value);
  };
  const auto method_of = [&](Point point) -> const Method& {
    return tradeoff.methods[point.method];
  };
  const auto add_resolution = [&](Resolution kind, const char* csv) {
    add({.key = to_string(kind), .csv = csv}, [&, kind](Point point) -> OutputTable::Cell {
      if (method_of(point).resolution != kind) return std::nullopt;
      return point.resolution;
    });
  };
  add({.key = "rung", .csv = "rung", .quoted = true, .text = "rung"},
      [&](Point point) { return method_of(point).name; });
  const bool metal = tradeoff.units == UnitSystem::metal;
  add_resolution(Resolution::step, metal ? "dt [ps]" : "dt [time]");
  add_resolution(Resolution::tolerance, "tolerance");
  add({.text = "", .width = 9},
      [&](Point point) { return to_string(method_of(point).resolution); });
  add({.text = "", .width = 8, .format = "{:.2g}"}, [](Point point) { return point.resolution; });
  add({.key = "value", .csv = "value"}, [](Point point) { return point.value; });
  add({.key = "error", .csv = "error"}, [](Point point) { return point.error; });
  add({.key = "relative_error", .csv = "relative error"}, [&](Point point) {
    return tradeoff.scale.relative ? Json(tradeoff.error_of(point)) : Json();
  });
  add({.text = "error", .width = 8, .format = "{:.1e}"},
      [&](Point point) { return tradeoff.error_of(point); });
  add({.key = "force_evaluations", .csv = "force evaluations", .text = "evaluations", .width = 12},
      [](Point point) { return point.evaluations; });
  add({.key = "jacobian_columns", .csv = "jacobian columns", .text = "columns", .width = 9},
      [](Point point) { return point.columns; });
  add({.key = "cost", .csv = "cost"}, [](Point point) { return point.cost(); });
  add({.key = "seconds", .csv = "wall time [s]", .text = "seconds", .width = 8, .format = "{:.2g}"},
      [](Point point) { return point.seconds; });
  add({.key = "fastest_at"}, [](Point point) { return point.fastest_at; });
  add({.key = "cheapest_at"}, [](Point point) { return point.cheapest_at; });
  return table;
}

std::string error_text(const Tradeoff& tradeoff, double error) {
  if (!tradeoff.scale.resolved) return fmt::format("{:.1e}", error);
  return fmt::format("{:.1e} ({:.1e} of {})", error, error / tradeoff.scale.size,
                     tradeoff.scale.relative ? "it" : fmt::format("{:.2g}", tradeoff.scale.size));
}

std::string second_text(const Tradeoff& tradeoff) {
  const Reference& reference = *tradeoff.reference;
  if (!reference.second_differs) return "no other scheme got through";
  std::string text = fmt::format("{} differs by {}", reference.second,
                                 error_text(tradeoff, *reference.second_differs));
  if (reference.second_agrees) return text;
  return text + (reference.second_settled ? ", and neither moves any more"
                                          : ", still moving when its part of the budget was over");
}

std::string quadruple_text(const Tradeoff& tradeoff) {
  const Reference& reference = *tradeoff.reference;
  if (!reference.quadruple_differs) return "not checked: " + reference.unchecked;
  return fmt::format("{} differs by {} over {:.3g} % of the run", reference.quadruple,
                     error_text(tradeoff, *reference.quadruple_differs),
                     100.0 * reference.quadruple_part);
}

std::string sensitivity_text(const Sensitivity& sensitivity, const ErrorScale& scale) {
  if (sensitivity.values.empty()) return "not known: " + sensitivity.why;
  std::string spread =
      fmt::format("starts that differ by {:g} and {:g} move it by {:.1e}",
                  sensitivity.sizes.front(), sensitivity.sizes.back(), sensitivity.spread);
  // Zero has no digits.
  if (scale.relative) spread += fmt::format(", {:.1f} digits are shared", sensitivity.digits);
  switch (sensitivity.verdict) {
    case Sensitivity::Verdict::determined:
      return "yes: " + spread;
    case Sensitivity::Verdict::not_determined:
      return fmt::format("NO: {}, {:.6g} to {:.6g}", spread, sensitivity.min, sensitivity.max);
    case Sensitivity::Verdict::unknown:
      break;
  }
  return "not known: " + sensitivity.why;
}

void add_reference(Sections& rows, const Tradeoff& tradeoff) {
  const Reference& reference = *tradeoff.reference;
  rows.row("reference", fmt::format("{:.12g}, error {}{}", reference.value,
                                    error_text(tradeoff, reference.error),
                                    reference.settled ? "" : "; it has not stopped moving"));
  rows.row("  by", fmt::format("{}, {} = {:g}, {} evaluations, {:.2g} s", reference.method,
                               to_string(reference.resolution), reference.resolution_value,
                               reference.cost, reference.seconds));
  rows.row("  other scheme", second_text(tradeoff));
  rows.row("  quadruple", quadruple_text(tradeoff));
  if (tradeoff.scale.resolved && !tradeoff.scale.relative) {
    rows.row("  zero", fmt::format("as far as it is known: errors are parts of {:.2g}, which the "
                                   "scene's own units have for it",
                                   tradeoff.scale.size));
  }
  rows.row("determined", sensitivity_text(tradeoff.sensitivity, tradeoff.scale));
}

/// "1e-2 to 1e-4" of 2, 3, 4.
std::string accuracies(const std::vector<int>& powers) {
  if (powers.size() == 1) return fmt::format("1e-{}", powers.front());
  return fmt::format("1e-{} to 1e-{}", powers.front(), powers.back());
}

std::string marks_of(const Tradeoff& tradeoff, std::size_t index) {
  const TradeoffPoint& point = tradeoff.points[index];
  std::string marks;
  const auto add = [&marks](const std::string& mark) {
    marks += (marks.empty() ? "" : ", ") + mark;
  };
  if (tradeoff.recommendation && tradeoff.recommendation->point == index) add("recommended");
  if (!point.cheapest_at.empty()) add("cheapest at " + accuracies(point.cheapest_at));
  if (!point.fastest_at.empty()) add("fastest at " + accuracies(point.fastest_at));
  return marks;
}

/// Returns the cheapest point of each method in each decade of the error, and all that have a mark.
std::vector<std::size_t> shown_points(const Tradeoff& tradeoff) {
  std::map<std::pair<std::size_t, int>, std::size_t> cheapest;
  std::vector<std::size_t> shown;
  for (std::size_t p = 0; p < tradeoff.points.size(); ++p) {
    const TradeoffPoint& point = tradeoff.points[p];
    const double error = tradeoff.error_of(point);
    const int decade =
        error > 0.0 ? std::clamp(static_cast<int>(std::floor(std::log10(error))), -kMostDecades, 1)
                    : -kMostDecades;
    const auto [entry, is_new] = cheapest.try_emplace({point.method, decade}, p);
    if (!is_new && point.cost() < tradeoff.points[entry->second].cost()) entry->second = p;
    if (!marks_of(tradeoff, p).empty()) shown.push_back(p);
  }
  for (const auto& [key, p] : cheapest) shown.push_back(p);
  std::sort(shown.begin(), shown.end());
  shown.erase(std::unique(shown.begin(), shown.end()), shown.end());
  return shown;
}

std::string shown_table(const Tradeoff& tradeoff) {
  const OutputTable table = table_of(tradeoff);
  std::string text = table.text_names() + "\n";
  for (const std::size_t p : shown_points(tradeoff)) {
    const std::string line = table.text(p) + "  " + marks_of(tradeoff, p);
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

/// Methods that are left out for the same reason stand together.
std::string gaps(const Tradeoff& tradeoff) {
  std::vector<std::pair<std::string, std::string>> by_reason;
  for (const TradeoffGap& gap : tradeoff.gaps) {
    const std::string reason = fmt::format("{}: {}", to_string(gap.kind), gap.why);
    const auto same = std::find_if(by_reason.begin(), by_reason.end(),
                                   [&](const auto& one) { return one.first == reason; });
    if (same == by_reason.end()) {
      by_reason.emplace_back(reason, gap.method);
    } else {
      same->second += "; " + gap.method;
    }
  }
  std::string text;
  for (const auto& [reason, methods] : by_reason) {
    fmt::format_to(std::back_inserter(text), "  {}: {}\n", methods, reason);
  }
  return text;
}

std::string recommendation(const Tradeoff& tradeoff) {
  if (!tradeoff.recommendation) return "no recommendation: " + tradeoff.why_none + "\n";
  const Recommendation& chosen = *tradeoff.recommendation;
  const TradeoffPoint& point = tradeoff.points[chosen.point];
  std::string text = fmt::format(
      "recommended for {} error of {:.2g}: {}, error {:.1e}, {} evaluations, {:.2g} s\n\n",
      tradeoff.scale.relative ? "a relative" : "an",
      chosen.tolerance * (tradeoff.scale.relative ? 1.0 : tradeoff.scale.size),
      tradeoff.methods[point.method].name, tradeoff.error_of(point), point.cost(), point.seconds);
  for (const std::string& line : scene_lines(chosen.settings)) text += "  " + line + "\n";
  return text;
}

// ---- JSON: numbers that are not finite are null

Json text_or_null(const std::string& text) { return text.empty() ? Json() : Json(text); }

Json reference_entry(const Reference& reference) {
  return {{"value", reference.value},
          {"error", reference.error},
          {"settled", reference.settled},
          {"rung", reference.method},
          {to_string(reference.resolution), reference.resolution_value},
          {"cost", reference.cost},
          {"seconds", reference.seconds},
          {"second",
           {{"rung", text_or_null(reference.second)},
            {"differs", number(reference.second_differs)},
            {"agrees", reference.second_agrees},
            {"settled", reference.second_settled}}},
          {"quadruple",
           {{"rung", text_or_null(reference.quadruple)},
            {"differs", number(reference.quadruple_differs)},
            {"part_of_run", reference.quadruple_part},
            {"unchecked", text_or_null(reference.unchecked)}}}};
}

Json determined_entry(const Sensitivity& found) {
  Json determined;
  if (found.verdict != Sensitivity::Verdict::unknown) {
    determined = found.verdict == Sensitivity::Verdict::determined;
  }
  return {{"determined", determined},
          {"spread", found.spread},
          {"digits", found.digits},
          {"min", found.min},
          {"max", found.max},
          {"integration_error", found.integration_error},
          {"sizes", found.sizes},
          {"values", found.values},
          {"why", text_or_null(found.why)}};
}

Json recommendation_entry(const Tradeoff& tradeoff) {
  if (!tradeoff.recommendation) return {};
  const Recommendation& chosen = *tradeoff.recommendation;
  Json entry = table_of(tradeoff).json(chosen.point);
  entry["tolerance"] = chosen.tolerance;
  entry["settings"] = Json::object();
  for (const Setting& setting : chosen.settings) entry["settings"][setting.path] = setting.value;
  entry["lines"] = scene_lines(chosen.settings);
  return entry;
}

}  // namespace

std::string tradeoff_text(const Scene& scene, const Tradeoff& tradeoff, const std::string& where) {
  Sections rows;
  rows.section(title_of(scene));
  rows.row("observable", tradeoff.observable);
  if (tradeoff.reference) {
    add_reference(rows, tradeoff);
  } else {
    rows.row("reference", "none: " + tradeoff.why_none);
  }
  rows.row("budget", fmt::format("{:.3g} of {:g} s used{}", tradeoff.seconds, tradeoff.budget,
                                 tradeoff.interrupted ? ", then interrupted" : ""));
  rows.row("results", where);
  std::string text = rows.text();
  if (!tradeoff.points.empty()) text += "\n" + shown_table(tradeoff);
  if (tradeoff.sensitivity.verdict == Sensitivity::Verdict::not_determined) {
    text += "\nErrors below the spread have no meaning: other rounding would give others.\n";
  }
  const std::string left_out = gaps(tradeoff);
  if (!left_out.empty()) text += "\nleft out\n" + left_out;
  return text + "\n" + recommendation(tradeoff);
}

std::string tradeoff_csv(const Tradeoff& tradeoff) { return table_of(tradeoff).csv(); }

std::string tradeoff_json(const Scene& scene, const Tradeoff& tradeoff) {
  Json json;
  json["scene"] = scene.file;
  json["status"] = to_string(tradeoff.interrupted ? RunStatus::interrupted : RunStatus::finished);
  json["observable"] = tradeoff.observable;
  json["tolerance"] = tradeoff.tolerance;
  json["relative"] = tradeoff.scale.relative;
  json["resolved"] = tradeoff.reference && tradeoff.scale.resolved;
  json["error_unit"] = tradeoff.scale.size;
  json["parameters"] = Json::object();
  for (const auto& [name, value] : scene.parameters) json["parameters"][name] = value;
  json["reference"] = tradeoff.reference ? reference_entry(*tradeoff.reference) : Json();
  json["determined"] = determined_entry(tradeoff.sensitivity);
  json["recommendation"] = recommendation_entry(tradeoff);
  json["no_recommendation"] = text_or_null(tradeoff.recommendation ? "" : tradeoff.why_none);
  json["left_out"] = Json::array();
  for (const TradeoffGap& gap : tradeoff.gaps) {
    json["left_out"].push_back(
        {{"rung", gap.method}, {"reason", to_string(gap.kind)}, {"why", gap.why}});
  }
  json["points"] = Json::array();
  const OutputTable table = table_of(tradeoff);
  for (std::size_t k = 0; k < tradeoff.points.size(); ++k) json["points"].push_back(table.json(k));
  json["budget"] = {{"seconds", tradeoff.budget}, {"used", tradeoff.seconds}};
  return json_text(json);
}

}  // namespace tomlin
