// `[run]` with what stands in it: noise on the start, and when a run ends.

#include <algorithm>
#include <numeric>
#include <utility>

#include "framework/scene/scene_draft.hpp"

namespace tomlin {
namespace {

/// The effective table of `perturb`; nothing when it is absent or unfit.
std::optional<Node> read_perturb(SceneDraft& draft, const SceneSection& run) {
  const std::string path = "run.perturb";
  const Node* node = run.table->find("perturb");
  if (node == nullptr) return std::nullopt;
  const auto given = draft.inside(*node, path, "{ size = ..., ... }");
  if (!given) return std::nullopt;
  PerturbSettings& perturb = draft.scene->run.perturb.emplace();
  const auto reading = draft.read(*given, perturb_layout(), path, &perturb);
  perturb.location = draft.source.location(node->where);
  perturb.locations = reading.locations;
  if (const Node* bodies = given->table->find("bodies")) {
    perturb.bodies = bodies_in(draft, *bodies, path + ".bodies");
  } else {
    perturb.bodies.resize(draft.bodies.size());
    std::iota(perturb.bodies.begin(), perturb.bodies.end(), std::size_t{0});
  }
  Table effective;
  effective.set("bodies", names_of_bodies(draft, perturb.bodies));
  append(effective, reading.effective);
  return Node{std::move(effective), {}};
}

/// The effective table of `until`, which is there; nothing when it is unfit.
std::optional<Node> read_until(SceneDraft& draft, const SceneSection& run) {
  const std::string path = "run.until";
  const Node& node = *run.table->find("until");
  const auto given = draft.inside(node, path, "{ steady = ..., ... } or { error = ..., ... }");
  if (!given) return std::nullopt;
  UntilSettings& until = draft.scene->run.until.emplace();
  const bool of_error =
      given->table->find("error") != nullptr || given->table->find("of") != nullptr;
  const auto reading =
      draft.read(*given, of_error ? until_error_layout() : until_layout(), path, &until);
  until.location = draft.source.location(node.where);
  until.locations = reading.locations;
  if (until.max) {
    double& duration = draft.scene->run.duration;
    duration = draft.duration_is_known ? std::min(duration, *until.max) : *until.max;
    draft.duration_is_known = true;
  } else if (run.table->find("duration") == nullptr) {
    draft.faults.of_key(run.where, {FaultCode::scene_missing_key, "run.duration", "missing",
                                    "a duration, or max in run.until"});
  }
  return Node{reading.effective, {}};
}

/// An integrator's keys beside it, instead of in its table, are looked for where one is unknown.
TableLayout with_integrators(TableLayout layout, const Registry& registry) {
  for (const auto& record : registry.integrators()) {
    for (const Parameter& row : record->parameters) {
      layout.elsewhere.push_back({row.key, "integrator = { type = ..., ... }"});
    }
  }
  return layout;
}

TableReading read_run_table(SceneDraft& draft, const SceneSection& given, bool until) {
  static const TableLayout layouts[] = {run_layout(false), run_layout(true)};
  const TableLayout& layout = layouts[until ? 1 : 0];
  const bool is_known = std::all_of(
      given.table->entries.begin(), given.table->entries.end(), [&](const Entry& entry) {
        return layout.row(entry.key) != nullptr || layout.is_own_key(entry.key);
      });
  RunSettings* run = &draft.scene->run;
  if (is_known) return draft.read(given, layout, "run", run);
  return draft.read(given, with_integrators(layout, draft.registry), "run", run);
}

}  // namespace

void read_run(SceneDraft& draft) {
  const auto given = draft.section("run");
  if (!given) {
    if (draft.document.find("run") == nullptr) {
      draft.faults.of_key(kTopOfFile,
                          {FaultCode::scene_missing_key, "run", "missing: a scene needs [run]",
                           "a table with duration and integrator"});
    }
    return;
  }
  RunSettings& run = draft.scene->run;
  const bool until = given->table->find("until") != nullptr;
  const TableReading reading = read_run_table(draft, *given, until);
  run.location = draft.source.location(given->where);
  run.locations = reading.locations;
  draft.duration_is_known = reading.has("duration");

  Table effective;
  if (auto integrator = read_integrator(draft, *given)) {
    effective.set("integrator", *std::move(integrator));
  }
  append(effective, reading.effective);
  if (auto perturb = read_perturb(draft, *given)) effective.set("perturb", *std::move(perturb));
  if (until) {
    if (auto table = read_until(draft, *given)) effective.set("until", *std::move(table));
  }
  draft.effective.set("run", {std::move(effective), {}});
}

}  // namespace tomlin
