#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/text/fault.hpp"
#include "framework/scene/document.hpp"
#include "framework/scene/libraries.hpp"
#include "framework/scene/scene.hpp"
#include "framework/scene/sweep_settings.hpp"

namespace tomlin {

/// The text of a scene, parsed once, which can be read with other values as often as is needed.
/// What is wrong with the file or its syntax is kept, and thrown when a scene is asked for.
class SceneDocument {
 public:
  explicit SceneDocument(const std::string& file);
  SceneDocument(std::string text, std::string file);

  const std::string& text() const { return text_; }
  /// Null where the text has no valid syntax.
  const Table* contents() const { return contents_ ? &*contents_ : nullptr; }
  /// The libraries that it names, which are to be loaded before it is read.
  std::vector<NamedLibrary> libraries() const;
  /// Its `[sweep]`; nothing where there is none. Adds every fault found in it. Throws InputError
  /// where the text has no valid syntax.
  std::optional<SweepSettings> sweep(std::vector<Fault>& found) const;
  /// Takes `[sweep]` out, which is otherwise checked whenever the scene is read.
  void drop_sweep();
  /// The checked scene with these settings. Throws InputError with every fault found.
  std::shared_ptr<const Scene> read(const Registry& registry,
                                    const std::vector<Setting>& settings = {}) const;

 private:
  std::string file_;
  std::string text_;
  std::optional<Table> contents_;
  std::optional<InputError> fault_;  ///< why there are no contents
};

}  // namespace tomlin
