#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "framework/core/records/unit_system.hpp"
#include "framework/scene/scene_document.hpp"

namespace tomlin {

/// A run as it lies in its folder: what figures need of summary.json and scene.toml.
struct StoredRun {
  std::string folder;  ///< as given
  std::string name;    ///< of the folder, without what is above it
  std::string status;  ///< "finished", "interrupted", "failed"
  std::vector<std::pair<std::string, double>> parameters;  ///< resolved, in the scene's order
  /// As scene.toml has them, expressions included; empty where it cannot be read.
  std::map<std::string, std::string> written;
  std::shared_ptr<const SceneDocument> scene;  ///< scene.toml
  UnitSystem system = UnitSystem::reduced;     ///< of the scene
  /// What the scene calls the units of axes, by its keys: "length", "force".
  std::map<std::string, std::string> units;
  /// The numbers of the summary by their dotted paths, "drivers.driver.mean_force.x"; NaN where one
  /// is undefined.
  std::map<std::string, double> results;
};

/// Is this the folder of a run that has ended: is there a summary?
bool holds_run(const std::string& folder);

/// Throws InputError when the summary is none.
StoredRun read_stored_run(const std::string& folder);

/// The name under which a path finds a result: "drivers.driver.mean_force.x", or without the first
/// part. Empty: there is none, or there are several.
std::string result_name(const StoredRun& run, const std::string& path);

/// A path inside the folder.
std::string file_of(const StoredRun& run, const char* name);

}  // namespace tomlin
