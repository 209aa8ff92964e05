// The integrator: the one given, or one that does what the scene asks for.

#include <utility>

#include "framework/scene/natural_units.hpp"
#include "framework/scene/scene_draft.hpp"

namespace tomlin {
namespace {

/// Defaults that are numbers of the scene's own units (natural_units.hpp), of keys that were not
/// given. Where there are faults those units are not known; such a scene is refused.
std::map<std::string, double> fill_in_natural_defaults(const SceneDraft& draft,
                                                       const IntegratorRecord& record,
                                                       const Table& given, void* description) {
  std::map<std::string, double> filled_in;
  if (!draft.faults.empty()) return filled_in;
  std::optional<NaturalUnits> units;
  for (const Parameter& row : record.parameters) {
    if (!has_natural_default(row) || given.find(row.key) != nullptr) continue;
    if (!units) units = natural_units(*draft.scene);
    const double value = natural_default(row, *units);
    row.assign(description, value);
    filled_in[row.key] = value;
  }
  return filled_in;
}

/// Takes a scheme with all its defaults, for the scene as far as it has been read.
void take(SceneDraft& draft, const IntegratorRecord& record) {
  SceneIntegrator& integrator = draft.scene->run.integrator;
  auto description = with_defaults(record);
  fill_in_natural_defaults(draft, record, Table{}, description.get());
  integrator.name = record.name;
  integrator.record = &record;
  integrator.description = std::move(description);
}

/// The first adaptive one that takes any force, or follows equilibria where that is asked for,
/// with its defaults: what a scene that asks for an accuracy can be bound with.
void take_any_integrator(SceneDraft& draft, const SceneSection& run, bool quasistatic) {
  for (const auto& record : draft.registry.integrators()) {
    if (!(quasistatic ? record->follows_equilibria : record->takes_any_scene())) continue;
    if (!record->adaptive) continue;
    take(draft, *record);
    draft.scene->run.integrator.location = draft.source.location(run.where);
    return;
  }
  draft.faults.of_key(run.where, {FaultCode::run_no_accuracy, "run.accuracy",
                                  "there is no adaptive integrator", "an integrator"});
}

/// `{ type = ... }` of the scheme that follows equilibria.
Table following_scheme(const Registry& registry) {
  Table table;
  for (const auto& record : registry.integrators()) {
    if (record->follows_equilibria) table.set("type", text_node(record->name));
  }
  return table;
}

/// Only one scheme follows equilibria, and it does nothing else: for quasistatic dynamics it is
/// taken in place of what is given.
void fit_to_dynamics(SceneDraft& draft, const TableReading& reading,
                     const IntegratorRecord& given) {
  if (given.follows_equilibria) {
    reading.complain(draft.faults, "type",
                     {FaultCode::integrator_unsuitable, "",
                      "follows equilibria: it is for dynamics = \"quasistatic\" alone",
                      "another integrator, or run.dynamics = \"quasistatic\""});
    return;
  }
  for (const auto& record : draft.registry.integrators()) {
    if (!record->follows_equilibria) continue;
    take(draft, *record);
    draft.scene->run.integrator.not_used = given.name;
    return;
  }
}

}  // namespace

std::optional<Node> read_integrator(SceneDraft& draft, const SceneSection& run) {
  const std::string path = "run.integrator";
  const std::string expected = "{ type = ..., ... }";
  const bool quasistatic = draft.scene->run.dynamics == Dynamics::quasistatic;
  const Node* node = run.table->find("integrator");
  const Entry* accuracy = run.table->find_entry("accuracy");
  if (accuracy != nullptr) {
    if (node == nullptr) {
      take_any_integrator(draft, run, quasistatic);
      return std::nullopt;
    }
    draft.faults.of_key(accuracy->where,
                        {FaultCode::scene_conflict, "run.accuracy",
                         "replaces the integrator, but an integrator is given", "one of the two"});
  }
  const Node by_default{following_scheme(draft.registry), run.where};
  if (node == nullptr && quasistatic) node = &by_default;
  if (node == nullptr) {
    draft.faults.of_key(
        run.where, {FaultCode::scene_missing_key, path, "missing", expected + ", or accuracy"});
    return std::nullopt;
  }
  const auto given = draft.inside(*node, path, expected);
  if (!given) return std::nullopt;
  const auto* record = read_record(draft, "integrator", *given, path, draft.registry.integrators());
  if (record == nullptr) return std::nullopt;

  auto description = record->make_description();
  auto reading = draft.read(*given, integrator_layout(*record), path, description.get());
  const auto natural = fill_in_natural_defaults(draft, *record, *given->table, description.get());
  for (const auto& [key, value] : natural) reading.effective.set(key, Node{value, {}});
  if (reading.valid) {
    const auto look = [&] { return record->complaints(description.get()); };
    report(complaints_of(*record, look), reading, draft.faults);
  }

  Table effective;
  effective.set("type", text_node(record->name));
  append(effective, reading.effective);

  SceneIntegrator& integrator = draft.scene->run.integrator;
  integrator.name = record->name;
  integrator.record = record;
  integrator.description = std::move(description);
  integrator.location = draft.source.location(given->where);
  integrator.locations = reading.locations;
  if (record->follows_equilibria != quasistatic) fit_to_dynamics(draft, reading, *record);
  return Node{std::move(effective), {}};
}

}  // namespace tomlin
