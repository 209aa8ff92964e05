#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "framework/model/model.hpp"

/// Bonds keep the images with which they start in a periodic box, however long they become. Their
/// lengths are looked at now and then, at times that do not depend on where a run was stopped.
namespace tomlin {

/// Whether a scene has a periodic side, through which images pull.
bool has_images(const Model& model);

/// Notes in `beyond`, one number for each force, which of them has a bond as long as half the box;
/// what was noted stays.
void note_long_bonds(const Model& model, const Stage<double>& stage, std::int64_t* beyond);

/// One for each force that was noted.
std::vector<std::string> warnings_of_long_bonds(const Model& model, const std::int64_t* beyond);

}  // namespace tomlin
