#include "framework/core/text_file.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <ios>
#include <system_error>
#include <utility>

namespace tomlin {
namespace {

TextFile refused(std::string why) { return {"", std::move(why)}; }

}  // namespace

TextFile read_text_file(const std::filesystem::path& path, std::size_t most_bytes) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    const bool absent = !error || error == std::errc::no_such_file_or_directory;
    return refused(absent ? "there is no such file"
                          : "the file cannot be read: " + error.message());
  }
  if (std::filesystem::is_directory(status)) return refused("a directory, where a file is due");
  // Reading from a pipe that nobody writes to would never end.
  if (std::filesystem::is_fifo(status)) return refused("a pipe, where a file is due");
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return refused(std::string("the file cannot be read: ") + std::strerror(errno));
  TextFile file;
  file.text.resize(most_bytes + 1);
  stream.read(file.text.data(), static_cast<std::streamsize>(file.text.size()));
  if (stream.bad()) return refused("the file cannot be read");
  file.text.resize(static_cast<std::size_t>(stream.gcount()));
  return file;
}

}  // namespace tomlin
