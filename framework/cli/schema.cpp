#include "framework/cli/schema.hpp"

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/cli/described.hpp"
#include "framework/cli/node_json.hpp"
#include "framework/core/formula/expression.hpp"
#include "framework/core/records/body.hpp"
#include "framework/core/records/force.hpp"
#include "framework/core/records/integrator.hpp"
#include "framework/scene/effective.hpp"
#include "framework/scene/language.hpp"
#include "framework/scene/natural_units.hpp"
#include "framework/scene/value_reader.hpp"

namespace tomlin {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMostDimensions = 3;
constexpr const char* kNamePattern = "^[A-Za-z_][A-Za-z0-9_-]*$";
constexpr const char* kParameterPattern = "^[A-Za-z_][A-Za-z0-9_]*$";

// ---- values. Keywords of a schema say nothing of values of another type than their own, so a
// number, a text and a list can be described side by side; that gives plainer errors than anyOf.

/// An object of one key.
Json only(const char* key, Json value) {
  Json result = Json::object();
  result[key] = std::move(value);
  return result;
}

Json requires_keys(const std::vector<std::string>& keys) { return only("required", keys); }

Json with_interval(Json schema, const Interval& interval) {
  if (std::isfinite(interval.low)) {
    schema[interval.low_open ? "exclusiveMinimum" : "minimum"] = interval.low;
  }
  if (std::isfinite(interval.high)) {
    schema[interval.high_open ? "exclusiveMaximum" : "maximum"] = interval.high;
  }
  return schema;
}

/// A number, or an expression.
Json number(const Interval& interval, const char* type = "number") {
  return with_interval({{"type", {type, "string"}}, {"minLength", 1}}, interval);
}

Json index() { return number(any_number, "integer"); }

Json list_of(Json items, int most = 0) {
  Json schema = {{"type", "array"}, {"minItems", 1}};
  if (most > 0) schema["maxItems"] = most;
  schema["items"] = std::move(items);
  return schema;
}

/// A number, or a list of numbers.
Json number_or_list(const Interval& interval, int most = 0) {
  Json schema = list_of(number(interval), most);
  schema["type"] = {"number", "string", "array"};
  schema["minLength"] = 1;
  return with_interval(std::move(schema), interval);
}

Json object(Json properties, const std::vector<std::string>& required = {}) {
  Json schema = {{"type", "object"}, {"properties", std::move(properties)}};
  if (!required.empty()) schema["required"] = required;
  schema["additionalProperties"] = false;
  return schema;
}

/// Shown by editors, which do not look into if and then; `true` in it admits everything.
Json suggestions(std::vector<Json> schemas) {
  schemas.insert(schemas.begin(), true);
  return schemas;
}

Json word_or(const std::vector<std::string>& words, Json otherwise) {
  return {{"anyOf", suggestions({only("enum", words)})},
          {"if", only("type", "string")},
          {"then", only("enum", words)},
          {"else", std::move(otherwise)}};
}

Json word_or_numbers(const Parameter& row) {
  Json schema = number_or_list(row.interval);
  schema["anyOf"] = suggestions({only("enum", expected_words(row))});
  return schema;
}

Json passing(const Parameter& row) {
  Json schema = object({{"when", {{"type", "string"}, {"minLength", 1}}},
                        {"above", number(row.interval)},
                        {"below", number(row.interval)},
                        {"times", number({.low = 1.0, .low_open = false}, "integer")}},
                       {"when"});
  schema["if"] = requires_keys({"above"});
  schema["else"] = requires_keys({"below"});
  schema["properties"]["times"]["description"] =
      "how often it counts: 1 by default; with above and below as long as the run lasts";
  return schema;
}

Json name_schema() { return {{"type", "string"}, {"pattern", kNamePattern}}; }

Json formula() { return only("type", std::vector{"string", "number"}); }

/// Returns the schema of the values that a row admits.
Json value_schema(const Parameter& row) {
  return std::visit(
      [&row](const auto& prototype) -> Json {
        using Kind = std::decay_t<decltype(prototype)>;
        const Interval& interval = row.interval;
        if constexpr (std::is_same_v<Kind, double>) {
          return row.per_particle ? number_or_list(interval) : number(interval);
        } else if constexpr (std::is_same_v<Kind, std::int64_t>) {
          return number(interval, "integer");
        } else if constexpr (std::is_same_v<Kind, bool>) {
          return only("type", "boolean");
        } else if constexpr (std::is_same_v<Kind, std::string>) {
          if (row.choices.empty()) return only("type", "string");
          return only("enum", row.choices);
        } else if constexpr (std::is_same_v<Kind, SpaceVector>) {
          if (row.per_particle) return list_of(number_or_list(interval, kMostDimensions));
          return list_of(number(interval), kMostDimensions);
        } else if constexpr (std::is_same_v<Kind, PerParticle>) {
          return number_or_list(interval);
        } else if constexpr (std::is_same_v<Kind, PerParticleVector> ||
                             std::is_same_v<Kind, PointList>) {
          return list_of(number_or_list(interval, kMostDimensions));
        } else if constexpr (std::is_same_v<Kind, NumberTable>) {
          return list_of(number_or_list(interval));
        } else if constexpr (std::is_same_v<Kind, PairSelection>) {
          Json pair = list_of(index(), 2);
          pair["minItems"] = 2;
          return word_or(expected_words(row), list_of(std::move(pair)));
        } else if constexpr (std::is_same_v<Kind, WordOrNumbers>) {
          return word_or_numbers(row);
        } else if constexpr (std::is_same_v<Kind, Attachment>) {
          return word_or(expected_words(row), object(only("particle", index()), {"particle"}));
        } else if constexpr (std::is_same_v<Kind, WordList>) {
          Json word = row.choices.empty() ? only("type", "string") : only("enum", row.choices);
          return {{"type", "array"}, {"uniqueItems", true}, {"items", std::move(word)}};
        } else if constexpr (std::is_same_v<Kind, FlagList>) {
          return list_of(only("type", "boolean"));
        } else if constexpr (std::is_same_v<Kind, Formula>) {
          return formula();
        } else if constexpr (std::is_same_v<Kind, FormulaList>) {
          return list_of(formula(), kMostDimensions);
        } else if constexpr (std::is_same_v<Kind, AngleSelection>) {
          Json angle = list_of(index(), 3);
          angle["minItems"] = 3;
          return word_or({"neighbours"}, list_of(std::move(angle)));
        } else if constexpr (std::is_same_v<Kind, NamePerParticle>) {
          Json names = list_of(name_schema());
          names["type"] = {"string", "array"};
          names["pattern"] = kNamePattern;
          return names;
        } else {
          static_assert(std::is_same_v<Kind, Passing>);
          return passing(row);
        }
      },
      row.prototype);
}

// ---- keys

/// The description first, where people look; suggestions are shown with their own.
Json described(const std::string& description, const Json& schema) {
  Json result = only("description", description);
  result.update(schema);
  if (!result.contains("anyOf")) return result;
  for (Json& shown : result["anyOf"]) {
    if (shown.is_object()) shown["description"] = description;
  }
  return result;
}

Json key_schema(const Parameter& row) {
  const std::string unit =
      row.dimension == dimension::none ? "" : " [" + to_string(row.dimension) + "]";
  Json schema = described(
      fmt::format("{}{}; {}; {}", row.doc, unit, admissible_values(row), default_text(row)),
      value_schema(row));
  const auto standard = row.standard ? to_node(*row.standard) : std::nullopt;
  if (standard && !has_natural_default(row)) schema["default"] = json_of(*standard);
  return schema;
}

/// A table: its rows, and the keys that the scene reader reads itself, `own`.
Json table_schema(const TableLayout& layout, const Json& own = Json::object()) {
  Json properties = Json::object();
  std::vector<std::string> required;
  for (const OwnKey& key : layout.own_keys) {
    properties[key.key] = described(key.doc, own.value(key.key, Json::object()));
  }
  for (const Parameter& row : layout.rows) {
    properties[row.key] = key_schema(row);
    if (row.required()) required.push_back(row.key);
  }
  return object(std::move(properties), required);
}

Json motion_schema() {
  return object({{"velocity", list_of(number(any_number), kMostDimensions)},
                 {"angular_velocity", number(any_number)}});
}

Json own_keys_of(const BodyRecord&) {
  return {{"name", name_schema()}, {"hold", value_schema(hold_row())}, {"motion", motion_schema()}};
}

Json own_keys_of(const ForceRecord& record) {
  Json bodies = list_of(only("type", "string"), record.most_bodies);
  bodies["minItems"] = record.fewest_bodies;
  bodies["uniqueItems"] = true;
  return {{"name", name_schema()},
          {"body", only("type", "string")},
          {"bodies", std::move(bodies)},
          {"driver", value_schema(driver_row())},
          {"active", table_schema(active_layout())}};
}

Json own_keys_of(const IntegratorRecord&) { return Json::object(); }

Json own_keys_of(const ObserverRecord&) { return {{"name", name_schema()}}; }

// ---- components

/// "#/definitions/force.harmonic_bonds"
std::string definition_of(const std::string& kind, const std::string& name) {
  return kind + "." + name;
}

Json reference_to(const std::string& definition) {
  return only("$ref", "#/definitions/" + definition);
}

/// A component of the kind, the one that `type` names: a chain of if, then and else, so that faults
/// are reported of the one that is meant.
Json any_component(const std::string& kind, const std::vector<const ComponentRecord*>& records) {
  Json names = Json::array();
  Json summaries = Json::array();
  std::vector<Json> shown;
  Json chain = Json::object();
  for (auto record = records.rbegin(); record != records.rend(); ++record) {
    const std::string& name = (*record)->name;
    Json link = {{"if", only("properties", only("type", only("const", name)))},
                 {"then", reference_to(definition_of(kind, name))}};
    if (!chain.empty()) link["else"] = std::move(chain);
    chain = std::move(link);
  }
  for (const ComponentRecord* record : records) {
    names.push_back(record->name);
    summaries.push_back(record->summary);
    shown.push_back(reference_to(definition_of(kind, record->name)));
  }
  Json type = {{"description", "which " + kind + " it is"},
               {"enum", std::move(names)},
               {"x-taplo", only("docs", only("enumValues", std::move(summaries)))}};
  Json schema = {{"type", "object"},
                 {"properties", only("type", std::move(type))},
                 {"required", std::vector{"type"}},
                 {"anyOf", suggestions(std::move(shown))}};
  schema.update(chain);
  return schema;
}

template <class Record>
void define_components(Json& definitions, const std::string& kind,
                       const std::vector<std::unique_ptr<Record>>& records,
                       TableLayout (*layout_of)(const Record&)) {
  std::vector<const ComponentRecord*> all;
  for (const auto& record : records) {
    Json own = own_keys_of(*record);
    own["type"] = Json::object();  // is checked before
    Json table = described(record->summary, table_schema(layout_of(*record), own));
    if constexpr (std::is_same_v<Record, ForceRecord>) {
      table["not"] = requires_keys({"body", "bodies"});
    }
    definitions[definition_of(kind, record->name)] = std::move(table);
    all.push_back(record.get());
  }
  definitions[kind] = any_component(kind, all);
}

// ---- the tables of a scene

Json parameters_schema() {
  Json reserved = std::vector{"pi"};
  for (const ExpressionFunction& function : expression_functions()) {
    if (!function.may_name_parameter) reserved.push_back(function.name);
  }
  for (const std::string_view variable : expression_variables()) reserved.push_back(variable);
  return {
      {"description",
       "numbers and expressions, by the names that expressions elsewhere use them by"},
      {"type", "object"},
      {"propertyNames", {{"pattern", kParameterPattern}, {"not", {{"enum", std::move(reserved)}}}}},
      {"additionalProperties", number(any_number)}};
}

Json perturb_schema() {
  Json bodies = list_of(only("type", "string"));
  bodies["uniqueItems"] = true;
  return table_schema(perturb_layout(), only("bodies", std::move(bodies)));
}

Json until_schema() {
  return only("anyOf",
              std::vector{table_schema(until_layout()), table_schema(until_error_layout())});
}

/// The length of a run comes from duration or until, its steps from an integrator or an accuracy.
Json run_schema() {
  Json schema = table_schema(run_layout(true), {{"integrator", reference_to("integrator")},
                                                {"perturb", perturb_schema()},
                                                {"until", until_schema()}});
  // A reference stands alone: what is beside it is not read.
  schema["properties"]["integrator"] = reference_to("integrator");
  Json quasistatic = requires_keys({"dynamics"});
  quasistatic["properties"] = only("dynamics", only("const", to_string(Dynamics::quasistatic)));
  const Json steps = {
      {"if", only("anyOf", std::vector{requires_keys({"accuracy"}), std::move(quasistatic)})},
      {"else", requires_keys({"integrator"})}};
  Json with_until = steps;
  with_until["anyOf"] = std::vector{requires_keys({"duration"}),
                                    only("properties", only("until", requires_keys({"max"})))};
  Json without_until = steps;
  without_until["required"] = std::vector{"duration"};
  schema["if"] = requires_keys({"until"});
  schema["then"] = std::move(with_until);
  schema["else"] = std::move(without_until);
  schema["dependencies"] = only("accuracy", only("not", requires_keys({"integrator"})));
  return schema;
}

/// "1e-4:1e-1:31:log", or a list of anything that a scene takes; names with dots may be tables in
/// one another.
Json sweep_values_schema() {
  Json schema = list_of(Json::object());
  schema["type"] = {"string", "array", "object"};
  schema["minLength"] = 1;
  schema["additionalProperties"] =
      only("$ref", "#/properties/sweep/properties/over/additionalProperties");
  return schema;
}

Json sweep_schema() {
  Json schema = table_schema(
      sweep_layout(),
      {{"over", {{"type", "object"}, {"additionalProperties", sweep_values_schema()}}},
       {"zip", list_of({{"type", {"string", "array"}}, {"items", only("type", "string")}})},
       {"continue_from_neighbour", only("type", "boolean")},
       {"repeats", {{"type", "integer"}, {"minimum", 2}}},
       {"refine", {{"type", "string"}, {"minLength", 1}}},
       {"refine_along", only("type", "string")},
       {"refine_to", {{"type", {"number", "string"}}}},
       {"observables", list_of(only("type", "string"))},
       {"files", {{"type", "object"}, {"additionalProperties", only("type", "string")}}}});
  schema["dependencies"] = {{"refine_along", {"refine"}}, {"refine_to", {"refine"}}};
  return schema;
}

Json components_schema(const std::string& kind, int fewest, const char* what) {
  return {{"description", what},
          {"type", "array"},
          {"minItems", fewest},
          {"items", reference_to(kind)}};
}

/// Returns the schema of the section under a top-level key.
Json section_schema(const std::string& key) {
  if (key == "scene") {
    return table_schema(scene_layout(), only("axes", table_schema(axes_layout())));
  }
  if (key == "parameters") return parameters_schema();
  if (key == "box") return table_schema(box_layout());
  if (key == "body") return components_schema(key, 1, "where particles start");
  if (key == "force") return components_schema(key, 0, "what acts on bodies");
  if (key == "observer") return components_schema(key, 0, "what is observed besides");
  if (key == "run") return run_schema();
  if (key == "measure") return table_schema(measure_layout());
  if (key == "output") return table_schema(output_layout());
  if (key == "sweep") return sweep_schema();
  if (key == "plugins") {
    return {{"type", "array"}, {"items", {{"type", "string"}, {"minLength", 1}}}};
  }
  return Json::object();
}

}  // namespace

