#pragma once

#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "framework/core/records/parameter.hpp"
#include "framework/run/results/results.hpp"
#include "framework/scene/document.hpp"
#include "framework/scene/effective.hpp"
#include "framework/scene/scene.hpp"

/// Conversion of a scene to other units, by the dimensions that its records declare.
namespace tomlin::test {

/// One unit of the scene in the new ones.
struct Units {
  double mass = 1.0;
  double length = 1.0;
  double time = 1.0;

  double of(const Dimension& dimension) const {
    const auto power = [](double x, int n) {
      double result = 1.0;
      for (int k = 0; k < std::abs(n); ++k) result = n < 0 ? result / x : result * x;
      return result;
    };
    const int energies = dimension.temperature;
    return power(mass, dimension.mass + energies) * power(length, dimension.length + 2 * energies) *
           power(time, dimension.time - 2 * energies);
  }
};

inline Node times(Node node, double factor) {
  if (auto* number = node.as<double>()) *number *= factor;
  if (const auto* integer = node.as<std::int64_t>()) {
    return {static_cast<double>(*integer) * factor, {}};
  }
  if (auto* list = node.as<List>()) {
    for (Node& element : *list) element = times(element, factor);
  }
  return node;
}

/// `--set` of all that has a dimension. Formulas and what waits for observables are not translated;
/// of the integrator only what the scene gives (a list of keys).
inline std::vector<Setting> in_units(const Scene& scene, const Units& units,
                                     const std::vector<std::string>& given_of_integrator = {}) {
  std::vector<Setting> settings;
  const auto set = [&](const std::string& path, double value) {
    settings.push_back({path, value_text({value, {}})});
  };
  const auto translate = [&](const std::string& prefix, const auto& component, const auto& wanted) {
    for (const Parameter& row : component.record->parameters) {
      if (row.dimension == dimension::none || !wanted(row)) continue;
      const auto value = to_node(row.read(component.description.get()));
      if (!value) continue;
      settings.push_back(
          {prefix + "." + row.key, value_text(times(*value, units.of(row.dimension)))});
    }
  };
  const auto all = [](const Parameter&) { return true; };
  for (const SceneBody& body : scene.bodies) translate("body." + body.name, body, all);
  for (const SceneForce& force : scene.forces) translate("force." + force.name, force, all);
  translate("run.integrator", scene.run.integrator, [&](const Parameter& row) {
    return std::find(given_of_integrator.begin(), given_of_integrator.end(), row.key) !=
           given_of_integrator.end();
  });
  set("run.duration", scene.run.duration * units.time);
  if (scene.run.until && scene.run.until->max) {
    set("run.until.max", *scene.run.until->max * units.time);
  }
  if (scene.measure.unit == MeasureSettings::Unit::time) {
    set("measure.from", scene.measure.from * units.time);
    if (scene.measure.to) set("measure.to", *scene.measure.to * units.time);
  }
  if (scene.measure.period) set("measure.period", *scene.measure.period * units.length);
  if (scene.output.every) set("output.every", *scene.output.every * units.time);
  if (!scene.box.lengths.empty()) {
    List lengths;
    for (const double x : scene.box.lengths) lengths.push_back({x * units.length, {}});
    settings.push_back({"box.lengths", value_text({lengths, {}})});
  }
  return settings;
}

/// The dimension of a result, as its row declares it.
inline Dimension dimension_of_result(std::string_view path) {
  const ResultQuantity* row = quantity_at(path);
  return row == nullptr ? dimension::none : row->dimension;
}

}  // namespace tomlin::test
