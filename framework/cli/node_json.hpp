#pragma once

#include <nlohmann/json.hpp>

#include "framework/scene/document.hpp"

namespace tomlin {

/// A value of a scene as JSON; null for a date.
nlohmann::ordered_json json_of(const Node& node);

}  // namespace tomlin
