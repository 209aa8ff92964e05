#include "framework/cli/summary_schema.hpp"

#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "framework/core/text/fault_code.hpp"
#include "framework/run/results/results.hpp"
#include "framework/study/sweep/bisection.hpp"
#include "framework/study/sweep/row.hpp"

namespace tomlin {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMostAxes = 3;

Json number_or_null() { return {{"type", {"number", "null"}}}; }

Json value_schema(const ResultQuantity& quantity) {
  Json schema;
  switch (quantity.shape) {
    case Shape::number:
      schema = number_or_null();
      break;
    case Shape::count:
      schema = {{"type", {"integer", "null"}}, {"minimum", 0}};
      break;
    case Shape::vector:
      schema = {{"type", {"array", "null"}},
                {"items", number_or_null()},
                {"minItems", 1},
                {"maxItems", kMostAxes}};
      break;
  }
  schema["description"] = fmt::format("{} [{}]", quantity.meaning, unit_of(quantity));
  return schema;
}

Json object() { return {{"type", "object"}}; }

Json map_of(Json schema) {
  return {{"type", "object"}, {"additionalProperties", std::move(schema)}};
}

/// Families that were not asked for are left out, except for those about the run itself.
bool is_always_there(const ResultFamily& family) {
  return family.family == "time" || family.family == "window" || family.family == "performance";
}

Json family_schema(const ResultFamily& family) {
  Json schema = {{"type", "object"}, {"properties", Json::object()}, {"required", Json::array()}};
  for (const ResultQuantity& quantity : family.quantities) {
    schema["properties"][quantity.key] = value_schema(quantity);
    if (is_always_there(family)) schema["required"].push_back(quantity.key);
  }
  // Machine and file of a run stand beside its performance.
  if (family.family != "performance") schema["additionalProperties"] = false;
  if (family.of.empty()) return schema;
  if (family.family == "forces")
    schema = map_of({{"type", "object"}, {"properties", {{"on", map_of(std::move(schema))}}}});
  return {{"type", "object"}, {"additionalProperties", std::move(schema)}};
}

std::vector<std::string_view> warning_ids() {
  std::vector<std::string_view> ids;
  for (const FaultKind& kind : fault_kinds()) {
    if (kind.severity == Severity::warning) ids.push_back(kind.id);
  }
  return ids;
}

}  // namespace

std::string summary_schema() {
  Json schema = {
      {"$schema", "http://json-schema.org/draft-07/schema#"},
      {"title", "summary.json of tomlin"},
      {"type", "object"},
      {"properties", Json::object()},
      {"required",
       {"status", "program", "scene", "integrator", "parameters", "time", "window", "drivers",
        "bodies", "warnings", "warning_codes", "left_out", "references", "performance"}},
      {"additionalProperties", false}};
  Json& properties = schema["properties"];
  properties["status"] = {{"enum", words_of<RunStatus>()}};
  for (const char* key : {"failure", "program", "scene", "until", "accuracy"}) {
    properties[key] = object();
  }
  properties["integrator"] = {{"type", {"object", "null"}}};
  properties["parameters"] = map_of(number_or_null());
  for (const ResultFamily& family : result_families()) {
    properties[std::string(family.family)] = family_schema(family);
  }
  properties["observers"] = map_of(map_of(number_or_null()));
  properties["determined"] = map_of(object());
  properties["error"] = map_of(number_or_null());
  properties["warnings"] = {{"type", "array"}, {"items", {{"type", "string"}}}};
  properties["warning_codes"] = {
      {"type", "array"},
      {"items", {{"enum", warning_ids()}}},
      {"description", "of each of the warnings, in their order; `tomlin describe CODE`"}};
  for (const char* key : {"left_out", "references", "plugins"}) {
    properties[key] = {{"type", "array"}, {"items", object()}};
  }
  return schema.dump(2) + "\n";
}

std::string sweep_summary_schema() {
  const Json text = {{"type", "string"}};
  const Json count = {{"type", "integer"}, {"minimum", 0}};
  const auto all_of = [](Json properties) {
    Json required = Json::array();
    for (const auto& [key, value] : properties.items()) required.push_back(key);
    return Json{{"type", "object"},
                {"properties", std::move(properties)},
                {"required", std::move(required)},
                {"additionalProperties", false}};
  };
  const auto list_of_these = [](Json items) {
    return Json{{"type", "array"}, {"items", std::move(items)}};
  };
  Json axis = all_of({{"name", text},
                      {"count", count},
                      {"dimension", count},
                      {"spacing", {{"enum", {"list", "linear", "logarithmic"}}}}});
  axis["properties"]["values"] = list_of_these({{"type", {"number", "string"}}});
  axis["properties"]["from"] = {{"type", "number"}};
  axis["properties"]["to"] = {{"type", "number"}};
  axis["oneOf"] = {{{"required", {"values"}}}, {{"required", {"from", "to"}}}};
  Json counts = object();
  for (const std::string& status : words_of<SweepStatus>()) counts["properties"][status] = count;
  counts["additionalProperties"] = false;
  counts["description"] = "of points by their status; empty where the sweep was interrupted";
  Json schema = {{"$schema", "http://json-schema.org/draft-07/schema#"},
                 {"title", "sweep.json of tomlin"}};
  schema.update(all_of(
      {{"status", {{"enum", {"finished", "interrupted"}}}},
       {"program", object()},
       {"scene", object()},
       {"sweep", {{"type", "string"}, {"description", "the same for the same sweep"}}},
       {"axes", list_of_these(std::move(axis))},
       {"observables", list_of_these(all_of(
                           {{"path", text}, {"column", text}, {"unit", text}, {"meaning", text}}))},
       {"continue_from_neighbour", {{"type", "boolean"}}},
       {"points", count},
       {"counts", std::move(counts)},
       {"warnings", list_of_these(all_of({{"code", {{"enum", warning_ids()}}},
                                          {"meaning", text},
                                          {"points", count},
                                          {"first", count}}))},
       {"performance", object()}}));
  schema["properties"]["shard"] = all_of({{"number", count}, {"of", count}, {"points", count}});
  schema["properties"]["shard"]["description"] =
      "of --shard: which part of the points this is, and how many; counts and warnings are its own";
  const Json two_numbers = {
      {"type", "array"}, {"items", {{"type", "number"}}}, {"minItems", 2}, {"maxItems", 2}};
  Json interval = all_of({{"status", {{"enum", words_of<BisectionStatus>()}}},
                          {"axes", map_of({{"type", {"number", "string"}}})}});
  interval["properties"]["interval"] = two_numbers;
  interval["properties"]["values"] = two_numbers;
  interval["dependencies"] = {{"interval", {"values"}}, {"values", {"interval"}}};
  schema["properties"]["refine"] = all_of({{"observable", text},
                                           {"level", number_or_null()},
                                           {"along", text},
                                           {"to", {{"type", "number"}}},
                                           {"intervals", list_of_these(std::move(interval))}});
  schema["properties"]["refine"]["description"] =
      "of --refine: intervals of the axis `along`, the observable at their two ends, and the "
      "values "
      "of the other axes";
  return schema.dump(2) + "\n";
}

}  // namespace tomlin
