#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "forcefields/sinusoidal_substrate.hpp"
#include "tests/forcefields/planted.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/spoilt_registry.hpp"

// The negative control of tests/properties/valid_checks.py: the same random scenes with a force
// whose derivative is wrong.

namespace tomlin::test {
namespace {

constexpr int kScenes = 400;
constexpr std::size_t kFewest = 20;  // of them with the force on what moves
/// Parts of these in which the fault is found: high above a substrate that decays there is no
/// force.
constexpr double kFewestFound = 0.95;

/// The force is one part in a hundred larger than the slope of its energy.
struct SlightlyLargerForce : SinusoidalSubstrate {
  template <class T, int D>
  static Vec<T, D> force(const Parameters<T, D>& p, const Site<T, D>& site) {
    Vec<T, D> force = SinusoidalSubstrate::force(p, site);
    for (int d = 0; d < D; ++d) force[d] = T(1.01) * force[d];
    return force;
  }
};

std::vector<std::string> valid_scenes() {
  const std::string command = std::string("python3 '") + paths::source +
                              "/tests/properties/valid_scenes.py' 0 " + std::to_string(kScenes);
  std::vector<std::string> scenes;
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string line;
  for (int c = std::fgetc(pipe.get()); c != EOF; c = std::fgetc(pipe.get())) {
    line += static_cast<char>(c);
    if (c != '\n') continue;
    if (line == "# next\n") {
      scenes.emplace_back();
    } else if (!scenes.empty()) {
      scenes.back() += line;
    }
    line.clear();
  }
  return scenes;
}

TEST(RandomFaults, AForceOfOnePercentMoreIsFoundInNearlyAllScenes) {
  const SpoiltRegistry valid("sinusoidal_substrate", {});
  const SpoiltRegistry spoilt("sinusoidal_substrate", planted<SlightlyLargerForce>);
  const std::vector<std::string> scenes = valid_scenes();
  ASSERT_EQ(scenes.size(), static_cast<std::size_t>(kScenes));
  std::size_t looked_at = 0;
  std::size_t found = 0;
  for (std::size_t k = 0; k < scenes.size(); ++k) {
    SCOPED_TRACE(scenes[k]);
    std::shared_ptr<const Scene> scene;
    try {
      scene = parse_scene(scenes[k], "test.toml", valid.registry());
      Model model(scene);
    } catch (const InputError&) {
      continue;
    }
    bool on_what_moves = false;
    for (const SceneForce& force : scene->forces) {
      if (force.record->name != "sinusoidal_substrate") continue;
      const SceneBody& body = scene->bodies[force.bodies.front()];
      const Coordinates coordinates = body.record->common(body.description.get()).coordinates;
      on_what_moves = on_what_moves || coordinates == Coordinates::particles;
    }
    // The planted force takes one amplitude for all particles.
    if (!on_what_moves || scenes[k].find("amplitude = [") != std::string::npos) continue;
    ++looked_at;
    if (!spoilt.broken_in(scenes[k]).empty()) ++found;
  }
  EXPECT_GE(looked_at, kFewest);
  EXPECT_GE(static_cast<double>(found), kFewestFound * static_cast<double>(looked_at));
}

}  // namespace
}  // namespace tomlin::test
