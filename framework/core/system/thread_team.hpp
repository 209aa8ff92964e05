#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

#include "framework/core/system/team.hpp"

namespace tomlin {

/// The threads of a Team, which live as long as this does. Between two pieces of work they look out
/// for the next one for some tenths of a millisecond and then sleep. One that is late is not waited
/// for: the others take its parts. Sharing allocates nothing.
class ThreadTeam {
 public:
  /// So many members, of whom the calling thread is one; fewer where the system starts no more.
  explicit ThreadTeam(std::size_t members);
  ~ThreadTeam();
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;

  std::size_t members() const { return team_.members; }
  const Team& team() const { return team_; }

 private:
  static void share(void* threads, std::size_t parts, TeamPart part, const void* work);
  void follow(std::size_t member);
  bool take_part(std::size_t member);

  // Apart, as each is written by others than the next.
  static constexpr std::size_t kApart = 64;

  TeamPart part_ = nullptr;  ///< of the present piece of work; stays until all parts are done
  const void* work_ = nullptr;
  /// Number of the piece of work, number of its parts, how many of the first and of the last are
  /// taken: 28 bits, and 12 each.
  alignas(kApart) std::atomic<std::uint64_t> next_{0};
  alignas(kApart) std::atomic<std::uint32_t> done_{0};    ///< parts
  alignas(kApart) std::atomic<std::uint32_t> pieces_{0};  ///< of work so far; the last is the end
  std::atomic<bool> ends_{false};
  std::atomic<int> processor_{-1};  ///< that the calling thread was on
  Team team_;
  std::vector<std::thread> threads_;
};

/// A team of so many; null for one, which needs none.
std::unique_ptr<ThreadTeam> team_of(std::size_t members);

}  // namespace tomlin
