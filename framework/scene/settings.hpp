#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "framework/scene/document.hpp"
#include "framework/scene/fault_list.hpp"
#include "framework/scene/scene.hpp"

namespace tomlin {

/// A dotted path at its dots.
std::vector<std::string> parts_of(std::string_view path);

/// A component's name in the file, or its type's.
std::string name_of(const Table& component);

inline constexpr std::size_t kMostSettings = 1000;

/// Write each `--set` into the document as if it had stood in the file, in the order given.
/// Whether the key is admissible and the value fits is judged later, with the file's own.
void apply_settings(const std::vector<Setting>& settings, Table& document, FaultList& faults);

}  // namespace tomlin
