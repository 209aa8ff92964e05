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

/// Some file systems have no fsync; then there is nothing to wait for.
bool synchronised(int descriptor) {
  return ::fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP;
}

/// So that the new name survives a power cut. The file itself is safe already.
void synchronise_folder_of(const std::filesystem::path& file) {
  const auto parent = file.parent_path();
  const int folder =
      ::open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return;
  ::fsync(folder);
  ::close(folder);
}

}  // namespace

OutputFile::OutputFile(std::filesystem::path file) : file_(std::move(file)), unfinished_(file_) {
  unfinished_ += kUnfinished;
  descriptor_ = ::open(unfinished_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail(errno);
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void OutputFile::append(std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor_, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(errno);
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

void OutputFile::write_at(std::uint64_t place, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written =
        ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(place));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(errno);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    place += static_cast<std::uint64_t>(written);
  }
}

void OutputFile::read_at(std::uint64_t place, std::span<std::byte> bytes) const {
  while (!bytes.empty()) {
    const ssize_t read =
        ::pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(place));
    if (read < 0 && errno == EINTR) continue;
    if (read < 0) fail(errno);
    if (read == 0) break;
    bytes = bytes.subspan(static_cast<std::size_t>(read));
    place += static_cast<std::uint64_t>(read);
  }
  std::fill(bytes.begin(), bytes.end(), std::byte{0});
}

void OutputFile::resize(std::uint64_t size) {
  while (::ftruncate(descriptor_, static_cast<off_t>(size)) != 0) {
    if (errno != EINTR) fail(errno);
  }
}

void OutputFile::publish() {
  if (!synchronised(descriptor_)) fail(errno);
  if (::close(std::exchange(descriptor_, -1)) != 0) fail(errno);
  if (std::rename(unfinished_.c_str(), file_.c_str()) != 0) fail(errno);
  synchronise_folder_of(file_);
}

void OutputFile::fail(int error) const {
  throw OutputError(fmt::format("cannot write {}: {}", unfinished_.string(),
                                std::generic_category().message(error)));
}

}  // namespace tomlin
