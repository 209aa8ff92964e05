#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "framework/output/run_folder.hpp"
#include "framework/run/run.hpp"
#include "framework/scene/scene.hpp"

namespace tomlin {

/// The store of a run (see RunStore) in its folder, which must be owned: one checked record,
/// written anew whenever something is kept. A file that is damaged, or of another scene, version or
/// plugin, is as good as none.
class StoreFile : public RunStore {
 public:
  enum class Before { read, ignore };  ///< what an earlier run has kept

  StoreFile(const RunFolder& folder, const Scene& scene, const std::string& program_version,
            Before before);
  /// Keeps the store in any file: only what the same owner has kept there is read.
  StoreFile(std::filesystem::path file, std::string owner, Before before);

  std::vector<std::byte> kept(const std::string& name) const override;
  void keep(const std::string& name, std::vector<std::byte> bytes) override;

 private:
  void read();

  const RunFolder* folder_ = nullptr;  ///< where it is that of a run
  std::filesystem::path file_;
  std::string owner_;  ///< whose it is: version, scene and plugins
  std::map<std::string, std::vector<std::byte>> all_;
};

}  // namespace tomlin
