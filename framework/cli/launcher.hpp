#pragma once

#include <memory>

#include "framework/study/sweep/process_link.hpp"

namespace tomlin {

/// This process among several that a launcher has started together, as `mpirun -n 4 tomlin sweep`.
class LaunchedProcess {
 public:
  /// Null when no launcher has started several processes. Otherwise MPI begins, for which the
  /// module beside the program is loaded: throws InputError without it, rather than let all
  /// processes do the same.
  static std::unique_ptr<LaunchedProcess> find();
  /// MPI ends.
  ~LaunchedProcess();
  LaunchedProcess(const LaunchedProcess&) = delete;
  LaunchedProcess& operator=(const LaunchedProcess&) = delete;

  const ProcessLink& link() const { return link_; }

 private:
  explicit LaunchedProcess(const ProcessLink& link) : link_(link) {}

  const ProcessLink& link_;
};

}  // namespace tomlin