std::string scene_schema(const Registry& registry) {
  Json sections = Json::object();
  for (const std::string& key : top_level_keys()) sections[key] = section_schema(key);
  for (const SceneTable& table : scene_tables()) {
    if (!sections.contains(table.name)) continue;  // it stands within another
    sections[table.name] = described(table.summary, sections[table.name]);
  }
  Json definitions = Json::object();
  define_components(definitions, "body", registry.bodies(), body_layout);
  define_components(definitions, "force", registry.forces(), force_layout);
  define_components(definitions, "integrator", registry.integrators(), integrator_layout);
  if (registry.observers().empty()) {
    sections["observer"] = {{"type", "array"}, {"maxItems", 0}};  // they come with plugins only
  } else {
    define_components(definitions, "observer", registry.observers(), observer_layout);
  }

  Json schema = {{"$schema", "http://json-schema.org/draft-07/schema#"},
                 {"title", "a scene of tomlin " TOMLIN_VERSION},
                 {"description",
                  "Where a number is expected, a text is an expression over [parameters]. "
                  "tomlin check SCENE sees what a schema cannot."},
                 {"$comment",
                  "An anyOf that begins with true admits everything: it is for completion, which "
                  "does not look into if and then."}};
  schema.update(object(std::move(sections), {"body", "run"}));
  schema["definitions"] = std::move(definitions);
  return schema.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace tomlin
