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

/// The parameters in which runs differ, as curve_labels() has them.
std::vector<std::string> differing_parameters(const std::vector<StoredRun>& runs);

/// Null when the run has no such parameter.
const double* parameter_of(const StoredRun& run, const std::string& parameter);

/// The runs in the order of the values of the parameters in which they differ; those that do not
/// differ stay in the order given.
std::vector<StoredRun> in_order_of_parameters(std::vector<StoredRun> runs);

/// "k = 2, v = 0.1": these parameters of a run, as far as it has them.
std::string label_of(const StoredRun& run, const std::vector<std::string>& parameters);

}  // namespace tomlin
