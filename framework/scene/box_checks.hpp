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

/// True when the box was read without faults and has the scene's dimension.
bool check_box(const BoxSettings& box, const TableReading& reading, std::optional<int> dimension,
               FaultList& faults);

/// Along the periodic axes of a valid box each force's period divides the length. Forces with
/// faults are left out.
void check_box_periods(const BoxSettings& box, const TableReading& reading,
                       const std::vector<ForceDraft>& forces, FaultList& faults);

/// A body of a lattice that ends at a side of the box, nearer to its image than two bonds, is one
/// that the box should repeat and cuts: its bonds through the side would be stretched or lost.
void check_box_bodies(const BoxSettings& box, const TableReading& reading,
                      const std::vector<BodyDraft>& bodies, int dimension, FaultList& faults);

}  // namespace tomlin
