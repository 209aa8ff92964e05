#pragma once

#include <filesystem>
#include <string>

#include "framework/output/descriptor.hpp"

namespace tomlin {

/// A file that says which program has a folder, for file systems without locks: it is made by one
/// program only. One that a killed program has left on this machine is replaced.
class LockFile {
 public:
  LockFile() = default;
  ~LockFile() { release(); }
  LockFile(const LockFile&) = delete;
  LockFile& operator=(const LockFile&) = delete;

  /// Makes the file. Empty, or who has made it: "process 12 on host". Throws OutputError.
  std::string take(const std::filesystem::path& file);
  /// Takes the file away.
  void release();
  bool taken() const { return descriptor_.open(); }

 private:
  std::filesystem::path file_;
  Descriptor descriptor_;
};

}  // namespace tomlin
