#pragma once

#include <memory>
#include <string>
#include <vector>

#include "framework/core/records/registry.hpp"
#include "framework/scene/scene.hpp"
#include "framework/scene/scene_document.hpp"

namespace tomlin {

/// A scene that is read again and again with a few of its values replaced; its text is parsed once.
class Variants {
 public:
  /// The registry must outlive this.
  Variants(std::shared_ptr<const Scene> scene, const Registry& registry)
      : scene_(std::move(scene)),
        document_(scene_->effective_toml, scene_->file),
        registry_(registry) {}

  const Scene& scene() const { return *scene_; }
  const Registry& registry() const { return registry_; }

  /// The scene with these settings, as `--set` has them. Throws InputError.
  std::shared_ptr<const Scene> with(const std::vector<Setting>& settings) const {
    return document_.read(registry_, settings);
  }
  /// The scene itself, with nothing but the integrator replaced by this table of a scene. Throws
  /// InputError.
  std::shared_ptr<const Scene> with_integrator(const std::string& table) const {
    auto result = std::make_shared<Scene>(*scene_);
    result->run.integrator = with({{"run.integrator", table}})->run.integrator;
    return result;
  }

 private:
  std::shared_ptr<const Scene> scene_;
  SceneDocument document_;
  const Registry& registry_;
};

}  // namespace tomlin
