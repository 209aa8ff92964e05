#pragma once

#include <memory>

#include "framework/run/observers/run_observer.hpp"

namespace tomlin::observers {

/// Time integrals, internal states and events of [[observer]] tables, and the results computed from
/// them at the end. Null where no observer of the scene has any.
std::unique_ptr<RunObserver> observed_integrals(const ObserverParts& parts);

}  // namespace tomlin::observers
