#include "framework/cli/describe_json.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <variant>

#include <nlohmann/json.hpp>

#include "framework/cli/node_json.hpp"
#include "framework/core/records/body.hpp"
#include "framework/core/records/observer.hpp"
#include "framework/core/text/citation.hpp"
#include "framework/run/results/results.hpp"
#include "framework/scene/effective.hpp"
#include "framework/scene/natural_units.hpp"
#include "framework/scene/value_reader.hpp"

namespace tomlin {
namespace {

using Json = nlohmann::ordered_json;

/// Returns the name of the kind of value that a row takes.
const char* kind_name(const Parameter& row) {
  static constexpr std::array kNames = {"number",
                                        "integer",
                                        "boolean",
                                        "word",
                                        "vector",
                                        "number_per_particle",
                                        "vector_per_particle",
                                        "pairs",
                                        "word_or_numbers",
                                        "attachment",
                                        "points",
                                        "number_table",
                                        "words",
                                        "flags",
                                        "passing",
                                        "formula",
                                        "formulas",
                                        "angles",
                                        "name_per_particle"};
  static_assert(kNames.size() == std::variant_size_v<ParameterValue>, "each kind has its name");
  return kNames[row.prototype.index()];
}

Json parameter_json(const Parameter& row) {
  Json entry;
  entry["key"] = row.key;
  entry["kind"] = kind_name(row);
  entry["dimension"] = to_string(row.dimension);
  entry["required"] = row.required();
  const auto standard = row.standard ? to_node(*row.standard) : std::nullopt;
  entry["default"] = standard ? json_of(*standard) : Json();
  if (has_natural_default(row)) entry["default_unit"] = natural_unit_text(row).substr(4);
  entry["admissible"] = admissible_values(row);
  entry["choices"] = row.choices;
  entry["doc"] = row.doc;
  return entry;
}

template <class Declarations>
void append_declared(Json& traits, const Declarations& given) {
  for (const auto& [name, holds] : given) {
    std::string key = name;
    std::replace(key.begin(), key.end(), ' ', '_');
    traits[key] = holds;
  }
}

Json citations_json(const std::string& source) {
  Json list = Json::array();
  for (const auto& [work, passage] : citations(source)) {
    list.push_back(Json{{"work", work}, {"place", passage}});
  }
  return list;
}

Json summaries_json(const std::vector<const Described*>& components) {
  Json list = Json::array();
  for (const Described* one : components) {
    list.push_back(Json{{"name", one->record->name}, {"summary", one->record->summary}});
  }
  return list;
}

Json own_keys_json(const std::vector<OwnKey>& keys) {
  Json list = Json::array();
  for (const OwnKey& own : keys) list.push_back(Json{{"key", own.key}, {"doc", own.doc}});
  return list;
}

Json traits_json(const Described& component) {
  Json traits = Json::object();
  if (component.force != nullptr) {
    append_declared(traits, declared(component.force->traits));
  }
  if (component.integrator != nullptr) {
    traits["order"] = component.integrator->order;
    traits["evaluations_per_step"] = component.integrator->evaluations_per_step;
    append_declared(traits, abilities(*component.integrator));
  }
  return traits;
}

void append_layout(Json& entry, const TableLayout& layout) {
  entry["parameters"] = Json::array();
  for (const Parameter& row : layout.rows) {
    entry["parameters"].push_back(parameter_json(row));
  }
  entry["other_keys"] = own_keys_json(layout.own_keys);
}

}  // namespace

Json table_json(const SceneTable& table) {
  Json entry = {{"name", table.name}, {"kind", "table"}, {"summary", table.summary}};
  append_layout(entry, table.layout);
  return entry;
}

Json component_json(const Described& component) {
  const ComponentRecord& record = *component.record;
  Json entry;
  entry["name"] = record.name;
  entry["kind"] = component.kind;
  entry["summary"] = record.summary;
  entry["equation"] = record.equation;
  entry["source"] = record.source;
  entry["works"] = citations_json(record.source);
  if (component.force != nullptr) entry["acts_on"] = acts_on(*component.force);
  entry["library"] = record.library.empty() ? Json() : Json(record.library);
  entry["traits"] = traits_json(component);
  if (component.kind != "body") entry["number_types"] = number_types(component);
  append_layout(entry, component.layout);
  entry["example"] = record.example;
  return entry;
}

Json list_json(const std::vector<Described>& all, const std::vector<SceneTable>& tables) {
  Json list;
  for (const auto& [kind, kinds] : kKinds) list[kinds] = summaries_json(those_of(kind, all));
  list["tables"] = Json::array();
  for (const SceneTable& table : tables) {
    list["tables"].push_back(Json{{"name", table.name}, {"summary", table.summary}});
  }
  return list;
}

Json kind_json(const KindNames& kind, const std::vector<Described>& all) {
  const auto found = those_of(kind.first, all);
  return {{"name", kind.first},
          {"kind", "kind"},
          {kind.second, summaries_json(found)},
          {"other_keys",
           found.empty() ? Json::array() : own_keys_json(found.front()->layout.own_keys)}};
}

Json results_json() {
  Json list = Json::array();
  for (const ResultFamily& family : result_families()) {
    Json entry = {{"family", family.family},
                  {"of", family.of},
                  {"when", family.when},
                  {"quantities", Json::array()}};
    for (const ResultQuantity& quantity : family.quantities) {
      entry["quantities"].push_back(Json{{"key", quantity.key},
                                         {"unit", unit_of(quantity)},
                                         {"shape", to_string(quantity.shape)},
                                         {"scope", to_string(quantity.scope)},
                                         {"doc", quantity.meaning}});
    }
    list.push_back(std::move(entry));
  }
  return Json{{"name", "results"}, {"kind", "results"}, {"families", std::move(list)}};
}

}  // namespace tomlin
