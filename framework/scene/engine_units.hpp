#pragma once

#include "framework/core/records/parameter.hpp"
#include "framework/core/records/unit_system.hpp"

/// Values of scenes in the engine's units, and back. `unit` is scene_unit() of the row's dimension.
namespace tomlin {

/// The numbers of a value in the engine's units. Indices, words, formulas, and levels that an
/// observable passes stay as they are.
ParameterValue in_engine_units(ParameterValue value, double unit);

/// Whether a row's interval holds them there, too: the smallest numbers may have become 0.
bool contains_all(const Interval& interval, const ParameterValue& value);

/// The number as a scene has it: one that is read back as the same bits, of several that with the
/// fewest digits.
double scene_number(double number, double unit);
ParameterValue in_scene_units(ParameterValue value, double unit);

}  // namespace tomlin
