#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "framework/core/nearest_name.hpp"
#include "framework/core/text_file.hpp"
#include "framework/scene/box_checks.hpp"
#include "framework/scene/checks.hpp"
#include "framework/scene/document.hpp"
#include "framework/scene/effective.hpp"
#include "framework/scene/fault_list.hpp"
#include "framework/scene/freedom_checks.hpp"
#include "framework/scene/language.hpp"
#include "framework/scene/libraries.hpp"
#include "framework/scene/motion_reader.hpp"
#include "framework/scene/natural_units.hpp"
#include "framework/scene/parameter_table.hpp"
#include "framework/scene/scene.hpp"
#include "framework/scene/settings.hpp"
#include "framework/scene/size_checks.hpp"
#include "framework/scene/table_reader.hpp"
#include "framework/scene/text.hpp"
#include "framework/scene/value_reader.hpp"

namespace tomlin {
namespace {

constexpr Extent kTopOfFile{{1, 1}, {1, 1}, 0};

template <class Record>
std::vector<std::string> names_of(const std::vector<std::unique_ptr<Record>>& records) {
  std::vector<std::string> names;
  names.reserve(records.size());
  for (const auto& record : records) names.push_back(record->name);
  return names;
}

template <class Draft>
std::vector<std::string> names_of(const std::vector<Draft>& drafts) {
  std::vector<std::string> names;
  for (const Draft& draft : drafts) {
    if (!draft.name.empty()) names.push_back(draft.name);
  }
  return names;
}

Node text_node(const std::string& text) {
  Node node;
  node.value = text;
  return node;
}

/// Reads one document. Every step reports its own faults and leaves the others to be found; the
/// scene is only handed out when there were none.
class SceneReader {
 public:
  SceneReader(const Table& document, const std::string& file, const Source& source,
              const Registry& registry, FaultList& faults)
      : document_(document),
        source_(source),
        registry_(registry),
        faults_(faults),
        values_(parameters_, faults),
        scene_(std::make_shared<Scene>()) {
    scene_->file = file;
    scene_->registry = &registry;
  }

  std::shared_ptr<const Scene> read() {
    report_unknown_tables();
    read_libraries();
    read_parameters();
    read_heading();
    read_box();
    read_bodies();
    read_forces();
    read_observers();
    check_names();
    check_components();
    read_run();
    read_measure();
    read_output();
    faults_.throw_if_any();
    hand_over();
    return scene_;
  }

 private:
  /// A table of the document with where it stands.
  struct Section {
    const Table* table;
    Extent where;
  };

  void report_unknown_tables() {
    TableLayout layout{{}, {}, reserved_top_level_keys()};
    for (const std::string& key : top_level_keys()) layout.own_keys.push_back({key, ""});
    for (const Entry& entry : document_.entries) {
      if (!layout.is_own_key(entry.key)) report_key(entry, "", layout, faults_);
    }
  }

  /// `[key]`; nothing when it is absent, or no table and reported.
  std::optional<Section> section(const std::string& key) {
    const Node* node = document_.find(key);
    if (node == nullptr) return std::nullopt;
    if (const auto* table = node->as<Table>()) return Section{table, node->where};
    faults_.of_key(node->where, {key, "found " + kind_of(*node), "a table, [" + key + "]"});
    return std::nullopt;
  }

  /// Every `[[key]]`.
  std::vector<Section> sections(const std::string& key) {
    const Node* node = document_.find(key);
    if (node == nullptr) return {};
    const std::string due = "a list of tables, [[" + key + "]]";
    const auto* list = node->as<List>();
    if (list == nullptr) {
      faults_.of_key(node->where, {key, "found " + kind_of(*node), due});
      return {};
    }
    if (list->size() > kMostComponents) {
      faults_.of_key(node->where, {key, fmt::format("there are {}", list->size()),
                                   fmt::format("at most {}", kMostComponents)});
      return {};
    }
    std::vector<Section> result;
    for (const Node& element : *list) {
      if (const auto* table = element.as<Table>()) {
        result.push_back({table, element.where});
      } else {
        faults_.of_value(element, {key, "found " + kind_of(element), due});
      }
    }
    return result;
  }

