#include "framework/cli/compare_text.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/cli/diagnostics.hpp"
#include "framework/cli/output_table.hpp"

namespace tomlin {
namespace {

using Json = nlohmann::ordered_json;

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

/// The models, but for what the text says in words.
OutputTable table_of(const std::vector<ComparedModel>& models) {
  OutputTable table;
  const auto add = [&](const ColumnHeading& heading, auto value) {
    table.add(heading, models, value);
  };
  using Model = const ComparedModel&;
  add({.key = "name", .csv = "model", .quoted = true, .text = "model"},
      [](Model model) { return model.name; });
  add({.key = "file", .csv = "file", .quoted = true}, [](Model model) { return model.file; });
  add({.key = "verdict", .csv = "verdict"}, [](Model model) { return to_string(model.verdict); });
  add({.key = "status"}, [](Model model) { return to_string(model.result.status); });
  add({.key = "particles", .csv = "particles"}, [](Model model) { return model.particles; });
  add({.key = "coordinates", .csv = "free coordinates", .text = "coordinates", .width = 11},
      [](Model model) { return model.coordinates; });
  add({.key = "value", .csv = "value", .text = "value", .width = 17, .format = "{:.9g}"},
      [](Model model) { return number(model.value); });
  add({.key = "error", .csv = "error", .text = "error", .width = 8, .format = "{:.1e}"},
      [](Model model) { return number(model.error); });
  add({.key = "difference",
       .csv = "difference",
       .text = "difference",
       .width = 11,
       .format = "{:.2e}"},
      [](Model model) { return number(model.difference); });
  add({.text = "evaluations", .width = 12}, [](Model model) { return model.cost(); });
  add({.key = "force_evaluations", .csv = "force evaluations"},
      [](Model model) { return model.result.force_evaluations; });
  add({.key = "jacobian_columns", .csv = "jacobian columns"},
      [](Model model) { return model.result.jacobian_columns; });
  add({.key = "seconds", .csv = "wall time [s]"},
      [](Model model) { return model.result.wall_seconds; });
  add({.key = "warnings"}, [](Model model) { return texts_of(model.result.warnings); });
  add({.key = "warning_codes"}, [](Model model) { return codes_of(model.result.warnings); });
  add({.key = "failure"}, [](Model model) -> OutputTable::Cell {
    if (!model.result.failure) return std::nullopt;
    return to_string(*model.result.failure);
  });
  return table;
}

}  // namespace

std::string compare_text(const Comparison& comparison, const std::string& where) {
  const OutputTable table = table_of(comparison.models);
  std::string text = comparison.observable + "\n\n" + table.text_names() + "  \n";
  for (std::size_t k = 0; k < comparison.models.size(); ++k) {
    const ComparedModel& model = comparison.models[k];
    text += table.text(k) + "  " + to_string(model.verdict) + "\n";
    if (model.result.failure) text += "    " + to_string(*model.result.failure) + "\n";
    for (const Warning& warning : model.result.warnings) {
      text += "    warning: " + to_string(warning) + "\n";
    }
  }
  for (const std::string& note : comparison.notes) text += "  note: " + note + "\n";
  return text + "\n" + answer(comparison) + "results: " + where + "\n";
}

std::string compare_csv(const Comparison& comparison) { return table_of(comparison.models).csv(); }

std::string compare_json(const Comparison& comparison) {
  Json json;
  json["observable"] = comparison.observable;
  json["tolerance"] = comparison.tolerance;
  json["status"] = to_string(comparison.interrupted ? RunStatus::interrupted : RunStatus::finished);
  const auto file_of = [&](const std::optional<std::size_t>& k) {
    return k ? Json(comparison.models[*k].file) : Json();
  };
  json["reference"] = file_of(comparison.reference);
  json["simplest"] = file_of(comparison.simplest);
  json["notes"] = comparison.notes;
  json["models"] = Json::array();
  const OutputTable table = table_of(comparison.models);
  for (std::size_t k = 0; k < comparison.models.size(); ++k)
    json["models"].push_back(table.json(k));
  return json_text(json);
}

std::string compare_curves_csv(const Comparison& comparison) {
  struct Sample {
    std::size_t model, row;
  };
  std::vector<Sample> samples;
  for (std::size_t k = 0; k < comparison.models.size(); ++k) {
    for (std::size_t row = 0; row < comparison.models[k].way.size(); ++row) {
      samples.push_back({k, row});
    }
  }
  const auto heading = [&](const char* name, const Dimension& dimension) {
    return fmt::format("{} [{}]", name, unit_in_tables(comparison.units, dimension));
  };
  const std::string displacement = heading("displacement", dimension::length);
  const std::string force = heading("force", dimension::force);
  const auto model = [&](Sample at) -> const ComparedModel& { return comparison.models[at.model]; };
  OutputTable table;
  table.add({.csv = "model"}, samples, [](Sample at) { return at.model; });
  table.add({.csv = "name", .quoted = true}, samples, [&](Sample at) { return model(at).name; });
  table.add({.csv = displacement.c_str()}, samples,
            [&](Sample at) { return model(at).way[at.row]; });
  table.add({.csv = force.c_str()}, samples, [&](Sample at) { return model(at).force[at.row]; });
  return table.csv();
}

}  // namespace tomlin
