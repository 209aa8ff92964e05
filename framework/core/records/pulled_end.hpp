#pragma once

#include <vector>

#include "framework/core/numbers/double_double.hpp"

namespace tomlin {

/// What a force is, too, whose pulled end can start elsewhere than its description says: where the
/// end of another run's driver has come to.
class PulledEnd {
 public:
  virtual ~PulledEnd() = default;
  /// From where the description starts it, along each axis, at a time that is no earlier than its
  /// last change of velocity.
  virtual std::vector<DoubleDouble> travelled(const DoubleDouble& time) const = 0;
  /// At time 0 it has travelled so far already. Before start_control().
  virtual void begin_at(const std::vector<DoubleDouble>& travel) = 0;

 protected:
  PulledEnd() = default;
};

}  // namespace tomlin