  /// `plugins`, which the registry has loaded by now.
  void read_libraries() {
    std::vector<Library>& libraries = scene_->libraries;
    const auto add = [&libraries](const Library& library) {
      const bool known = std::any_of(libraries.begin(), libraries.end(),
                                     [&](const auto& one) { return one.path == library.path; });
      if (!known) libraries.push_back(library);
    };
    for (const NamedLibrary& named : named_libraries(document_, scene_->file, source_, faults_)) {
      const Library* library = registry_.library(named.path.string());
      if (library != nullptr) {
        add(*library);
        continue;
      }
      faults_.of_key(document_.find_entry("plugins")->where,
                     {"plugins", named.path.string() + " has not been loaded",
                      "a program that loads plugins before it reads the scene"});
    }
    for (const Library& library : registry_.libraries()) {
      if (library.everywhere) add(library);
    }
    if (libraries.empty()) return;
    List paths;
    for (const Library& library : libraries) paths.push_back(text_node(library.path));
    effective_.set("plugins", {std::move(paths), {}});
  }

  void read_parameters() {
    const auto given = section("parameters");
    if (!given) return;
    const auto& entries = given->table->entries;
    if (entries.size() > kMostParameters) {
      faults_.of_key(given->where, {"parameters", fmt::format("there are {}", entries.size()),
                                    fmt::format("at most {}", kMostParameters)});
      return;
    }
    std::vector<bool> reported(entries.size(), false);
    for (std::size_t i = 0; i < entries.size(); ++i) {
      reported[i] = !add_parameter(entries[i]);
    }
    parameters_.resolve();
    for (const ParameterFault& fault : parameters_.faults()) {
      if (reported[fault.entry]) continue;
      const Entry& entry = entries[fault.entry];
      const Wrong wrong{parameter_path(entry), fault.why, "", fault.nearest};
      if (fault.part == ParameterFault::Part::name) {
        faults_.of_key(entry.where, wrong);
      } else {
        faults_.inside(entry.value, fault.column, wrong);
      }
    }
    scene_->parameters = parameters_.values();
    put("parameters", *given->table);
  }

  static std::string parameter_path(const Entry& entry) {
    return "parameters." + key_text(shortened(entry.key, kLongestShownValue));
  }

  /// False when the value is no number at all, and reported.
  bool add_parameter(const Entry& entry) {
    const Node& node = entry.value;
    if (const auto* expression = node.as<std::string>()) {
      parameters_.add(entry.key, *expression);
    } else if (const auto* number = node.as<double>()) {
      parameters_.add(entry.key, *number);
    } else if (const auto* integer = node.as<std::int64_t>()) {
      parameters_.add(entry.key, static_cast<double>(*integer));
    } else {
      // Known but without a value, so that nothing that uses it is called unknown.
      parameters_.add(entry.key, std::numeric_limits<double>::quiet_NaN());
      faults_.of_value(
          node, {parameter_path(entry), "found " + kind_of(node), "a number or an expression"});
      return false;
    }
    return true;
  }

  TableReading read_section(const Section& given, const TableLayout& layout, std::string path,
                            void* description) {
    return read_table(*given.table, given.where, layout, std::move(path), description, values_,
                      source_, faults_);
  }

  void read_heading() {
    const Table nothing;
    const auto given = section("scene").value_or(Section{&nothing, kTopOfFile});
    put("scene", read_section(given, scene_layout(), "scene", scene_.get()).effective);
  }

  void read_box() {
    const auto given = section("box");
    if (!given) return;
    BoxSettings& box = scene_->box;
    box_ = read_section(*given, box_layout(), "box", &box);
    box.place = source_.place(given->where);
    box.places = box_->places;
    put("box", box_->effective);
  }

  void read_bodies() {
    const auto given = sections("body");
    const auto types = type_counts(given);
    const Node* node = document_.find("body");
    if (node == nullptr || (node->as<List>() && node->as<List>()->empty())) {
      faults_.of_key(kTopOfFile, {"body", "missing: a scene needs at least one [[body]]"});
    }
    for (const Section& body : given) {
      BodyDraft draft;
      read_component(draft, "body", body, types, bodies_.size(), registry_.bodies(), body_layout);
      read_freedom(draft, body);
      note_name(draft);
      bodies_.push_back(std::move(draft));
    }
  }

  /// `hold` and `motion`.
  void read_freedom(BodyDraft& draft, const Section& given) {
    if (const Node* node = given.table->find("hold")) {
      const auto held = values_.read(hold_row(), *node, draft.reading.path + ".hold");
      if (held) draft.hold = std::get<WordList>(*held).words;
      draft.sound = draft.sound && held;
    }
    if (const Node* node = given.table->find("motion")) {
      draft.motion = read_motion(*node, draft.reading.path + ".motion", parameters_, faults_);
      draft.sound = draft.sound && draft.motion;
    }
  }

