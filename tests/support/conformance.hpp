#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "framework/core/records/force.hpp"
#include "framework/core/records/integrator.hpp"
#include "framework/model/model.hpp"
#include "framework/model/properties.hpp"
#include "tests/support/random_description.hpp"
#include "tests/support/scenes.hpp"

/// Runs the checks of `tomlin check` (framework/model/properties.hpp) on many scenes of one force:
/// those of its record's example, and parameters drawn from the record's own rows on bodies of
/// every kind.
namespace tomlin::test {

/// A body in a row or a ring, neighbours about one apart, with no two particles alike.
inline std::string body_text(const std::string& name, const Arrangement& arrangement,
                             std::size_t count, double aside, Random& random) {
  const auto vector = [&](double x) {
    std::string list = "[" + digits(x + uniform(random, -0.1, 0.1));
    for (int d = 1; d < arrangement.dimension; ++d) {
      list += ", " + digits(uniform(random, -0.1, 0.1));
    }
    return list + "]";
  };
  std::string text = "[[body]]\nname = \"" + name + "\"\n";
  const std::string number = std::to_string(count);
  if (arrangement.closed) {
    const double radius = static_cast<double>(count) / 6.0 + 0.3;
    text += "type = \"ring\"\ncount = " + number + "\nradius = " + digits(radius) +
            "\ncentre = " + vector(aside) + "\n";
  } else if (arrangement.boxed) {
    text +=
        "type = \"chain\"\ncount = " + number + "\nspacing = 1.0\norigin = " + vector(aside) + "\n";
  } else {
    text += "type = \"particles\"\npositions = [";
    for (std::size_t i = 0; i < count; ++i) text += vector(aside + static_cast<double>(i)) + ", ";
    text += "]\n";
  }
  text += "particle_mass = [";
  for (std::size_t i = 0; i < count; ++i) text += digits(uniform(random, 0.5, 2.0)) + ", ";
  return text + "]\n";
}

/// The scene of an arrangement, with this force alone.
inline std::shared_ptr<const Scene> arranged(const Arrangement& arrangement,
                                             const ForceRecord& record,
                                             std::shared_ptr<const void> description,
                                             Random& random) {
  std::string text;
  if (arrangement.boxed) {
    text = "[box]\nlengths = [" + digits(arrangement.box_length());
    for (int d = 1; d < arrangement.dimension; ++d) text += ", 1.0";
    text += "]\nperiodic = [true";
    for (int d = 1; d < arrangement.dimension; ++d) text += ", false";
    text += "]\n";
  }
  text += body_text("body", arrangement, arrangement.count, 0.0, random);
  if (arrangement.rigid) text += "coordinates = \"rigid\"\n";
  if (arrangement.rigid && arrangement.dimension == 3) text += "hold = [\"rotation\"]\n";
  if (arrangement.second > 0) {
    // At some distance, so that no two particles meet.
    const double aside = static_cast<double>(arrangement.count + arrangement.second) + 1.0;
    text += body_text("other", arrangement, arrangement.second, aside, random);
  }
  if (arrangement.prescribed) {
    text += "coordinates = \"prescribed\"\nmotion = { velocity = [0.3";
    for (int d = 1; d < arrangement.dimension; ++d) text += ", 0.1";
    text += "] }\n";
  }
  const std::string scheme = record.thermostat ? "velocity_verlet" : "rk4";
  text += "[run]\nduration = 1.0\nintegrator = { type = \"" + scheme + "\", dt = 1e-3 }\n";
  auto scene = std::make_shared<Scene>(*scene_of(text));
  // No step is taken, and no scheme refuses a force for its noise.
  static const IntegratorRecord any = [] {
    IntegratorRecord rk4 = *standard().integrator("rk4");
    rk4.takes_noise = true;
    return rk4;
  }();
  if (!record.thermostat) scene->run.integrator.record = &any;
  SceneForce& force = scene->forces.emplace_back();
  force.name = record.name;
  force.record = &record;
  force.description = std::move(description);
  for (std::size_t b = 0; b < scene->bodies.size(); ++b) force.bodies.push_back(b);
  return scene;
}

/// Whether the force refuses these bodies as they stand, since particles are too large for it.
inline bool starts_too_near(const std::shared_ptr<const Scene>& scene) {
  try {
    Model model(scene);
  } catch (const InputError& error) {
    if (error.faults().front().code == FaultCode::body_invalid_coordinates) return true;
    throw;
  }
  return false;
}

/// The verified properties of a force over all scenes that it is shown.
class Conformance {
 public:
  using Seen = std::function<void(const void* description, const Arrangement&)>;

  explicit Conformance(const ForceRecord& record) : record_(record) {}

  void examine(const Scene& scene, std::uint64_t seed) {
    PropertyOptions options;
    options.displaced_states = 2;  // of each of many scenes
    options.seed = seed;
    for (const PropertyResult& result : check_properties(scene, options)) {
      if (result.type != record_.name && result.force != kAllForces) continue;
      states_[result.property] += result.states;
      if (!result.holds) where_.try_emplace(result.property, result.worst.text());
    }
    ++examined_;
  }

  /// The record's own example, with the force bound as this record binds it.
  void examine_example(std::uint64_t seed) {
    Scene scene = *scene_of(record_.example);
    for (SceneForce& force : scene.forces) {
      if (force.record->name == record_.name) force.record = &record_;
    }
    examine(scene, seed);
  }

  /// Parameters drawn for every arrangement of these numbers of particles. `seen` is called with
  /// each. Ends as soon as the property `until` is broken.
  void examine_everywhere(std::uint64_t seed, const std::vector<std::size_t>& counts,
                          const Seen& seen = nullptr, const std::string& until = {}) {
    Random random(seed);
    for (const std::size_t count : counts) {
      for (const Arrangement& arrangement : arrangements_of(record_, count)) {
        for (int draw = 0; draw < kMostDraws; ++draw) {
          const auto description = random_description(record_, arrangement, random);
          if (!description || where_.count(until) == 1) break;
          const auto scene = arranged(arrangement, record_, description, random);
          if (starts_too_near(scene)) continue;
          if (seen) seen(description.get(), arrangement);
          examine(*scene, random());
          break;
        }
      }
    }
  }

  int examined() const { return examined_; }

  /// The properties that do not hold, each with where it broke first, and those for which no scene
  /// had anything to compare.
  std::map<std::string, std::string> broken() const {
    std::map<std::string, std::string> all = where_;
    for (const auto& [property, states] : states_) {
      if (states == 0) all.try_emplace(property, "nothing could be compared anywhere");
    }
    return all;
  }

 private:
  /// Parameters are drawn this often, until particles are no nearer than they allow.
  static constexpr int kMostDraws = 20;

  const ForceRecord& record_;
  std::map<std::string, int> states_;         ///< of each property, at which it was looked at
  std::map<std::string, std::string> where_;  ///< of those that do not hold
  int examined_ = 0;
};

}  // namespace tomlin::test
