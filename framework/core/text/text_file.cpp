#include "framework/core/text/text_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tomlin {
namespace {

TextFile refused(std::string why) { return {"", std::move(why)}; }

TextFile unreadable(int error) {
  return refused("the file cannot be read: " + std::generic_category().message(error));
}

/// Why it is no file that can be read to its end; empty when it is one.
std::string other_than_file(const struct stat& status) {
  if (S_ISREG(status.st_mode)) return "";
  if (S_ISDIR(status.st_mode)) return "a directory, where a file is expected";
  if (S_ISFIFO(status.st_mode)) return "a pipe, where a file is expected";
  return "a device or a socket, where a file is expected";
}

/// Reads to the end, but no further than a byte beyond what is allowed: what /proc holds has no
/// size beforehand.
TextFile contents_of(int descriptor, std::size_t size, std::size_t most_bytes) {
  constexpr std::size_t kBlock = std::size_t{1} << 16;
  TextFile file;
  std::size_t length = 0;
  file.text.resize(std::min(size, most_bytes) + 1);
  while (true) {
    const ssize_t got = ::read(descriptor, file.text.data() + length, file.text.size() - length);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return unreadable(errno);
    length += static_cast<std::size_t>(got);
    if (length > most_bytes) return {"", "", true};
    if (got == 0) break;
    if (length == file.text.size()) file.text.resize(std::min(length + kBlock, most_bytes + 1));
  }
  file.text.resize(length);
  return file;
}

}  // namespace

TextFile read_text_file(const std::filesystem::path& path, std::size_t most_bytes) {
  struct stat status = {};
  // Looked at before it is opened, and once more when nobody can exchange it any more.
  if (::stat(path.c_str(), &status) != 0) {
    if (errno == ENOENT) return refused("there is no such file");
    return unreadable(errno);
  }
  if (std::string why = other_than_file(status); !why.empty()) return refused(std::move(why));
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (descriptor < 0) return unreadable(errno);
  TextFile file;
  if (::fstat(descriptor, &status) != 0) {
    file = unreadable(errno);
  } else if (std::string why = other_than_file(status); !why.empty()) {
    file = refused(std::move(why));
  } else if (static_cast<std::uintmax_t>(status.st_size) > most_bytes) {
    file.too_large = true;
  } else {
    file = contents_of(descriptor, static_cast<std::size_t>(status.st_size), most_bytes);
  }
  ::close(descriptor);
  return file;
}

}  // namespace tomlin