  void read_forces() {
    const auto given = sections("force");
    const auto types = type_counts(given);
    for (const Section& force : given) {
      ForceDraft draft;
      read_component(draft, "force", force, types, forces_.size(), registry_.forces(),
                     force_layout);
      read_bodies_of(draft, force);
      forces_.push_back(std::move(draft));
    }
  }

  void read_observers() {
    const auto given = sections("observer");
    const auto types = type_counts(given);
    for (const Section& observer : given) {
      ObserverDraft draft;
      read_component(draft, "observer", observer, types, observers_.size(), registry_.observers(),
                     observer_layout);
      read_bodies_of(draft, observer);
      observers_.push_back(std::move(draft));
    }
  }

  /// How many components have each type.
  using TypeCounts = std::map<std::string, std::size_t>;

  static TypeCounts type_counts(const std::vector<Section>& components) {
    TypeCounts counts;
    for (const Section& component : components) {
      if (const auto* type = text_at(component, "type")) ++counts[*type];
    }
    return counts;
  }

  /// A body whose own name is unfit is still the one that is meant by it; the first of several is.
  void note_name(const BodyDraft& draft) {
    const Node* node = draft.reading.given->find("name");
    const auto* written = node ? node->as<std::string>() : nullptr;
    const std::string& name = written ? *written : draft.name;
    if (!name.empty() || written) body_indices_.try_emplace(name, bodies_.size());
  }

  /// Name, type and rows of a body or a force.
  template <class Draft, class Record>
  void read_component(Draft& draft, const std::string& kind, const Section& given,
                      const TypeCounts& types, std::size_t index,
                      const std::vector<std::unique_ptr<Record>>& records,
                      TableLayout (*layout_of)(const Record&)) {
    const std::string nameless = fmt::format("{}[{}]", kind, index);
    const auto* written = text_at(given, "name");
    const auto* type = text_at(given, "type");
    const std::string label = written ? *written : type ? *type : "";
    const std::string path =
        label.empty() ? nameless : kind + "." + key_text(shortened(label, kLongestShownValue));

    draft.reading.path = path;
    draft.reading.where = given.where;
    draft.reading.given = given.table;
    draft.record = read_type(kind, given, path, records);
    draft.name = read_name(given, types, path);
    if (draft.record == nullptr) return;

    draft.description = draft.record->make_description();
    draft.reading = read_section(given, layout_of(*draft.record), path, draft.description.get());
    draft.sound = draft.reading.sound;
  }

  static const std::string* text_at(const Section& given, const char* key) {
    const Node* node = given.table->find(key);
    return node ? node->as<std::string>() : nullptr;
  }

  /// The record that `type` names; nullptr when there is none, and reported.
  template <class Record>
  const Record* read_type(const std::string& kind, const Section& given, const std::string& path,
                          const std::vector<std::unique_ptr<Record>>& records) {
    const auto names = names_of(records);
    const std::string key = path + ".type";
    const Node* node = given.table->find("type");
    if (node == nullptr) {
      faults_.of_key(given.where, {key, "missing", listed(in_quotes(names))});
      return nullptr;
    }
    const auto* type = node->as<std::string>();
    if (type == nullptr) {
      faults_.of_value(*node, {key, "found " + kind_of(*node), listed(in_quotes(names))});
      return nullptr;
    }
    for (const auto& record : records) {
      if (record->name == *type) return record.get();
    }
    const ReservedKey* planned = planned_word(*type);
    faults_.of_value(
        *node, {key, planned ? not_in_this_version(*planned) : "there is no such " + kind,
                listed(in_quotes(names)), planned ? "" : nearest_name(*type, names).value_or("")});
    return nullptr;
  }

  /// The name given, or the type's; empty when unfit, and reported.
  std::string read_name(const Section& given, const TypeCounts& types, const std::string& path) {
    const Node* node = given.table->find("name");
    if (node == nullptr) return default_name(given, types, path);
    const auto* name = node->as<std::string>();
    const std::string key = path + ".name";
    if (name == nullptr) {
      faults_.of_value(*node, {key, "found " + kind_of(*node), "text"});
    } else if (!is_component_name(*name)) {
      faults_.of_value(*node,
                       {key, "not a name", "letters, digits, _ and -, the first a letter or _"});
    } else if (is_word_of_summary(*name)) {
      faults_.of_value(*node, {key, "a word of the summary; choose another name"});
    } else {
      return *name;
    }
    return "";
  }

