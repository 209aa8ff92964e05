#pragma once

#include <memory>

#include "framework/run/observer.hpp"

namespace tomlin::observers {

/// What [[observer]] tables gather along the run: integrals over the window, events, numbers of
/// their own, and what follows from them at the end. Null where none of the scene's does.
std::unique_ptr<RunObserver> observed_integrals(const ObserverParts& parts);

}  // namespace tomlin::observers
