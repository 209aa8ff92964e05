#pragma once

#include <memory>
#include <string>

#include "framework/core/records/registry.hpp"
#include "framework/scene/document.hpp"
#include "framework/scene/fault_list.hpp"
#include "framework/scene/scene.hpp"

namespace tomlin {

/// The checked scene that a document describes, its settings already in it. Throws InputError with
/// every fault found.
std::shared_ptr<const Scene> read_document(const Table& document, const std::string& file,
                                           const Source& source, const Registry& registry,
                                           FaultList& faults, EffectiveText text);

}  // namespace tomlin
