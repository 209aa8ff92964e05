#pragma once

#include <optional>
#include <vector>

#include "framework/scene/checks.hpp"
#include "framework/scene/fault_list.hpp"
#include "framework/scene/scene.hpp"
#include "framework/scene/table_reader.hpp"

namespace tomlin {

/// A period divides a length when that many times the length it is off by no more.
inline constexpr double kPeriodTolerance = 1e-9;

/// The box has the scene's dimension, and along its periodic axes each force's period divides its
/// length. Forces with faults are left out.
void check_box(const BoxSettings& box, const TableReading& reading,
               const std::vector<ForceDraft>& forces, std::optional<int> dimension,
               FaultList& faults);

}  // namespace tomlin
