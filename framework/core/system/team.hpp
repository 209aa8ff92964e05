#pragma once

#include <cstddef>

#include "framework/core/numbers/target.hpp"
#include "framework/core/system/stage.hpp"

/// Loops over particles that several threads share. The bits of a result do not depend on their
/// number, since each particle's numbers are computed by one thread from what all can read.
namespace tomlin {

/// A piece of work: parts from 0 on, each for whichever member takes it.
using TeamPart = void (*)(const void* work, std::size_t part, std::size_t member);

/// Threads that share work, as kernels see them; see ThreadTeam.
struct Team {
  /// Calls `part` for each of so many parts once, and returns when all have returned. Called by one
  /// thread at a time, which takes parts itself as member 0.
  void (*share)(void* threads, std::size_t parts, TeamPart part, const void* work) = nullptr;
  void* threads = nullptr;
  std::size_t members = 1;
};

inline namespace TOMLIN_TARGET {

/// Loop that `in_parts` hands to the members of a team.
template <class Use>
struct SharedLoop {
  Use use;
  std::size_t groups = 0;
  std::size_t parts = 1;

  TOMLIN_FLATTEN static void run(const void* work, std::size_t part, std::size_t member) {
    // A copy, which no store to memory can change.
    const SharedLoop loop = *static_cast<const SharedLoop*>(work);
    loop.use(loop.groups * part / loop.parts * kGroup,
             loop.groups * (part + 1) / loop.parts * kGroup, member);
  }
};

/// use(begin, end, member) for ranges of particles that come to [0, count) with its padding; each
/// begins and ends at a whole group. Few particles, and all without a team, are one range. `use`
/// captures by value.
template <class Use>
void in_parts(const Team* team, std::size_t count, const Use& use) {
  constexpr std::size_t kLeastGroups = 16;    // are worth a part: some ten microseconds
  constexpr std::size_t kPartsOfAMember = 4;  // of which a slow one takes fewer
  SharedLoop<Use> loop{use, (count + kGroup - 1) / kGroup};
  if (team != nullptr) {
    const std::size_t most = kPartsOfAMember * team->members;
    const std::size_t parts = loop.groups / kLeastGroups;
    loop.parts = parts > most ? most : parts > 1 ? parts : 1;
  }
  if (loop.parts == 1) {
    SharedLoop<Use>::run(&loop, 0, 0);
  } else {
    team->share(team->threads, loop.parts, &SharedLoop<Use>::run, &loop);
  }
}

}  // namespace TOMLIN_TARGET
}  // namespace tomlin
