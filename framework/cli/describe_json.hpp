#pragma once

#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "framework/cli/described.hpp"
#include "framework/scene/language.hpp"

/// Output of `tomlin describe --json`.
namespace tomlin {

nlohmann::ordered_json component_json(const Described& component);
nlohmann::ordered_json kind_json(const KindNames& kind, const std::vector<Described>& all);
nlohmann::ordered_json table_json(const SceneTable& table);
nlohmann::ordered_json results_json();
/// Everything in a line each.
nlohmann::ordered_json list_json(const std::vector<Described>& all,
                                 const std::vector<SceneTable>& tables);

}  // namespace tomlin
