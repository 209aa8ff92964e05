#include "framework/scene/reader.hpp"

#include <optional>

#include "framework/scene/box_checks.hpp"
#include "framework/scene/freedom_checks.hpp"
#include "framework/scene/scene_draft.hpp"
#include "framework/scene/sweep_settings.hpp"

namespace tomlin {
namespace {

void report_unknown_tables(const Table& document, FaultList& faults) {
  TableLayout layout;
  for (const std::string& key : top_level_keys()) layout.own_keys.push_back({key, ""});
  for (const Entry& entry : document.entries) {
    if (!layout.is_own_key(entry.key)) report_key(entry, "", layout, faults);
  }
}

/// Holds the components against each other and against the box.
void check_components(SceneDraft& draft) {
  std::vector<BodyDraft>& bodies = draft.bodies;
  FaultList& faults = draft.faults;
  const std::optional<int> dimension = draft.dimension;
  if (dimension) draft.scene->dimension = *dimension;
  check_freedom(bodies, dimension, faults);
  check_bodies(bodies, dimension, faults);
  const BoxSettings& box = draft.scene->box;
  const bool box_is_valid = !draft.box ? draft.document.find("box") == nullptr
                                       : check_box(box, *draft.box, dimension, faults);
  const BoxSettings* valid_box = box_is_valid ? &box : nullptr;
  check_forces(draft.forces, bodies, valid_box, dimension, faults);
  check_observers(draft.observers, bodies, valid_box, dimension, faults);
  if (!draft.box || !box_is_valid) return;
  check_box_periods(box, *draft.box, draft.forces, faults);
  check_box_bodies(box, *draft.box, bodies, *dimension, faults);
}

}  // namespace

/// Every step reports its own faults and leaves the others to be found; the scene is only handed
/// out when there were none.
std::shared_ptr<const Scene> read_document(const Table& document, const std::string& file,
                                           const Source& source, const Registry& registry,
                                           FaultList& faults, EffectiveText text) {
  SceneDraft draft(document, source, registry, faults);
  draft.scene->file = file;
  draft.scene->registry = &registry;
  report_unknown_tables(document, faults);
  read_libraries(draft);
  read_parameters(draft);
  read_heading(draft);
  read_box(draft);
  read_components(draft);
  check_components(draft);
  describe_components(draft);
  read_run(draft);
  read_measure(draft);
  read_output(draft);
  check_sweep(document, source, faults);
  faults.throw_if_any();
  // The pilots of a run that is asked for an accuracy are scenes made from the text.
  const bool has_pilots = draft.scene->run.accuracy.has_value();
  if (text == EffectiveText::written || has_pilots) write_effective_scene(draft);
  return draft.scene;
}

}  // namespace tomlin
