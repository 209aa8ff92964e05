/// A library that stands between the program and the system (LD_PRELOAD). It counts the calls that
/// change files, and lets the one that is asked for go wrong:
///   FAILING_CALLS_AT=N        which one, from 1
///   FAILING_CALLS_HOW=        "error": it fails; "half": it fails, if it writes after half of it,
///                             and so does every later one; "kill": the program is killed before
///                             it; "stop": the program gets a SIGTERM before it
///   FAILING_CALLS_ERROR=E     errno of the failure; no space by default
///   FAILING_CALLS_COUNT=FILE  gets the number of calls at the end
///   FAILING_CALLS_OPEN=NAME   only calls that open a file of this name count, for reading too
///   FAILING_CALLS_FLOCK=E     errno of every flock(), and nothing is locked
/// fsync() counts and fails, but never waits: nothing here survives a power cut anyway.
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <utility>

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

namespace {

constexpr int kStandardStreams = 3;

long asked_for(const char* name) {
  const char* text = std::getenv(name);
  return text != nullptr ? std::strtol(text, nullptr, 10) : 0;
}

bool how(const char* way) {
  const char* text = std::getenv("FAILING_CALLS_HOW");
  return text != nullptr && std::strcmp(text, way) == 0;
}

long g_calls = 0;

/// "mg/sweep.journal" is a file of the name "sweep.journal".
bool is_named(const char* path, const char* name) {
  const size_t length = std::strlen(path);
  const size_t of_name = std::strlen(name);
  return length >= of_name && std::strcmp(path + length - of_name, name) == 0;
}

/// Whether the call that is about to be made fails; it may not even be reached. `opened` is the
/// path of a file that it opens.
bool fails(const char* opened = nullptr) {
  static const char* const only = std::getenv("FAILING_CALLS_OPEN");
  if (only != nullptr && (opened == nullptr || !is_named(opened, only))) return false;
  static const long at = asked_for("FAILING_CALLS_AT");
  ++g_calls;
  if (at == 0 || g_calls < at) return false;
  if (how("kill")) ::kill(::getpid(), SIGKILL);
  if (how("stop")) {
    if (g_calls == at) ::kill(::getpid(), SIGTERM);
    return false;
  }
  if (g_calls > at && how("error")) return false;
  const long error = asked_for("FAILING_CALLS_ERROR");
  errno = error != 0 ? static_cast<int>(error) : ENOSPC;
  return true;
}

/// Half of the first write that fails gets through, if that was asked for.
bool half_is_left(size_t size) {
  static bool done = false;
  return how("half") && size > 1 && !std::exchange(done, true);
}

template <class Function>
Function* real(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

struct Count {
  ~Count() {
    const char* file = std::getenv("FAILING_CALLS_COUNT");
    if (file == nullptr) return;
    if (std::FILE* out = std::fopen(file, "w")) {
      std::fprintf(out, "%ld\n", g_calls);
      std::fclose(out);
    }
  }
} g_count;

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  mode_t mode = 0;
  if ((flags & O_CREAT) != 0) {
    va_list arguments;
    va_start(arguments, flags);
    mode = va_arg(arguments, mode_t);
    va_end(arguments);
  }
  static const bool reads_count = std::getenv("FAILING_CALLS_OPEN") != nullptr;
  if ((reads_count || (flags & O_ACCMODE) != O_RDONLY) && fails(path)) return -1;
  return real<int(const char*, int, ...)>("open")(path, flags, mode);
}

ssize_t write(int file, const void* data, size_t size) {
  static auto* const next = real<ssize_t(int, const void*, size_t)>("write");
  if (file < kStandardStreams || !fails()) return next(file, data, size);
  return half_is_left(size) ? next(file, data, size / 2) : -1;
}

ssize_t pwrite(int file, const void* data, size_t size, off_t offset) {
  static auto* const next = real<ssize_t(int, const void*, size_t, off_t)>("pwrite");
  if (!fails()) return next(file, data, size, offset);
  return half_is_left(size) ? next(file, data, size / 2, offset) : -1;
}

int fsync(int file) {
  (void)file;
  return fails() ? -1 : 0;
}

int flock(int file, int operation) noexcept {
  static const long error = asked_for("FAILING_CALLS_FLOCK");
  if (error == 0) return real<int(int, int)>("flock")(file, operation);
  errno = static_cast<int>(error);
  return -1;
}

int ftruncate(int file, off_t length) noexcept {
  if (fails()) return -1;
  return real<int(int, off_t)>("ftruncate")(file, length);
}

int rename(const char* from, const char* to) noexcept {
  if (fails()) return -1;
  return real<int(const char*, const char*)>("rename")(from, to);
}

int unlink(const char* path) noexcept {
  if (fails()) return -1;
  return real<int(const char*)>("unlink")(path);
}

int mkdir(const char* path, mode_t mode) noexcept {
  if (fails()) return -1;
  return real<int(const char*, mode_t)>("mkdir")(path, mode);
}

}  // extern "C"
