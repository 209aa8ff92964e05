#include "framework/scene/scene_draft.hpp"

#include <utility>

#include <fmt/format.h>

#include "framework/scene/size_checks.hpp"

namespace tomlin {

std::optional<SceneSection> SceneDraft::section(const std::string& key) {
  const Node* node = document.find(key);
  if (node == nullptr) return std::nullopt;
  if (const auto* table = node->as<Table>()) return SceneSection{table, node->where};
  faults.of_key(node->where, {FaultCode::scene_wrong_type, key, "found " + kind_of(*node),
                              "a table, [" + key + "]"});
  return std::nullopt;
}

std::vector<SceneSection> SceneDraft::sections(const std::string& key) {
  const Node* node = document.find(key);
  if (node == nullptr) return {};
  const std::string expected = "a list of tables, [[" + key + "]]";
  const auto* list = node->as<List>();
  if (list == nullptr) {
    faults.of_key(node->where,
                  {FaultCode::scene_wrong_type, key, "found " + kind_of(*node), expected});
    return {};
  }
  if (list->size() > kMostComponents) {
    faults.of_key(node->where, {FaultCode::scene_too_large, key,
                                fmt::format("{} tables are too many", list->size()),
                                fmt::format("at most {}", kMostComponents)});
    return {};
  }
  std::vector<SceneSection> result;
  for (const Node& element : *list) {
    if (const auto table = inside(element, key, expected)) result.push_back(*table);
  }
  return result;
}

std::optional<SceneSection> SceneDraft::inside(const Node& node, const std::string& path,
                                               const std::string& expected) {
  if (const auto* table = node.as<Table>()) return SceneSection{table, node.where};
  faults.of_wrong_type(node, path, expected);
  return std::nullopt;
}

TableReading SceneDraft::read(const SceneSection& given, const TableLayout& layout,
                              std::string path, void* description) {
  return read_table(*given.table, given.where, layout, std::move(path), description, values, source,
                    faults);
}

Node names_of_bodies(const SceneDraft& draft, const std::vector<std::size_t>& indices) {
  List names;
  for (const std::size_t index : indices) names.push_back(text_node(draft.bodies[index].name));
  return {std::move(names), {}};
}

}  // namespace tomlin
