// Drafts without faults become the scene's components and its effective text.

#include <set>
#include <string>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "framework/scene/effective.hpp"
#include "framework/scene/motion_reader.hpp"
#include "framework/scene/scene_draft.hpp"

namespace tomlin {
namespace {

template <class Component, class Draft>
Component component_of(const Draft& from, const Source& source) {
  Component component;
  component.name = from.name;
  component.record = from.record;
  component.description = from.description;
  component.location = source.location(from.reading.where);
  component.locations = from.reading.locations;
  return component;
}

Table name_and_type(const std::string& name, const ComponentRecord& record) {
  Table table;
  table.set("name", text_node(name));
  table.set("type", text_node(record.name));
  return table;
}

Node effective_body(const SceneDraft& draft, const BodyDraft& body) {
  Table table = name_and_type(body.name, *body.record);
  append(table, body.reading.effective);
  if (const Node* hold = body.reading.given->find("hold")) table.set("hold", *hold);
  if (const Node* motion = body.reading.given->find("motion")) {
    table.set("motion", {effective_motion(*motion->as<Table>(), draft.scene->dimension), {}});
  }
  return {std::move(table), {}};
}

/// The table of a force or an observer.
template <class Draft>
Node effective_component(const SceneDraft& draft, const Draft& component) {
  Table table = name_and_type(component.name, *component.record);
  if (component.bodies.size() == 1) {
    table.set("body", text_node(draft.bodies[component.bodies.front()].name));
  } else {
    table.set("bodies", names_of_bodies(draft, component.bodies));
  }
  append(table, component.reading.effective);
  if (const Node* driver = component.reading.given->find("driver")) {
    if (table.find("driver") == nullptr) table.set("driver", *driver);
  }
  if constexpr (std::is_same_v<Draft, ForceDraft>) {
    if (component.active) table.set("active", {component.active_effective, {}});
  }
  return {std::move(table), {}};
}

}  // namespace

void describe_components(SceneDraft& draft) {
  Scene& scene = *draft.scene;
  std::set<std::string> known;  // species
  for (const BodyDraft& body : draft.bodies) {
    scene.bodies.push_back(component_of<SceneBody>(body, draft.source));
    scene.bodies.back().hold = body.hold;
    scene.bodies.back().motion = body.motion;
    if (body.record == nullptr || body.description == nullptr) continue;
    const BodyDescription& common = body.record->common(body.description.get());
    for (const std::string& name : common.species.names) {
      if (known.insert(name).second) scene.species.push_back(name);
    }
  }
  for (const ForceDraft& force : draft.forces) {
    scene.forces.push_back(component_of<SceneForce>(force, draft.source));
    scene.forces.back().bodies = force.bodies;
    scene.forces.back().driver = force.driver;
    scene.forces.back().active = force.active;
    scene.forces.back().variations = variations_of(force);
    scene.forces.back().warnings = force.warnings;
  }
  for (const ObserverDraft& observer : draft.observers) {
    scene.observers.push_back(component_of<SceneObserver>(observer, draft.source));
    scene.observers.back().bodies = observer.bodies;
  }
  scene.draws_random = draft.parameters.draws_random();
}

void write_effective_scene(SceneDraft& draft) {
  List bodies;
  for (const BodyDraft& body : draft.bodies) bodies.push_back(effective_body(draft, body));
  List forces;
  for (const ForceDraft& one : draft.forces) forces.push_back(effective_component(draft, one));
  List observers;
  for (const ObserverDraft& one : draft.observers) {
    observers.push_back(effective_component(draft, one));
  }
  draft.effective.set("body", {std::move(bodies), {}});
  draft.effective.set("force", {std::move(forces), {}});
  draft.effective.set("observer", {std::move(observers), {}});

  Table in_order;
  for (const std::string& key : top_level_keys()) {
    if (Node* node = draft.effective.find(key)) in_order.set(key, std::move(*node));
  }
  std::string& text = draft.scene->effective_toml;
  text = to_toml(in_order);
  // With the contents of files written out it may have become more than can be read again.
  std::optional<Wrong> wrong;
  if (text.size() > kLargestSceneFile) {
    const Node* bodies_of_scene = in_order.find("body");
    Table of_bodies;
    if (bodies_of_scene != nullptr) of_bodies.set("body", *bodies_of_scene);
    const bool by_bodies = 2 * to_toml(of_bodies).size() > text.size();
    wrong = {FaultCode::scene_too_large, by_bodies ? "body" : "force",
             fmt::format("with all {} written out the scene takes {} MB",
                         by_bodies ? "positions" : "numbers of its forces", text.size() >> 20),
             fmt::format("at most {} MB", kLargestSceneFile >> 20)};
  } else {
    try {
      check_outline(text, draft.scene->file);
    } catch (const InputError& error) {
      const Fault& fault = error.faults().front();
      wrong = {fault.code, "body", "with all positions written out: " + fault.why,
               fault.admissible};
    }
  }
  if (!wrong) return;
  draft.faults.of_key(kTopOfFile, *std::move(wrong));
  draft.faults.throw_if_any();
}

}  // namespace tomlin
