#pragma once

#include <array>
#include <filesystem>
#include <string_view>
#include <vector>

#include "framework/output/output_file.hpp"

namespace tomlin {

inline constexpr const char* kSummaryFile = "summary.json";
inline constexpr const char* kTableFile = "observables.csv";
inline constexpr const char* kSceneFile = "scene.toml";

/// Everything that a run leaves in its folder, and so all that --force may replace.
inline constexpr std::array kFilesOfARun = {kSummaryFile, kTableFile, kSceneFile};

/// What to do with a folder that has something in it.
enum class Occupied {
  refuse,
  replace_results,  ///< replace the files of a run, touch nothing else
};

/// The folder that a run writes its results to.
class RunFolder {
 public:
  /// Looks, and makes nothing. Throws InputError when the folder cannot be used.
  RunFolder(const std::filesystem::path& folder, Occupied occupied);
  /// A folder that was made and never written to disappears again.
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  /// Makes the folder with all above it. Throws InputError when that fails.
  void create();
  /// Takes away what an earlier run left. Throws OutputError.
  void remove_earlier_results();
  /// Writes a file whole or not at all. Throws OutputError.
  void write_file(std::string_view name, std::string_view text) const;

  const std::filesystem::path& path() const { return folder_; }
  std::filesystem::path file(std::string_view name) const { return folder_ / name; }

 private:
  void check_folder() const;
  void check_place_for_new() const;

  std::filesystem::path folder_;
  Occupied occupied_;
  std::vector<std::filesystem::path> made_;  ///< outermost first
};

}  // namespace tomlin
