#pragma once

#include <optional>
#include <string>

#include "framework/core/records/parameter.hpp"
#include "framework/scene/document.hpp"

/// The effective scene: what was read with every default filled in, as TOML.
namespace tomlin {

/// A default as it would stand in a scene; nothing for an empty value.
std::optional<Node> to_node(const ParameterValue& value);

/// Text of a value behind "key = ", on one line.
std::string value_text(const Node& value);

/// Values first, tables as [name], lists of tables as [[name]], all else in one line per key.
/// Numbers are the shortest that read back as the same bits.
std::string to_toml(const Table& document);

}  // namespace tomlin
