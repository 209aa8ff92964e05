#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "framework/core/text/fault_code.hpp"

namespace tomlin {

/// A finding that neither refuses a scene nor ends a run, and limits what results mean. Its code is
/// one of a warning or, where it announces that a run would be refused, that of the refusal.
struct Warning {
  FaultCode code;
  std::string text;
  /// Subject: a key of the scene ("body.tip.velocity"), a component ("force.bonds"), or
  /// results ("drivers.driver", "bodies.tip"); empty for the run as a whole.
  std::string key = {};
};

/// `TEXT [CODE]`
std::string to_string(const Warning& warning);

/// The two lists of the outputs, in the same order.
std::vector<std::string> texts_of(const std::vector<Warning>& warnings);
std::vector<std::string_view> codes_of(const std::vector<Warning>& warnings);

}  // namespace tomlin
