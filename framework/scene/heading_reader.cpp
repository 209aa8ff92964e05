// Readers of all above the components: plugins, parameters, the heading and the box.

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "framework/scene/libraries.hpp"
#include "framework/scene/scene_draft.hpp"
#include "framework/scene/size_checks.hpp"
#include "framework/scene/text.hpp"

namespace tomlin {
namespace {

std::string parameter_path(const Entry& entry) {
  return "parameters." + key_text(shortened(entry.key, kLongestShownValue));
}

/// False when the value is no number at all, and reported.
bool add_parameter(SceneDraft& draft, const Entry& entry) {
  const Node& node = entry.value;
  if (const auto* expression = node.as<std::string>()) {
    draft.parameters.add(entry.key, *expression);
  } else if (const auto* number = node.as<double>()) {
    draft.parameters.add(entry.key, *number);
  } else if (const auto* integer = node.as<std::int64_t>()) {
    draft.parameters.add(entry.key, static_cast<double>(*integer));
  } else {
    // Known but without a value, so that nothing that uses it is called unknown.
    draft.parameters.add(entry.key, std::numeric_limits<double>::quiet_NaN());
    draft.faults.of_wrong_type(node, parameter_path(entry), "a number or an expression");
    return false;
  }
  return true;
}

/// The effective table of `axes`; nothing when it is absent or unfit.
std::optional<Node> read_axes(SceneDraft& draft, const SceneSection& heading) {
  const Node* node = heading.table->find("axes");
  if (node == nullptr) return std::nullopt;
  const auto given = draft.inside(*node, "scene.axes", "{ length = ..., ... }");
  if (!given) return std::nullopt;
  return Node{draft.read(*given, axes_layout(), "scene.axes", &draft.scene->axes).effective, {}};
}

}  // namespace

void read_libraries(SceneDraft& draft) {
  std::vector<Library>& libraries = draft.scene->libraries;
  const auto add = [&libraries](const Library& library) {
    const bool known = std::any_of(libraries.begin(), libraries.end(),
                                   [&](const auto& one) { return one.path == library.path; });
    if (!known) libraries.push_back(library);
  };
  for (const NamedLibrary& named :
       named_libraries(draft.document, draft.scene->file, draft.source, draft.faults)) {
    const Library* library = draft.registry.library(named.path.string());
    if (library != nullptr) {
      add(*library);
      continue;
    }
    draft.faults.of_key(
        draft.document.find_entry("plugins")->where,
        {FaultCode::plugin_cannot_load, "plugins", named.path.string() + " has not been loaded",
         "a program that loads plugins before it reads the scene"});
  }
  for (const Library& library : draft.registry.libraries()) {
    if (library.everywhere) add(library);
  }
  if (libraries.empty()) return;
  List paths;
  for (const Library& library : libraries) paths.push_back(text_node(library.path));
  draft.effective.set("plugins", {std::move(paths), {}});
}

void read_parameters(SceneDraft& draft) {
  const auto given = draft.section("parameters");
  if (!given) return;
  const auto& entries = given->table->entries;
  if (entries.size() > kMostParameters) {
    draft.faults.of_key(given->where, {FaultCode::scene_too_large, "parameters",
                                       fmt::format("{} parameters are too many", entries.size()),
                                       fmt::format("at most {}", kMostParameters)});
    return;
  }
  std::vector<bool> reported(entries.size(), false);
  for (std::size_t i = 0; i < entries.size(); ++i) reported[i] = !add_parameter(draft, entries[i]);
  draft.parameters.resolve();
  for (const ParameterFault& fault : draft.parameters.faults()) {
    if (reported[fault.entry]) continue;
    const Entry& entry = entries[fault.entry];
    const Wrong wrong{fault.code, parameter_path(entry), fault.why, "", fault.nearest};
    if (fault.part == ParameterFault::Part::name) {
      draft.faults.of_key(entry.where, wrong);
    } else {
      draft.faults.inside(entry.value, fault.column, wrong);
    }
  }
  draft.scene->parameters = draft.parameters.values();
  draft.effective.set("parameters", {*given->table, {}});
}

void read_heading(SceneDraft& draft) {
  const Table nothing;
  const auto given = draft.section("scene").value_or(SceneSection{&nothing, kTopOfFile});
  static const TableLayout layout = scene_layout();
  auto reading = draft.read(given, layout, "scene", draft.scene.get());
  if (auto axes = read_axes(draft, given)) reading.effective.set("axes", *std::move(axes));
  const UnitSystem units = draft.scene->units;
  const Entry* axes = given.table->find_entry("axes");
  if (units != UnitSystem::reduced && axes != nullptr) {
    draft.faults.of_key(axes->where,
                        {FaultCode::scene_conflict, "scene.axes",
                         fmt::format("units = \"{}\" have names already", to_string(units)),
                         "axes with reduced units alone"});
  }
  draft.values.set_units(units);
  draft.effective.set("scene", {std::move(reading.effective), {}});
}

void read_box(SceneDraft& draft) {
  const auto given = draft.section("box");
  if (!given) return;
  BoxSettings& box = draft.scene->box;
  draft.box = draft.read(*given, box_layout(), "box", &box);
  box.location = draft.source.location(given->where);
  box.locations = draft.box->locations;
  draft.effective.set("box", {draft.box->effective, {}});
}

}  // namespace tomlin
