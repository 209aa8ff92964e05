#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/records/fetched_numbers.hpp"
#include "framework/core/text/fault.hpp"
#include "framework/scene/document.hpp"
#include "framework/scene/libraries.hpp"
#include "framework/scene/scene.hpp"
#include "framework/scene/sweep_settings.hpp"

namespace tomlin {

/// The text of a scene, parsed once, which can be read with other values as often as is needed.
/// Errors of the file or its syntax are kept, and thrown when a scene is asked for. Files
/// that scenes name are those of `[sweep] files`, and otherwise those of the disk.
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
  /// From now on every file that a scene names is read once and kept, for this object alone.
  void keep_files();
  /// Texts of files by their names: those of `[sweep] files`, and those that are kept of
  /// scenes that were accepted.
  std::map<std::string, std::string> files() const;
  /// The document with these settings. Throws InputError with every fault of theirs.
  Table with(const std::vector<Setting>& settings) const;
  /// The checked scene with these settings. Throws InputError with every fault found.
  std::shared_ptr<const Scene> read(const Registry& registry,
                                    const std::vector<Setting>& settings = {},
                                    EffectiveText text = EffectiveText::written) const;

 private:
  void parse();

  std::string file_;
  std::string text_;
  std::optional<Table> contents_;
  std::shared_ptr<FileTexts> texts_;  ///< null: there are none, and none are kept
  std::optional<InputError> fault_;   ///< why there are no contents
};

}  // namespace tomlin
