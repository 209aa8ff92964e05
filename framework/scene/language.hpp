#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "framework/core/records/parameter.hpp"
#include "framework/core/records/registry.hpp"

/// The scene language as tables: which keys each table of a scene takes.
namespace tomlin {

/// A key that the scene reader reads itself, e.g. name and type.
struct OwnKey {
  std::string key;
  std::string doc;
};

/// Keys that one table of a scene takes.
struct TableLayout {
  std::vector<OwnKey> own_keys;
  std::vector<Parameter> rows;
  /// Keys that are looked for here and stand elsewhere, with where: "run.integrator".
  std::vector<OwnKey> elsewhere = {};

  /// Every admissible key: its own, then those of the rows.
  std::vector<std::string> keys() const;
  const Parameter* row(std::string_view key) const;
  bool is_own_key(std::string_view key) const;
};

// The rows of these assign members of Scene, BoxSettings, RunSettings, PerturbSettings,
// MeasureSettings and OutputSettings.
TableLayout scene_layout();
TableLayout axes_layout();
TableLayout box_layout();
/// With `until` a scene need not say how long it runs.
TableLayout run_layout(bool until = false);
TableLayout until_layout();
/// Layout of `until` with `of` or `error` in it.
TableLayout until_error_layout();
TableLayout perturb_layout();
TableLayout measure_layout();
TableLayout output_layout();
/// `[sweep]`, see sweep_settings.hpp.
TableLayout sweep_layout();

/// A table of a scene that is no component, with what it is for.
struct SceneTable {
  std::string name;  ///< "run", "run.perturb"
  std::string summary;
  TableLayout layout;
};

/// All of them but [parameters], whose keys are the scene's own; in the order of a scene.
std::vector<SceneTable> scene_tables();

// The rows of these assign members of the component's description.
TableLayout body_layout(const BodyRecord& record);
/// `hold`, which every body takes; assigns SceneBody::hold.
Parameter hold_row();
/// `driver`, which every force takes; assigns SceneForce::driver.
Parameter driver_row();
/// `active` of a force.
TableLayout active_layout();
TableLayout force_layout(const ForceRecord& record);
TableLayout observer_layout(const ObserverRecord& record);
TableLayout integrator_layout(const IntegratorRecord& record);

/// plugins, and the tables of a scene: scene, parameters, box, body, force, observer, run, measure,
/// output, sweep; in the order of the effective scene.
const std::vector<std::string>& top_level_keys();

/// Words that a summary uses beside the names of bodies and forces.
bool is_word_of_summary(std::string_view name);

}  // namespace tomlin
