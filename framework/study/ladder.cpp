#include "framework/study/ladder.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "framework/run/engine.hpp"
#include "framework/scene/natural_units.hpp"
#include "framework/scene/text.hpp"

namespace tomlin {
namespace {

constexpr const char* kAbsolute = "absolute";
constexpr const char* kTolerance = "tolerance";
constexpr const char* kQuasistatic = "quasistatic";

/// The rows of an integrator that its knob sets: those without a default, and all tolerances.
std::vector<const Parameter*> knob_rows(const IntegratorRecord& integrator) {
  std::vector<const Parameter*> rows;
  for (const Parameter& row : integrator.parameters) {
    if (!std::holds_alternative<double>(row.prototype)) continue;
    if (row.required() || std::string_view(row.key).ends_with(kTolerance)) rows.push_back(&row);
  }
  return rows;
}

bool is_absolute(const Parameter& row) { return std::string_view(row.key).starts_with(kAbsolute); }

/// A model of the scene, or the scene's own.
struct ModelChange {
  std::string name;
  std::vector<Setting> settings;
  std::string dynamics;
};

/// Flexible bodies of several particles with forces that act within them only.
std::vector<std::string> bodies_held_together(const Scene& scene) {
  std::vector<std::string> names;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody& body = scene.bodies[b];
    const void* description = body.description.get();
    if (body.record->common(description).coordinates != "particles") continue;
    if (body.record->count(description) < 2) continue;
    const bool bonded =
        std::any_of(scene.forces.begin(), scene.forces.end(), [b](const SceneForce& force) {
          return force.traits().internal && force.bodies == std::vector<std::size_t>{b};
        });
    if (bonded) names.push_back(body.name);
  }
  return names;
}

std::vector<ModelChange> model_changes(const Scene& scene) {
  std::vector<ModelChange> changes = {{"", {}, scene.run.dynamics}};
  if (scene.run.dynamics == "inertial") {
    for (const char* dynamics : {"overdamped", kQuasistatic}) {
      changes.push_back({dynamics, {{"run.dynamics", quoted_text(dynamics)}}, dynamics});
    }
  }
  const std::vector<std::string> bodies = bodies_held_together(scene);
  if (bodies.empty()) return changes;
  const std::size_t flexible = changes.size();
  for (std::size_t k = 0; k < flexible; ++k) {
    ModelChange change = changes[k];
    change.name = change.name.empty() ? "rigid" : "rigid, " + change.name;
    for (const std::string& body : bodies) {
      change.settings.push_back({"body." + body + ".coordinates", quoted_text("rigid")});
    }
    changes.push_back(std::move(change));
  }
  return changes;
}

Rung rung_of(const Scene& scene, const ModelChange& model, const IntegratorRecord& integrator,
             const char* number_type) {
  Rung rung;
  rung.model = model.name;
  rung.integrator = &integrator;
  rung.number_type = number_type;
  rung.settings = model.settings;
  rung.name = model.name.empty() ? integrator.name : model.name + ", " + integrator.name;
  if (rung.number_type != "double") rung.name += " in " + rung.number_type;
  if (rung.number_type != scene.run.number_type) {
    rung.settings.push_back({"run.number_type", quoted_text(rung.number_type)});
  }
  rung.knob = integrator.adaptive ? Knob::tolerance : Knob::step;
  rung.absolute_share = length_scale(scene);
  if (rung.knob == Knob::step) rung.unit = scene.run.duration;
  return rung;
}

/// Binds the scene on this rung: why it is refused, or how far its steps may go.
void try_to_bind(const Variants& variants, Rung& rung) {
  constexpr double kAnyTolerance = 1e-3;
  const bool fixed = rung.knob == Knob::step;
  try {
    const auto scene =
        variants.with(rung.at(fixed ? variants.scene().run.duration : kAnyTolerance));
    const Engine engine(scene, options_to_bind());
    if (fixed && engine.stable_step() > 0.0) rung.stable_step = engine.stable_step();
  } catch (const InputError& error) {
    rung.refused = condensed(error);
  }
}

}  // namespace

const char* to_string(Knob knob) { return knob == Knob::step ? "dt" : "tolerance"; }

std::vector<Setting> Rung::at(double value) const {
  std::string table = "{ type = " + quoted_text(integrator->name);
  for (const Parameter* row : knob_rows(*integrator)) {
    const double number = is_absolute(*row) ? value * absolute_share : value;
    table += fmt::format(", {} = {}", row->key, number);
  }
  std::vector<Setting> all = settings;
  all.push_back({"run.integrator", table + " }"});
  return all;
}

std::vector<Rung> ladder(const Variants& variants) {
  const Scene& scene = variants.scene();
  std::vector<Rung> rungs;
  for (const ModelChange& model : model_changes(scene)) {
    for (const auto& integrator : variants.registry().integrators()) {
      if (integrator->follows_equilibria != (model.dynamics == kQuasistatic)) continue;
      for (const char* number_type : {"double", "float"}) {
        const bool in_float = std::string_view(number_type) == "float";
        if (in_float && (!model.name.empty() || integrator->bind.in_float == nullptr)) continue;
        rungs.push_back(rung_of(scene, model, *integrator, number_type));
        try_to_bind(variants, rungs.back());
      }
    }
  }
  return rungs;
}

std::vector<Rung> own_ladder(const Variants& variants) {
  const Scene& scene = variants.scene();
  const ModelChange own = {"", {}, scene.run.dynamics};
  std::vector<Rung> rungs;
  for (const auto& integrator : variants.registry().integrators()) {
    if (integrator->follows_equilibria != (own.dynamics == kQuasistatic)) continue;
    rungs.push_back(rung_of(scene, own, *integrator, scene.run.number_type.c_str()));
    try_to_bind(variants, rungs.back());
  }
  return rungs;
}

double length_scale(const Scene& scene) { return natural_units(scene).length; }

std::string condensed(const InputError& error) {
  const std::vector<Fault>& faults = error.faults();
  if (faults.empty()) return error.what();
  const Fault& first = faults.front();
  std::string text = first.key.empty() ? first.why : first.key + ": " + first.why;
  if (faults.size() > 1) text += fmt::format(" (and {} more)", faults.size() - 1);
  return shortened(text, kLongestShownMessage);
}

}  // namespace tomlin
