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

OutputError::OutputError(const std::filesystem::path& file, int error)
    : OutputError(fmt::format("cannot write {}: {}", file.string(),
                              std::generic_category().message(error))) {}

std::filesystem::path unfinished(std::filesystem::path file) { return file += kUnfinished; }

OutputFile::OutputFile(std::filesystem::path file)
    : file_(std::move(file)), unfinished_(unfinished(file_)) {
  descriptor_ =
      Descriptor(::open(unfinished_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (!descriptor_.open()) fail(errno);
}

OutputFile::~OutputFile() {
  if (!published_) ::unlink(unfinished_.c_str());
}

void OutputFile::append(std::string_view text) { append(std::as_bytes(std::span(text))); }

void OutputFile::append(std::span<const std::byte> bytes) {
  if (const int error = write_all(descriptor_, bytes)) fail(error);
}

void OutputFile::write_at(std::uint64_t place, std::span<const std::byte> bytes) {
  if (const int error = tomlin::write_at(descriptor_, bytes, place)) fail(error);
}

void OutputFile::read_at(std::uint64_t place, std::span<std::byte> bytes) const {
  const std::ptrdiff_t read = tomlin::read_at(descriptor_, bytes, place);
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
  if (::close(descriptor_.release()) != 0) fail(errno);
  if (std::rename(unfinished_.c_str(), file_.c_str()) != 0) fail(errno);
  published_ = true;
}

void OutputFile::fail(int error) const { throw OutputError(unfinished_, error); }

}  // namespace tomlin