  std::string default_name(const Section& given, const TypeCounts& types, const std::string& path) {
    const auto* type = text_at(given, "type");
    if (type == nullptr) return "";  // the missing type is reported
    const std::size_t same_type = types.at(*type);
    if (same_type == 1) return *type;
    faults_.of_key(given.where, {path + ".name",
                                 fmt::format("missing: {} share the type {}", same_type,
                                             quoted_text(shortened(*type, kLongestShownValue)))});
    return "";
  }

  /// `body = NAME`, which may be left out where there is one body only, or `bodies = [..]`.
  template <class Draft>
  void read_bodies_of(Draft& draft, const Section& given) {
    if (bodies_.empty()) return;
    const std::string& path = draft.reading.path;
    const Node* one = given.table->find("body");
    const Node* several = given.table->find("bodies");
    if (one && several) {
      faults_.of_key(given.table->find_entry("bodies")->where,
                     {path + ".bodies", "body is given too", "one of the two"});
      return;
    }
    const std::string key = path + (several ? ".bodies" : ".body");
    if (several) {
      draft.bodies = bodies_in(*several, key);
    } else if (one) {
      if (const auto index = body_named(*one, key)) draft.bodies = {*index};
    } else if (bodies_.size() == 1) {
      draft.bodies = {0};
    } else {
      faults_.of_key(given.where,
                     {key, "missing: there are several bodies", listed(names_of(bodies_))});
    }
    check_number_of_bodies(draft, several ? several : one, key);
  }

  static const char* verb_of(const ForceDraft& force) {
    (void)force;
    return "acts on";
  }
  static const char* verb_of(const ObserverDraft& observer) {
    (void)observer;
    return "looks at";
  }

  template <class Draft>
  void check_number_of_bodies(Draft& draft, const Node* node, const std::string& key) {
    if (draft.record == nullptr || draft.bodies.empty()) return;
    const auto given = static_cast<int>(draft.bodies.size());
    const auto& [fewest, most] = std::pair(draft.record->fewest_bodies, draft.record->most_bodies);
    if (given >= fewest && given <= most) return;
    const std::string due =
        fewest == most ? fmt::format("{}", most) : fmt::format("{} to {}", fewest, most);
    const Wrong wrong{key,
                      fmt::format("found {} bod{}, but {} {} {}", given, given == 1 ? "y" : "ies",
                                  draft.record->name, verb_of(draft), due)};
    if (node) {
      faults_.of_value(*node, wrong);
    } else {
      faults_.of_key(draft.reading.where, wrong);
    }
    draft.bodies.clear();
  }

  /// The body of that name; nothing when there is none, and reported.
  std::optional<std::size_t> body_named(const Node& node, const std::string& key) {
    const auto* name = node.as<std::string>();
    if (name == nullptr) {
      faults_.of_value(node, {key, "found " + kind_of(node), "the name of a body"});
      return std::nullopt;
    }
    const auto found = body_indices_.find(*name);
    if (found != body_indices_.end()) return found->second;
    const auto names = names_of(bodies_);
    faults_.of_value(node, {key, "there is no such body", listed(names),
                            nearest_name(*name, names).value_or("")});
    return std::nullopt;
  }

  /// A list of different bodies by their names; empty when one is unfit, and reported.
  std::vector<std::size_t> bodies_in(const Node& node, const std::string& key) {
    const std::string due = "a list of names of bodies";
    const auto* list = node.as<List>();
    if (list == nullptr || list->empty()) {
      faults_.of_value(node, {key, list ? "the list is empty" : "found " + kind_of(node), due});
      return {};
    }
    std::vector<std::size_t> result;
    std::set<std::size_t> seen;
    bool sound = true;
    for (const Node& element : *list) {
      const auto index = body_named(element, key);
      if (index && !seen.insert(*index).second) {
        faults_.of_value(element, {key, "the body is named twice", "different bodies"});
        sound = false;
      }
      if (index) result.push_back(*index);
      sound = sound && index;
    }
    return sound ? result : std::vector<std::size_t>();
  }

  /// Bodies and forces share their names: an observable says "ring.turns", whatever "ring" is.
  void check_names() {
    std::map<std::string, const TableReading*> taken;
    for (const BodyDraft& body : bodies_) check_name(body.name, body.reading, taken);
    for (const ForceDraft& force : forces_) check_name(force.name, force.reading, taken);
    for (const ObserverDraft& one : observers_) check_name(one.name, one.reading, taken);
  }

