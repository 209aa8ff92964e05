#include "framework/output/output_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

namespace tomlin {
namespace {

/// Takes a file away that a killed program has left. 0, or why it stays: EBUSY when somebody is
/// writing it.
int remove_left(const std::filesystem::path& file) {
  const Descriptor left(::open(file.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  // A file that cannot be opened, a link say, has no writer.
  if (left.open()) {
    if (lock(left) == LockOutcome::held) return EBUSY;
    if (!is_at(left, file)) return 0;  // somebody else has taken it away
  }
  return ::unlink(file.c_str()) == 0 || errno == ENOENT ? 0 : errno;
}

}  // namespace

OutputError::OutputError(const std::filesystem::path& file, int error)
    : OutputError(fmt::format("cannot write {}: {}", file.string(),
                              std::generic_category().message(error))) {}

std::filesystem::path unfinished(std::filesystem::path file) { return file += kUnfinished; }

OutputFile::OutputFile(std::filesystem::path file)
    : file_(std::move(file)), unfinished_(unfinished(file_)) {
  constexpr int kTries = 10;  // others may come and go
  for (int k = 0; k < kTries && !descriptor_.open(); ++k) {
    descriptor_ =
        Descriptor(::open(unfinished_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (descriptor_.open()) break;
    if (errno != EEXIST) fail(errno);
    if (const int error = remove_left(unfinished_)) fail(error);
  }
  if (!descriptor_.open()) fail(EBUSY);
  // Only the owner of the folder writes here, if the file system has no locks.
  lock(descriptor_);
}

OutputFile::~OutputFile() {
  if (!published_ && is_at(descriptor_, unfinished_)) ::unlink(unfinished_.c_str());
}

void OutputFile::append(std::string_view text) { append(std::as_bytes(std::span(text))); }

void OutputFile::append(std::span<const std::byte> bytes) {
  if (const int error = write_all(descriptor_, bytes)) fail(error);
}

void OutputFile::append_if_long(std::string& text) {
  if (text.size() < kTextAtOnce) return;
  append(text);
  text.clear();
}

void OutputFile::write_at(std::uint64_t offset, std::span<const std::byte> bytes) {
  if (const int error = tomlin::write_at(descriptor_, bytes, offset)) fail(error);
}

void OutputFile::read_at(std::uint64_t offset, std::span<std::byte> bytes) const {
  const std::ptrdiff_t read = tomlin::read_at(descriptor_, bytes, offset);
  if (read < 0) fail(static_cast<int>(-read));
  std::fill(bytes.begin() + read, bytes.end(), std::byte{0});
}

void OutputFile::resize(std::uint64_t size) {
  if (::ftruncate(descriptor_.number(), static_cast<off_t>(size)) != 0) fail(errno);
}

void OutputFile::publish(Lasting lasting) {
  if (lasting == Lasting::with_its_name) {
    if (const int error = synchronise(descriptor_)) fail(error);
  }
  if (!is_at(descriptor_, unfinished_)) fail(ENOENT);
  // Some file systems tell only now that there was no room. The lock goes with the last descriptor.
  const Descriptor kept(::dup(descriptor_.number()));
  if (::close(descriptor_.release()) != 0) {
    const int error = errno;
    if (is_at(kept, unfinished_)) ::unlink(unfinished_.c_str());
    fail(error);
  }
  if (std::rename(unfinished_.c_str(), file_.c_str()) != 0) {
    const int error = errno;
    ::unlink(unfinished_.c_str());
    fail(error);
  }
  published_ = true;
}

void OutputFile::fail(int error) const { throw OutputError(unfinished_, error); }

}  // namespace tomlin
