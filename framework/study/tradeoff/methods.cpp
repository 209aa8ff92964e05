#include "framework/study/tradeoff/methods.hpp"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "framework/model/stability.hpp"
#include "framework/run/engine.hpp"
#include "framework/scene/natural_units.hpp"
#include "framework/scene/text.hpp"

namespace tomlin {
namespace {

constexpr const char* kAbsolute = "absolute";
constexpr const char* kTolerance = "tolerance";

/// The parameters of an integrator that its resolution sets: those without a default, and all
/// tolerances.
std::vector<const Parameter*> resolution_rows(const IntegratorRecord& integrator) {
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
  Dynamics dynamics = Dynamics::inertial;
};

/// Flexible bodies of several particles with forces that act within them only.
std::vector<std::string> bodies_held_together(const Scene& scene) {
  std::vector<std::string> names;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody& body = scene.bodies[b];
    const void* description = body.description.get();
    if (body.record->common(description).coordinates != Coordinates::particles) continue;
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
  if (scene.run.dynamics == Dynamics::inertial) {
    for (const Dynamics dynamics : {Dynamics::overdamped, Dynamics::quasistatic}) {
      const char* word = to_string(dynamics);
      changes.push_back({word, {{"run.dynamics", quoted_text(word)}}, dynamics});
    }
  }
  const std::vector<std::string> bodies = bodies_held_together(scene);
  if (bodies.empty()) return changes;
  const std::size_t flexible = changes.size();
  for (std::size_t k = 0; k < flexible; ++k) {
    ModelChange change = changes[k];
    change.name = change.name.empty() ? "rigid" : "rigid, " + change.name;
    for (const std::string& body : bodies) {
      change.settings.push_back(
          {"body." + body + ".coordinates", quoted_text(to_string(Coordinates::rigid))});
    }
    changes.push_back(std::move(change));
  }
  return changes;
}

/// Whether an integrator has no advantage where there is no noise.
bool is_for_noise(const IntegratorRecord& integrator) {
  return integrator.half_step_velocities || !integrator.with_inertia;
}

Method method_of(const Scene& scene, const ModelChange& model, const IntegratorRecord& integrator,
                 NumberType number_type) {
  Method method;
  method.model = model.name;
  method.integrator = &integrator;
  method.number_type = number_type;
  method.settings = model.settings;
  method.name = model.name.empty() ? integrator.name : model.name + ", " + integrator.name;
  if (number_type != NumberType::double_precision) {
    method.name += std::string(" in ") + to_string(number_type);
  }
  if (number_type != scene.run.number_type) {
    method.settings.push_back({"run.number_type", quoted_text(to_string(number_type))});
  }
  method.resolution = integrator.adaptive ? Resolution::tolerance : Resolution::step;
  method.absolute_share = natural_units(scene).length;
  if (method.resolution == Resolution::step) method.unit = scene.run.duration;
  return method;
}

/// Binds the scene on this method: why it is refused, or how far its steps may go.
void try_to_bind(const Variants& variants, Method& method) {
  constexpr double kAnyTolerance = 1e-3;
  const bool fixed = method.resolution == Resolution::step;
  try {
    const auto scene =
        variants.with(method.at(fixed ? variants.scene().run.duration : kAnyTolerance));
    Engine engine(scene, options_to_bind());
    const double stable = stable_step_of(engine.model(), engine.context().scheme);
    if (fixed && stable > 0.0) method.stable_step = stable;
  } catch (const InputError& error) {
    method.refused = condensed(error);
  }
}

/// Adds every registered integrator on one model.
void add_methods(const Variants& variants, const ModelChange& model, NumberType number_type,
                 std::vector<Method>& methods) {
  for (const auto& integrator : variants.registry().integrators()) {
    if (integrator->follows_equilibria != (model.dynamics == Dynamics::quasistatic)) continue;
    if (is_for_noise(*integrator)) continue;
    methods.push_back(method_of(variants.scene(), model, *integrator, number_type));
    try_to_bind(variants, methods.back());
  }
}

}  // namespace

std::string Method::integrator_at(double value) const {
  std::string table = "{ type = " + quoted_text(integrator->name);
  for (const Parameter* row : resolution_rows(*integrator)) {
    const double number = is_absolute(*row) ? value * absolute_share : value;
    table += fmt::format(", {} = {}", row->key, number);
  }
  return table + " }";
}

std::vector<Setting> Method::at(double value) const {
  std::vector<Setting> all = settings;
  all.push_back({"run.integrator", integrator_at(value)});
  return all;
}

double Method::rounded(double value, int digits) const {
  return rounded_to_digits(value / unit, digits) * unit;
}

std::vector<Method> methods_for(const Variants& variants) {
  std::vector<Method> methods;
  for (const ModelChange& model : model_changes(variants.scene())) {
    add_methods(variants, model, NumberType::double_precision, methods);
  }
  return methods;
}

std::vector<Method> methods_of_own_model(const Variants& variants) {
  const RunSettings& run = variants.scene().run;
  std::vector<Method> methods;
  add_methods(variants, {"", {}, run.dynamics}, run.number_type, methods);
  return methods;
}

double rounded_to_digits(double x, int digits) {
  const std::string text = fmt::format("{:.{}e}", x, digits - 1);
  double rounded = x;
  std::from_chars(text.data(), text.data() + text.size(), rounded);
  return rounded;
}

std::string condensed(const InputError& error) {
  const std::vector<Fault>& faults = error.faults();
  if (faults.empty()) return error.what();
  const Fault& first = faults.front();
  std::string text = first.key.empty() ? first.why : first.key + ": " + first.why;
  if (faults.size() > 1) text += fmt::format(" (and {} more)", faults.size() - 1);
  return shortened(text, kLongestShownMessage);
}

}  // namespace tomlin