  void check_name(const std::string& name, const TableReading& reading,
                  std::map<std::string, const TableReading*>& taken) {
    if (name.empty()) return;
    const auto [first, is_new] = taken.emplace(name, &reading);
    if (is_new) return;
    const Place place = source_.place(first->second->where);
    reading.complain(faults_, "name",
                     {"", fmt::format("the name {} is taken by {} in line {}", quoted_text(name),
                                      first->second->path, place.line)});
  }

  void check_components() {
    prepare_bodies(bodies_, std::filesystem::path(scene_->file).parent_path(), faults_);
    const auto dimension = scene_dimension(bodies_);
    count_particles(bodies_, dimension, faults_);
    if (dimension) scene_->dimension = *dimension;
    check_freedom(bodies_, dimension, faults_);
    check_bodies(bodies_, dimension, faults_);
    const BoxSettings& box = scene_->box;
    const bool box_is_sound =
        !box_ ? document_.find("box") == nullptr : check_box(box, *box_, dimension, faults_);
    check_forces(forces_, bodies_, box_is_sound ? &box : nullptr, dimension, faults_);
    check_observers(observers_, bodies_, box_is_sound ? &box : nullptr, dimension, faults_);
    if (box_ && box_is_sound) check_box_periods(box, *box_, forces_, faults_);
  }

  void read_run() {
    const auto given = section("run");
    if (!given) {
      if (document_.find("run") == nullptr) {
        faults_.of_key(kTopOfFile, {"run", "missing: a scene needs [run]",
                                    "a table with duration and integrator"});
      }
      return;
    }
    RunSettings& run = scene_->run;
    const bool until = given->table->find("until") != nullptr;
    TableLayout layout = run_layout(until);
    // An integrator's keys beside it, instead of in its table.
    for (const auto& record : registry_.integrators()) {
      for (const Parameter& row : record->parameters) {
        layout.elsewhere.push_back({row.key, "integrator = { type = ..., ... }"});
      }
    }
    const TableReading reading = read_section(*given, layout, "run", &run);
    run.place = source_.place(given->where);
    run.places = reading.places;
    duration_is_known_ = reading.has("duration");

    Table effective;
    if (const auto integrator = read_integrator(*given)) effective.set("integrator", *integrator);
    append(effective, reading.effective);
    if (const auto perturb = read_perturb(*given)) effective.set("perturb", *perturb);
    if (until) {
      if (const auto table = read_until(*given)) effective.set("until", *table);
    }
    put("run", std::move(effective));
  }

  /// The effective table of `perturb`; nothing when it is absent or unfit.
  std::optional<Node> read_perturb(const Section& run) {
    const std::string path = "run.perturb";
    const Node* node = run.table->find("perturb");
    if (node == nullptr) return std::nullopt;
    const auto* table = node->as<Table>();
    if (table == nullptr) {
      faults_.of_value(*node, {path, "found " + kind_of(*node), "{ size = ..., ... }"});
      return std::nullopt;
    }
    PerturbSettings& perturb = scene_->run.perturb.emplace();
    const auto reading = read_section({table, node->where}, perturb_layout(), path, &perturb);
    perturb.place = source_.place(node->where);
    perturb.places = reading.places;
    if (const Node* bodies = table->find("bodies")) {
      perturb.bodies = bodies_in(*bodies, path + ".bodies");
    } else {
      perturb.bodies.resize(bodies_.size());
      std::iota(perturb.bodies.begin(), perturb.bodies.end(), std::size_t{0});
    }
    Table effective;
    effective.set("bodies", names_of_bodies(perturb.bodies));
    append(effective, reading.effective);
    return Node{std::move(effective), {}};
  }

  /// The effective table of `until`, which is there; nothing when it is unfit.
  std::optional<Node> read_until(const Section& run) {
    const std::string path = "run.until";
    const Node& node = *run.table->find("until");
    const auto* table = node.as<Table>();
    if (table == nullptr) {
      faults_.of_value(node, {path, "found " + kind_of(node), "{ steady = ..., ... }"});
      return std::nullopt;
    }
    UntilSettings& until = scene_->run.until.emplace();
    const auto reading = read_section({table, node.where}, until_layout(), path, &until);
    until.place = source_.place(node.where);
    until.places = reading.places;
    if (until.max) {
      double& duration = scene_->run.duration;
      duration = duration_is_known_ ? std::min(duration, *until.max) : *until.max;
      duration_is_known_ = true;
    } else if (run.table->find("duration") == nullptr) {
      faults_.of_key(run.where, {"run.duration", "missing", "a duration, or max in run.until"});
    }
    return Node{reading.effective, {}};
  }

