#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "framework/cli/tradeoff_text.hpp"
#include "framework/output/number_text.hpp"

namespace tomlin {
namespace {

using Json = nlohmann::ordered_json;

Json number(double x) { return std::isfinite(x) ? Json(x) : Json(); }

Json number(const std::optional<double>& x) { return x ? number(*x) : Json(); }

Json text_or_null(const std::string& text) { return text.empty() ? Json() : Json(text); }

/// In double quotes: names hold commas.
std::string quoted(const std::string& text) { return "\"" + text + "\""; }

Json reference_entry(const Reference& reference) {
  return {{"value", number(reference.value)},
          {"error", number(reference.error)},
          {"settled", reference.settled},
          {"rung", reference.method},
          {to_string(reference.resolution), number(reference.knob_value)},
          {"cost", reference.cost},
          {"seconds", number(reference.seconds)},
          {"second",
           {{"rung", text_or_null(reference.second)},
            {"differs", number(reference.second_differs)},
            {"agrees", reference.second_agrees},
            {"settled", reference.second_settled}}},
          {"quadruple",
           {{"rung", text_or_null(reference.quadruple)},
            {"differs", number(reference.quadruple_differs)},
            {"part_of_run", number(reference.quadruple_part)},
            {"unchecked", text_or_null(reference.unchecked)}}}};
}

Json determined_entry(const Sensitivity& found) {
  Json determined;
  if (found.verdict != Sensitivity::Verdict::unknown) {
    determined = found.verdict == Sensitivity::Verdict::determined;
  }
  return {{"determined", determined},       {"spread", number(found.spread)},
          {"digits", number(found.digits)}, {"min", number(found.min)},
          {"max", number(found.max)},       {"integration_error", number(found.integration_error)},
          {"sizes", found.sizes},           {"values", found.values},
          {"why", text_or_null(found.why)}};
}

Json point_entry(const Tradeoff& tradeoff, const TradeoffPoint& point) {
  const Method& method = tradeoff.methods[point.method];
  Json entry;
  entry["rung"] = method.name;
  entry[to_string(method.resolution)] = number(point.resolution);
  entry["value"] = number(point.value);
  entry["error"] = number(point.error);
  entry["relative_error"] = tradeoff.scale.relative ? number(tradeoff.error_of(point)) : Json();
  entry["force_evaluations"] = point.evaluations;
  entry["jacobian_columns"] = point.columns;
  entry["cost"] = point.cost();
  entry["seconds"] = number(point.seconds);
  entry["fastest_at"] = point.fastest_at;
  entry["cheapest_at"] = point.cheapest_at;
  return entry;
}

Json recommendation_entry(const Tradeoff& tradeoff) {
  if (!tradeoff.recommendation) return {};
  const Recommendation& chosen = *tradeoff.recommendation;
  Json entry = point_entry(tradeoff, tradeoff.points[chosen.point]);
  entry["tolerance"] = number(chosen.tolerance);
  entry["settings"] = Json::object();
  for (const Setting& setting : chosen.settings) entry["settings"][setting.path] = setting.value;
  entry["lines"] = scene_lines(chosen.settings);
  return entry;
}

}  // namespace

std::string tradeoff_csv(const Tradeoff& tradeoff) {
  std::string text =
      "rung,dt [time],tolerance,value,error,relative error,force evaluations,jacobian columns,"
      "cost,wall time [s]\n";
  for (const TradeoffPoint& point : tradeoff.points) {
    const Method& method = tradeoff.methods[point.method];
    const bool step = method.resolution == Resolution::step;
    text += quoted(method.name) + ",";
    if (step) append_number(text, point.resolution);
    text += ",";
    if (!step) append_number(text, point.resolution);
    for (const double x : {point.value, point.error}) {
      text += ",";
      append_number(text, x);
    }
    text += ",";
    if (tradeoff.scale.relative) append_number(text, tradeoff.error_of(point));
    text += "," + std::to_string(point.evaluations) + "," + std::to_string(point.columns) + "," +
            std::to_string(point.cost()) + ",";
    append_number(text, point.seconds);
    text += "\n";
  }
  return text;
}

std::string tradeoff_json(const Scene& scene, const Tradeoff& tradeoff) {
  Json json;
  json["scene"] = scene.file;
  json["status"] = to_string(tradeoff.interrupted ? RunStatus::interrupted : RunStatus::finished);
  json["observable"] = tradeoff.observable;
  json["tolerance"] = number(tradeoff.tolerance);
  json["relative"] = tradeoff.scale.relative;
  json["resolved"] = tradeoff.reference && tradeoff.scale.resolved;
  json["error_unit"] = number(tradeoff.scale.size);
  json["parameters"] = Json::object();
  for (const auto& [name, value] : scene.parameters) json["parameters"][name] = number(value);
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
  for (const TradeoffPoint& point : tradeoff.points) {
    json["points"].push_back(point_entry(tradeoff, point));
  }
  json["budget"] = {{"seconds", number(tradeoff.budget)}, {"used", number(tradeoff.seconds)}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace tomlin
