#pragma once

#include "framework/core/system/team.hpp"

namespace tomlin {

/// Further interface of forces whose evaluations several threads can share.
class SharesWork {
 public:
  virtual ~SharesWork() = default;
  /// Before its passes are asked for; the team outlives the force.
  virtual void share_with(const Team& team) = 0;

 protected:
  SharesWork() = default;
};

}  // namespace tomlin