  Node names_of_bodies(const std::vector<std::size_t>& indices) const {
    List names;
    for (const std::size_t index : indices) names.push_back(text_node(bodies_[index].name));
    return Node{std::move(names), {}};
  }

  /// The first adaptive one that takes any force, or follows equilibria where that is asked for,
  /// with its defaults: what a scene that asks for an accuracy can be bound with.
  void take_any_integrator(const Section& run) {
    for (const auto& record : registry_.integrators()) {
      const bool quasistatic = scene_->run.dynamics == "quasistatic";
      if (!(quasistatic ? record->follows_equilibria : record->takes_any_scene())) continue;
      if (!record->adaptive) continue;
      SceneIntegrator& integrator = scene_->run.integrator;
      integrator.name = record->name;
      integrator.record = record.get();
      integrator.description = with_natural_defaults(*record);
      integrator.place = source_.place(run.where);
      return;
    }
    faults_.of_key(run.where, {"run.accuracy", "there is no adaptive integrator", "an integrator"});
  }

  /// The integrator's effective table; nothing when it is unfit.
  std::optional<Node> read_integrator(const Section& run) {
    const std::string path = "run.integrator";
    const std::string due = "{ type = ..., ... }";
    const bool quasistatic = scene_->run.dynamics == "quasistatic";
    const Node* node = run.table->find("integrator");
    const Entry* accuracy = run.table->find_entry("accuracy");
    if (accuracy != nullptr) {
      if (node == nullptr) {
        take_any_integrator(run);
        return std::nullopt;
      }
      faults_.of_key(
          accuracy->where,
          {"run.accuracy", "stands in place of an integrator, and there is one", "one of the two"});
    }
    const Table follower = following_scheme();
    const Node by_default{follower, run.where};
    if (node == nullptr && quasistatic) node = &by_default;
    if (node == nullptr) {
      faults_.of_key(run.where, {path, "missing", due + ", or accuracy"});
      return std::nullopt;
    }
    const auto* table = node->as<Table>();
    if (table == nullptr) {
      faults_.of_value(*node, {path, "found " + kind_of(*node), due});
      return std::nullopt;
    }
    const Section given{table, node->where};
    const auto* record = read_type("integrator", given, path, registry_.integrators());
    if (record == nullptr) return std::nullopt;

    auto description = record->make_description();
    auto reading = read_section(given, integrator_layout(*record), path, description.get());
    const auto natural = fill_in_natural_defaults(*record, *table, description.get());
    for (const auto& [key, value] : natural) reading.effective.set(key, Node{value, {}});
    if (reading.sound) {
      const auto look = [&] { return record->complaints(description.get()); };
      report(complaints_of(*record, look), reading, faults_);
    }

    Table effective;
    effective.set("type", text_node(record->name));
    append(effective, reading.effective);

    SceneIntegrator& integrator = scene_->run.integrator;
    integrator.name = record->name;
    integrator.record = record;
    integrator.description = std::move(description);
    integrator.place = source_.place(given.where);
    integrator.places = reading.places;
    if (record->follows_equilibria != quasistatic) fit_to_dynamics(reading, *record);
    return Node{std::move(effective), {}};
  }

  /// Defaults that are numbers of the scene's own units (natural_units.hpp), of keys that were not
  /// given. Where there are faults those units are not known; such a scene is refused.
  std::map<std::string, double> fill_in_natural_defaults(const IntegratorRecord& record,
                                                         const Table& given,
                                                         void* description) const {
    std::map<std::string, double> filled_in;
    if (!faults_.empty()) return filled_in;
    std::optional<NaturalUnits> units;
    for (const Parameter& row : record.parameters) {
      if (!has_natural_default(row) || given.find(row.key) != nullptr) continue;
      if (!units) units = natural_units(so_far());
      const double value = natural_default(row, *units);
      row.assign(description, value);
      filled_in[row.key] = value;
    }
    return filled_in;
  }

  /// What has been read, as far as it says what the scene's units are.
  Scene so_far() const {
    Scene scene;
    scene.dimension = scene_->dimension;
    scene.run.dynamics = scene_->run.dynamics;
    scene.run.duration = scene_->run.duration;
    for (const BodyDraft& draft : bodies_) {
      scene.bodies.push_back(component_of<SceneBody>(draft));
      scene.bodies.back().motion = draft.motion;
    }
    for (const ForceDraft& draft : forces_) {
      scene.forces.push_back(component_of<SceneForce>(draft));
      scene.forces.back().bodies = draft.bodies;
    }
    return scene;
  }

