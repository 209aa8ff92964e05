#pragma once

#include <string>
#include <vector>

#include "framework/plot/stored_run.hpp"

namespace tomlin {

/// What to call each run among the others: by the parameters in which it differs from them,
/// "lambda = 0.1", as the scenes have them: one that only follows from others, by the same
/// expression everywhere, is left out. A run that this does not tell from the others goes by the
/// name of its folder, or else by its path. One run alone needs no label and gets "".
std::vector<std::string> curve_labels(const std::vector<StoredRun>& runs);

}  // namespace tomlin
