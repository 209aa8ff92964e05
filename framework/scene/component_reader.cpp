// Bodies, forces and observers: their types and names, and which bodies each acts on.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "framework/core/text/nearest_name.hpp"
#include "framework/scene/motion_reader.hpp"
#include "framework/scene/scene_draft.hpp"
#include "framework/scene/size_checks.hpp"
#include "framework/scene/text.hpp"

namespace tomlin {
namespace {

const std::string* text_at(const SceneSection& given, const char* key) {
  const Node* node = given.table->find(key);
  return node ? node->as<std::string>() : nullptr;
}

/// The name given, or the type's; empty when unfit, and reported.
std::string read_name(SceneDraft& draft, const SceneSection& given,
                      const std::map<std::string, std::size_t>& types, const std::string& path) {
  const std::string key = path + ".name";
  const Node* node = given.table->find("name");
  if (node == nullptr) {
    const auto* type = text_at(given, "type");
    if (type == nullptr) return "";  // the missing type is reported
    const std::size_t same_type = types.at(*type);
    if (same_type == 1) return *type;
    draft.faults.of_key(given.where,
                        {FaultCode::scene_missing_key, key,
                         fmt::format("missing: {} share the type {}", same_type,
                                     quoted_text(shortened(*type, kLongestShownValue)))});
    return "";
  }
  const auto* name = node->as<std::string>();
  if (name == nullptr) {
    draft.faults.of_wrong_type(*node, key, "text");
  } else if (!is_component_name(*name)) {
    draft.faults.of_value(*node, {FaultCode::scene_invalid_name, key, "not a name",
                                  "letters, digits, _ and -, the first a letter or _"});
  } else if (is_word_of_summary(*name)) {
    draft.faults.of_value(*node, {FaultCode::scene_invalid_name, key,
                                  "a reserved word of summary.json; choose another name"});
  } else {
    return *name;
  }
  return "";
}

/// The particles of the one body that a force names, or of the only one.
ValueReader::CountInExpressions count_for(const SceneDraft& draft, const SceneSection& given) {
  const Node* node = given.table->find("body");
  if (const Node* several = given.table->find("bodies")) {
    const auto* list = several->as<List>();
    if (list != nullptr && list->size() > 1) return {};
    if (list != nullptr && !list->empty()) node = &list->front();
  }
  const auto* name = node ? node->as<std::string>() : nullptr;
  const auto found = name ? draft.body_indices.find(*name) : draft.body_indices.end();
  std::optional<std::int64_t> count;
  if (found != draft.body_indices.end()) count = draft.bodies[found->second].count;
  if (node == nullptr && draft.bodies.size() == 1) count = draft.bodies.front().count;
  return {count, !count};
}

/// Keys with values that may differ between particles.
std::vector<std::string> keys_of_particles(const std::vector<Parameter>& rows) {
  std::vector<std::string> keys;
  for (const Parameter& row : rows) {
    if (row.per_particle) keys.push_back(row.key);
  }
  return keys;
}

/// Every component of a kind: name, type and rows, and then what `read_rest` reads of each.
template <class Component, class Record, class Rest>
void read_all(SceneDraft& draft, const std::string& kind, std::vector<Component>& components,
              const std::vector<std::unique_ptr<Record>>& records,
              TableLayout (*layout_of)(const Record&), const Rest& read_rest) {
  const auto sections = draft.sections(kind);
  std::map<std::string, std::size_t> types;  // how many components have each
  for (const SceneSection& given : sections) {
    if (const auto* type = text_at(given, "type")) ++types[*type];
  }
  for (const SceneSection& given : sections) {
    const auto* written = text_at(given, "name");
    const auto* type = text_at(given, "type");
    const std::string label = written ? *written : type ? *type : "";
    const std::string path = label.empty()
                                 ? fmt::format("{}[{}]", kind, components.size())
                                 : kind + "." + key_text(shortened(label, kLongestShownValue));
    Component component;
    component.reading.path = path;
    component.reading.where = given.where;
    component.reading.given = given.table;
    component.record = read_record(draft, kind, given, path, records);
    component.name = read_name(draft, given, types, path);
    if (component.record != nullptr) {
      component.description = component.record->make_description();
      draft.values.begin_component(
          kind == "force" ? count_for(draft, given) : ValueReader::CountInExpressions(),
          keys_of_particles(component.record->parameters));
      component.reading =
          draft.read(given, layout_of(*component.record), path, component.description.get());
      component.valid = component.reading.valid;
    }
    read_rest(component, given);
    components.push_back(std::move(component));
  }
  draft.values.begin_component({}, {});
}

/// `hold` and `motion`.
void read_freedom(SceneDraft& draft, BodyDraft& body, const SceneSection& given) {
  if (const Node* node = given.table->find("hold")) {
    const auto held = draft.values.read(hold_row(), *node, body.reading.path + ".hold");
    if (held) body.hold = std::get<WordList>(*held).words;
    body.valid = body.valid && held;
  }
  if (const Node* node = given.table->find("motion")) {
    body.motion = read_motion(*node, body.reading.path + ".motion", draft.parameters, draft.faults);
    body.valid = body.valid && body.motion;
  }
}

/// `driver`.
void read_driver(SceneDraft& draft, ForceDraft& force, const SceneSection& given) {
  const Node* node = given.table->find("driver");
  if (node == nullptr) return;
  const auto declared = draft.values.read(driver_row(), *node, force.reading.path + ".driver");
  if (declared) force.driver = std::get<bool>(*declared);
  force.valid = force.valid && declared;
  if (declared && !force.driver && force.record != nullptr && force.record->traits.does_work) {
    draft.faults.of_value(*node, {FaultCode::scene_conflict, force.reading.path + ".driver",
                                  "a " + force.record->name + " is always a driver", "true"});
    force.valid = false;
  }
}

/// `active`.
void read_active(SceneDraft& draft, ForceDraft& force, const SceneSection& given) {
  const Node* node = given.table->find("active");
  if (node == nullptr) return;
  const std::string path = force.reading.path + ".active";
  const auto table = draft.inside(*node, path, "{ from = TIME, until = TIME }");
  if (!table) {
    force.valid = false;
    return;
  }
  ActiveSettings& active = force.active.emplace();
  TableReading reading = draft.read(*table, active_layout(), path, &active);
  force.valid = force.valid && reading.valid;
  if (reading.valid && active.until && !(*active.until > active.from)) {
    reading.complain(draft.faults, "until",
                     {FaultCode::scene_out_of_range, path + ".until", "it is not after from",
                      "a time after from, or none"});
    force.valid = false;
  }
  force.active_effective = std::move(reading.effective);
}

/// A body whose own name is unfit is still the one that is meant by it; the first of several is.
void note_name(SceneDraft& draft, const BodyDraft& body, const SceneSection& given) {
  const auto* written = text_at(given, "name");
  const std::string& name = written ? *written : body.name;
  if (!name.empty() || written) draft.body_indices.try_emplace(name, draft.bodies.size());
}

/// The body of that name; nothing when there is none, and reported.
std::optional<std::size_t> body_named(SceneDraft& draft, const Node& node, const std::string& key) {
  const auto* name = node.as<std::string>();
  if (name == nullptr) {
    draft.faults.of_wrong_type(node, key, "the name of a body");
    return std::nullopt;
  }
  const auto found = draft.body_indices.find(*name);
  if (found != draft.body_indices.end()) return found->second;
  const auto names = names_of(draft.bodies);
  draft.faults.of_value(node, {FaultCode::scene_unknown_name, key, "there is no such body",
                               listed(names), nearest_name(*name, names).value_or("")});
  return std::nullopt;
}

/// `body = NAME`, which may be left out where there is one body only, or `bodies = [..]`. How many
/// it may be is the record's to say, as what the component does to them is the `verb`'s.
template <class Component>
void read_bodies_of(SceneDraft& draft, Component& component, const SceneSection& given,
                    const char* verb) {
  if (draft.bodies.empty()) return;
  const std::string& path = component.reading.path;
  const Node* one = given.table->find("body");
  const Node* several = given.table->find("bodies");
  if (one && several) {
    draft.faults.of_key(
        given.table->find_entry("bodies")->where,
        {FaultCode::scene_conflict, path + ".bodies", "body is given too", "one of the two"});
    return;
  }
  const std::string key = path + (several ? ".bodies" : ".body");
  if (several) {
    component.bodies = bodies_in(draft, *several, key);
  } else if (one) {
    if (const auto index = body_named(draft, *one, key)) component.bodies = {*index};
  } else if (draft.bodies.size() == 1) {
    component.bodies = {0};
  } else {
    draft.faults.of_key(given.where,
                        {FaultCode::scene_missing_key, key, "missing: there are several bodies",
                         listed(names_of(draft.bodies))});
  }
  if (component.record == nullptr || component.bodies.empty()) return;
  const auto count = static_cast<int>(component.bodies.size());
  const int fewest = component.record->fewest_bodies;
  const int most = component.record->most_bodies;
  if (count >= fewest && count <= most) return;
  const std::string expected =
      fewest == most ? fmt::format("{}", most) : fmt::format("{} to {}", fewest, most);
  const Wrong wrong{FaultCode::scene_wrong_count, key,
                    fmt::format("found {} bod{}, but {} {} {}", count, count == 1 ? "y" : "ies",
                                component.record->name, verb, expected)};
  if (const Node* node = several ? several : one) {
    draft.faults.of_value(*node, wrong);
  } else {
    draft.faults.of_key(given.where, wrong);
  }
  component.bodies.clear();
}

/// Reads values that forces and bodies give particle by particle, once these are counted.
template <class Component>
void read_particle_values(const SceneDraft& draft, Component& component,
                          std::optional<std::int64_t> count) {
  if (component.record == nullptr) return;
  read_deferred(component.reading, component.record->parameters, component.description.get(), count,
                draft.values, draft.faults);
  component.valid = component.valid && component.reading.valid;
}

std::filesystem::path folder_of(const SceneDraft& draft) {
  return std::filesystem::path(draft.scene->file).parent_path();
}

void count_bodies(SceneDraft& draft) {
  prepare_bodies(draft.bodies, folder_of(draft), draft.faults);
  draft.dimension = scene_dimension(draft.bodies);
  count_particles(draft.bodies, draft.dimension, draft.faults);
  for (BodyDraft& body : draft.bodies) read_particle_values(draft, body, body.count);
}

/// Bodies and forces share their names: an observable says "ring.turns", whatever "ring" is.
class NameCheck {
 public:
  explicit NameCheck(SceneDraft& draft) : draft_(draft) {}