  /// With all its defaults, for the scene as far as it has been read.
  std::shared_ptr<void> with_natural_defaults(const IntegratorRecord& record) const {
    auto description = with_defaults(record);
    fill_in_natural_defaults(record, Table{}, description.get());
    return description;
  }

  /// `{ type = ... }` of the scheme that follows equilibria.
  Table following_scheme() const {
    Table table;
    for (const auto& record : registry_.integrators()) {
      if (record->follows_equilibria) table.set("type", text_node(record->name));
    }
    return table;
  }

  /// Only one scheme follows equilibria, and it does nothing else: for quasistatic dynamics it is
  /// taken in place of what is given.
  void fit_to_dynamics(const TableReading& reading, const IntegratorRecord& given) {
    if (given.follows_equilibria) {
      reading.complain(faults_, "type",
                       {"", "follows equilibria: it is for dynamics = \"quasistatic\" alone",
                        "another integrator, or run.dynamics = \"quasistatic\""});
      return;
    }
    for (const auto& record : registry_.integrators()) {
      if (!record->follows_equilibria) continue;
      SceneIntegrator& integrator = scene_->run.integrator;
      integrator.not_used = std::exchange(integrator.name, record->name);
      integrator.record = record.get();
      integrator.description = with_natural_defaults(*record);
      return;
    }
  }

  void read_measure() {
    const auto given = section("measure");
    if (!given) return;
    MeasureSettings& measure = scene_->measure;
    const TableReading reading = read_section(*given, measure_layout(), "measure", &measure);
    measure.place = source_.place(given->where);
    measure.places = reading.places;
    if (!scene_->run.until) check_window(reading);
    if (reading.sound) check_periods(reading);
    put("measure", reading.effective);
  }

  // How far a driver gets is known to the model only; see there for windows in its periods.
  void check_window(const TableReading& reading) {
    const MeasureSettings& measure = scene_->measure;
    const double duration = scene_->run.duration;
    if (!reading.has("from") || (reading.given->find("to") && !reading.has("to"))) return;
    if (measure.to && *measure.to <= measure.from) {
      reading.complain(faults_, "to",
                       {"", "the window ends before it begins",
                        fmt::format("> {}, the value of from", measure.from)});
      return;
    }
    const bool in_time = reading.has("in") && measure.unit == MeasureSettings::Unit::time;
    if (!in_time || !duration_is_known_) return;
    if (measure.to && *measure.to > duration) {
      reading.complain(
          faults_, "to",
          {"", "past the end of the run", fmt::format("<= {}, the run's duration", duration)});
    } else if (!measure.to && measure.from >= duration) {
      reading.complain(
          faults_, "from",
          {"", "past the end of the run", fmt::format("< {}, the run's duration", duration)});
    }
  }

  void check_periods(const TableReading& reading) {
    const MeasureSettings& measure = scene_->measure;
    for (const char* key : {"driver", "period"}) {
      if (measure.unit == MeasureSettings::Unit::time && reading.has(key)) {
        reading.complain(faults_, key, {"", "only counts where in = \"driver_periods\""});
        return;
      }
    }
    if (!reading.has("driver")) return;
    const auto names = names_of(forces_);
    if (std::find(names.begin(), names.end(), measure.driver) == names.end()) {
      reading.complain(faults_, "driver",
                       {"", "there is no such force", listed(names),
                        nearest_name(measure.driver, names).value_or("")});
    }
  }

  void read_output() {
    const Table nothing;
    const auto given = section("output").value_or(Section{&nothing, kTopOfFile});
    const auto reading = read_section(given, output_layout(), "output", &scene_->output);
    scene_->output.place = source_.place(given.where);
    scene_->output.places = reading.places;
    if (scene_->output.trajectory && given.table->find("every") == nullptr) {
      reading.complain(faults_, "trajectory",
                       {"", "positions come with samples, and there are none",
                        "with every, the sampling interval"});
    }
    put("output", reading.effective);
  }

  static void append(Table& table, const Table& more) {
    table.entries.insert(table.entries.end(), more.entries.begin(), more.entries.end());
  }

  void put(const std::string& key, Table table) { effective_.set(key, Node{std::move(table), {}}); }

  template <class Component, class Draft>
  Component component_of(const Draft& draft) const {
    Component component;
    component.name = draft.name;
    component.record = draft.record;
    component.description = draft.description;
    component.place = source_.place(draft.reading.where);
    component.places = draft.reading.places;
    return component;
  }

