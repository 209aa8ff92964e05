#include "framework/output/lock_file.hpp"

#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstddef>
#include <span>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/types.h>
#include <unistd.h>

#include "framework/output/output_file.hpp"

namespace tomlin {
namespace {

std::string name_of_this_machine() {
  std::array<char, 256> name = {};
  ::gethostname(name.data(), name.size() - 1);
  return name.data();
}

/// Who has made a lock file: a process and its machine.
struct Holder {
  pid_t process = 0;
  std::string machine;

  /// Whether the process that wrote the file has ended; false where this cannot be known.
  bool has_ended() const {
    return process > 0 && machine == name_of_this_machine() && ::kill(process, 0) != 0 &&
           errno == ESRCH;
  }
};

/// "process 12 on host", as the file says it.
std::string text_of(const Holder& holder) {
  return fmt::format("process {} on {}", holder.process, holder.machine);
}

std::string text_in(const std::filesystem::path& file) {
  const Descriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW));
  std::array<char, 512> text = {};
  const auto bytes = std::as_writable_bytes(std::span(text));
  const std::ptrdiff_t size = descriptor.open() ? read_at(descriptor, bytes, 0) : 0;
  return {text.data(), static_cast<std::size_t>(size > 0 ? size : 0)};
}

Holder holder_in(std::string_view text) {
  constexpr std::string_view kBefore = "process ";
  constexpr std::string_view kBetween = " on ";
  Holder holder;
  if (!text.starts_with(kBefore)) return holder;
  text.remove_prefix(kBefore.size());
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), holder.process);
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  if (error != std::errc() || !text.starts_with(kBetween)) return {};
  holder.machine = text.substr(kBetween.size());
  return holder;
}

/// Whoever else does this at the same time gets the name of this process's file, and puts it back.
void remove_left(const std::filesystem::path& file, const std::string& text) {
  const std::filesystem::path aside = file.string() + fmt::format(".{}", ::getpid());
  if (::rename(file.c_str(), aside.c_str()) != 0) return;
  if (text_in(aside) != text) ::link(aside.c_str(), file.c_str());
  ::unlink(aside.c_str());
}

}  // namespace

void LockFile::release() {
  if (taken() && is_at(descriptor_, file_)) ::unlink(file_.c_str());
  descriptor_ = Descriptor();
}

std::string LockFile::take(const std::filesystem::path& file) {
  constexpr int kTries = 10;  // others may come and go
  for (int k = 0; k < kTries; ++k) {
    Descriptor made(::open(file.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666));
    if (made.open()) {
      const std::string text = text_of({::getpid(), name_of_this_machine()});
      file_ = file;
      descriptor_ = std::move(made);
      if (const int error = write_all(descriptor_, std::as_bytes(std::span(text)))) {
        throw OutputError(file, error);
      }
      return "";
    }
    if (errno != EEXIST) throw OutputError(file, errno);
    const std::string text = text_in(file);
    const Holder holder = holder_in(text);
    if (!holder.has_ended()) return holder.process > 0 ? text_of(holder) : "another process";
    remove_left(file, text);
  }
  return "another process";
}

}  // namespace tomlin
