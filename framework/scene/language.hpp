#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "framework/core/parameter.hpp"
#include "framework/core/registry.hpp"

/// The scene language as tables: which keys each table of a scene takes, and what the language
/// names but this version does not have yet. To switch a feature on, move its line.
namespace tomlin {

inline constexpr const char* kNotInThisVersion = "not in this version";

/// What one table of a scene takes.
struct TableLayout {
  std::vector<std::string> own_keys;  ///< read by the scene reader itself, e.g. name and type
  std::vector<Parameter> rows;
  std::vector<ReservedKey> reserved;

  /// Every admissible key, in the order of the effective scene.
  std::vector<std::string> keys() const;
  const Parameter* row(std::string_view key) const;
  const ReservedKey* reserved_key(std::string_view key) const;
};

// The rows of these assign members of Scene, RunSettings, MeasureSettings and OutputSettings.
TableLayout scene_layout();
TableLayout run_layout();
TableLayout measure_layout();
TableLayout output_layout();

// The rows of these assign members of the component's description.
TableLayout body_layout(const BodyRecord& record);
TableLayout force_layout(const ForceRecord& record);
TableLayout integrator_layout(const IntegratorRecord& record);

/// scene, parameters, body, force, run, measure, output: the tables of a scene, in the order of
/// the effective scene.
const std::vector<std::string>& top_level_keys();
const std::vector<ReservedKey>& reserved_top_level_keys();

/// Types that the language names. What is registered is not looked up here.
bool is_later_type(std::string_view kind, std::string_view type);

/// Words that a summary uses beside the names of bodies and forces.
bool is_word_of_summary(std::string_view name);

}  // namespace tomlin
