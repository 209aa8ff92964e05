#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "framework/scene/scene.hpp"

namespace tomlin {

/// The text of a scene with settings written into it as a person would: values are replaced where
/// they stand, what is absent becomes a new line of its table, and everything else stays as it is,
/// comments too. Keys of a table that a setting replaces are turned into comments. Throws
/// InputError where the text cannot be edited so; whether the result means the same is for the
/// caller to see.
std::string edited(std::string_view text, const std::string& file,
                   const std::vector<Setting>& settings);

}  // namespace tomlin
