#pragma once

#include <cstddef>

#include "framework/core/records/bound_force.hpp"
#include "framework/core/system/team.hpp"

namespace tomlin {

/// The kernel of a force on the particles of a body, shared by a team. The force does no work of
/// its own that is integrated: it has no rate.
template <class Real>
class SharedSites {
 public:
  /// A pass of such a force by its team from now on; `this` outlives it.
  void share(Pass<Real>& pass, const Team& team) {
    const auto* const all = static_cast<const SiteArguments<Real>*>(pass.arguments);
    work_ = {&team, pass.set, pass.add, all};
    if (pass.set != nullptr) pass.set = &run<true>;
    pass.add = &run<false>;
    pass.arguments = &work_;
    pass.lanes = {};
  }

 private:
  struct Work {
    const Team* team = nullptr;
    Kernel<Real> set = nullptr;
    Kernel<Real> add = nullptr;
    const SiteArguments<Real>* all = nullptr;
  };

  template <bool set>
  static void run(const void* arguments, const Stage<Real>& stage_of_all) {
    const Work& given = *static_cast<const Work*>(arguments);
    in_parts(given.team, given.all->body.count,
             [work = given, stage = stage_of_all](std::size_t begin, std::size_t end, std::size_t) {
               SiteArguments<Real> part = *work.all;
               const std::size_t count = part.body.count;
               part.body.offset += begin;
               part.body.count = (end < count ? end : count) - begin;
               if (part.each != nullptr) part.each += begin;
               if (part.start != nullptr) part.start += begin;
               (set ? work.set : work.add)(&part, stage);
             });
  }

  Work work_;
};

}  // namespace tomlin
