#include "framework/core/system/thread_team.hpp"

#include <algorithm>
#include <csignal>
#include <system_error>

#include <sched.h>

namespace tomlin {
namespace {

// A piece of work in a word: its number, how many parts it has, how many of them are taken from the
// first on and how many from the last on.
constexpr int kPartBits = 12;
constexpr std::uint64_t kPartMask = (std::uint64_t{1} << kPartBits) - 1;
constexpr std::uint64_t kOneFromTheLast = 1;
constexpr std::uint64_t kOneFromTheFirst = std::uint64_t{1} << kPartBits;
constexpr std::size_t kMostMembers = 1000;

std::uint64_t from_the_last(std::uint64_t word) { return word & kPartMask; }
std::uint64_t from_the_first(std::uint64_t word) { return (word >> kPartBits) & kPartMask; }
std::uint64_t parts_of(std::uint64_t word) { return (word >> (2 * kPartBits)) & kPartMask; }

void pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

/// Waits until a number is no longer this one, at first without sleeping.
void wait_for_change(const std::atomic<std::uint32_t>& number, std::uint32_t old) {
  constexpr int kLooks = 20'000;
  constexpr int kLooksBetweenYields = 2000;
  for (int k = 1; k <= kLooks; ++k) {
    if (number.load(std::memory_order_acquire) != old) return;
    if (k % kLooksBetweenYields == 0) {
      std::this_thread::yield();
    } else {
      pause();
    }
  }
  number.wait(old, std::memory_order_acquire);
}

/// Keeps a thread off the processor of the one that it works for, if it may use another one: on a
/// busy machine the system otherwise leaves it where it was woken up, to wait there for its turn.
class OtherProcessors {
 public:
  OtherProcessors() { known_ = sched_getaffinity(0, sizeof allowed_, &allowed_) == 0; }

  void leave(int processor) {
    if (!known_ || processor < 0 || processor != sched_getcpu()) return;
    cpu_set_t others = allowed_;
    CPU_CLR(processor, &others);
    if (CPU_COUNT(&others) > 0) sched_setaffinity(0, sizeof others, &others);
  }

 private:
  cpu_set_t allowed_{};
  bool known_ = false;
};

/// While it lives, threads are started that signals leave alone.
class WithoutSignals {
 public:
  WithoutSignals() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~WithoutSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  WithoutSignals(const WithoutSignals&) = delete;
  WithoutSignals& operator=(const WithoutSignals&) = delete;

 private:
  sigset_t before_{};
};

}  // namespace

ThreadTeam::ThreadTeam(std::size_t members) {
  const std::size_t most = std::clamp<std::size_t>(members, 1, kMostMembers);
  threads_.reserve(most - 1);
  const WithoutSignals quiet;
  try {
    while (threads_.size() + 1 < most) {
      threads_.emplace_back([this, member = threads_.size() + 1] { follow(member); });
    }
  } catch (const std::system_error&) {
    // The others do its work.
  }
  team_ = {&ThreadTeam::share, this, threads_.size() + 1};
}

ThreadTeam::~ThreadTeam() {
  ends_.store(true, std::memory_order_relaxed);
  pieces_.fetch_add(1, std::memory_order_release);
  pieces_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void ThreadTeam::share(void* threads, std::size_t parts, TeamPart part, const void* work) {
  auto& self = *static_cast<ThreadTeam*>(threads);
  self.part_ = part;
  self.work_ = work;
  self.done_.store(0, std::memory_order_relaxed);
  self.processor_.store(sched_getcpu(), std::memory_order_relaxed);
  const std::uint32_t piece = self.pieces_.load(std::memory_order_relaxed) + 1;
  self.next_.store((std::uint64_t{piece} << (3 * kPartBits)) | (parts << (2 * kPartBits)),
                   std::memory_order_release);
  self.pieces_.store(piece, std::memory_order_release);
  self.pieces_.notify_all();
  while (self.take_part(0)) {
  }
  for (std::uint32_t done = 0; (done = self.done_.load(std::memory_order_acquire)) < parts;) {
    wait_for_change(self.done_, done);
  }
}

/// Runs a part of the present piece of work, whichever it is; false where none is left. The calling
/// thread begins with the first part and the others with the last: when the same work is shared
/// again and again, each finds its own in its cache.
bool ThreadTeam::take_part(std::size_t member) {
  std::uint64_t word = next_.load(std::memory_order_acquire);
  do {
    if (from_the_first(word) + from_the_last(word) >= parts_of(word)) return false;
  } while (!next_.compare_exchange_weak(word,
                                        word + (member == 0 ? kOneFromTheFirst : kOneFromTheLast),
                                        std::memory_order_acq_rel, std::memory_order_acquire));
  part_(work_, member == 0 ? from_the_first(word) : parts_of(word) - 1 - from_the_last(word),
        member);
  const std::uint32_t done = done_.fetch_add(1, std::memory_order_acq_rel) + 1;
  if (done == parts_of(word)) done_.notify_one();
  return true;
}

void ThreadTeam::follow(std::size_t member) {
  OtherProcessors processors;
  for (;;) {
    const std::uint32_t seen = pieces_.load(std::memory_order_acquire);
    if (ends_.load(std::memory_order_relaxed)) return;
    processors.leave(processor_.load(std::memory_order_relaxed));
    while (take_part(member)) {
    }
    wait_for_change(pieces_, seen);
  }
}

std::unique_ptr<ThreadTeam> team_of(std::size_t members) {
  return members > 1 ? std::make_unique<ThreadTeam>(members) : nullptr;
}

}  // namespace tomlin
