#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/records/registry.hpp"
#include "framework/scene/checks.hpp"
#include "framework/scene/document.hpp"
#include "framework/scene/fault_list.hpp"
#include "framework/scene/language.hpp"
#include "framework/scene/parameter_table.hpp"
#include "framework/scene/scene.hpp"
#include "framework/scene/table_reader.hpp"
#include "framework/scene/value_reader.hpp"

namespace tomlin {

inline constexpr Extent kTopOfFile{{1, 1}, {1, 1}, 0};

/// A table of the document with where it stands.
struct SceneSection {
  const Table* table = nullptr;
  Extent where;
};

/// A scene while its document is read: what every part of the reading sees, and what the parts have
/// found so far.
struct SceneDraft {
  SceneDraft(const Table& from, const Source& written, const Registry& components, FaultList& found)
      : document(from),
        source(written),
        registry(components),
        faults(found),
        values(parameters, found),
        scene(std::make_shared<Scene>()) {}
  SceneDraft(const SceneDraft&) = delete;
  SceneDraft& operator=(const SceneDraft&) = delete;

  /// `[key]`; nothing when it is absent, or no table and reported.
  std::optional<SceneSection> section(const std::string& key);
  /// Every `[[key]]`.
  std::vector<SceneSection> sections(const std::string& key);
  /// A table inside of another, `key = { ... }`; nothing when it is no table, and reported.
  std::optional<SceneSection> inside(const Node& node, const std::string& path,
                                     const std::string& expected);
  /// Assigns the rows of a table to the description and reports what is unfit.
  TableReading read(const SceneSection& given, const TableLayout& layout, std::string path,
                    void* description);

  const Table& document;
  const Source& source;
  const Registry& registry;
  FaultList& faults;
  ParameterTable parameters;
  ValueReader values;
  std::shared_ptr<Scene> scene;
  std::optional<TableReading> box;
  std::vector<BodyDraft> bodies;
  std::optional<int> dimension;  ///< of space; nothing when faults of the bodies hide it
  std::map<std::string, std::size_t> body_indices;  ///< by the names that mean them
  std::vector<ForceDraft> forces;
  std::vector<ObserverDraft> observers;
  Table effective;
  bool duration_is_known = false;
};

// Each of these reads one part of the document into the draft and reports the part's own faults.

/// `plugins`, which the registry has loaded by now.
void read_libraries(SceneDraft& draft);
void read_parameters(SceneDraft& draft);
/// `[scene]`.
void read_heading(SceneDraft& draft);
void read_box(SceneDraft& draft);
/// `[[body]]`, `[[force]]` and `[[observer]]`, and whether their names differ.
void read_components(SceneDraft& draft);
/// `[run]`, after the components: what it leaves out may follow from them.
void read_run(SceneDraft& draft);
/// `integrator` of `[run]`: its effective table; nothing when it is absent or unfit.
std::optional<Node> read_integrator(SceneDraft& draft, const SceneSection& run);
void read_measure(SceneDraft& draft);
void read_output(SceneDraft& draft);

/// Index of `type` among these names; nothing when it is none of them, which is reported.
std::optional<std::size_t> read_type(SceneDraft& draft, const std::string& kind,
                                     const SceneSection& given, const std::string& path,
                                     const std::vector<std::string>& names);
/// A list of different bodies by their names; empty when one is unfit, and reported.
std::vector<std::size_t> bodies_in(SceneDraft& draft, const Node& node, const std::string& key);

/// The bodies, forces and observers of the drafts become those of the scene.
void describe_components(SceneDraft& draft);
/// Writes the effective scene, which must not have become too large to be read again.
void write_effective_scene(SceneDraft& draft);

/// The record that `type` names; nullptr when there is none, and reported.
template <class Record>
const Record* read_record(SceneDraft& draft, const std::string& kind, const SceneSection& given,
                          const std::string& path,
                          const std::vector<std::unique_ptr<Record>>& records) {
  std::vector<std::string> names;
  names.reserve(records.size());
  for (const auto& record : records) names.push_back(record->name);
  const auto index = read_type(draft, kind, given, path, names);
  return index ? records[*index].get() : nullptr;
}

/// The names that drafts have.
template <class Draft>
std::vector<std::string> names_of(const std::vector<Draft>& drafts) {
  std::vector<std::string> names;
  for (const Draft& draft : drafts) {
    if (!draft.name.empty()) names.push_back(draft.name);
  }
  return names;
}

inline Node text_node(const std::string& text) { return {text, {}}; }

/// The names of the bodies with these indices.
Node names_of_bodies(const SceneDraft& draft, const std::vector<std::size_t>& indices);

inline void append(Table& table, const Table& more) {
  table.entries.insert(table.entries.end(), more.entries.begin(), more.entries.end());
}

}  // namespace tomlin