  template <class Component>
  void operator()(const std::vector<Component>& components) {
    for (const Component& component : components) {
      if (component.name.empty()) continue;
      const auto [first, is_new] = taken_.emplace(component.name, &component.reading);
      if (is_new) continue;
      const SourceLocation location = draft_.source.location(first->second->where);
      component.reading.complain(
          draft_.faults, "name",
          {FaultCode::scene_duplicate_name, "",
           fmt::format("the name {} is taken by {} in line {}", quoted_text(component.name),
                       first->second->path, location.line)});
    }
  }

 private:
  SceneDraft& draft_;
  std::map<std::string, const TableReading*> taken_;
};

}  // namespace

void read_components(SceneDraft& draft) {
  const Node* bodies = draft.document.find("body");
  if (bodies == nullptr || (bodies->as<List>() && bodies->as<List>()->empty())) {
    draft.faults.of_key(kTopOfFile, {FaultCode::scene_missing_key, "body",
                                     "missing: a scene needs at least one [[body]]"});
  }
  const Registry& registry = draft.registry;
  read_all(draft, "body", draft.bodies, registry.bodies(), body_layout,
           [&](BodyDraft& body, const SceneSection& given) {
             read_freedom(draft, body, given);
             note_name(draft, body, given);
           });
  count_bodies(draft);
  read_all(draft, "force", draft.forces, registry.forces(), force_layout,
           [&](ForceDraft& force, const SceneSection& given) {
             read_bodies_of(draft, force, given, "acts on");
             read_driver(draft, force, given);
             read_active(draft, force, given);
             prepare_force(force, folder_of(draft), draft.faults);
             const bool one = force.bodies.size() == 1;
             read_particle_values(draft, force,
                                  one ? draft.bodies[force.bodies.front()].count : std::nullopt);
           });
  read_all(draft, "observer", draft.observers, registry.observers(), observer_layout,
           [&](ObserverDraft& observer, const SceneSection& given) {
             read_bodies_of(draft, observer, given, "looks at");
           });
  NameCheck check(draft);
  check(draft.bodies);
  check(draft.forces);
  check(draft.observers);
}

std::optional<std::size_t> read_type(SceneDraft& draft, const std::string& kind,
                                     const SceneSection& given, const std::string& path,
                                     const std::vector<std::string>& names) {
  const std::string key = path + ".type";
  const Node* node = given.table->find("type");
  if (node == nullptr) {
    draft.faults.of_key(given.where,
                        {FaultCode::scene_missing_key, key, "missing", listed(in_quotes(names))});
    return std::nullopt;
  }
  const auto* type = node->as<std::string>();
  if (type == nullptr) {
    draft.faults.of_wrong_type(*node, key, listed(in_quotes(names)));
    return std::nullopt;
  }
  const auto found = std::find(names.begin(), names.end(), *type);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  draft.faults.of_value(*node, {FaultCode::scene_unknown_component, key, "there is no such " + kind,
                                listed(in_quotes(names)), nearest_name(*type, names).value_or("")});
  return std::nullopt;
}

std::vector<std::size_t> bodies_in(SceneDraft& draft, const Node& node, const std::string& key) {
  const auto* list = node.as<List>();
  if (list == nullptr || list->empty()) {
    draft.faults.of_value(
        node, {list ? FaultCode::scene_wrong_count : FaultCode::scene_wrong_type, key,
               list ? "the list is empty" : "found " + kind_of(node), "a list of names of bodies"});
    return {};
  }
  std::vector<std::size_t> result;
  std::set<std::size_t> seen;
  bool valid = true;
  for (const Node& element : *list) {
    const auto index = body_named(draft, element, key);
    if (index && !seen.insert(*index).second) {
      draft.faults.of_value(element, {FaultCode::scene_duplicate_key, key,
                                      "the body is named twice", "different bodies"});
      valid = false;
    }
    if (index) result.push_back(*index);
    valid = valid && index;
  }
  return valid ? result : std::vector<std::size_t>();
}

}  // namespace tomlin
