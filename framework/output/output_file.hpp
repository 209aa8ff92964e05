#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "framework/output/descriptor.hpp"

namespace tomlin {

/// A result that could not be written; the message names the file and the reason.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  /// "cannot write FILE: REASON", of an error number.
  OutputError(const std::filesystem::path& file, int error);
};

/// Suffix of a file's name until the file is complete.
inline constexpr std::string_view kUnfinished = ".part";

/// Bytes of text that are gathered before they are appended to a file: 64 KiB, so that calls of the
/// system take no time beside the text itself.
inline constexpr std::size_t kTextAtOnce = std::size_t{1} << 16;

/// The name of a file that is not complete.
std::filesystem::path unfinished(std::filesystem::path file);

/// A file that appears complete or not at all: it is written as NAME.part and renamed when it is
/// published. One that never is disappears, unless the program was killed: then NAME.part stays
/// until somebody writes the same file. Who writes has NAME.part locked. Where another file has got
/// the name meanwhile, as in a folder that was moved and made anew, that is not touched. Everything
/// throws OutputError.
class OutputFile {
 public:
  /// Whether a file that has its name is whole even after a power cut, or may need a moment. (The
  /// name itself may be lost until its folder is synchronised.)
  enum class Lasting { with_its_name, some_time_later };

  /// Makes NAME.part, in place of one that nobody is writing any more.
  explicit OutputFile(std::filesystem::path file);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Writes at once, without a buffer.
  void append(std::string_view text);
  void append(std::span<const std::byte> bytes);
  /// Appends a text that has grown to kTextAtOnce, and empties it.
  void append_if_long(std::string& text);
  /// Writes anywhere in the file; bytes before that were never written are zero.
  void write_at(std::uint64_t offset, std::span<const std::byte> bytes);
  /// Reads what was written there; zeros behind the end.
  void read_at(std::uint64_t offset, std::span<std::byte> bytes) const;
  void resize(std::uint64_t size);
  /// Gives the file its name, replacing one that has it.
  void publish(Lasting lasting = Lasting::with_its_name);

 private:
  [[noreturn]] void fail(int error) const;

  std::filesystem::path file_;
  std::filesystem::path unfinished_;
  Descriptor descriptor_;
  bool published_ = false;
};

}  // namespace tomlin
