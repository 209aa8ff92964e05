#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <utility>

#include <unistd.h>

namespace tomlin {

/// An open file of the operating system, closed at the end.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(other.release()) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }

  int number() const { return number_; }
  bool open() const { return number_ >= 0; }
  /// The caller closes it.
  int release() { return std::exchange(number_, -1); }

 private:
  int number_ = -1;
};

/// Writes all of it. 0, or the reason why not.
int write_all(const Descriptor& file, std::span<const std::byte> bytes);
/// Writes all of it from `at` on, wherever the file ends. 0, or the reason why not.
int write_at(const Descriptor& file, std::span<const std::byte> bytes, std::size_t at);
/// Reads as much as there is from `at` on, up to the size of `bytes`. The number of bytes that were
/// read, or minus the reason why it cannot be done.
std::ptrdiff_t read_at(const Descriptor& file, std::span<std::byte> bytes, std::size_t at);
/// Waits until the file is on the disk. 0, or the reason why it is not.
int synchronise(const Descriptor& file);
/// An exclusive lock of an open file, which goes with its last descriptor.
enum class LockOutcome {
  taken,
  held,       ///< by another program
  not_known,  ///< the file system has no locks
};
LockOutcome lock(const Descriptor& file);
/// Makes the names in a file's folder survive a power cut; the files themselves do not need it.
void synchronise_folder_of(const std::filesystem::path& file);
/// Whether the open file is the one of this name.
bool is_at(const Descriptor& file, const std::filesystem::path& path);

}  // namespace tomlin
