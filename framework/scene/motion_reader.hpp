#pragma once

#include <optional>
#include <string>

#include "framework/scene/document.hpp"
#include "framework/scene/fault_list.hpp"
#include "framework/scene/motion.hpp"
#include "framework/scene/parameter_table.hpp"

namespace tomlin {

/// `motion = { velocity = [..], angular_velocity = .. }`, where `key` names it in messages. A
/// velocity that is not given stays empty: how long it is to be is not known here. Nothing when
/// the motion is unfit, and reported.
std::optional<Motion> read_motion(const Node& node, const std::string& key,
                                  const ParameterTable& parameters, FaultList& faults);

/// A motion as the effective scene has it: what was given, and zeros for the rest.
Table effective_motion(const Table& given, int dimension);

}  // namespace tomlin
