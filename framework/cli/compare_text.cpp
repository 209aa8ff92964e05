#include "framework/cli/compare_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/output/number_text.hpp"

namespace tomlin {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kHeight = 300.0;  // of the panel, in points of the screen

std::string text_of(const std::optional<double>& x, const char* format) {
  return x ? fmt::format(fmt::runtime(format), *x) : "-";
}

std::string answer(const Comparison& comparison) {
  if (comparison.interrupted) return "interrupted: no model was judged\n";
  if (!comparison.reference) {
    return "no answer: the model with the most coordinates has no result to compare others with\n";
  }
  const ComparedModel& reference = comparison.models[*comparison.reference];
  const ComparedModel& simplest = comparison.models[*comparison.simplest];
  if (comparison.simplest == comparison.reference) {
    return fmt::format("no simpler model agrees with {} within {:g}\n", reference.name,
                       comparison.tolerance);
  }
  return fmt::format("simplest within {:g} of {}: {}, {} free coordinates ({})\n",
                     comparison.tolerance, reference.name, simplest.name, simplest.coordinates,
                     simplest.file);
}

Json number(const std::optional<double>& x) { return x && std::isfinite(*x) ? Json(*x) : Json(); }

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? "\"\"" : std::string(1, c);
  return result + "\"";
}

}  // namespace

std::string compare_text(const Comparison& comparison, const std::string& where) {
  std::size_t width = 5;
  for (const ComparedModel& model : comparison.models) width = std::max(width, model.name.size());
  std::string text = fmt::format("{}\n\n  {:<{}}  {:>11}  {:>17}  {:>8}  {:>11}  {:>12}  {}\n",
                                 comparison.observable, "model", width, "coordinates", "value",
                                 "error", "difference", "evaluations", "");
  for (const ComparedModel& model : comparison.models) {
    text += fmt::format("  {:<{}}  {:>11}  {:>17}  {:>8}  {:>11}  {:>12}  {}\n", model.name, width,
                        model.coordinates, text_of(model.value, "{:.9g}"),
                        text_of(model.error, "{:.1e}"), text_of(model.difference, "{:.2e}"),
                        model.cost(), to_string(model.verdict));
    if (model.result.failure) text += "    " + to_string(*model.result.failure) + "\n";
    for (const Warning& warning : model.result.warnings) {
      text += "    warning: " + to_string(warning) + "\n";
    }
  }
  for (const std::string& note : comparison.notes) text += "  note: " + note + "\n";
  return text + "\n" + answer(comparison) + "results: " + where + "\n";
}

std::string compare_csv(const Comparison& comparison) {
  std::string text =
      "model,file,verdict,particles,free coordinates,value,error,difference,force evaluations,"
      "jacobian columns,wall time [s]\n";
  for (const ComparedModel& model : comparison.models) {
    text += quoted(model.name) + "," + quoted(model.file) + "," + to_string(model.verdict) + "," +
            std::to_string(model.particles) + "," + std::to_string(model.coordinates);
    for (const auto& x : {model.value, model.error, model.difference}) {
      text += ",";
      if (x && std::isfinite(*x)) append_number(text, *x);
    }
    text += "," + std::to_string(model.result.force_evaluations) + "," +
            std::to_string(model.result.jacobian_columns) + ",";
    append_number(text, model.result.wall_seconds);
    text += "\n";
  }
  return text;
}

std::string compare_json(const Comparison& comparison) {
  Json json;
  json["observable"] = comparison.observable;
  json["tolerance"] = comparison.tolerance;
  json["status"] = comparison.interrupted ? "interrupted" : "finished";
  const auto file_of = [&](const std::optional<std::size_t>& k) {
    return k ? Json(comparison.models[*k].file) : Json();
  };
  json["reference"] = file_of(comparison.reference);
  json["simplest"] = file_of(comparison.simplest);
  json["notes"] = comparison.notes;
  json["models"] = Json::array();
  for (const ComparedModel& model : comparison.models) {
    Json entry;
    entry["name"] = model.name;
    entry["file"] = model.file;
    entry["verdict"] = to_string(model.verdict);
    entry["status"] = to_string(model.result.status);
    entry["particles"] = model.particles;
    entry["coordinates"] = model.coordinates;
    entry["value"] = number(model.value);
    entry["error"] = number(model.error);
    entry["difference"] = number(model.difference);
    entry["force_evaluations"] = model.result.force_evaluations;
    entry["jacobian_columns"] = model.result.jacobian_columns;
    entry["seconds"] = number(model.result.wall_seconds);
    entry["warnings"] = texts_of(model.result.warnings);
    entry["warning_codes"] = codes_of(model.result.warnings);
    if (model.result.failure) entry["failure"] = to_string(*model.result.failure);
    json["models"].push_back(std::move(entry));
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Figure compare_figure(const Comparison& comparison) {
  Figure figure;
  figure.x_label = {"displacement of the driver [length]"};
  Panel panel;
  panel.height = kHeight;
  panel.y_label = {"lateral force along the pull [force]"};
  for (std::size_t k = 0; k < comparison.models.size(); ++k) {
    const ComparedModel& model = comparison.models[k];
    if (model.way.empty()) continue;
    Polyline line;
    for (std::size_t i = 0; i < model.way.size(); ++i) {
      line.push_back({model.way[i], model.force[i]});
    }
    Curve curve;
    curve.label = model.name;
    curve.colour = static_cast<int>(k);
    curve.pieces = {std::move(line)};
    panel.curves.push_back(std::move(curve));
  }
  if (!panel.curves.empty()) figure.panels = {std::move(panel)};
  return figure;
}

}  // namespace tomlin