  /// The table of a force or an observer.
  template <class Draft>
  Node effective_component(const Draft& draft) const {
    Table table;
    table.set("name", text_node(draft.name));
    table.set("type", text_node(draft.record->name));
    if (draft.bodies.size() == 1) {
      table.set("body", text_node(bodies_[draft.bodies.front()].name));
    } else {
      table.set("bodies", names_of_bodies(draft.bodies));
    }
    append(table, draft.reading.effective);
    return Node{std::move(table), {}};
  }

  /// The drafts become the scene's components.
  void hand_over() {
    List bodies;
    for (const BodyDraft& draft : bodies_) {
      auto body = component_of<SceneBody>(draft);
      body.hold = draft.hold;
      body.motion = draft.motion;
      scene_->bodies.push_back(std::move(body));
      Table table;
      table.set("name", text_node(draft.name));
      table.set("type", text_node(draft.record->name));
      append(table, draft.reading.effective);
      if (const Node* hold = draft.reading.given->find("hold")) table.set("hold", *hold);
      if (const Node* motion = draft.reading.given->find("motion")) {
        table.set("motion", {effective_motion(*motion->as<Table>(), scene_->dimension), {}});
      }
      bodies.push_back({std::move(table), {}});
    }
    List forces;
    for (const ForceDraft& draft : forces_) {
      auto force = component_of<SceneForce>(draft);
      force.bodies = draft.bodies;
      scene_->forces.push_back(std::move(force));
      forces.push_back(effective_component(draft));
    }
    List observers;
    for (const ObserverDraft& draft : observers_) {
      auto observer = component_of<SceneObserver>(draft);
      observer.bodies = draft.bodies;
      scene_->observers.push_back(std::move(observer));
      observers.push_back(effective_component(draft));
    }
    effective_.set("body", {std::move(bodies), {}});
    effective_.set("force", {std::move(forces), {}});
    effective_.set("observer", {std::move(observers), {}});

    Table in_order;
    for (const std::string& key : top_level_keys()) {
      if (const Node* node = effective_.find(key)) in_order.set(key, *node);
    }
    scene_->effective_toml = to_toml(in_order);
    // With the contents of files written out it may have become more than can be read again.
    if (scene_->effective_toml.size() > kLargestSceneFile) {
      faults_.of_key(kTopOfFile,
                     {"body",
                      fmt::format("with all positions written out the scene takes {} MB",
                                  scene_->effective_toml.size() >> 20),
                      fmt::format("at most {} MB", kLargestSceneFile >> 20)});
      faults_.throw_if_any();
    }
    try {
      check_outline(scene_->effective_toml, scene_->file);
    } catch (const InputError& error) {
      const Fault& fault = error.faults().front();
      faults_.of_key(kTopOfFile,
                     {"body", "with all positions written out: " + fault.why, fault.admissible});
      faults_.throw_if_any();
    }
  }

  const Table& document_;
  const Source& source_;
  const Registry& registry_;
  FaultList& faults_;
  ParameterTable parameters_;
  ValueReader values_;
  std::shared_ptr<Scene> scene_;
  std::optional<TableReading> box_;
  std::vector<BodyDraft> bodies_;
  std::map<std::string, std::size_t> body_indices_;  ///< by the names that mean them
  std::vector<ForceDraft> forces_;
  std::vector<ObserverDraft> observers_;
  Table effective_;
  bool duration_is_known_ = false;
};

std::string contents_of(const std::string& file) {
  TextFile contents = read_text_file(file, kLargestSceneFile);
  if (contents.too_large) refuse_too_large(file);
  if (contents.why.empty()) return std::move(contents.text);
  Fault fault;
  fault.place = {file, 1, 1};
  fault.why = std::move(contents.why);
  throw InputError({std::move(fault)});
}

}  // namespace

std::shared_ptr<const Scene> read_scene(const std::string& file, const Registry& registry,
                                        const std::vector<Setting>& settings) {
  return parse_scene(contents_of(file), file, registry, settings);
}

std::shared_ptr<const Scene> parse_scene(std::string_view text, const std::string& file,
                                         const Registry& registry,
                                         const std::vector<Setting>& settings) {
  Table document = parse_document(text, file);
  const Source source(file, text, settings);
  FaultList faults(source);
  apply_settings(settings, document, faults);
  // What comes next evaluates them.
  if (!check_expressions(document, faults)) faults.throw_if_any();
  return SceneReader(document, file, source, registry, faults).read();
}

}  // namespace tomlin
