#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "framework/output/run_folder.hpp"
#include "framework/run/run.hpp"
#include "framework/scene/scene.hpp"

namespace tomlin {

/// A store (see RunStore) in a file of one checked record, which is written anew as a whole. What
/// cannot be written is computed again, and a file that is damaged, or of another owner, is as good
/// as none.
class StoreFile : public RunStore {
 public:
  enum class Before { read, ignore };  ///< what an earlier run has kept

  /// The store of a run in its folder, which must be owned. It belongs to the scene, the version of
  /// the program and the plugins, and is written whenever something is kept.
  StoreFile(const RunFolder& folder, const Scene& scene, const std::string& program_version,
            Before before);
  /// Any file, of which only what the same owner has kept is read; without a name the store is in
  /// memory alone. It is written when something is kept `every` seconds after the last time or
  /// after the start, and by write(): what is short leaves no file.
  StoreFile(std::filesystem::path file, std::string owner, double every);

  std::vector<std::byte> kept(const std::string& name) const override;
  void keep(const std::string& name, std::vector<std::byte> bytes) override;
  /// Writes what has been kept since the last time.
  void write();
  /// Removes the file, and what a kill has left unfinished of it.
  void remove() const;

 private:
  void read();

  const RunFolder* folder_ = nullptr;  ///< where it is that of a run
  std::filesystem::path file_;
  std::string owner_;
  double every_ = 0.0;
  std::chrono::steady_clock::time_point last_written_ = std::chrono::steady_clock::now();
  bool is_written_ = true;  ///< all of it
  std::map<std::string, std::vector<std::byte>> all_;
};

}  // namespace tomlin
