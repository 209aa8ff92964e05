#pragma once

#include <memory>

#include "framework/run/run.hpp"

namespace tomlin {

/// Fewer digits than this shared by runs from starts that hardly differ: the result is called not
/// determined.
inline constexpr double kDigitsOfADeterminedResult = 3.0;

/// `[run] perturb`: repeats the run from starts with noise (one stream of the scene's seed a
/// repeat) and adds to the result how far its observables are determined, with a warning for each
/// that is not. Throws InputError for an observable that there is not.
///
/// Quasistatic runs are repeated twice at least, since the steady forces that disturb them are
/// opposite in pairs, and each under half the force as well: results are extrapolated to none.
void determine(const std::shared_ptr<const Scene>& scene, const RunOptions& options,
               RunResult& result);

}  // namespace tomlin
