#include "framework/model/properties.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "framework/model/properties/force_under_test.hpp"
#include "framework/model/properties/scale.hpp"

namespace tomlin {
namespace {

constexpr properties::PropertyCheck kProperties[] = {
    &properties::conservative, &properties::not_conservative,
    &properties::exact,        &properties::quadruple,
    &properties::path,         &properties::hessian,
    &properties::stiffness,    &properties::tight,
    &properties::finite,       &properties::internal,
    &properties::not_internal, &properties::dissipative,
    &properties::friction,     &properties::friction_bound,
    &properties::balance,      &properties::flow,
    &properties::flow_repeats, &properties::heat_of_flow,
    &properties::driver,       &properties::periodic,
    &properties::rebase,       &properties::origin,
    &properties::velocity,     &properties::uses_velocity,
    &properties::time,         &properties::uses_time,
    &properties::repeatable,   &properties::its_own,
    &properties::set_and_add,  &properties::padding,
    &properties::point,        &properties::same_bits,
    &properties::number_types, &properties::digits};

/// The shortest distance between particles that follow one another.
double shortest_spacing(const Model::Body& body) {
  double shortest = 0.0;
  for (std::size_t i = 1; i < body.bound.start.size(); ++i) {
    double square = 0.0;
    for (std::size_t d = 0; d < 3; ++d) {
      const double apart = body.bound.start[i][d] - body.bound.start[i - 1][d];
      square += apart * apart;
    }
    const double distance = std::sqrt(square);
    if (distance > 0.0 && (shortest == 0.0 || distance < shortest)) shortest = distance;
  }
  return shortest;
}

/// 0 where none is declared.
double shortest_length(const Model& model) {
  double shortest = 0.0;
  const auto consider = [&](double length) {
    if (length > 0.0 && (shortest == 0.0 || length < shortest)) shortest = length;
  };
  for (const Model::Force& force : model.forces()) consider(force.diagnosis->shortest_bond());
  for (const SceneForce& force : model.scene().forces) {
    for (int axis = 0; axis < model.dimension(); ++axis) {
      consider(force.record->period(force.description.get(), axis));
    }
  }
  for (const Model::Body& body : model.bodies()) {
    consider(body.rolling_radius);
    consider(shortest_spacing(body));
  }
  return shortest;
}

/// Length of each force: the scene's shortest that is declared, or its own where that is much
/// shorter or nothing is declared. Without either it is that of the other forces; where none has
/// one, how far from the origin bodies are, but at most 1.
std::vector<double> lengths_of(const Scene& scene) {
  const double declared = shortest_length(Model(std::make_shared<Scene>(scene)));
  std::vector<double> lengths(scene.forces.size(), 0.0);
  double shortest = 0.0;
  double reach = 0.0;
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    SingleForce alone(scene, k);
    if (!alone.built() || alone.variables().empty()) continue;
    for (const SingleForce::Variable& variable : alone.variables()) {
      if (variable.axis >= 0) reach = std::max(reach, std::abs(alone.position(variable)));
    }
    lengths[k] = properties::length_of(alone, declared).value_or(declared);
    if (lengths[k] > 0.0 && (shortest == 0.0 || lengths[k] < shortest)) shortest = lengths[k];
  }
  if (shortest == 0.0) shortest = reach > 0.0 ? std::min(reach, 1.0) : 1.0;
  for (double& length : lengths) {
    if (length == 0.0) length = shortest;
  }
  return lengths;
}

}  // namespace

std::vector<PropertyResult> check_properties(const Scene& scene, const PropertyOptions& options) {
  const std::vector<double> lengths = lengths_of(scene);
  std::vector<PropertyResult> results;
  for (std::size_t k = 0; k < scene.forces.size(); ++k) {
    properties::ForceUnderTest examination(scene, k, lengths[k], options);
    if (!examination.worthwhile()) continue;
    for (const properties::PropertyCheck property : kProperties) {
      if (options.stop != nullptr && *options.stop) return results;
      if (auto result = property(examination)) results.push_back(std::move(*result));
    }
  }
  if (!results.empty()) {
    const double length = *std::min_element(lengths.begin(), lengths.end());
    if (auto result = properties::sum_of_all(scene, length, options)) {
      results.push_back(std::move(*result));
    }
  }
  return results;
}

}  // namespace tomlin
