#pragma once

#include "framework/cli/arguments.hpp"

namespace tomlin {

/// `tomlin new plugin NAME [-o DIR]`: a folder with a force to start from. Throws InputError and
/// OutputError.
int new_plugin(const NewArguments& arguments);

}  // namespace tomlin
