#pragma once

#include <cstddef>

namespace tomlin {

/// How processes that a launcher has started together send each other bytes. Plain, since it is the
/// border to a module that is loaded (mpi/module.cpp), and since tests put threads in the place of
/// processes. Messages between two processes arrive in their order. Its functions are called from
/// several threads, one at a time.
struct ProcessLink {
  unsigned format = 0;  ///< kProcessLinkFormat
  int rank = 0;         ///< of this process: 0 to size - 1
  int size = 1;
  void* context = nullptr;  ///< the first argument of the functions
  /// Returns when `bytes` may be changed.
  void (*send)(void* context, int to, const void* bytes, std::size_t size) = nullptr;
  /// The size of a message that has come, and where from; negative when there is none. Never waits.
  std::ptrdiff_t (*poll)(void* context, int* from) = nullptr;
  /// Takes the message that poll() has shown.
  void (*receive)(void* context, int from, void* bytes, std::size_t size) = nullptr;
  /// Called once in each process, at the end; waits for the others.
  void (*end)(void* context) = nullptr;
};

inline constexpr unsigned kProcessLinkFormat = 1;

/// What the module defines under the name kProcessLinkFunction. Where it fails, it returns null and
/// writes why.
using ProcessLinkFunction = const ProcessLink* (*)(char* why, std::size_t size);
inline constexpr const char* kProcessLinkFunction = "tomlin_process_link";

}  // namespace tomlin
