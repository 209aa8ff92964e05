#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <utility>

#include "framework/model/properties.hpp"
#include "tests/support/scenes.hpp"

/// All components of this version, with one force changed.
namespace tomlin::test {

class SpoiltRegistry {
 public:
  SpoiltRegistry(const std::string& force, const ForceFactories& bind,
                 void (*change)(ForceRecord&) = nullptr) {
    for (const auto& body : standard().bodies()) registry_.add(*body);
    for (const auto& scheme : standard().integrators()) registry_.add(*scheme);
    for (const auto& valid : standard().forces()) {
      ForceRecord record = *valid;
      if (record.name == force && bind.in_double != nullptr) record.bind = bind;
      if (record.name == force && change != nullptr) change(record);
      registry_.add(std::move(record));
    }
  }

  const Registry& registry() const { return registry_; }

  /// Returns the properties that do not hold for a scene, each as "force: property".
  std::set<std::string> broken_in(const std::string& text, std::uint64_t seed = 1) const {
    std::set<std::string> failed;
    const auto scene = parse_scene(text, "test.toml", registry_);
    for (const PropertyResult& result : check_properties(*scene, {.seed = seed})) {
      if (!result.holds) failed.insert(result.force + ": " + result.property);
    }
    return failed;
  }

 private:
  Registry registry_;
};

}  // namespace tomlin::test
