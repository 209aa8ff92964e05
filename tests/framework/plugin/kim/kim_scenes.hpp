#pragma once

#include <array>
#include <random>
#include <string>
#include <vector>

#include "framework/plugin/kim/kim_model.hpp"
#include "tests/framework/plugin/kim/own_models.hpp"
#include "tests/support/scenes.hpp"

/// Scenes with kim_model, whose models are those of test_model.cpp.
namespace tomlin::test {

inline const Registry& with_kim() {
  static const Registry registry = [] {
    use_own_models();
    Registry all = standard_registry();
    all.add(kim_model_record());
    return all;
  }();
  return registry;
}

inline std::shared_ptr<const Scene> kim_scene(const std::string& text,
                                              const std::vector<Setting>& settings = {}) {
  return parse_scene(text, "test.toml", with_kim(), settings);
}

using AtomPositions = std::vector<std::array<double, 3>>;

/// A simple cubic crystal, each atom displaced by up to `disorder` along each axis.
inline AtomPositions crystal(const std::array<int, 3>& cells, double spacing, double disorder,
                             unsigned seed, const std::array<double, 3>& corner = {}) {
  std::mt19937_64 random(seed);
  const auto away = [&] {
    constexpr double kSteps = 9007199254740992.0;  // 2^53
    return disorder * (2.0 * static_cast<double>(random() >> 11) / kSteps - 1.0);
  };
  AtomPositions positions;
  for (int i = 0; i < cells[0]; ++i) {
    for (int j = 0; j < cells[1]; ++j) {
      for (int k = 0; k < cells[2]; ++k) {
        const double x = corner[0] + spacing * i + away();
        const double y = corner[1] + spacing * j + away();
        const double z = corner[2] + spacing * k + away();
        positions.push_back({x, y, z});
      }
    }
  }
  return positions;
}

inline std::string list_of_positions(const AtomPositions& positions) {
  std::string list = "[";
  for (const auto& x : positions) {
    list += "[" + digits(x[0]) + ", " + digits(x[1]) + ", " + digits(x[2]) + "], ";
  }
  return list + "]";
}

/// Atoms of two species in turn, the first of them first.
inline std::string atoms(const std::string& name, const AtomPositions& positions,
                         const std::string& one, const std::string& other,
                         const std::string& more = "") {
  std::string species;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    species += "\"" + (i % 3 == 1 ? other : one) + "\", ";
  }
  return "[[body]]\nname = \"" + name + "\"\ntype = \"particles\"\nparticle_mass = 39.948\n" +
         more + "species = [" + species + "]\npositions = " + list_of_positions(positions) + "\n";
}

inline std::string box_of(const std::array<double, 3>& lengths, const std::string& periodic) {
  return "[box]\nlengths = [" + digits(lengths[0]) + ", " + digits(lengths[1]) + ", " +
         digits(lengths[2]) + "]\nperiodic = " + periodic + "\n";
}

inline std::string kim_force(const std::string& model, const std::string& bodies) {
  return "[[force]]\ntype = \"kim_model\"\nbodies = " + bodies + "\nmodel = \"" + model + "\"\n";
}

inline const std::string kMetal = "[scene]\nunits = \"metal\"\n";
inline const std::string kShortRun = "[run]\nduration = 0.1\nintegrator = " + verlet(0.001) + "\n";

}  // namespace tomlin::test
