#pragma once

#include <array>
#include <string>
#include <vector>

#include "tests/support/scenes.hpp"

/// Scenes of one body, and its shape.
namespace tomlin::test {

/// A scene of a body of this type with these keys, whose particles have unit mass, and with forces.
inline std::string one_body(const std::string& type, const std::string& keys,
                            const std::string& more = "") {
  return "[[body]]\ntype = \"" + type + "\"\n" + keys + "\nparticle_mass = 1.0\n" + more +
         "[run]\nduration = 0.1\nintegrator = { type = \"rk4\", dt = 0.01 }\n";
}

inline BodyGeometry shape_in(const Scene& scene) {
  const SceneBody& body = scene.bodies.front();
  return body.record->build(body.description.get(), scene.dimension);
}

inline BodyGeometry shape_of(const std::string& type, const std::string& keys,
                             const std::vector<Setting>& settings = {}) {
  return shape_in(*scene_of(one_body(type, keys), settings));
}

inline std::vector<IndexPair> bonds_of(const std::string& type, const std::string& keys,
                                       const std::array<double, 3>& box = {}) {
  const auto scene = scene_of(one_body(type, keys));
  const SceneBody& body = scene->bodies.front();
  return body.record->neighbours(body.description.get(), box);
}

inline std::string note_of(const std::string& type, const std::string& keys) {
  const auto scene = scene_of(one_body(type, keys));
  const SceneBody& body = scene->bodies.front();
  return body.record->note(body.description.get());
}

/// The faults of a body of this type with these keys, which begin in line 3.
inline std::vector<std::string> faults_with(const std::string& type, const std::string& keys,
                                            const std::string& more = "") {
  return briefs_of([&] { (void)scene_of(one_body(type, keys, more)); });
}

/// The mean of the particles: their centre of mass, relative to the body's centre.
inline std::vector<double> mean_of(const BodyGeometry& shape) {
  std::vector<double> mean(shape.anchor.size(), 0.0);
  for (const auto& particle : shape.relative) {
    for (std::size_t d = 0; d < mean.size(); ++d) {
      mean[d] += particle[d] / static_cast<double>(shape.relative.size());
    }
  }
  return mean;
}

/// A model's moment of inertia of a body's particles, of unit mass, about their centre.
inline double inertia_of(const std::string& type, const std::string& keys) {
  Engine engine(scene_of(one_body(type, keys)), {});
  return engine.model().bodies().front().inertia;
}

/// The effective scene of a body gives the same shape, and itself.
inline bool effective_scene_keeps(const std::string& type, const std::string& keys) {
  const auto scene = scene_of(one_body(type, keys));
  const auto again = scene_of(scene->effective_toml);
  const BodyGeometry one = shape_in(*scene);
  const BodyGeometry other = shape_in(*again);
  for (std::size_t i = 0; i < one.relative.size(); ++i) {
    if (!same_bits(one.relative[i], other.relative[i])) return false;
  }
  return one.relative.size() == other.relative.size() && same_bits(one.anchor, other.anchor) &&
         again->effective_toml == scene->effective_toml;
}

}  // namespace tomlin::test
