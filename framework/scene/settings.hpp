#pragma once

#include <cstddef>
#include <vector>

#include "framework/scene/document.hpp"
#include "framework/scene/fault_list.hpp"
#include "framework/scene/scene.hpp"

namespace tomlin {

inline constexpr std::size_t kMostSettings = 1000;

/// Write each `--set` into the document as if it had stood in the file, in the order given.
/// Whether the key is admissible and the value fits is judged later, with the file's own.
void apply_settings(const std::vector<Setting>& settings, Table& document, FaultList& faults);

}  // namespace tomlin
