#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace tomlin {

/// A result that could not be written; the message names the file and the reason.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What stands behind a file's name until the file is complete.
inline constexpr std::string_view kUnfinished = ".part";

/// A file that appears complete or not at all: it is written as NAME.part and renamed when it is
/// published. One that never is, because the run was killed or the disk is full, stays NAME.part.
/// Everything throws OutputError.
class OutputFile {
 public:
  /// Opens NAME.part, which must not exist.
  explicit OutputFile(std::filesystem::path file);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Not buffered.
  void append(std::string_view text);
  /// The same anywhere in the file; what lies before it and was never written is zero.
  void write_at(std::uint64_t place, std::span<const std::byte> bytes);
  /// What was written there; zeros behind the end.
  void read_at(std::uint64_t place, std::span<std::byte> bytes) const;
  void resize(std::uint64_t size);
  /// Brings everything to the disk and gives the file its name, replacing one that has it.
  void publish();

 private:
  [[noreturn]] void fail(int error) const;

  std::filesystem::path file_;
  std::filesystem::path unfinished_;
  int descriptor_ = -1;
};

}  // namespace tomlin
